// SPDX-License-Identifier: Apache-2.0
// Shared context of a study's parts: options, environment, and the rows returned by its steps. Independent of measures
// and of the list of steps.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/video.h"
#include "capture/capture.h"
#include "gpu/device.h"
#include "refine/refine.h"

namespace fourdvt::study {

// Row of evaluate.csv.
struct Row {
  std::string table;     // e.g. "table1", "layers", "storage", "rate", "speed", "labels", "held-out"
  std::string sequence;  // empty: all
  std::string method;    // "fvvr", "naive", "spatial", "temporal-paper", "joint", codec names …
  std::string setting;   // "key=value key=value", e.g. "layers=3 size=512"; may be empty
  std::string quantity;  // e.g. "ssim_fg", "psnr_full_db", "video_bytes"
  double value = 0;
  std::string unit;  // "dB", "bytes", "ratio", …
};

struct StudyOptions {
  std::string capture_folder, report_folder;
  std::vector<std::string> sequences;  // empty: all
  bool quick = false;                  // two minutes on the sample: one sequence, few views, few settings
  int jobs = 0;
  refine::RefineOptions refine;    // for mesh and cameras, except the rows of the given mesh
  std::string generator;           // "fourdvt-lab X.Y.Z", for evaluate.json
  std::vector<std::string> steps;  // subset of steps, in the study's order; empty: all
  int ring_views = 36;             // views per sequence's ring; 8 in a quick study
  // Options of `fourdvt-lab methods`.
  std::vector<std::string> methods;  // empty: all
  uint32_t test_frames = 1;          // per sequence, at the held-out cameras
  // Test frames of conditions that decide no choice, then without flicker, and of cameras and calibration on the first
  // sequence only; 0: test_frames, on all.
  uint32_t axis_frames = 0;
  const char* command = "study";  // subcommand of fourdvt-lab
  // Kind of study: rows are in REPORT/<stem>.csv and .json. The report folder of another kind is rejected.
  std::string stem = "evaluate";
  std::string further;  // options as typed, besides folders, --sequences and --quick; " --frames 2"
};

struct StudyProgress {
  std::string step, detail;  // "storage", "run 12/19"
  double share = 0;          // 0..1: share of the step in a step's report, of the whole study in that of runSteps
};

struct StudyContext {
  StudyOptions options;                            // sequences listed, folders without a trailing slash
  const capture::Capture* capture = nullptr;       // refined, once runStudy has begun
  const capture::Capture* given = nullptr;         // unrefined; set by runStudy
  const refine::Refinement* refinement = nullptr;  // refinement of `capture`, for the study's bakes; null: none
  OpenVideo open_video;
  gpu::Device* device = nullptr;  // GLES, current on this thread
  std::function<void(const StudyProgress&)> progress;
  const std::atomic<bool>* stop = nullptr;  // a step returns Interrupted soon after
  std::string pictures() const { return options.report_folder + "/pictures"; }
  std::string work() const { return options.report_folder + "/work"; }  // baked characters, references; kept for resume
};

using Rows = std::vector<Row>;
struct StudyStep {
  const char* name;
  double weight;  // relative share of the time
  Result<Rows> (*run)(const StudyContext& context);
};

}  // namespace fourdvt::study
