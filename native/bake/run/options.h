// SPDX-License-Identifier: Apache-2.0
// What a bake can be asked for. Named sets of these are in bake/quality.h.
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
#include "encode/encoder.h"
#include "gpu/device.h"
#include "package/character.h"
#include "refine/refine.h"

namespace fourdvt::bake {

// What is made of capture.json's motion classes.
struct MotionClassOptions {
  bool bake = true;   // each class becomes one more sequence of the character
  bool align = true;  // what the members show is aligned on the surface, at bake time
  // Largest vertex distance of the hybrid mesh blend from the non-linear one; none: 1 mm for a person (kBlendError_m).
  std::optional<double> blend_error_m;
  std::optional<double> alignment_step_m;  // quantisation of the alignment; none: 0.1 mm for a person
};

// What a character from cameras is made with; layers take no notice of it.
struct CameraOptions {
  double tile_scale = 1;      // texels per pixel of the cameras' pictures, 0.01..1
  double max_texels = 9.4e6;  // of the tiled picture: what H.264's level 5.1 allows, as decoders of phones do
  int faces = 10'000;         // most of a frame whose topology is its own (one topology for all stays); 0: all
  std::string method;         // that players draw it by (render/cameras/camera_method.h); empty: measured, by `choice`
  ChoiceRule choice;
};

// One rendition below the highest.
struct LowerRendition {
  // From layers: texels, side of layer 1, a multiple of 32 from 64. From cameras: the share of the highest's sides, a
  // multiple of 1/8.
  double size = 0;
  int crf = 0;  // on the codec's own scale
  encode::Codec codec = encode::Codec::H264;
  std::string preset;  // as BakeOptions::preset
};

// The command line sets texture, layers, crf and preset from quality.cpp, for the codec of --codec. The defaults here
// equal its "web" for H.264, which quality_test.cpp checks.
struct BakeOptions {
  std::string capture_folder, character_folder;
  std::vector<std::string> sequences;                 // empty: all
  std::vector<std::string> camera_names;              // empty: all, or the best ones where a character cannot hold all
  std::optional<package::AppearanceKind> appearance;  // none: layers where the meshes allow it, else cameras
  int layers = 3;                                     // texture layers, 1..6
  int texture = 1024;                                 // texels, side of layer 1; further layers: see equal_layers
  int crf = 29;                                       // constant rate factor on the codec's own scale, lower is better
  int gop = 20;         // the largest number of frames per GOP; lengths in a sequence differ by at most 1
  int jobs = 0;         // worker threads; 0: as many as cores
  bool resume = false;  // reuse GOPs that an interrupted run with the same settings finished
  // Quantisation of streamed vertices; none: 0.25 mm from layers, 1 mm from cameras for a person, and in proportion for
  // smaller and larger surfaces.
  std::optional<double> position_step_m;
  // Likewise, for renditions with fewer texels than the highest; 0: as the others; none: 2 mm for a person.
  std::optional<double> coarse_step_m;
  int gutter_texels = 10;        // width of the gutter round every chart, texels of layer 1; limits in check()
  refine::RefineOptions refine;  // of the mesh and the cameras, before anything is drawn
  bool refine_asked = false;     // explicitly: refused where it cannot be done
  const Labelling* labels = &kJoint;
  TexelRule texel_rule = nullptr;  // null: a texel takes the camera that its face's label names
  Penalty penalty = Penalty::Axis;
  bool equal_layers = false;  // all layers have the size of layer 1, as in the papers
  bool colour_calibration = true;
  ResampleOptions resample;
  encode::Codec codec = encode::Codec::H264;
  std::string preset;  // in the encoder's own terms; empty: its default
  // Beside the highest rendition, which texture, crf, codec and preset describe (run/renditions.h).
  std::vector<LowerRendition> lower_renditions;
  bool standard_renditions = false;  // the bake sets lower_renditions, once it has the appearance
  MotionClassOptions classes;
  CameraOptions cameras;
  // Where visibility, colour maps and labels are kept between bakes of the same capture; empty: in the work folder.
  std::string survey_folder;
  int survey_window_frames = 32;  // frames whose visibility is measured into one file; does not change the result
  std::string check() const;      // empty, or what is wrong
};

// The report lies beside the character, which holds only what pages need.
inline std::string reportFolderOf(const std::string& character_folder) { return character_folder + ".report"; }

// A bake's lengths that suit a person; the surface's length scale (base/length_scale.h) multiplies them.

inline constexpr double kLayersStep_m = 0.00025, kCamerasStep_m = 0.001;  // position steps
inline constexpr double kCoarseStep_m = 0.002, kBlendError_m = 0.001, kAlignmentStep_m = 0.0001;

// What a bake needs from the program that runs it: a GPU, a way to open videos, a listener, a way to be stopped.

struct Progress {
  // "warp locomotion", "survey walk 12/28", "walk 12/28", "align locomotion 12/28", "graph"
  std::string stage;
  uint32_t done = 0, total = 0;  // frames encoded in the whole bake; 0 until the survey ends
  double frames_per_s = 0, left_s = 0;
};

struct BakeEnvironment {
  gpu::Device* device = nullptr;  // GLES; current on this thread
  OpenVideo open_video;
  const refine::Refinement* refinement = nullptr;  // already known for this capture; null: the bake makes it
  std::function<void(const Progress&)> progress;
  std::function<void(const std::string&)> note;  // one line that the user should read before the work begins
  std::string writer;  // of unfinished files (RecordFile): one of its own where several processes bake at once
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finish the frame, keep finished GOPs, return Interrupted
};

}  // namespace fourdvt::bake
