// SPDX-License-Identifier: Apache-2.0
// What `fourdvt render` is asked for. What depends on the character is checked once there is one.
#pragma once

#include <string>
#include <vector>

#include "package/character.h"
#include "render/cameras/fvvr.h"
#include "render/recipe.h"
#include "tools/args.h"
#include "tools/look_arguments.h"
#include "tools/motion_arguments.h"
#include "tools/refine_arguments.h"

namespace fourdvt::tools {

// Where the picture is taken from.
struct ViewArguments {
  std::optional<std::pair<int, int>> size;
  std::string camera, cameras_folder;  // camera name; folder of a COLMAP model, empty: the character's own cameras
  std::optional<double> azimuth_deg, elevation_deg, distance_m, vertical_fov_deg;
};

// The free-viewpoint baseline from a capture's videos.
struct FvvrArguments {
  bool wanted = false;
  std::string capture_folder;
  refine::RefineOptions refine;
  render::FvvrOptions options;
  render::DepthMapOptions depth_maps;
};

struct RenderArguments {
  std::string character, output, turntable;
  std::string sequence;  // or class; empty: the first
  bool wants_class = false;
  std::optional<int> rendition;  // as openCharacter takes it
  int frame = 0;
  std::optional<double> phase;  // position in one pass, 0…1; instead of the frame
  Parameters parameters;
  AlignMethod align = AlignMethod::Baked;
  std::optional<Sweep> sweep;
  std::vector<Cue> cues;
  bool travel = false, follow = false;
  std::string scene;  // scene.json instead of `character`
  double fps = 25;    // of movies by --sweep and --play
  ViewArguments view;
  double seconds = 0;  // length of a movie; 0: what its kind takes
  std::string debug;   // "", labels, layers, weights, normals
  render::RecipeOptions recipe;
  std::string method_name;  // empty: what the character is decides
  render::MethodOptions method;
  bool chooses_cameras = false;  // some of `method` was asked for
  LookArguments look;
  bool room = false;  // the character's room as background
  FvvrArguments fvvr;
  bool movie() const;  // whether the output is a movie
};

const CommandHelp& renderHelp();
RenderArguments readRenderArguments(Args& args);
// Whether the character can be drawn so. Errors: InvalidArgument.
Status checkMethod(const RenderArguments& arguments, const package::Character& character);
// The camera asked for. Errors: InvalidArgument, and those of reading the cameras.
Result<PinholeCamera> chooseCamera(const RenderArguments& arguments, const package::Character& character);
// The orbit asked for, for a picture of this size.
OrbitView chooseOrbit(const RenderArguments& arguments, const package::Character& character, int width, int height);

}  // namespace fourdvt::tools
