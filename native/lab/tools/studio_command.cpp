// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <tuple>

#include "lab/studio/studio.h"
#include "lab/tools/commands.h"
#include "tools/args.h"
#include "tools/session.h"
#include "tools/stop_signal.h"

namespace fourdvt::lab {
namespace {

using tools::Args;

const tools::CommandHelp& help() {
  static const tools::CommandHelp text{
      "studio MODEL.glb|procedural -o CAPTURE [options]",
      "Renders an actor from a ring of cameras as a capture folder with held-out pictures and, for a motion class, the "
      "truth between its members. MODEL is a rigged, textured glTF with animations, or \"procedural\" (also --actor "
      "procedural), a built-in actor with the motions walk, jog and run. The same options give the same bytes.",
      {{"-o", "CAPTURE", "folder to write (required)"},
       {"--sequences", "A,B", "animations to capture (default: all; procedural: walk,run)"},
       {"--class", "C=P:A,B",
        "sequences A, B … are class C with parameter P (procedural: locomotion=speed_mps: all sequences)"},
       {"--cameras", "N", "cameras on the ring, 2 to 128 (default 8); three held-out cameras are added"},
       {"--size", "WxH", "pixels of a picture, even (default 480x640)"},
       {"--fps", "N", "frames a second (default 25)"},
       {"--frames", "N", "only the first N frames of each sequence, which are then no loops and in no class"},
       {"--images", nullptr, "PNG pictures and mattes instead of videos"},
       {"--room", nullptr,
        "a furnished room instead of the green studio, with the actor's shadow; no mattes but in mattes_true/"},
       {"--scale", "X", "the written world (cameras, meshes, room, speeds) is X times as large (default 1)"},
       {"--room-size", "M", "length of the room's walls in metres (default: a quarter more than the cameras need)"},
       {"--plates", "N", "pictures of the empty room per camera (default 1)"},
       {"--no-plates", nullptr, "no pictures of the empty room: there is nothing to make mattes from"},
       {"--test-every", "N", "held-out pictures of every Nth frame (default 8)"},
       {"--truth", "A,B",
        "positions between a class's first (0) and last (1) member to render (default 0,0.2,0.4,0.6,0.8,1)"},
       {"--truth-phases", "N", "phases of the truth (default 8)"},
       {"--truth-ring", "N", "ring cameras that the truth is rendered from, besides the held-out ones (default 2)"},
       {"--no-truth", nullptr, "no truth between the members"},
       {"--seed", "N", "seed of all random numbers (default 1)"},
       {"--drift-mm", "X", "appearance slides over the mesh by up to X between first and last member (default 0)"},
       {"--wrinkles", "X", "0 to 1: folds that depend on the motion (default 0)"},
       {"--specular", "X", "0 to 1: highlights (default 0)"},
       {"--shading", "X", "0 to 1: shading by fixed lights (default 0.5)"},
       {"--rotation-deg", "X", "calibration error, deviation of the rotation (default 0)"},
       {"--translation-mm", "X", "calibration error, deviation of the position (default 0)"},
       {"--focal-percent", "X", "calibration error, deviation of the focal length (default 0)"},
       {"--plain", nullptr, "the actor is of one colour, its texture's mean: nothing for stereo to match but shading"},
       {"--proxy-mm", "X", "largest distance of the mesh from the true surface (default 0)"},
       {"--mesh-cell-mm", "X", "procedural: size of the mesh's faces, 8 to 45 (default 25: about 4000 vertices)"},
       {"--gain-percent", "X", "deviation of the cameras' colour gains (default 0)"},
       {"--lens", "K1,K2,K3", "pictures, plates and mattes through a lens of these radial coefficients (default none)"},
       {"--offset-frames", "X",
        "deviation of the cameras' time offsets in frames; \"offset_frames_true\" in capture.json has them (default "
        "0)"},
       {"--bystander", nullptr, "with --room: a second person behind the ring, whom one or two cameras see"},
       {"--soft-shadows", "X", "radius of the penumbra of the actor's shadow in metres (default 0: hard)"},
       {"--plate-move", "X",
        "plates of the room from cameras turned and moved until they are X pixels off (default 0)"},
       {"--exposure-drift", "X", "percent by which each camera's exposure strays over a clip, at most (default 0)"},
       {"--white-balance-drift", "X", "percent by which red strays up and blue down, at most (default 0)"},
       {"--noise", "X", "sensor noise, deviation in levels of 255 (default 0)"},
       {"--erosion", "X", "mattes are X pixels too small (default 0)"}}};
  return text;
}

// "locomotion=speed_mps:walk,run"
studio::StudioClass readClass(Args& args, const std::string& text) {
  studio::StudioClass out;
  const size_t equals = text.find('='), colon = text.find(':', equals);
  if (equals == std::string::npos || colon == std::string::npos) {
    args.complain("--class must be NAME=PARAMETER:A,B, not \"" + text + "\"");
    return out;
  }
  out.name = text.substr(0, equals);
  out.parameter = text.substr(equals + 1, colon - equals - 1);
  const std::string members = text.substr(colon + 1) + ",";
  for (size_t start = 0, comma; (comma = members.find(',', start)) != std::string::npos; start = comma + 1)
    out.members.push_back(members.substr(start, comma - start));
  return out;
}

void readTruth(Args& args, studio::StudioOptions& o) {
  o.truth_phases = args.integer("--truth-phases", o.truth_phases, 1, 1000);
  o.truth_ring = args.integer("--truth-ring", o.truth_ring, 0, 128);
  if (args.has("--no-truth") && args.has("--truth")) args.complain("--truth and --no-truth exclude each other");
  if (args.has("--truth") || args.has("--no-truth")) o.truth_at.clear();
  for (const std::string& text : args.list("--truth")) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end || !(value >= 0 && value <= 1))
      args.complain("--truth must be numbers from 0 to 1 separated by commas, not \"" + args.text("--truth") + "\"");
    o.truth_at.push_back(value);
  }
}

