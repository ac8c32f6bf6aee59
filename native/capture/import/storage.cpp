// SPDX-License-Identifier: Apache-2.0
#include "capture/import/storage.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <pugixml.hpp>

#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxNumbers = 64;
constexpr size_t kMaxTexts = 1024;
constexpr size_t kMaxStorageBytes = 4 << 20;  // yaml-cpp takes a hundred times as much memory
constexpr int kMaxNesting = 3;

// Words of the node, of its <data>, or of its list of <_>; nullopt if it contains other elements.
std::optional<std::vector<std::string>> xmlWords(const pugi::xml_node& node, int nesting = 0) {
  if (nesting > kMaxNesting) return std::nullopt;
  if (nesting == 0 && node.child("data")) return xmlWords(node.child("data"), 1);
  std::vector<std::string> out;
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() == pugi::node_comment) continue;
    if (child.type() == pugi::node_element) {
      const auto inner = std::string(child.name()) == "_" ? xmlWords(child, nesting + 1) : std::nullopt;
      if (!inner) return std::nullopt;
      out.insert(out.end(), inner->begin(), inner->end());
    } else {
      std::string text = child.value();
      for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
      std::string_view rest = text;
      for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) out.emplace_back(word);
    }
    if (out.size() > kMaxTexts) return std::nullopt;
  }
  return out;
}

bool yamlWords(const YAML::Node& node, int nesting, std::vector<std::string>& out) {
  if (node.IsScalar()) {
    out.push_back(node.Scalar());
    return out.size() <= kMaxTexts;
  }
  if (nesting == 0 && node.IsMap()) return node["data"].IsDefined() && yamlWords(node["data"], 1, out);
  if (!node.IsSequence() || nesting > kMaxNesting) return false;
  for (const YAML::Node& child : node)
    if (!yamlWords(child, nesting + 1, out)) return false;
  return true;
}

// Removes OpenCV's "%YAML:1.0", which is an invalid YAML directive.
std::string withoutDirective(const std::string& text) {
  if (!text.starts_with("%YAML:")) return text;
  const size_t end = text.find('\n');
  return end == std::string::npos ? std::string() : text.substr(end + 1);
}

std::string unquoted(std::string text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') return text.substr(1, text.size() - 2);
  return text;
}

Error notStorage(const std::string& where) {
  return {ErrorId::FileUnreadable,
          where + "not a file of OpenCV's FileStorage (XML, YAML, JSON); export the calibration again"};
}

}  // namespace

struct Storage::Tree {
  virtual ~Tree() = default;
  virtual bool has(const std::string& name) const = 0;
  // Words of an existing node; nullopt if they are no list.
  virtual std::optional<std::vector<std::string>> words(const std::string& name) const = 0;
};

struct Storage::XmlTree : Storage::Tree {
  pugi::xml_document document;
  pugi::xml_node node(const std::string& name) const { return document.document_element().child(name.c_str()); }
  bool has(const std::string& name) const override { return !node(name).empty(); }
  std::optional<std::vector<std::string>> words(const std::string& name) const override { return xmlWords(node(name)); }
};

struct Storage::YamlTree : Storage::Tree {
  explicit YamlTree(const YAML::Node& given) : root(given) {}
  const YAML::Node root;
  bool has(const std::string& name) const override { return root[name].IsDefined(); }
  std::optional<std::vector<std::string>> words(const std::string& name) const override {
    std::vector<std::string> out;
    if (yamlWords(root[name], 0, out)) return out;
    return std::nullopt;
  }
};

Result<Storage> Storage::open(const std::string& text, const std::string& path) {
  const Error bad = notStorage(path + ": ");
  const size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos || text.size() > kMaxStorageBytes || text.find('\0') != std::string::npos) return bad;
  Storage out;
  if (text[begin] == '<') {
    auto tree = std::make_shared<XmlTree>();
    const auto parsed = tree->document.load_buffer(text.data() + begin, text.size() - begin);
    if (!parsed) {
      const int line = lineOfByte(text, begin + static_cast<size_t>(std::max<ptrdiff_t>(parsed.offset, 0)));
      return notStorage(atLine(path, line));
    }
    out.tree_ = std::move(tree);
    return out;
  }
  try {
    std::string yaml = withoutDirective(text.substr(begin));
    if (yaml[0] == '{') std::replace(yaml.begin(), yaml.end(), '\t', ' ');  // JSON may be indented by tabs
    const YAML::Node root = YAML::Load(yaml);
    if (!root.IsMap()) return bad;
    out.tree_ = std::make_shared<YamlTree>(root);
  } catch (const YAML::ParserException& error) {
    const int before = text.starts_with("%YAML:") ? 2 : 1;  // the directive's line is removed
    return notStorage(atLine(path, lineOfByte(text, begin) - 1 + std::max(error.mark.line, 0) + before));
  } catch (const std::exception&) {
    return bad;
  }
  return out;
}

bool Storage::has(const Names& names) const {
  for (const std::string& name : names)
    if (tree_->has(name)) return true;
  return false;
}

std::vector<std::string> Storage::texts(const Names& names) const {
  for (const std::string& name : names) {
    if (!tree_->has(name)) continue;
    auto words = tree_->words(name).value_or(std::vector<std::string>());
    for (std::string& word : words) word = unquoted(word);
    return words;
  }
  return {};
}

std::vector<double> Storage::numbers(const Names& names) const {
  std::vector<double> out;
  for (std::string word : texts(names)) {
    const auto number = toNumber<double>(word);
    if (!number && word != ".Nan" && word != ".nan" && word != ".NaN") return {};
    out.push_back(number.value_or(NAN));
  }
  return out.size() > kMaxNumbers ? std::vector<double>() : out;
}

std::string Storage::problem(const Names& names, size_t wanted) const {
  const auto words = texts(names);
  for (const std::string& word : words)
    if (!toNumber<double>(word)) return ": " + numberProblem(word);
  return tooManyNumbers(words.size(), wanted);
}

std::string Storage::text(const Names& names) const {
  const auto words = texts(names);
  return words.size() == 1 ? words[0] : std::string();
}

}  // namespace fourdvt::capture
