// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "base/text.h"
#include "capture/import/import_capture.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/planned_commands.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

using track::TrackOptions;

// Parses SEQUENCE:FRAME.
std::optional<track::FrameName> frameNamed(const std::string& text) {
  const size_t colon = text.rfind(':');
  track::FrameName out;
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  out.sequence = text.substr(0, colon);
  const char *first = text.data() + colon + 1, *last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, out.frame);
  if (error != std::errc() || end != last || first == last) return std::nullopt;
  return out;
}

Options rows(TrackOptions& o) {
  return {
      {"-o CAPTURE2", required(o.folder), "folder to write (required)"},
      sequencesOption(o.sequences),
      {"--faces N", number(o.mesh.faces, 500, 100'000), "triangles of the mesh, 500 to 100000 (default 8000)"},
      {"--template SEQUENCE:FRAME", parsed(o.template_frame, frameNamed, "SEQUENCE:FRAME, such as walk:12"),
       "frame whose surface becomes the mesh (default: the one with the most surface in sight and no parts in "
       "contact)"},
      {"--loop A,B", list(o.loops),
       "sequences of which one cycle, such as a stride, becomes a loop (default: none; loops of the input stay)"},
      classOption(o.classes),
      jobsOption(o.jobs),
      resumeOption(o.resume),
  };
}

// Checks loops and classes against the input's sequences, before any work.
Status checkMotions(const TrackOptions& options) {
  if (options.classes.empty() && options.loops.empty()) return {};
  FOURDVT_ASSIGN(const auto capture,
                 capture::openDescription(options.capture_folder, options.sequences, capture::MeshNeed::Nothing));
  std::vector<std::string> names, loops;
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    names.push_back(sequence.name);
    if (sequence.loop) loops.push_back(sequence.name);
  }
  for (const std::string& name : options.loops) {
    const std::string where = options.capture_folder + ": --loop: ";
    const capture::CaptureSequence* sequence = capture.find(name);
    if (!sequence)
      return Error{ErrorId::InvalidArgument,
                   where + "no sequence \"" + name + "\"; choose among: " + joined(names, ", ")};
    if (!sequence->loop && sequence->frame_count <= track::kMinCycle_s * capture.fps)
      return Error{ErrorId::InvalidArgument, where + "the " + std::to_string(sequence->frame_count) + " frames of \"" +
                                                 name + "\" are too few for a cycle; film at least one whole stride"};
    loops.push_back(name);
  }
  const std::string problem = capture::classProblem(options.classes, names, loops);
  return problem.empty() ? Status() : Error{ErrorId::InvalidArgument, options.capture_folder + ": " + problem};
}

}  // namespace

Result<std::optional<int>> readTrackCommand(int argc, char** argv, TrackOptions& o, TrackExtension extension) {
  Args args({"track SURFACES -o CAPTURE2 [options]",
             "Makes one mesh with texture coordinates, and moves it through all frames of a capture with a surface per "
             "frame, such as `fourdvt reconstruct` writes. The new capture folder is one that bake takes for texture "
             "layers, motion classes and transitions; its pictures are links. The folder appears when it is complete. "
             "After Ctrl-C, the same command with --resume continues. The report is CAPTURE2/track.html.",
             {&o.capture_folder},
             extension ? join({rows(o), extension(o)}) : rows(o)},
            argc, argv);
  if (const auto code = args.helpOrProblem()) return code;
  FOURDVT_TRY(checkMotions(o));
  return std::optional<int>();
}

track::TrackEnvironment trackEnvironment(ProgressLine& line) {
  track::TrackEnvironment environment;
  environment.open_video = videoOpener();
  environment.progress = [&line](const FrameProgress& p) { line.show(p); };
  environment.note = [](const std::string& text) { note("%s", text.c_str()); };
  environment.stop = listenForStop();
  return environment;
}

void printTrackSummary(const std::string& folder, const track::TrackSummary& s) {
  for (const std::string& warning : s.warnings) warn("%s", warning.c_str());
  for (const std::string& loop : s.loops) note("%s", loop.c_str());
  const uint32_t made = s.frames - s.frames_kept;
  note(
      "%s: %u frames, %.1f s (%.2f s per frame), a mesh of %u triangles from %s, frame %u; it covers the mattes by "
      "%.4f "
      "(lowest %.4f), and 95 %% of it lies within %.1f mm of the surfaces",
      folder.c_str(), s.frames, s.wall_s, made ? s.wall_s / made : 0.0, s.faces, s.template_frame.sequence.c_str(),
      s.template_frame.frame, s.mean_overlap, s.lowest_overlap, 1e3 * s.distance_95_m);
  note("figures: %s/track.html", folder.c_str());
}

Result<int> trackCommand(int argc, char** argv, TrackExtension extension) {
  TrackOptions options;
  FOURDVT_ASSIGN(const auto code, readTrackCommand(argc, argv, options, extension));
  if (code) return *code;
  ProgressLine line;
  FOURDVT_ASSIGN(const auto summary, track::track(options, trackEnvironment(line)));
  line.end();
  printTrackSummary(options.folder, summary);
  return kOk;
}

}  // namespace fourdvt::tools
