// SPDX-License-Identifier: Apache-2.0
// What `fourdvt render` was asked for, checked against the character where that needs one.
#pragma once

#include <string>
#include <vector>

#include "package/character.h"
#include "render/fvvr.h"
#include "render/recipe.h"
#include "tools/args.h"

namespace fourdvt::tools {

struct RenderArguments {
  std::string character, output, turntable;
  std::string sequence;  // empty: the first
  int frame = 0;
  std::optional<std::pair<int, int>> size;
  std::string camera, cameras_folder;  // camera name; folder of a COLMAP model, empty: the character's own
  std::optional<double> azimuth_deg, elevation_deg, distance_m, vertical_fov_deg;
  double seconds = 0;  // turntable; 0: whole loops, at least 8 s
  std::string debug;   // "", labels, layers, weights, normals
  render::RecipeOptions recipe;
  bool fvvr = false;           // the free-viewpoint baseline instead of the layers
  std::string capture_folder;  // fvvr only
  render::FvvrOptions fvvr_options;
};

const CommandHelp& renderHelp();
RenderArguments readRenderArguments(Args& args);
// The camera asked for. Errors: InvalidArgument, and those of reading the cameras.
Result<PinholeCamera> chooseCamera(const RenderArguments& arguments, const package::Character& character);
// The orbit asked for, for a picture of this size.
OrbitView chooseOrbit(const RenderArguments& arguments, const package::Character& character, int width, int height);

}  // namespace fourdvt::tools
