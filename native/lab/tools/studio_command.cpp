// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "base/watch.h"
#include "lab/studio/studio.h"
#include "lab/tools/commands.h"
#include "tools/args.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::lab {
namespace {

using tools::Args, tools::flag, tools::number, tools::Options;

// "locomotion=speed_mps:walk,run"
std::optional<std::vector<studio::StudioClass>> parseClass(const std::string& text) {
  const size_t equals = text.find('='), colon = text.find(':', equals);
  if (equals == std::string::npos || colon == std::string::npos) return std::nullopt;
  studio::StudioClass out{text.substr(0, equals), text.substr(equals + 1, colon - equals - 1), {}};
  const std::string members = text.substr(colon + 1) + ",";
  for (size_t start = 0, comma; (comma = members.find(',', start)) != std::string::npos; start = comma + 1)
    out.members.push_back(members.substr(start, comma - start));
  return std::vector{out};
}

// Parses comma-separated numbers; returns an empty list if one is invalid or out of the range.
std::vector<double> parseNumbers(const std::string& text, double low, double high) {
  std::vector<double> out;
  for (const char* at = text.c_str();; ++at) {
    char* end = nullptr;
    out.push_back(std::strtod(at, &end));
    if (end == at || (*end && *end != ',') || !(out.back() >= low && out.back() <= high)) return {};
    if (!*end) return out;
    at = end;
  }
}

std::optional<std::vector<double>> parseTruth(const std::string& text) {
  auto out = parseNumbers(text, 0, 1);
  return out.empty() ? std::nullopt : std::optional(std::move(out));
}

std::optional<std::array<double, 3>> parseLens(const std::string& text) {
  const auto out = parseNumbers(text, -10, 10);
  return out.size() == 3 ? std::optional(std::array{out[0], out[1], out[2]}) : std::nullopt;
}

Options captureOptions(studio::StudioOptions& o) {
  return {
      {"-o CAPTURE", tools::required(o.folder), "folder to write (required)"},
      {"--sequences A,B", tools::list(o.sequences), "animations to capture (default: all; procedural: walk,run)"},
      {"--class C=P:A,B", tools::parsed(o.classes, parseClass, "NAME=PARAMETER:A,B"),
       "sequences A, B … are class C with parameter P (procedural: locomotion=speed_mps: all gaits)"},
      {"--cameras N", number(o.cameras, 2, 128),
       "cameras on the ring, 2 to 128 (default 8); three held-out cameras are added"},
      {"--size WxH", tools::size(o.width, o.height, 4096), "pixels of a picture, even (default 480x640)"},
      {"--fps N", number(o.fps, 1, 1000), "frames a second (default 25)"},
      {"--frames N", number(o.frames, 0, 1000000),
       "only the first N frames of each sequence, which are then no loops and in no class"},
      {"--strides N", number(o.strides, 0, 100),
       "gaits take N strides, a clip with an end that is in no class (default 0: one, a loop)"},
      {"--travel", flag(o.travel), "with --strides: they lead through the middle of the stage, not on the spot"},
      {"--images", flag(o.images), "PNG pictures and mattes instead of videos"},
      {"--room", flag(o.room),
       "a furnished room instead of the green studio, with the actor's shadow; no mattes but in mattes_true/"},
      {"--scale X", number(o.scale, 0.001, 1000),
       "the written world (cameras, meshes, room, speeds) is X times as large (default 1)"},
      {"--room-size M", number(o.room_size_m, 0, 1000),
       "length of the room's walls in metres (default: a quarter more than the cameras need)"},
      {"--plates N", number(o.plates, 1, 99), "pictures of the empty room per camera (default 1)"},
      {"--no-plates",
       [&o](Args& args, const std::string& name) {
         if (!args.has(name)) return;
         o.plates = 0;
         if (args.has("--plates")) args.complain("--plates and --no-plates exclude each other");
       },
       "no pictures of the empty room: there is nothing to make mattes from"},
      {"--test-every N", number(o.test_every, 1, 1000000), "held-out pictures of every Nth frame (default 8)"},
  };
}

Options truthOptions(studio::StudioOptions& o) {
  return {
      {"--truth A,B", tools::parsed(o.truth_at, parseTruth, "numbers from 0 to 1 separated by commas"),
       "positions between a class's first (0) and last (1) member to render (default 0,0.2,0.4,0.6,0.8,1)"},
      {"--truth-phases N", number(o.truth_phases, 1, 1000), "phases of the truth (default 8)"},
      {"--truth-ring N", number(o.truth_ring, 0, 128),
       "ring cameras that the truth is rendered from, besides the held-out ones (default 2)"},
      {"--no-truth",
       [&o](Args& args, const std::string& name) {
         if (!args.has(name)) return;
         o.truth_at.clear();
         if (args.has("--truth")) args.complain("--truth and --no-truth exclude each other");
       },
       "no truth between the members"},
  };
}

Options knobOptions(studio::StudioOptions& o) {
  studio::StudioKnobs& k = o.knobs;
  return {
      {"--seed N", number(k.seed, 0, 1000000000), "seed of all random numbers (default 1)"},
      {"--drift-mm X", number(k.drift_mm, 0, 100),
       "appearance slides over the mesh by up to X between first and last member (default 0)"},
      {"--wrinkles X", number(k.wrinkles, 0, 1), "0 to 1: folds that depend on the motion (default 0)"},
      {"--specular X", number(k.specular, 0, 1), "0 to 1: highlights (default 0)"},
      {"--shading X", number(k.shading, 0, 1), "0 to 1: shading by fixed lights (default 0.5)"},
      {"--rotation-deg X", number(k.rotation_deg, 0, 10), "calibration error, deviation of the rotation (default 0)"},
      {"--translation-mm X", number(k.translation_mm, 0, 1000),
       "calibration error, deviation of the position (default 0)"},
      {"--focal-percent X", number(k.focal_percent, 0, 20),
       "calibration error, deviation of the focal length (default 0)"},
      {"--plain", flag(k.plain),
       "the actor is of one colour, its texture's mean: nothing for stereo to match but shading"},
      {"--plain-clothes", flag(k.plain_clothes),
       "procedural: shirt, trousers and shoes are of one colour each; skin, face and hair keep their texture"},
      {"--proxy-mm X", number(k.proxy_mm, 0, 100), "largest distance of the mesh from the true surface (default 0)"},
      {"--mesh-cell-mm X", number(k.mesh_cell_mm, 8, 45),
       "procedural: size of the mesh's faces, 8 to 45 (default 25: about 4000 vertices)"},
      {"--gain-percent X", number(k.gain_percent, 0, 20), "deviation of the cameras' colour gains (default 0)"},
      {"--lens K1,K2,K3", tools::parsed(k.lens, parseLens, "three numbers like -0.2,0.05,0.01"),
       "pictures, plates and mattes through a lens of these radial coefficients (default none)"},
      {"--offset-frames X", number(k.offset_frames, 0, 100),
       "deviation of the cameras' time offsets in frames; \"offset_frames_true\" in capture.json has them (default "
       "0)"},
      {"--bystander", flag(o.bystander), "with --room: a second person behind the ring, whom one or two cameras see"},
      {"--soft-shadows X", number(k.soft_shadow_m, 0, 0.5),
       "radius of the penumbra of the actor's shadow in metres (default 0: hard)"},
      {"--plate-move X", number(k.plate_move_pixels, 0, 100),
       "plates of the room from cameras turned and moved until they are X pixels off (default 0)"},
      {"--exposure-drift X", number(k.exposure_drift_percent, 0, 50),
       "percent by which each camera's exposure strays over a clip, at most (default 0)"},
      {"--white-balance-drift X", number(k.white_balance_drift_percent, 0, 50),
       "percent by which red strays up and blue down, at most (default 0)"},
      {"--noise X", number(k.noise_levels, 0, 64), "sensor noise, deviation in levels of 255 (default 0)"},
      {"--erosion X", number(k.erosion_pixels, 0, 64), "mattes are X pixels too small (default 0)"},
  };
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
  ~ProgressLine() { end(); }
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

Result<int> studioCommand(int argc, char** argv) {
  std::vector<char*> arguments = withoutActorOption(argc, argv);
  studio::StudioOptions options;
  Args args(
      {"studio MODEL.glb|procedural -o CAPTURE [options]",
       "Renders an actor from a ring of cameras as a capture folder with held-out pictures and, for a motion "
       "class, the truth between its members. MODEL is a rigged, textured glTF with animations, or \"procedural\" "
       "(also --actor procedural), a built-in actor with the motions walk, jog, run, stand and raise. The same "
       "options give the same bytes.",
       {&options.actor},
       tools::join({captureOptions(options), truthOptions(options), knobOptions(options)})},
      static_cast<int>(arguments.size()), arguments.data());
  args.complain(options.check());
  if (const auto code = args.helpOrProblem()) return *code;

  const std::atomic<bool>* stop = tools::listenForStop();
  FOURDVT_ASSIGN(const auto gpu, tools::openGpu());
  ProgressLine line;
  const studio::StudioEnvironment environment{gpu.device.get(), [&](const studio::StudioProgress& p) { line.show(p); },
                                              stop};
  const Watch watch;
  FOURDVT_ASSIGN(const studio::StudioReport r, studio::runStudio(options, environment));
  line.end();
  const double seconds = watch.seconds();
  std::printf("%s: %u frames of %d cameras, mesh of %u vertices and %u faces, %u pictures in %.1f s\n",
              options.folder.c_str(), r.frames, options.cameras, r.vertices, r.faces, r.pictures, seconds);
  return tools::kOk;
}

}  // namespace fourdvt::lab
