// SPDX-License-Identifier: Apache-2.0
// Keys of a calibration file that were not read: known ones become one warning, others a detail.
#pragma once

#include <set>
#include <string>

#include "capture/import/imported.h"

namespace fourdvt::capture {

class KeyNotes {
 public:
  // `read`: keys that the reader reads; `known`: keys of the format that bear on cameras or pictures and are not read.
  KeyNotes(std::set<std::string> read, std::set<std::string> known)
      : read_(std::move(read)), known_(std::move(known)) {}
  void see(const std::string& key);
  // Adds at most one warning and one detail to the calibration.
  void finish(ImportedCalibration& out) const;

 private:
  std::set<std::string> read_, known_, not_read_, unknown_;
};

}  // namespace fourdvt::capture
