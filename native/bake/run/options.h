// SPDX-License-Identifier: Apache-2.0
// What a bake can be asked for. Named sets of these are in bake/quality.h.
#pragma once

#include <string>
#include <vector>

#include "bake/labels/labelling.h"
#include "bake/texels/resample.h"
#include "bake/video/encode.h"

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

}  // namespace fourdvt::bake
