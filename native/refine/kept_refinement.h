// SPDX-License-Identifier: Apache-2.0
// Serialisation of a refinement, cached between bakes (store/folder.h).
#pragma once

#include <string>

#include "refine/refine.h"
#include "store/archive.h"

namespace fourdvt::refine {

// Errors: FileMissing, FileUnreadable; Internal for a damaged file or one of another capture.
Result<Refinement> loadRefinement(const std::string& path, const capture::Capture& capture);
// Hash of the changes to a capture, without the measurements.
uint64_t changeHash(const Refinement& refinement);

}  // namespace fourdvt::refine

namespace fourdvt::store {

void fields(Archive& a, refine::RefineOptions& o);
void fields(Archive& a, refine::Refinement& r);

}  // namespace fourdvt::store
