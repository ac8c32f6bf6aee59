// SPDX-License-Identifier: Apache-2.0
// PLY: position of every element "vertex", polygons of every element "face" and strips of every element "tristrips",
// ASCII or binary of either byte order. Other elements and properties are skipped; faces in an element of another name
// are an error.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <vector>

#include "base/bytes.h"
#include "base/text.h"
#include "capture/mesh_readers.h"
#include "capture/polygon.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr uint32_t kNoCorner = 0xffffffff;  // invalid index

enum class Format { Ascii, LittleEndian, BigEndian };
enum class Type { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

struct Property {
  std::string_view name;
  Type type = Type::Float;
  std::optional<Type> count_type;  // list properties only
};

struct Element {
  std::string_view name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::Ascii;
  std::vector<Element> elements;
};

std::optional<Type> typeNamed(std::string_view word) {
  struct Name {
    std::string_view old, sized;
    Type type;
  };
  constexpr std::array<Name, 8> kNames{{{"char", "int8", Type::Int8},
                                        {"uchar", "uint8", Type::UInt8},
                                        {"short", "int16", Type::Int16},
                                        {"ushort", "uint16", Type::UInt16},
                                        {"int", "int32", Type::Int32},
                                        {"uint", "uint32", Type::UInt32},
                                        {"float", "float32", Type::Float},
                                        {"double", "float64", Type::Double}}};
  for (const Name& name : kNames)
    if (word == name.old || word == name.sized) return name.type;
  return std::nullopt;
}

size_t sizeOf(Type type) {
  constexpr std::array<size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

// Reads the numbers behind the header in order. After the first failure ok() is false and all are 0.
class Numbers {
 public:
  Numbers(std::string_view bytes, Format format) : format_(format), text_(bytes), bytes_(bytesOf(bytes)) {}
  bool ok() const { return ok_; }
  bool atEnd() const { return at_end_; }
  // ASCII: the remaining text, from the word that failed first.
  std::string_view left() const { return text_; }
  // Returns false if `count` numbers exceed the remaining bytes: each takes its size, or in ASCII a digit and a
  // separator.
  bool holds(uint64_t count, Type type) const {
    return format_ == Format::Ascii ? count <= (text_.size() + 1) / 2 : count <= bytes_.remaining() / sizeOf(type);
  }
  double next(Type type) {
    const double value = format_ == Format::Ascii ? word() : binary(type);
    return ok_ ? value : 0;
  }

 private:
  double word() {
    const size_t begin = text_.find_first_not_of(" \t\r\n");
    text_.remove_prefix(std::min(begin, text_.size()));
    const size_t end = std::min(text_.find_first_of(" \t\r\n"), text_.size());
    const auto value = ok_ ? toNumber<double>(text_.substr(0, end)) : std::nullopt;
    if (!value) return fail(text_.empty());
    text_.remove_prefix(end);
    return *value;
  }

  double binary(Type type) {
    const size_t size = sizeOf(type);
    std::array<uint8_t, 8> raw{};
    const auto part = bytes_.bytes(size);
    if (!bytes_.ok()) return fail(true);
    std::copy(part.begin(), part.end(), raw.begin());
    if (format_ == Format::BigEndian) std::reverse(raw.begin(), raw.begin() + static_cast<long>(size));
    switch (type) {
      case Type::Int8:
        return as<int8_t>(raw);
      case Type::UInt8:
        return as<uint8_t>(raw);
      case Type::Int16:
        return as<int16_t>(raw);
      case Type::UInt16:
        return as<uint16_t>(raw);
      case Type::Int32:
        return as<int32_t>(raw);
      case Type::UInt32:
        return as<uint32_t>(raw);
      case Type::Float:
        return as<float>(raw);
      case Type::Double:
        break;
    }
    return as<double>(raw);
  }

  template <class T>
  static double as(const std::array<uint8_t, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }

  double fail(bool at_end) {
    if (ok_) at_end_ = at_end;
    ok_ = false;
    return 0;
  }

  Format format_;
  std::string_view text_;  // ASCII: remaining text
  ByteReader bytes_;       // binary
  bool ok_ = true, at_end_ = false;
};

class PlyParser {
 public:
  PlyParser(std::string_view bytes, const std::string& path) : whole_(bytes), rest_(bytes), path_(path) {}

  Result<TriangleMesh> parse() {
    FOURDVT_TRY(readHeader());
    Numbers numbers(rest_, header_.format);
    for (const Element& element : header_.elements) FOURDVT_TRY(readElement(element, numbers));
    if (mesh_.faces.empty()) return noFaces();
    if (const size_t corners = polygons_.split(mesh_.positions, mesh_.faces); corners > 0)
      return Error{ErrorId::Unsupported, path_ + ": " + tooManyCorners(corners)};
    return std::move(mesh_);
  }

 private:
  Error error(const std::string& what) const {
    return {ErrorId::FileUnreadable, path_ + ": " + what + "; export the mesh again"};
  }
  Error truncated() const { return error("the PLY ends before all that its header announces (truncated)"); }

  Error noFaces() const {
    const std::string elements =
        joined(header_.elements, ", ", [](const Element& element) { return element.name.substr(0, 40); });
    return {ErrorId::MeshIndex, path_ + ": no faces in it" + (elements.empty() ? "" : ", but " + elements) +
                                    "; export the mesh with its faces, not as points"};
  }

  Status readHeader() {
    std::string_view line;
    takeLine(rest_, line);  // "ply"
    bool has_format = false;
    while (true) {
      if (!takeHeaderLine(line)) return truncated();
      const std::string_view keyword = takeWord(line);
      if (keyword == "end_header") break;
      if (keyword == "format") {
        FOURDVT_TRY(readFormat(takeWord(line)));
        has_format = true;
      } else if (keyword == "element") {
        FOURDVT_TRY(addElement(line));
      } else if (keyword == "property") {
        FOURDVT_TRY(addProperty(line));
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        return error("the PLY's header has a line that begins with none of PLY's words");
      }
    }
    return has_format ? Status() : error("the PLY's header does not say its format");
  }

  // Takes a complete line; returns false for the rest of a file truncated inside its header.
  bool takeHeaderLine(std::string_view& line) {
    return rest_.find_first_of("\r\n") != rest_.npos && takeLine(rest_, line);
  }

  Status readFormat(std::string_view word) {
    if (word == "ascii")
      header_.format = Format::Ascii;
    else if (word == "binary_little_endian")
      header_.format = Format::LittleEndian;
    else if (word == "binary_big_endian")
      header_.format = Format::BigEndian;
    else
      return error("the PLY's format is none of ascii, binary_little_endian and binary_big_endian");
    return {};
  }

  Status addElement(std::string_view line) {
    Element element{takeWord(line), 0, {}};
    const auto count = toNumber<uint64_t>(takeWord(line));
    if (element.name.empty() || !count) return error("an \"element\" of the PLY's header has no count");
    element.count = *count;
    header_.elements.push_back(std::move(element));
    return {};
  }

  Status addProperty(std::string_view line) {
    Property property;
    std::string_view word = takeWord(line);
    const bool list = word == "list";
    if (list) {
      property.count_type = typeNamed(takeWord(line));
      word = takeWord(line);
    }
    const auto type = typeNamed(word);
    property.name = takeWord(line);
    if (!type || (list && !property.count_type) || property.name.empty() || header_.elements.empty())
      return error("a \"property\" of the PLY's header cannot be understood");
    property.type = *type;
    header_.elements.back().properties.push_back(property);
    return {};
  }

  Status readElement(const Element& element, Numbers& numbers) {
    if (element.properties.empty() || element.count == 0) return {};
    const Property& first = element.properties.front();
    if (!numbers.holds(element.count, first.count_type.value_or(first.type))) return truncated();
    const bool vertices = element.name == "vertex";
    FOURDVT_TRY(checkFaceLists(element));
    if (vertices) {
      FOURDVT_TRY(checkVertexProperties(element));
      mesh_.positions.reserve(mesh_.positions.size() + element.count);
    }
    for (uint64_t i = 0; i < element.count; ++i) {
      glm::vec3 position(0);
      for (const Property& property : element.properties) {
        if (property.count_type)
          FOURDVT_TRY(readList(element, property, numbers));
        else
          keepCoordinate(property.name, numbers.next(property.type), position);
      }
      if (!numbers.ok()) return failed(numbers);
      if (vertices) mesh_.positions.push_back(position);
    }
    return {};
  }

  Error failed(const Numbers& numbers) const {
    if (numbers.atEnd()) return truncated();
    const std::string_view left = numbers.left();
    return {ErrorId::FileUnreadable,
            atLine(path_, lineOfByte(whole_, whole_.size() - left.size())) + "where a number is due, " +
                numberProblem(left.substr(0, left.find_first_of(" \t\r\n"))) + "; export the mesh again"};
  }

  Status checkVertexProperties(const Element& element) const {
    for (const std::string_view name : {"x", "y", "z"}) {
      const auto is = [&](const Property& p) { return p.name == name && !p.count_type; };
      if (std::none_of(element.properties.begin(), element.properties.end(), is))
        return error("the PLY's vertices have no x, y and z");
    }
    return {};
  }

  static bool isFaceList(const Property& p) {
    return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
  }

  Status checkFaceLists(const Element& element) const {
    const auto& properties = element.properties;
    if (element.name == "face" || element.name == "tristrips" ||
        std::none_of(properties.begin(), properties.end(), isFaceList))
      return {};
    return Error{ErrorId::Unsupported, path_ + ": has faces in the element \"" +
                                           std::string(element.name.substr(0, 40)) +
                                           "\", but \"face\" and \"tristrips\" are read; export as one of them"};
  }

  static void keepCoordinate(std::string_view name, double value, glm::vec3& position) {
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') position[name[0] - 'x'] = static_cast<float>(value);
  }

  Status readList(const Element& element, const Property& property, Numbers& numbers) {
    const double count = numbers.next(*property.count_type);
    if (!numbers.ok()) return failed(numbers);
    if (!(count >= 0) || count > 0xffffffffu) return error("a list of the PLY has no valid length");
    if (!numbers.holds(static_cast<uint64_t>(count), property.type)) return truncated();
    const bool kept = isFaceList(property);
    corners_.clear();
    for (uint64_t i = 0; i < static_cast<uint64_t>(count); ++i) {
      const double value = numbers.next(property.type);
      if (kept) corners_.push_back(value >= 0 && value < kNoCorner ? static_cast<uint32_t>(value) : kNoCorner);
    }
    if (!numbers.ok()) return failed(numbers);
    if (kept) element.name == "face" ? addPolygon() : addStrips();
    return {};
  }

  // Adds a fan, which is replaced once the positions are known.
  void addPolygon() {
    polygons_.add(mesh_.faces.size(), corners_);
    for (size_t i = 2; i < corners_.size(); ++i) mesh_.faces.emplace_back(corners_[0], corners_[i - 1], corners_[i]);
  }

  // Adds strips: -1 separates them; degenerate triangles only join parts of a strip.
  void addStrips() {
    size_t begin = 0;
    for (size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == kNoCorner) begin = i + 1;
      if (i < begin + 2) continue;
      glm::uvec3 face(corners_[i - 2], corners_[i - 1], corners_[i]);
      if ((i - begin) % 2 == 1) std::swap(face.x, face.y);
      if (face.x != face.y && face.y != face.z && face.z != face.x) mesh_.faces.push_back(face);
    }
  }

  std::string_view whole_, rest_;
  const std::string& path_;
  Header header_;
  TriangleMesh mesh_;
  LatePolygons polygons_;
  std::vector<uint32_t> corners_;  // corners of one list
};

}  // namespace

Result<TriangleMesh> parsePly(std::string_view bytes, const std::string& path) {
  return PlyParser(bytes, path).parse();
}

}  // namespace fourdvt::capture