std::array<double, 3> readLens(Args& args) {
  std::array<double, 3> out{};
  const std::vector<std::string> texts = args.list("--lens");
  bool good = texts.size() == out.size();
  for (size_t i = 0; good && i < out.size(); ++i) {
    char* end = nullptr;
    out[i] = std::strtod(texts[i].c_str(), &end);
    good = !texts[i].empty() && !*end && std::abs(out[i]) <= 10;
  }
  if (!good) args.complain("--lens must be three numbers like -0.2,0.05,0.01, not \"" + args.text("--lens") + "\"");
  return out;
}

void readKnobs(Args& args, studio::StudioKnobs& k) {
  k.seed = static_cast<uint32_t>(args.integer("--seed", int(k.seed), 0, 1000000000));
  k.drift_mm = args.number("--drift-mm", k.drift_mm, 0, 100);
  k.wrinkles = args.number("--wrinkles", k.wrinkles, 0, 1);
  k.specular = args.number("--specular", k.specular, 0, 1);
  k.shading = args.number("--shading", k.shading, 0, 1);
  k.plain = args.has("--plain");
  k.rotation_deg = args.number("--rotation-deg", k.rotation_deg, 0, 10);
  k.translation_mm = args.number("--translation-mm", k.translation_mm, 0, 1000);
  k.focal_percent = args.number("--focal-percent", k.focal_percent, 0, 20);
  k.proxy_mm = args.number("--proxy-mm", k.proxy_mm, 0, 100);
  k.mesh_cell_mm = args.number("--mesh-cell-mm", k.mesh_cell_mm, 8, 45);
  k.gain_percent = args.number("--gain-percent", k.gain_percent, 0, 20);
  if (args.has("--lens")) k.lens = readLens(args);
  k.offset_frames = args.number("--offset-frames", k.offset_frames, 0, 100);
  k.soft_shadow_m = args.number("--soft-shadows", k.soft_shadow_m, 0, 0.5);
  k.plate_move_pixels = args.number("--plate-move", k.plate_move_pixels, 0, 100);
  k.exposure_drift_percent = args.number("--exposure-drift", k.exposure_drift_percent, 0, 50);
  k.white_balance_drift_percent = args.number("--white-balance-drift", k.white_balance_drift_percent, 0, 50);
  k.noise_levels = args.number("--noise", k.noise_levels, 0, 64);
  k.erosion_pixels = args.number("--erosion", k.erosion_pixels, 0, 64);
}

