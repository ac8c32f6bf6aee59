// SPDX-License-Identifier: Apache-2.0
// Options of every command that reads a capture's meshes and cameras: refinement of both against the pictures.
#pragma once

#include "refine/refine.h"
#include "tools/args.h"

namespace fourdvt::tools {

inline constexpr Option kRefineOption{
    "--refine", "MODE",
    "outline (default): move the mesh along its normals until its outlines match the mattes; none: as given"};
inline constexpr Option kRefineCamerasOption{
    "--refine-cameras", "MODE", "on (default): correct cameras that the mattes clearly contradict; off: as given"};
inline constexpr Option kMatteBiasOption{
    "--matte-bias-px", "PX",
    "margin of the mattes beyond the performer's outline, pixels; negative if they are too small (default: measured)"};

refine::RefineOptions readRefineOptions(Args& args);

}  // namespace fourdvt::tools
