// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. The stages in order of execution; each is one file of this folder:
//
//   validate      whole capture readable, output writable; the settings' hash for --resume
//   survey        first pass over the frames: which camera sees which face (visibility: depth maps and sample tests on
//                 the GPU), and the cameras' colours against each other (colour_calibration)
//   labelling     cameras per face for whole sequences (4DVT Eq. 1-5, ALGORITHMS 1)
//   resample      camera pictures → L texture layers in UV space on the GPU
//   fill          empty texels and gutters (ALGORITHMS 2)
//   tile          layers + barcode → one 4:2:0 picture
//   encode        H.264, one closed GOP at a time
//   geometry      quantised positions and labels → chunks
//   assemble      mp4 + bin + character.gltf + texture still + poster + report, renamed into place at the end
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets, whatever the length.
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
  std::string preset;  // the encoder's own; empty: the default
  // Where visibility, colour maps and labels are kept between bakes of the same capture; empty: with the work folder.
  std::string survey_folder;
  std::string check() const;  // empty, or what is wrong
};

struct Progress {
  std::string stage;             // "survey walk 12/28", "walk 12/28"
  uint32_t done = 0, total = 0;  // frames baked over the whole bake; the survey has none done
  double frames_per_s = 0, left_s = 0;
};

struct BakeReport {
  std::map<std::string, double> seconds_by_stage;
  uint32_t frames = 0;
  uint64_t peak_rss_bytes = 0;
  std::map<std::string, uint64_t> bytes_by_part;
  std::map<std::string, LabelStatistics> labels_by_sequence;
};

struct BakeEnvironment {
  gpu::Device* device = nullptr;  // GLES; current on this thread
  OpenVideo open_video;
  std::function<void(const Progress&)> progress;
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: finish the frame, keep finished GOPs, return Interrupted
};

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

}  // namespace fourdvt::bake
