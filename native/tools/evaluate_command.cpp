// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <optional>

#include "measure/held_out.h"
#include "measure/surface_score.h"
#include "platform/files.h"
#include "platform/folders.h"
#include "render/cameras/camera_method.h"
#include "study/projective/method_scores.h"
#include "study/projective/projective_study.h"
#include "study/study.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/refine_arguments.h"
#include "tools/session.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

const CommandHelp& help() {
  static const CommandHelp text{
      "evaluate CAPTURE -o REPORT [--quick]  or  evaluate CAPTURE --character CHARACTER [options]  or\n"
      "       evaluate CAPTURE --surface [--reference CAPTURE2]  or\n"
      "       evaluate CAPTURE --projective [-o REPORT] [--methods A,B] [--quick]",
      "The first form bakes the capture in every way that is compared and writes the papers' tables and curves as\n"
      "REPORT/evaluate.csv, evaluate.json (the same rows) and report.html. Stop it with Ctrl-C; the same command goes "
      "on\n"
      "where it was.\n"
      "The second form scores one baked character: PSNR (RGB) and SSIM (luma, 11x11 Gaussian) over the union of both\n"
      "silhouettes, on black, at the capture's held-out cameras and at its input cameras: per sequence, camera and "
      "mean.\n"
      "\"common dB\" is the PSNR where both silhouettes are, without the outline's error. Flicker is what changes on "
      "the\n"
      "surface from one picture to the next: of the error at an input camera, of the colours on the orbit.\n"
      "The third form scores the capture's surfaces, of whatever topology: plain projective texturing from its videos "
      "at\n"
      "the held-out cameras, and distances to the surfaces of a reference capture.\n"
      "The fourth form compares the methods of characters from cameras (`fourdvt render --method`), drawn from the "
      "raw\n"
      "videos. With -o: on the capture's surfaces, coarser ones, hulls and a plane, by number of cameras and with "
      "errors "
      "of\n"
      "calibration, into REPORT/projective.csv, projective.json (the same rows) and report.html; the same command goes "
      "on\n"
      "after Ctrl-C. Without: one table on the capture's surfaces.",
      {{"-o", "FOLDER",
        "report folder (required by the first form; with --character: evaluate.csv, .txt and worst.png)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--quick", nullptr, "the shortest sequence, few views and settings: for a first look"},
       {"--jobs", "N", "worker threads of the bakes; 0: one per core (default 0)"},
       kRefineOption,
       kRefineCamerasOption,
       kMatteBiasOption,
       {"--character", "CHARACTER", "score this character folder, baked from CAPTURE"},
       {"--method", "NAME",
        "with --character: how it is drawn; of a layered one: montage4d (default: the plain blend)"},
       {"--input-every", "N", "with --character: input cameras, every Nth frame, 0: none (default 4)"},
       {"--flicker", "N",
        "with --character, if the capture's meshes keep their topology: flicker between consecutive frames, at the "
        "first N input cameras and on a slow orbit of frame 0, in levels of 255; 0: none (default 1)"},
       {"--yardstick", nullptr,
        "with --character: also plain projective texturing of the mesh as given, no layers, no codec"},
       {"--closest", "M",
        "with --surface: textured on the GPU from the M cameras nearest to the view, 0: all (default: on the CPU from "
        "all); with --character: of a character from cameras (default 4)"},
       {"--projective", nullptr, "compare the methods of characters from cameras on the capture's surfaces"},
       {"--methods", "A,B", "with --projective: these methods (default: all; of the table: fvvr)"},
       {"--frames", "N", "with --projective -o: test frames of each sequence, spread over it (default 1)"},
       {"--sweep-planes", "N",
        "with --projective without -o, method sweep: depths tried at each pixel, 4 to 32 in steps of 4 (default 12)"},
       {"--sweep-band-mm", "X", "likewise: how far behind the surface it looks (default 32)"},
       {"--surface", nullptr, "score the capture's surfaces"},
       {"--reference", "CAPTURE2", "with --surface: the same motions with the surfaces that are taken for true"}}};
  return text;
}

