// SPDX-License-Identifier: Apache-2.0
// Files of OpenCV's FileStorage from memory: nodes as lists of numbers. OpenCV's own reader crashes on truncated XML
// (4.6), hence XML is read by pugixml, and YAML and JSON, a near subset of YAML, by yaml-cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::capture {

class Storage {
 public:
  using Names = std::vector<std::string>;
  // Parses XML, YAML or JSON, with or without its first line. Errors: FileUnreadable.
  static Result<Storage> open(const std::string& text, const std::string& path);
  // Numbers of the first existing node: a matrix row by row, a list, or one number. Empty for missing nodes, other
  // contents, or more than 64 numbers.
  std::vector<double> numbers(const Names& names) const;
  // Reason why the first existing node is no list of `wanted` numbers, prefixed with ": "; empty if unknown.
  std::string problem(const Names& names, size_t wanted) const;
  bool has(const Names& names) const;
  std::string text(const Names& names) const;                // empty without one
  std::vector<std::string> texts(const Names& names) const;  // strings of a list

 private:
  struct Tree;
  struct XmlTree;
  struct YamlTree;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace fourdvt::capture
