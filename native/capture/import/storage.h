// SPDX-License-Identifier: Apache-2.0
// Files of OpenCV's FileStorage from memory: nodes as lists of numbers. Its own reader crashes on XML that is cut off
// (4.6), so that XML is read by pugixml, and YAML and JSON, which is nearly YAML, by yaml-cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::capture {

class Storage {
 public:
  using Names = std::vector<std::string>;
  // XML, YAML or JSON, with or without its first line. Errors: FileUnreadable.
  static Result<Storage> open(const std::string& text, const std::string& path);
  // The numbers of the first of these nodes that is there: of a matrix row by row, of a list, or of one number. Empty
  // if there is none or if it holds anything else, or more than 64 numbers.
  std::vector<double> numbers(const Names& names) const;
  // The reason why the first of these nodes that is there is no list of `wanted` numbers, behind ": "; empty where it
  // is not known.
  std::string problem(const Names& names, size_t wanted) const;
  bool has(const Names& names) const;
  std::string text(const Names& names) const;                // empty if there is none
  std::vector<std::string> texts(const Names& names) const;  // a list's

 private:
  struct Tree;
  struct XmlTree;
  struct YamlTree;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace fourdvt::capture
