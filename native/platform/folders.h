// SPDX-License-Identifier: Apache-2.0
// Output folders of long commands: creation with parents, removal, atomic replacement of an older one.
#pragma once

#include <functional>
#include <string>

#include "base/result.h"

namespace fourdvt::platform {

// Creates the folder and its parents; leaves an existing one unchanged. Errors: WriteFailed.
Status makeFolder(const std::string& path);
void removeFolder(const std::string& path);
// Variant that deletes the file `last` in it after all else, so that a partly removed folder still has it.
void removeFolder(const std::string& path, const std::string& last);
// Removes the folder's entries whose names satisfy `chosen`.
void removeEntries(const std::string& folder, const std::function<bool(const std::string& name)>& chosen);
void removeIfEmpty(const std::string& path);
// Renames `from` to `to`; an earlier `to` becomes `previous`. On failure `to` is unchanged. All three lie on one file
// system. Errors: WriteFailed.
Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous);

}  // namespace fourdvt::platform
