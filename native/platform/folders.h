// SPDX-License-Identifier: Apache-2.0
// Folders that a long command writes its result into: made with their parents, removed, put in the place of an older
// one.
#pragma once

#include <functional>
#include <string>

#include "base/result.h"

namespace fourdvt::platform {

// Creates the folder and its parents; one that exists is left as it is. Errors: WriteFailed.
Status makeFolder(const std::string& path);
void removeFolder(const std::string& path);
// The same; the file `last` in it goes after all else, so that a folder that is left half removed still has it.
void removeFolder(const std::string& path, const std::string& last);
// Removes those files and folders of the folder whose names are chosen.
void removeEntries(const std::string& folder, const std::function<bool(const std::string& name)>& chosen);
void removeIfEmpty(const std::string& path);
// `from` takes the place of `to`; an earlier `to` becomes `previous`. On failure `to` is as before. All three lie on
// one file system. Errors: WriteFailed.
Status replaceFolder(const std::string& from, const std::string& to, const std::string& previous);

}  // namespace fourdvt::platform
