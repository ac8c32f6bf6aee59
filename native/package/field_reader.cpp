// SPDX-License-Identifier: Apache-2.0
#include "package/field_reader.h"

#include <cmath>

namespace fourdvt::package {
namespace {

bool isPlain(char c) {
  const char lower = static_cast<char>(c | 32);
  return (lower >= 'a' && lower <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

// Returns true for a URI of non-empty segments of plain characters, none of them "." or "..": no URL parser resolves it
// outside of the character folder.
bool isSafeUri(const std::string& uri) {
  size_t segment = 0;
  for (size_t i = 0; i <= uri.size(); ++i) {
    if (i < uri.size() && uri[i] != '/') {
      if (!isPlain(uri[i])) return false;
      continue;
    }
    const size_t length = i - segment;
    if (length == 0 || (length < 3 && uri.find_first_not_of('.', segment) >= i)) return false;
    segment = i + 1;
  }
  return true;
}

}  // namespace

std::string item(const std::string& list, int index) { return list + "/" + std::to_string(index); }

void FieldReader::fail(const std::string& pointer, const char* what) {
  if (ok()) problem_ = pointer + " " + what;
}

double FieldReader::number(const std::string& pointer, double low, double high) {
  const auto value = json_.number(pointer);
  if (!value) return fail(pointer, "is missing or not a number"), low;
  if (!(*value >= low && *value <= high)) return fail(pointer, "is out of range"), low;
  return *value;
}

double FieldReader::integer(const std::string& pointer, double low, double high) {
  const double value = number(pointer, low, high);
  if (value != std::floor(value)) fail(pointer, "is not a whole number");
  return value;
}

std::string FieldReader::text(const std::string& pointer, size_t max_length) {
  const auto value = json_.string(pointer);
  if (!value || value->empty()) return fail(pointer, "is missing or not a string"), std::string();
  if (value->size() > max_length) return fail(pointer, "is too long"), std::string();
  return *value;
}

std::string FieldReader::uri(const std::string& pointer) {
  std::string value = text(pointer, 512);
  if (ok() && !isSafeUri(value))
    fail(pointer, "must be a relative path of letters, digits and . _ - / inside the character folder");
  return value;
}

uint64_t FieldReader::hash(const std::string& pointer) {
  const std::string digits = text(pointer, 16);
  uint64_t value = 0;
  bool good = digits.size() == 16;
  for (const char c : digits) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    good = good && digit >= 0;
    value = 16 * value + uint64_t(digit);
  }
  if (!good) fail(pointer, "is not a hash of 16 hexadecimal digits");
  return value;
}

bool FieldReader::flag(const std::string& pointer) {
  const auto value = json_.boolean(pointer);
  if (!value) fail(pointer, "is missing or not true/false");
  return value.value_or(false);
}

std::vector<double> FieldReader::numbers(const std::string& pointer, size_t count, double low, double high) {
  const int size = arraySize(pointer, int(count), int(count));
  std::vector<double> out;
  for (int i = 0; i < size; ++i) out.push_back(number(item(pointer, i), low, high));
  out.resize(count);
  return out;
}

glm::dvec3 FieldReader::vec3(const std::string& pointer) {
  const std::vector<double> v = numbers(pointer, 3, -kMaxMetres, kMaxMetres);
  return {v[0], v[1], v[2]};
}

Rect FieldReader::rect(const std::string& pointer) {
  int v[4];
  for (int i = 0; i < 4; ++i) v[i] = int(integer(item(pointer, i), 0, kMaxPictureSide));
  return {v[0], v[1], v[2], v[3]};
}

int FieldReader::arraySize(const std::string& pointer, int low, int high) {
  int count = 0;
  while (count <= high && json_.has(item(pointer, count))) ++count;
  if (count < low || count > high)
    fail(pointer, ("must have " + std::to_string(low) + " to " + std::to_string(high) + " entries").c_str());
  return ok() ? count : 0;
}

void FieldReader::fail(const std::string& at, const char* key, const char* what) { fail(at + key, what); }
bool FieldReader::has(const std::string& at, const char* key) const { return has(at + key); }
double FieldReader::number(const std::string& at, const char* key, double low, double high) {
  return number(at + key, low, high);
}
double FieldReader::integer(const std::string& at, const char* key, double low, double high) {
  return integer(at + key, low, high);
}
std::string FieldReader::text(const std::string& at, const char* key, size_t max_length) {
  return text(at + key, max_length);
}
std::string FieldReader::uri(const std::string& at, const char* key) { return uri(at + key); }
uint64_t FieldReader::hash(const std::string& at, const char* key) { return hash(at + key); }
bool FieldReader::flag(const std::string& at, const char* key) { return flag(at + key); }
std::vector<double> FieldReader::numbers(const std::string& at, const char* key, size_t count, double low,
                                         double high) {
  return numbers(at + key, count, low, high);
}
glm::dvec3 FieldReader::vec3(const std::string& at, const char* key) { return vec3(at + key); }
Rect FieldReader::rect(const std::string& at, const char* key) { return rect(at + key); }
int FieldReader::arraySize(const std::string& at, const char* key, int low, int high) {
  return arraySize(at + key, low, high);
}

}  // namespace fourdvt::package
