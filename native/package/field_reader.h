// SPDX-License-Identifier: Apache-2.0
// Bounded reading of a manifest's fields. Internal to package/.
#pragma once

#include <string>

#include "package/character.h"

namespace fourdvt::package {

constexpr double kMaxMetres = 1e6;

std::string item(const std::string& list, int index);  // JSON pointer of a list entry

// Keeps the first error. Values read after it are in range, but meaningless.
class FieldReader {
 public:
  explicit FieldReader(const FlatJson& json) : json_(json) {}
  bool ok() const { return problem_.empty(); }
  const std::string& problem() const { return problem_; }
  void fail(const std::string& pointer, const char* what);
  bool has(const std::string& pointer) const { return json_.has(pointer); }
  double number(const std::string& pointer, double low, double high);
  double integer(const std::string& pointer, double low, double high);
  std::string text(const std::string& pointer, size_t max_length);
  std::string uri(const std::string& pointer);
  uint64_t hash(const std::string& pointer);  // 16 hexadecimal digits
  bool flag(const std::string& pointer);
  // Reads a list of exactly `count` numbers.
  std::vector<double> numbers(const std::string& pointer, size_t count, double low, double high);
  glm::dvec3 vec3(const std::string& pointer);  // metres
  Rect rect(const std::string& pointer);
  // Length of a list; error outside [low, high].
  int arraySize(const std::string& pointer, int low, int high);

  // Overloads for a key ("/name") below `at`: half the code size at the call sites.
  void fail(const std::string& at, const char* key, const char* what);
  bool has(const std::string& at, const char* key) const;
  double number(const std::string& at, const char* key, double low, double high);
  double integer(const std::string& at, const char* key, double low, double high);
  std::string text(const std::string& at, const char* key, size_t max_length);
  std::string uri(const std::string& at, const char* key);
  uint64_t hash(const std::string& at, const char* key);
  bool flag(const std::string& at, const char* key);
  std::vector<double> numbers(const std::string& at, const char* key, size_t count, double low, double high);
  glm::dvec3 vec3(const std::string& at, const char* key);
  Rect rect(const std::string& at, const char* key);
  int arraySize(const std::string& at, const char* key, int low, int high);

 private:
  const FlatJson& json_;
  std::string problem_;
};

// Fields shared by the manifests of characters and live streams, file names excepted.

// Reads name, counts, box, ground, scale and cameras; for a character from cameras also the method. Requires
// `appearance` to be set.
void readBody(FieldReader& in, const std::string& at, Character& character);
void readLayout(FieldReader& in, const std::string& at, Sequence& sequence);  // character from cameras only
// Reads codec, size, barcode and layers of the tiled picture. layer_count: sum over the members; 0: a character from
// cameras, with tiles in place of layers.
void readPicture(FieldReader& in, const std::string& at, int layer_count, Rendition& rendition);

}  // namespace fourdvt::package
