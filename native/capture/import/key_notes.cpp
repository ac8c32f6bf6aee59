// SPDX-License-Identifier: Apache-2.0
#include "capture/import/key_notes.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxNamed = 40;  // keys per line

std::string listOf(const std::set<std::string>& keys) {
  std::string out;
  size_t named = 0;
  for (const std::string& key : keys) {
    if (++named > kMaxNamed) return out + " and " + std::to_string(keys.size() - kMaxNamed) + " more";
    out += (out.empty() ? "" : ", ") + key;
  }
  return out;
}

}  // namespace

void KeyNotes::see(const std::string& key) {
  if (read_.count(key)) return;
  (known_.count(key) ? not_read_ : unknown_).insert(key);
}

void KeyNotes::finish(ImportedCalibration& out) const {
  if (!not_read_.empty())
    out.warnings.push_back(out.path + ": not read: " + listOf(not_read_) + "; check that the cameras do not need it");
  if (!unknown_.empty()) out.details.push_back(out.path + ": unknown keys, passed over: " + listOf(unknown_));
}

}  // namespace fourdvt::capture
