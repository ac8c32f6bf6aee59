// SPDX-License-Identifier: Apache-2.0
// Options and environment of a bake. bake/quality.h has named sets of options.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bake/labels/labelling.h"
#include "bake/method/method_choice.h"
#include "bake/texels/resample.h"
#include "base/video.h"
#include "base/watch.h"
#include "encode/encoder.h"
#include "gpu/device.h"
#include "package/character.h"
#include "refine/refine.h"

namespace fourdvt::bake {

// Options of capture.json's motion classes.
struct MotionClassOptions {
  bool bake = true;   // each class becomes one more sequence of the character
  bool align = true;  // aligns the members' appearance on the surface, at bake time
  // Largest vertex distance of the hybrid mesh blend from the non-linear one; none: 1 mm for a person (kBlendError_m).
  std::optional<double> blend_error_m;
  std::optional<double> alignment_step_m;  // quantisation of the alignment; none: 0.1 mm for a person
};

// Options of a character from cameras; ignored for layers.
struct CameraOptions {
  double tile_scale = 1;      // texels per pixel of the cameras' pictures, 0.01..1
  double max_texels = 9.4e6;  // maximum of the tiled picture: limit of H.264's level 5.1, which phones decode
  int faces = 10'000;         // maximum for a frame whose topology is its own (one topology for all stays); 0: all
  std::string method;  // players' rendering method (render/cameras/camera_method.h); empty: measured, by `choice`
  ChoiceRule choice;
};

// One rendition below the highest.
struct LowerRendition {
  // From layers: texels, side of layer 1, a multiple of 32 from 64. From cameras: share of the highest's sides, a
  // multiple of 1/8.
  double size = 0;
  int crf = 0;  // on the codec's own scale
  encode::Codec codec = encode::Codec::H264;
  std::string preset;  // see BakeOptions::preset
};

// Options of a bake. The command line sets texture, layers, crf and preset from quality.cpp, for the codec of
// --codec. The defaults here equal its "web" for H.264, which quality_test.cpp checks.
struct BakeOptions {
  std::string capture_folder, character_folder;
  std::vector<std::string> sequences;                 // empty: all
  std::vector<std::string> camera_names;              // empty: all, or the best ones where a character cannot hold all
  std::optional<package::AppearanceKind> appearance;  // none: layers where the meshes allow it, else cameras
  int layers = 3;                                     // texture layers, 1..6
  int texture = 1024;                                 // texels, side of layer 1; further layers: see equal_layers
  int crf = 29;                                       // constant rate factor on the codec's own scale, lower is better
  int gop = 20;         // maximum number of frames per GOP; lengths in a sequence differ by at most 1
  int jobs = 0;         // worker threads; 0: number of cores
  bool resume = false;  // reuse finished GOPs of an interrupted run with the same settings
  // Quantisation step of streamed vertices, from layers that of their residuals (package::ResidualSteps). None: for a
  // person 0.5 mm from layers and 1 mm from cameras, in proportion for smaller and larger surfaces.
  std::optional<double> position_step_m;
  // Quantisation for renditions below the highest; 0: position_step_m; none: 3.5 mm for a person.
  std::optional<double> coarse_step_m;
  int gutter_texels = 10;        // width of the gutter round every chart, texels of layer 1; limits in check()
  refine::RefineOptions refine;  // refinement of the mesh and the cameras, before any rendering
  bool refine_asked = false;     // set explicitly: an error where it is impossible
  const Labelling* labels = &kJoint;
  TexelRule texel_rule = nullptr;  // null: a texel uses the camera in its face's label
  Penalty penalty = Penalty::Axis;
  bool equal_layers = false;  // all layers have the size of layer 1, as in the papers
  bool colour_calibration = true;
  ResampleOptions resample;
  bool common_detail = true;  // layers show the mean detail of a GOP's frames (texels/detail.h)
  encode::Codec codec = encode::Codec::H264;
  std::string preset;  // in the encoder's own terms; empty: its default
  // Beside the highest rendition, which texture, crf, codec and preset describe (run/renditions.h).
  std::vector<LowerRendition> lower_renditions;
  bool standard_renditions = false;  // lower_renditions are filled in once the appearance is selected
  MotionClassOptions classes;
  CameraOptions cameras;
  // Folder of visibility, colour maps and labels between bakes of the same capture; empty: in the work folder.
  std::string survey_folder;
  int survey_window_frames = 32;  // frames per visibility file; does not change the result
  std::string check() const;      // empty, or an error message
};

// Folder of the report, beside the character, which holds only files of the page.
inline std::string reportFolderOf(const std::string& character_folder) { return character_folder + ".report"; }

// Lengths for a person; the surface's length scale (lengthScale in base/mesh.h) multiplies them.

inline constexpr double kLayersStep_m = 0.0005, kCamerasStep_m = 0.001;  // position steps
inline constexpr double kCoarseStep_m = 0.0035, kBlendError_m = 0.001, kAlignmentStep_m = 0.0001;

// Vertices from layers are streamed on a grid that is finer than their residuals' step by this, so that predictions are
// not rounded to whole steps.
inline constexpr int kGridPerStep = 16;
// Step of the grid that vertices are streamed on, as streams hold it. Lengths and appearance are settled.
double gridStep_m(const BakeOptions& options);

// Services that the calling program supplies: a GPU, video decoders, progress and stop callbacks.

struct BakeEnvironment {
  gpu::Device* device = nullptr;  // GLES; current on this thread
  OpenVideo open_video;
  const refine::Refinement* refinement = nullptr;  // precomputed for this capture; null: the bake computes it
  // Receives the frames encoded in the whole bake, in total 0 until the survey ends. Stages: "warp locomotion", "survey
  // walk 12/28", "walk 12/28", "align locomotion 12/28", "graph".
  std::function<void(const FrameProgress&)> progress;
  std::function<void(const std::string&)> note;  // receives a line for the user before the work begins
  std::string writer;  // suffix of unfinished files (RecordFile): unique where several processes bake at once
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finish the frame, keep finished GOPs, return Interrupted
};

}  // namespace fourdvt::bake
