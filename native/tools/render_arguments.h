// SPDX-License-Identifier: Apache-2.0
// What `fourdvt render` is asked for. What depends on the character is checked once there is one.
#pragma once

#include <string>
#include <vector>

#include "edge/motion.h"
#include "package/character.h"
#include "refine/refine.h"
#include "render/method.h"
#include "render/recipe.h"
#include "render/styles/styles.h"
#include "tools/args.h"

namespace fourdvt::tools {

// Where the picture is taken from.
struct ViewArguments {
  std::optional<std::pair<int, int>> size;
  std::string camera, cameras_folder;  // camera name; folder of a COLMAP model, empty: the character's own cameras
  std::optional<double> azimuth_deg, elevation_deg, distance_m, vertical_fov_deg;
};

// The free-viewpoint baseline from a capture's videos.
struct FvvrArguments {
  std::string capture_folder;  // empty: the character's own pictures or layers
  refine::RefineOptions refine;
};

// The look that figures are drawn in (render/styles/styles.h).
struct LookArguments {
  std::optional<render::StyleKind> kind;  // none: as filmed
  float strength = 1;
  std::string light_picture;  // equirectangular; empty: the light of StyleOptions
  double light_turn_deg = 0;
};

struct RenderArguments {
  std::string character, output, turntable;
  std::string sequence;          // or class; empty: the first
  std::string motion_class;      // if a class is given
  std::optional<int> rendition;  // as openCharacter takes it
  int frame = 0;
  std::optional<double> phase;  // position in one pass, 0…1; instead of the frame
  edge::Parameters parameters;
  edge::AlignMethod align = edge::AlignMethod::Baked;
  std::optional<edge::Sweep> sweep;
  std::vector<edge::Cue> cues;
  bool travel = false, follow = false;
  std::string scene;  // scene.json instead of `character`
  double fps = 25;    // of movies by --sweep and --play
  ViewArguments view;
  double seconds = 0;  // length of a movie; 0: what its kind takes
  render::RecipeOptions recipe;
  std::string method_name;  // empty: what the character is decides
  std::optional<int> closest;
  render::MethodOptions method;
  bool chooses_cameras = false;  // some of `method` is given
  LookArguments look;
  bool room = false;  // the character's room as background
  FvvrArguments fvvr;
  bool fromCapture() const { return !fvvr.capture_folder.empty(); }
  bool playing() const { return sweep || !cues.empty(); }
  bool movie() const;  // the output is one
  bool drawsLayersApart() const {
    return recipe.debug == render::DebugView::Layer || recipe.debug == render::DebugView::Labels;
  }
};

// Sets the arguments; with a value, help or a problem was printed, and that is the exit code.
std::optional<int> readRenderCommand(int argc, char** argv, RenderArguments& arguments);
// Checks that the character can be drawn so. Errors: InvalidArgument.
Status checkMethod(const RenderArguments& arguments, const package::Character& character);
// Errors: those of reading the picture, with its path; GpuFailure.
Status setLook(const LookArguments& look, gpu::Device& device, render::Recipe& recipe);
// The camera asked for. Errors: InvalidArgument, and those of reading the cameras.
Result<PinholeCamera> chooseCamera(const RenderArguments& arguments, const package::Character& character);
// The orbit asked for, for a picture of this size.
OrbitView chooseOrbit(const RenderArguments& arguments, const package::Character& character, int width, int height);

// Renders --sweep and --play: one character, with the camera from the arguments.
Status renderMotion(const RenderArguments& arguments);
// Renders --scene.
Status renderScene(const RenderArguments& arguments);

}  // namespace fourdvt::tools
