// SPDX-License-Identifier: Apache-2.0
// Unread keys of a calibration file: known ones become one warning, others a detail.
#pragma once

#include <set>
#include <string>

#include "capture/import/imported.h"

namespace fourdvt::capture {

class KeyNotes {
 public:
  // `read`: keys used by the reader; `known`: unread keys of the format that affect cameras or pictures.
  KeyNotes(std::set<std::string> read, std::set<std::string> known)
      : read_(std::move(read)), known_(std::move(known)) {}
  void see(const std::string& key);
  // Adds at most one warning and one detail to the calibration.
  void finish(ImportedCalibration& out) const;

 private:
  std::set<std::string> read_, known_, not_read_, unknown_;
};

}  // namespace fourdvt::capture
