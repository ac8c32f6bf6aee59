// SPDX-License-Identifier: Apache-2.0
// Arguments of `fourdvt render`. Checks that depend on the character follow once it is open.
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

// Viewpoint of the picture.
struct ViewArguments {
  std::optional<std::pair<int, int>> size;
  std::string camera, cameras_folder;  // camera name; folder of a COLMAP model, empty: the character's own cameras
  std::optional<double> azimuth_deg, elevation_deg, distance_m, vertical_fov_deg;
};

// Free-viewpoint baseline from a capture's videos.
struct FvvrArguments {
  std::string capture_folder;  // empty: the character's own pictures or layers
  refine::RefineOptions refine;
};

// Drawing style of the figures (render/styles/styles.h).
struct LookArguments {
  std::optional<render::StyleKind> kind;  // none: as filmed
  float strength = 1;
  std::string light_picture;  // equirectangular; empty: the light of StyleOptions
  double light_turn_deg = 0;
};

struct RenderArguments {
  std::string character, output, turntable;
  std::string sequence;          // or class; empty: the first
  std::string motion_class;      // set if a class is given
  std::optional<int> rendition;  // as openCharacter takes it
  int frame = 0;
  std::optional<double> phase;  // position in one cycle, 0…1; replaces the frame
  edge::Parameters parameters;
  edge::AlignMethod align = edge::AlignMethod::Baked;
  std::optional<edge::Sweep> sweep;
  std::vector<edge::Cue> cues;
  bool travel = false, follow = false;
  std::string scene;  // scene.json instead of `character`
  double fps = 25;    // movies by --sweep and --play
  ViewArguments view;
  double seconds = 0;  // movie length; 0: its kind's default
  render::RecipeOptions recipe;
  std::string method_name;  // empty: the character's default
  std::optional<int> closest;
  render::MethodOptions method;
  bool chooses_cameras = false;  // an option of `method` is given
  LookArguments look;
  bool room = false;  // the character's room as background
  FvvrArguments fvvr;
  bool fromCapture() const { return !fvvr.capture_folder.empty(); }
  bool playing() const { return sweep || !cues.empty(); }
  bool movie() const;  // the output is a movie
  bool drawsLayersApart() const {
    return recipe.debug == render::DebugView::Layer || recipe.debug == render::DebugView::Labels;
  }
};

// Sets the arguments. A value is the exit code: help or a problem was printed.
std::optional<int> readRenderCommand(int argc, char** argv, RenderArguments& arguments);
// Checks that the character supports the method. Errors: InvalidArgument.
Status checkMethod(const RenderArguments& arguments, const package::Character& character);
// Errors: those of reading the picture, with its path; GpuFailure.
Status setLook(const LookArguments& look, gpu::Device& device, render::Recipe& recipe);
// Camera by the arguments. Errors: InvalidArgument, and those of reading the cameras.
Result<PinholeCamera> chooseCamera(const RenderArguments& arguments, const package::Character& character);
// Orbit by the arguments, for a picture of this size.
OrbitView chooseOrbit(const RenderArguments& arguments, const package::Character& character, int width, int height);

// Renders --sweep and --play: one character, with the camera from the arguments.
Status renderMotion(const RenderArguments& arguments);
// Renders --scene.
Status renderScene(const RenderArguments& arguments);

}  // namespace fourdvt::tools
