// SPDX-License-Identifier: Apache-2.0
// `fourdvt evaluate CAPTURE -o REPORT`: the papers' tables on one capture, as a list of steps. A step measures and
// returns figures (rows of evaluate.csv) and writes its pictures into REPORT/pictures. A finished step's rows are kept
// in REPORT/steps/<name>.csv, so that an interrupted study resumes; the document is made from rows only.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/video.h"
#include "capture/capture.h"
#include "gpu/device.h"

namespace fourdvt::study {

// One row of evaluate.csv.
struct Figure {
  std::string table;     // e.g. "table1", "layers", "storage", "rate", "speed", "labels", "held-out"
  std::string sequence;  // empty: all
  std::string method;    // "fvvr", "naive", "spatial", "temporal-paper", "joint", codec names …
  std::string setting;   // "key=value key=value", e.g. "layers=3 size=512"; empty where there is none
  std::string quantity;  // e.g. "ssim_fg", "psnr_full_db", "video_bytes"
  double value = 0;
  std::string unit;  // "dB", "bytes", "ratio", …
};

struct StudyOptions {
  std::string capture_folder, report_folder;
  std::vector<std::string> sequences;  // empty: all
  bool quick = false;                  // ≤ 2 minutes on the sample: one sequence, few views, few settings
  int jobs = 0;
  std::string generator;  // "fourdvt X.Y.Z", for evaluate.json
};

struct StudyProgress {
  std::string step, detail;  // "storage", "run 12/19"
  double share = 0;          // 0..1; from a step: of the step (runSteps makes it of the whole study)
};

struct StudyContext {
  StudyOptions options;  // sequences listed, folders without a trailing slash
  const capture::Capture* capture = nullptr;
  OpenVideo open_video;
  gpu::Device* device = nullptr;  // GLES, current on this thread
  std::function<void(const StudyProgress&)> progress;
  const std::atomic<bool>* stop = nullptr;  // a step returns Interrupted soon after
  std::string pictures() const { return options.report_folder + "/pictures"; }
  std::string work() const { return options.report_folder + "/work"; }  // baked characters, references; kept for resume
};

using Figures = std::vector<Figure>;
struct StudyStep {
  const char* name;
  double weight;  // share of the time, relative
  Result<Figures> (*run)(const StudyContext& context);
};

// The steps, each in a file of its name. They may use what earlier steps left in work().
Result<Figures> runReference(
    const StudyContext& context);  // steps/reference: FVVR pictures of the ring, masked multi-view
Result<Figures> runMethods(const StudyContext& context);   // steps/methods: 4DVT Table 1, held-out truth, labels
Result<Figures> runLayers(const StudyContext& context);    // steps/layers: LVDT Fig. 5-7, Table 1; 4DVT Fig. 9
Result<Figures> runRate(const StudyContext& context);      // steps/rate: rate-distortion of codecs and layouts
Result<Figures> runSpeed(const StudyContext& context);     // steps/speed: LVDT 4.4, per-pass breakdown
Result<Figures> runPictures(const StudyContext& context);  // steps/pictures: layers with camera maps, grazing views
Result<Figures> runMotion(const StudyContext& context);    // motion/: 4DVT 5-6: blend, alignment, transitions

// The steps in order.
std::vector<StudyStep> studySteps();
// Checks the report folder, runs what is missing and writes evaluate.csv, evaluate.json and report.html after every
// step. The context needs folders, capture, device and open_video. Errors: those of the steps; Interrupted;
// InvalidArgument (the report folder holds something else); WriteFailed.
Result<Figures> runStudy(const StudyContext& context);

std::string figuresCsv(const Figures& figures);
// evaluate.json: what was run and the same rows, {"generator", "capture", "quick", "sequences", "jobs",
// "rows": [{"table", "sequence", "method", "setting", "quantity", "value", "unit"}, …]}. A value that is not finite is
// null; "text=…" settings of table "about" stay as they are.
std::string figuresJson(const Figures& figures, const StudyOptions& options, const std::string& capture_name);
Result<Figures> parseFiguresCsv(const std::string& text, const std::string& path);

}  // namespace fourdvt::study
