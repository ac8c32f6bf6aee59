// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. The stages in order of execution; each is one file of this folder:
//
//   validate      whole capture readable, output writable; the settings' hash for --resume
//   warp          motion classes: members on common time, root motion, corrections of the mesh blend (class_plan)
//   survey        first pass over the frames: which camera sees which face (visibility: depth maps and sample tests on
//                 the GPU), and the cameras' colours against each other (colour_calibration)
//   labelling     cameras per face for whole sequences (4DVT Eq. 1-5, ALGORITHMS 1)
//   resample      camera pictures → L texture layers in UV space on the GPU
//   fill          empty texels and gutters (ALGORITHMS 2.4)
//   tile          layers + barcode → one 4:2:0 picture
//   encode        H.264, one closed GOP at a time
//   align         classes: what the decoded members show, brought together on the surface (surface_alignment)
//   geometry      quantised positions, labels, corrections and alignment → chunks
//   graph         where every state enters every other one (transitions)
//   assemble      mp4 + bin + character.gltf + texture still + poster + report, renamed into place at the end
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets and meshes, whatever the
// length; besides, for classes, 12 bytes a vertex, phase and further member (alignment over the whole motion).
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bake/encode.h"
#include "bake/labelling.h"
#include "bake/resample.h"
#include "base/result.h"
#include "base/video.h"
#include "gpu/device.h"

namespace fourdvt::bake {

struct BakeOptions {
  std::string capture_folder, character_folder;
  std::vector<std::string> sequences;  // empty: all
  int layers = 3;                      // texture layers, 1..6
  int texture = 1024;                  // texels, side of layer 1; further layers: see equal_layers
  int crf = 28;                        // constant rate factor on the codec's own scale, lower is better
  int gop = 20;                        // frames a GOP at most; GOPs of a sequence are of equal length ±1
  int jobs = 0;                        // worker threads; 0: as many as cores
  bool resume = false;                 // reuse GOPs that an interrupted run with the same settings finished
  double position_step_m = 0.00025;    // quantisation of streamed vertices
  int gutter_texels = 10;              // true-content gutter round every chart, texels of layer 1
  LabelMode labels = LabelMode::Joint;
  Penalty penalty = Penalty::Axis;
  bool equal_layers = false;  // all layers of the size of layer 1, as in the papers
  bool colour_calibration = true;
  ResampleOptions resample;
  Codec codec = Codec::H264;
  std::string preset;                // the encoder's own; empty: the default
  bool classes = true;               // capture.json's motion classes, one more sequence each
  bool align = true;                 // classes: alignment at bake time
  double blend_error_m = 0.003;      // classes: hybrid mesh blend against the non-linear one, largest vertex distance
  double alignment_step_m = 0.0001;  // quantisation of the alignment
  // Where visibility, colour maps and labels are kept between bakes of the same capture; empty: with the work folder.
  std::string survey_folder;
  std::string check() const;  // empty, or what is wrong
};

struct Progress {
  // "warp locomotion", "survey walk 12/28", "walk 12/28", "align locomotion 12/28", "graph"
  std::string stage;
  uint32_t done = 0, total = 0;  // frames encoded over the whole bake; none before the survey's end
  double frames_per_s = 0, left_s = 0;
};

struct ClassFigures {
  std::vector<std::string> members;
  struct Parameter {
    std::string name;
    double min = 0, max = 0;
  };
  std::vector<Parameter> parameters;
  uint32_t references = 0;                        // corrections of the mesh blend a frame
  double linear_error_m = 0, hybrid_error_m = 0;  // against the non-linear blend, largest vertex distance
  bool aligned = false;
};

struct BakeReport {
  std::map<std::string, double> seconds_by_stage;
  uint32_t frames = 0;  // of all sequences and classes
  uint64_t peak_rss_bytes = 0;
  std::map<std::string, uint64_t> bytes_by_part;
  std::map<std::string, LabelStatistics> labels_by_sequence;
  std::map<std::string, ClassFigures> classes;
  std::vector<std::string> notes;  // what the user should know, one sentence each
};

struct BakeEnvironment {
  gpu::Device* device = nullptr;  // GLES; current on this thread
  OpenVideo open_video;
  std::function<void(const Progress&)> progress;
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finish the frame, keep finished GOPs, return Interrupted
};

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

}  // namespace fourdvt::bake
