// SPDX-License-Identifier: Apache-2.0
// Stores the solved windows of a sequence's labels until the labels are complete, in files beside theirs.
#pragma once

#include <string>

#include "bake/labels/labelling.h"

namespace fourdvt::bake {

class KeptWindows {
 public:
  explicit KeptWindows(std::string labels_path) : path_(std::move(labels_path)) {}
  // Borrows this object. A damaged file counts as absent.
  LabelKeeper keeper() const;
  // Removes the windows of this sequence's labels, and no others.
  void remove() const;

 private:
  std::string pathOf(uint32_t first, uint32_t end) const;
  std::string path_;
};

}  // namespace fourdvt::bake
