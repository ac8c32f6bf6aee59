// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "evaluate/held_out.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

const CommandHelp& help() {
  static const CommandHelp text{
      "evaluate CAPTURE --character CHARACTER [options]",
      "PSNR (RGB) and SSIM (luma, 11x11 Gaussian) of a character over the union of both silhouettes, on black, at the\n"
      "capture's held-out cameras and at its input cameras: per sequence, camera and mean. \"common dB\" is the PSNR "
      "where both\n"
      "silhouettes are, without the outline's error.",
      {{"--character", "CHARACTER", "character folder baked from CAPTURE (required)"},
       {"--sequences", "A,B", "only these sequences (default: all of the character)"},
       {"--input-every", "N", "input cameras: every Nth frame, 0: none (default 4)"},
       {"--yardstick", nullptr, "also plain projective texturing from the input pictures: no layers, no codec"},
       {"-o", "FOLDER", "also write evaluate.csv, evaluate.txt and worst.png there"}}};
  return text;
}

Status writeText(const std::string& path, const std::string& text) {
  return platform::writeFileAtomic(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

Status writeReport(const std::string& folder, const evaluate::HeldOutReport& report) {
  FOURDVT_TRY(writeText(folder + "/evaluate.csv", evaluate::scoreCsv(report)));
  FOURDVT_TRY(writeText(folder + "/evaluate.txt", evaluate::scoreTable(report)));
  if (report.worst.empty()) return {};
  return platform::writeImage(folder + "/worst.png", evaluate::contactSheet(report.worst));
}

}  // namespace

int evaluateCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const std::string folder = args.positional(), character = args.required("--character"), output = args.text("-o");
  evaluate::HeldOutOptions options;
  options.sequences = args.list("--sequences");
  options.input_every = static_cast<uint32_t>(args.integer("--input-every", 4, 0, 1'000'000));
  options.yardstick = args.has("--yardstick");
  if (const auto code = helpOrProblem(help(), args)) return *code;

  std::error_code failed;
  if (!output.empty()) std::filesystem::create_directories(output, failed);
  if (failed)
    return fail({ErrorId::WriteFailed, output + ": " + failed.message() + "; choose a folder that is writable"});
  auto session = openCharacter(character);
  if (!session.ok()) return fail(session.error());
  auto capture = capture::openCapture(folder, videoOpener(), options.sequences);
  if (!capture.ok()) return fail(capture.error());
  const bool tty = isatty(STDERR_FILENO) != 0;
  auto report = evaluate::evaluateHeldOut(capture.value(), videoOpener(), *session.value().player, options,
                                          [&](const std::string& sequence, uint32_t frame) {
                                            if (tty)
                                              std::fprintf(stderr, "\r\033[K%s frame %u", sequence.c_str(), frame);
                                          });
  if (tty) std::fputs("\r\033[K", stderr);
  if (!report.ok()) return fail(report.error());
  std::fputs(evaluate::scoreTable(report.value()).c_str(), stdout);
  if (output.empty()) return kOk;
  const Status written = writeReport(output, report.value());
  return written.ok() ? kOk : fail(written.error());
}

}  // namespace fourdvt::tools
