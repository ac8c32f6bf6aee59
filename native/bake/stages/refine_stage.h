// SPDX-License-Identifier: Apache-2.0
// Before anything looks at meshes and cameras: makes both agree with the pictures (refine/refine.h). A refinement is
// kept in the survey folder under a key of the capture and of the options, so that a bake that was stopped goes on with
// it.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// FOLDER/refinement_<hash>.bin
std::string refinementPath(const std::string& folder, const capture::Capture& capture,
                           const refine::RefineOptions& options);
// What is kept at `path`, else a new refinement. `on_progress`: as of refineCapture. Errors: those of refineCapture.
Result<refine::Refinement> loadOrRefine(const std::string& path, const capture::Capture& capture,
                                        const refine::RefineOptions& options, const OpenVideo& open_video,
                                        const std::function<bool(const std::string& what, double share)>& on_progress);
// Errors: WriteFailed.
Status keepRefinement(const std::string& path, const refine::Refinement& refinement);

// Refines the run's capture, if its options ask for it, and plans again what depends on meshes and cameras.
Status refineJob(BakeRun& run);
// Keeps the run's refinement, if there is one, where refineJob of the next run finds it.
Status keepRefinement(const BakeRun& run);
// Adds the pictures of the job's refinement to it, from where it was kept. False if they are not there.
bool loadRefinementPictures(Job& job);

}  // namespace fourdvt::bake
