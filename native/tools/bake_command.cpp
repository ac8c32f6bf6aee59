// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>

#include "bake/bake.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

std::atomic<bool> g_stop{false};

// The first signal asks the bake to stop after the frame at hand; a second one ends the process at once.
void onSignal(int) {
  if (g_stop.exchange(true)) _exit(kInterrupted);
}

void listenForStop() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

const CommandHelp& help() {
  static const CommandHelp text{
      "bake CAPTURE -o CHARACTER [options]",
      "Turns a capture folder into a character folder that any web server can host. Nothing is written into place\n"
      "before everything is finished; after Ctrl-C, the same command with --resume goes on.",
      {{"-o", "CHARACTER", "folder to write (required)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--layers", "N", "texture layers, 1 to 6 (default 3)"},
       {"--texture", "N", "texels, side of layer 1 (default 1024)"},
       {"--crf", "N", "H.264 rate factor, 0 to 51, lower is better (default 23)"},
       {"--gop", "N", "frames a group of pictures at most (default 20)"},
       {"--jobs", "N", "worker threads, 0: as many as cores (default 0)"},
       {"--resume", nullptr, "reuse what an interrupted run with the same settings finished"}}};
  return text;
}

std::string timeLeft(double seconds) {
  char text[32];
  const int s = static_cast<int>(seconds + 0.5);
  if (s < 60)
    std::snprintf(text, sizeof text, "%d s", s);
  else
    std::snprintf(text, sizeof text, "%d min %02d s", s / 60, s % 60);
  return text;
}

// One line, rewritten in place on a terminal; elsewhere a line every 5 s and a last one.
class ProgressLine {
 public:
  void show(const bake::Progress& p) {
    const auto now = std::chrono::steady_clock::now();
    if (!tty_ && p.done != p.total && shown_ && now - last_ < std::chrono::seconds(5)) return;
    if (tty_ && p.done != p.total && shown_ && now - last_ < std::chrono::milliseconds(100)) return;
    if (!tty_ && line_ == p.stage) return;
    last_ = now;
    shown_ = true;
    line_ = p.stage;
    char numbers[120] = "";
    if (p.total > 0) std::snprintf(numbers, sizeof numbers, "  %u of %u frames", p.done, p.total);
    std::string line = p.stage + numbers;
    if (p.frames_per_s > 0) {
      std::snprintf(numbers, sizeof numbers, "  %.2f frames/s  %s left", p.frames_per_s, timeLeft(p.left_s).c_str());
      line += numbers;
    }
    std::fprintf(stderr, tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
    std::fflush(stderr);
  }
  void end() {
    if (tty_ && shown_) std::fputs("\r\033[K", stderr);
  }

 private:
  const bool tty_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::string line_;
  std::chrono::steady_clock::time_point last_;
};

bake::BakeOptions readOptions(Args& args) {
  bake::BakeOptions o;
  o.capture_folder = args.positional();
  o.character_folder = args.required("-o");
  o.sequences = args.list("--sequences");
  o.layers = args.integer("--layers", o.layers, 1, 6);
  o.texture = args.integer("--texture", o.texture, 64, 4096);
  o.crf = args.integer("--crf", o.crf, 0, 51);
  o.gop = args.integer("--gop", o.gop, 1, 1000);
  o.jobs = args.integer("--jobs", o.jobs, 0, 1024);
  o.resume = args.has("--resume");
  return o;
}

void printSummary(const bake::BakeOptions& options, const bake::BakeReport& report, double seconds) {
  uint64_t bytes = 0;
  for (const auto& [part, size] : report.bytes_by_part) bytes += size;
  std::printf("%s: %u frames, %.2f MB, %.1f s (%.2f s a frame), peak memory %.0f MB\nfigures: %s/report.html\n",
              options.character_folder.c_str(), report.frames, bytes / 1e6, seconds,
              report.frames ? seconds / report.frames : 0.0, report.peak_rss_bytes / 1e6,
              options.character_folder.c_str());
}

}  // namespace

int bakeCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const bake::BakeOptions options = readOptions(args);
  if (args.problem().empty() && !args.wantsHelp()) {
    const std::string wrong = options.check();
    if (!wrong.empty()) args.complain(wrong);
  }
  if (const auto code = helpOrProblem(help(), args)) return *code;

  listenForStop();
  auto gpu = openGpu();
  if (!gpu.ok()) return fail(gpu.error());
  ProgressLine line;
  bake::BakeEnvironment environment;
  environment.device = gpu.value().device.get();
  environment.open_video = videoOpener();
  environment.progress = [&](const bake::Progress& p) { line.show(p); };
  environment.stop = &g_stop;
  const auto start = std::chrono::steady_clock::now();
  auto report = bake::bake(options, environment);
  line.end();
  if (!report.ok()) return fail(report.error());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  printSummary(options, report.value(), seconds.count());
  return kOk;
}

}  // namespace fourdvt::tools