struct Arguments {
  std::string capture, character, output, reference, method;
  bool surface = false, projective = false;
  std::vector<std::string> methods;
  uint32_t test_frames = 1;
  std::optional<int> closest;
  render::SweepOptions sweep;
  std::vector<std::string> sequences;
  bool quick = false;
  int jobs = 0;
  refine::RefineOptions refine;
  measure::HeldOutOptions held_out;
};

Arguments readArguments(Args& args) {
  Arguments a;
  a.capture = args.positional();
  a.character = args.text("--character");
  a.method = args.text("--method");
  if (!a.method.empty() && a.character.empty()) args.complain("--method belongs to --character");
  a.output = args.text("-o");
  a.sequences = a.held_out.sequences = args.list("--sequences");
  a.quick = args.has("--quick");
  a.jobs = args.integer("--jobs", 0, 0, 1024);
  a.held_out.input_every = static_cast<uint32_t>(args.integer("--input-every", 4, 0, 1'000'000));
  a.held_out.yardstick = args.has("--yardstick");
  a.held_out.flicker_cameras = static_cast<uint32_t>(args.integer("--flicker", 1, 0, package::kMaxCameras));
  a.refine = readRefineOptions(args);
  a.surface = args.has("--surface");
  a.projective = args.has("--projective");
  a.methods = args.list("--methods");
  if (!a.methods.empty() && !a.projective) args.complain("--methods belongs to --projective");
  a.test_frames = static_cast<uint32_t>(args.integer("--frames", 1, 1, 10'000));
  if (args.has("--frames") && (!a.projective || a.output.empty())) args.complain("--frames belongs to --projective -o");
  if (a.projective && (a.surface || !a.character.empty() || args.has("--jobs") || args.has("--reference") ||
                       args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px")))
    args.complain(
        "--projective goes with -o, --sequences, --methods, --frames, --closest, --quick, --sweep-planes and "
        "--sweep-band-mm only");
  a.sweep.planes = args.integer("--sweep-planes", a.sweep.planes, 4, 32);
  a.sweep.band_m = static_cast<float>(args.number("--sweep-band-mm", 1000 * a.sweep.band_m, 0.1, 1000) / 1000);
  if ((args.has("--sweep-planes") || args.has("--sweep-band-mm")) && (!a.projective || !a.output.empty()))
    args.complain("--sweep-planes and --sweep-band-mm belong to --projective without -o");
  a.reference = args.text("--reference");
  if (args.has("--closest")) a.closest = args.integer("--closest", 0, 0, package::kMaxCameras);
  if (a.closest && a.projective && !a.output.empty())
    args.complain("--closest does not go with --projective -o, which measures numbers of cameras itself");
  if (a.closest && !a.surface && !a.projective && a.character.empty())
    args.complain("--closest belongs to --surface and --character");
  if (!a.reference.empty() && !a.surface) args.complain("--reference belongs to --surface");
  if (a.surface && (!a.character.empty() || !a.output.empty() || a.quick || args.has("--jobs") ||
                    args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px")))
    args.complain("--surface goes with --sequences, --reference and --closest only");
  if (a.character.empty() && a.output.empty() && !a.surface && !a.projective)
    args.complain("-o FOLDER is missing: where the report goes; or score one character with --character");
  if (a.character.empty() && (args.has("--input-every") || args.has("--yardstick") || args.has("--flicker")))
    args.complain("--input-every, --yardstick and --flicker belong to --character");
  if (!a.character.empty() && (args.has("--quick") || args.has("--jobs")))
    args.complain("--quick and --jobs do not go with --character");
  if (!a.character.empty() && (args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px")))
    args.complain(
        "--refine, --refine-cameras and --matte-bias-px do not go with --character: it was baked with its own");
  return a;
}

// Prints one line, rewritten in place, on a terminal; elsewhere a line every 5 s.
class ProgressLine {
 public:
  void show(const study::StudyProgress& p) {
    const auto now = Clock::now();
    if (!started_) started_ = now, first_share_ = p.share;
    if (shown_ && now - last_ < (tty_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000))) return;
    last_ = now;
    shown_ = true;
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%3.0f %%  ", 100 * p.share);
    const std::string line = numbers + p.step + (p.detail.empty() ? "" : ": " + p.detail) + timeLeft(now, p.share);
    std::fprintf(stderr, tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
    std::fflush(stderr);
  }
  void end() const {
    if (tty_ && shown_) std::fputs("\r\033[K", stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  // Work that earlier runs finished does not count.
  std::string timeLeft(Clock::time_point now, double share) const {
    const double elapsed_s = std::chrono::duration<double>(now - *started_).count(), done = share - first_share_;
    if (elapsed_s < 3 || done < 0.01) return "";
    const int left_s = static_cast<int>(elapsed_s * (1 - share) / done + 0.5);
    char text[48];
    if (left_s < 60)
      std::snprintf(text, sizeof text, "  %d s left", left_s);
    else
      std::snprintf(text, sizeof text, "  %d min %02d s left", left_s / 60, left_s % 60);
    return text;
  }
  const bool tty_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::optional<Clock::time_point> started_;
  double first_share_ = 0;
  Clock::time_point last_;
};

std::string furtherOptions(const Arguments& arguments) {
  if (!arguments.projective) return "";
  std::string out = " --projective";
  for (const std::string& method : arguments.methods)
    out += (&method == &arguments.methods.front() ? " --methods " : ",") + method;
  return out + (arguments.test_frames > 1 ? " --frames " + std::to_string(arguments.test_frames) : "");
}

int runWholeStudy(const Arguments& arguments) {
  using capture::MeshNeed;
  auto capture = capture::openCapture(arguments.capture, videoOpener(), arguments.sequences,
                                      arguments.projective ? MeshNeed::AnySurface : MeshNeed::ConstantTopology);
  if (!capture.ok()) return fail(capture.error());
  const std::atomic<bool>* stop = listenForStop();
  auto gpu = openGpu();
  if (!gpu.ok()) return fail(gpu.error());
  ProgressLine line;
  study::StudyContext context;
  context.options = {arguments.capture, arguments.output, arguments.sequences,       arguments.quick,
                     arguments.jobs,    arguments.refine, "fourdvt " FOURDVT_VERSION};
  context.options.methods = arguments.methods;
  context.options.test_frames = arguments.test_frames;
  if (arguments.projective) context.options.stem = "projective";
  context.options.further = furtherOptions(arguments);
  context.capture = &capture.value();
  context.open_video = videoOpener();
  context.device = gpu.value().device.get();
  context.progress = [&](const study::StudyProgress& p) { line.show(p); };
  context.stop = stop;
  const auto start = std::chrono::steady_clock::now();
  auto rows = arguments.projective ? study::runProjectiveStudy(context) : study::runStudy(context);
  line.end();
  if (!rows.ok()) return fail(rows.error());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("%zu rows in %.0f s\nrows: %s/%s.csv\nreport: %s/report.html\n", rows.value().size(), seconds.count(),
              arguments.output.c_str(), context.options.stem.c_str(), arguments.output.c_str());
  return kOk;
}

Status writeReport(const std::string& folder, const measure::HeldOutReport& report) {
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/evaluate.csv", measure::scoreCsv(report)));
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/evaluate.txt", measure::scoreTable(report)));
  if (report.worst.empty()) return {};
  return platform::writeImage(folder + "/worst.png", measure::contactSheet(report.worst));
}

// On a terminal, one line that is rewritten.
class FrameLine {
 public:
  void operator()(const std::string& sequence, uint32_t frame) const {
    if (tty_) std::fprintf(stderr, "\r\033[K%s frame %u", sequence.c_str(), frame);
  }
  void end() const {
    if (tty_) std::fputs("\r\033[K", stderr);
  }

 private:
  const bool tty_ = isatty(STDERR_FILENO) != 0;
};

int scoreCharacter(const Arguments& arguments) {
  const std::string& output = arguments.output;
  if (!output.empty())
    if (const Status made = platform::makeFolder(output); !made.ok()) return fail(made.error());
  auto session = openCharacter(arguments.character);
  if (!session.ok()) return fail(session.error());
  if (!arguments.method.empty())
    if (const Status used = useMethod(session.value(), arguments.method); !used.ok()) return fail(used.error());
  if (arguments.closest) session.value().player->player().setMethod({.closest = *arguments.closest});
  auto capture = capture::openCapture(arguments.capture, videoOpener(), arguments.sequences);
  if (!capture.ok()) return fail(capture.error());
  const FrameLine line;
  auto report =
      measure::evaluateHeldOut(capture.value(), videoOpener(), *session.value().player, arguments.held_out, line);
  line.end();
  if (!report.ok()) return fail(report.error());
  std::fputs(measure::scoreTable(report.value()).c_str(), stdout);
  if (output.empty()) return kOk;
  const Status written = writeReport(output, report.value());
  return written.ok() ? kOk : fail(written.error());
}

int scoreSurface(const Arguments& arguments) {
  auto capture =
      capture::openCapture(arguments.capture, videoOpener(), arguments.sequences, capture::MeshNeed::AnySurface);
  if (!capture.ok()) return fail(capture.error());
  std::optional<capture::Capture> reference;
  if (!arguments.reference.empty()) {
    auto opened =
        capture::openCapture(arguments.reference, videoOpener(), arguments.sequences, capture::MeshNeed::AnySurface);
    if (!opened.ok()) return fail(opened.error());
    reference = opened.take();
  }
  std::optional<GpuSession> gpu;
  if (arguments.closest) {
    auto opened = openGpu();
    if (!opened.ok()) return fail(opened.error());
    gpu = opened.take();
  }
  const FrameLine line;
  const auto scores = measure::scoreSurfaces(capture.value(), reference ? &*reference : nullptr, videoOpener(),
                                             {gpu ? gpu->device.get() : nullptr, arguments.closest.value_or(0)}, line);
  line.end();
  if (!scores.ok()) return fail(scores.error());
  std::fputs(measure::surfaceTable(scores.value()).c_str(), stdout);
  return kOk;
}

int compareMethods(const Arguments& arguments) {
  auto capture =
      capture::openCapture(arguments.capture, videoOpener(), arguments.sequences, capture::MeshNeed::AnySurface);
  if (!capture.ok()) return fail(capture.error());
  auto gpu = openGpu();
  if (!gpu.ok()) return fail(gpu.error());
  study::MethodScoreOptions options{.methods = arguments.methods, .quick = arguments.quick};
  if (options.methods.empty()) options.methods = render::cameraMethodNames(render::MethodGroup::Textured);
  if (arguments.closest) options.method.closest = *arguments.closest;
  options.method.sweep = arguments.sweep;
  const FrameLine line;
  const auto scores = study::scoreMethods(*gpu.value().device, capture.value(), videoOpener(), options, line);
  line.end();
  if (!scores.ok()) return fail(scores.error());
  std::fputs(study::methodTable(scores.value()).c_str(), stdout);
  return kOk;
}

}  // namespace

int evaluateCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const Arguments arguments = readArguments(args);
  if (const auto code = helpOrProblem(help(), args)) return *code;
  if (arguments.surface) return scoreSurface(arguments);
  if (arguments.projective && arguments.output.empty()) return compareMethods(arguments);
  return arguments.character.empty() ? runWholeStudy(arguments) : scoreCharacter(arguments);
}

}  // namespace fourdvt::tools
