// SPDX-License-Identifier: Apache-2.0
// The options of every command that reads a capture's meshes and cameras: whether both are made to fit the pictures.
#pragma once

#include "refine/refine.h"
#include "tools/args.h"

namespace fourdvt::tools {

inline constexpr Option kRefineOption{
    "--refine", "MODE",
    "outline (default): the mesh moves along its normals until its outlines lie on the mattes'; none: as given"};
inline constexpr Option kRefineCamerasOption{
    "--refine-cameras", "MODE",
    "on (default): cameras that the mattes clearly contradict are turned, moved and zoomed; off: as given"};
inline constexpr Option kMatteBiasOption{
    "--matte-bias-px", "PX",
    "how far the mattes' edges lie outside the figure's, negative: too small (default: measured in the pictures)"};

refine::RefineOptions readRefineOptions(Args& args);

}  // namespace fourdvt::tools
