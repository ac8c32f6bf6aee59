// SPDX-License-Identifier: Apache-2.0
// A refinement in a file, to be kept between bakes (store/folder.h).
#pragma once

#include <string>

#include "refine/refine.h"
#include "store/archive.h"

namespace fourdvt::refine {

// Errors: FileMissing, FileUnreadable; Internal for a damaged file, and for one that does not fit this capture.
Result<Refinement> loadRefinement(const std::string& path, const capture::Capture& capture);
// Hash of what it changes in a capture, not of what it measured.
uint64_t changeHash(const Refinement& refinement);

}  // namespace fourdvt::refine

namespace fourdvt::store {

void fields(Archive& a, refine::RefineOptions& o);
void fields(Archive& a, refine::Refinement& r);

}  // namespace fourdvt::store