studio::StudioOptions readOptions(Args& args) {
  studio::StudioOptions o;
  o.actor = args.positional();
  o.folder = args.required("-o");
  o.sequences = args.list("--sequences");
  if (args.has("--class")) o.classes.push_back(readClass(args, args.text("--class")));
  o.cameras = args.integer("--cameras", o.cameras, 2, 128);
  if (const auto size = args.size("--size", 4096)) std::tie(o.width, o.height) = *size;
  o.fps = args.number("--fps", o.fps, 1, 1000);
  o.images = args.has("--images");
  o.room = args.has("--room");
  o.frames = args.integer("--frames", o.frames, 0, 1000000);
  o.bystander = args.has("--bystander");
  o.scale = args.number("--scale", o.scale, 0.001, 1000);
  o.room_size_m = args.number("--room-size", o.room_size_m, 0, 1000);
  o.plates = args.integer("--plates", o.plates, 1, 99);
  if (args.has("--no-plates") && args.has("--plates")) args.complain("--plates and --no-plates exclude each other");
  if (args.has("--no-plates")) o.plates = 0;
  o.test_every = args.integer("--test-every", o.test_every, 1, 1000000);
  readTruth(args, o);
  readKnobs(args, o.knobs);
  return o;
}

// Turns "--actor NAME" and "--actor=NAME" into the positional argument.
std::vector<char*> withoutActorOption(int argc, char** argv) {
  std::vector<char*> out;
  for (int i = 0; i < argc; ++i) {
    if (std::strcmp(argv[i], "--actor") == 0) continue;
    out.push_back(std::strncmp(argv[i], "--actor=", 8) == 0 ? argv[i] + 8 : argv[i]);
  }
  return out;
}

// Prints one line, rewritten in place, on a terminal; elsewhere one line per step.
class ProgressLine {
 public:
  void show(const studio::StudioProgress& p) {
    if (!tty_ && p.step == step_) return;
    const auto now = std::chrono::steady_clock::now();
    if (tty_ && p.done != p.total && now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    step_ = p.step;
    std::fprintf(stderr, tty_ ? "\r\033[K%s  %u of %u pictures" : "%s  %u of %u pictures\n", p.step.c_str(), p.done,
                 p.total);
    std::fflush(stderr);
  }
  void end() const {
    if (tty_ && !step_.empty()) std::fputs("\r\033[K", stderr);
  }

 private:
  const bool tty_ = isatty(STDERR_FILENO) != 0;
  std::string step_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace

int studioCommand(int argc, char** argv) {
  std::vector<char*> arguments = withoutActorOption(argc, argv);
  Args args(help(), static_cast<int>(arguments.size()), arguments.data());
  const studio::StudioOptions options = readOptions(args);
  if (args.problem().empty() && !args.wantsHelp()) {
    const std::string wrong = options.check();
    if (!wrong.empty()) args.complain(wrong);
  }
  if (const auto code = tools::helpOrProblem(help(), args)) return *code;

  const std::atomic<bool>* stop = tools::listenForStop();
  auto gpu = tools::openGpu();
  if (!gpu.ok()) return tools::fail(gpu.error());
  ProgressLine line;
  const studio::StudioEnvironment environment{gpu.value().device.get(),
                                              [&](const studio::StudioProgress& p) { line.show(p); }, stop};
  const auto start = std::chrono::steady_clock::now();
  auto report = studio::runStudio(options, environment);
  line.end();
  if (!report.ok()) return tools::fail(report.error());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const studio::StudioReport& r = report.value();
  std::printf("%s: %u frames of %d cameras, mesh of %u vertices and %u faces, %u pictures in %.1f s\n",
              options.folder.c_str(), r.frames, options.cameras, r.vertices, r.faces, r.pictures, seconds.count());
  return tools::kOk;
}

}  // namespace fourdvt::lab
