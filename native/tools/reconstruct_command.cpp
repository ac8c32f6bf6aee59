// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tools/args.h"
#include "tools/choice.h"
#include "tools/commands.h"
#include "tools/log.h"
#include "tools/reconstruct_arguments.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

using reconstruct::HullKind, reconstruct::ReconstructOptions;

const CommandHelp& help() {
  static const CommandHelp text{
      "reconstruct CAPTURE -o CAPTURE2 [options]",
      "Makes a surface for every frame from calibrated cameras and their pictures alone, and writes a capture folder "
      "with it: pictures are links into CAPTURE, meshes are PLY files. Meshes of CAPTURE are ignored. The folder "
      "appears when it is complete. After Ctrl-C, the same command with --resume continues. The report is "
      "CAPTURE2/reconstruct.html.",
      {{"-o", "CAPTURE2", "folder to write (required)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--leave-out", "A,B", "cameras that the new capture shall not have"},
       {"--mattes-alone", nullptr,
        "missing mattes are made by every camera by itself (default: cameras help each other, see fourdvt mattes)"},
       {"--any-silhouettes", nullptr, "go on although no common volume explains the silhouettes of the first frame"},
       {"--synchronise", "MODE",
        "on (default): find cameras that are off in time by their silhouettes (see fourdvt calibrate); off: as given"},
       {"--refine-cameras", "MODE",
        "on (default): turn cameras that the silhouettes clearly contradict; off: as given"},
       {"--hull", "KIND",
        "volumetric (voxels; default), or polyhedral (exact intersection of the silhouettes' cones, few triangles; "
        "volumetric in frames where the polyhedron fails its checks)"},
       {"--contour-tolerance", "PX",
        "polyhedral: largest distance of polygons from the outlines, pixels, 0.25 to 8 (default 1)"},
       {"--voxel-mm", "X",
        "side of a voxel, 0.001 to 10000 (default: the size of a pixel on the performer in the sequence's first frame, "
        "or larger where the surface would have over four times --faces)"},
       {"--faces", "N",
        "most triangles of a surface, 1000 to 10000000; those beyond are simplified away (default 150000)"},
       {"--adaptivity", "X", "0 to 1: fewer triangles where the surface is flat (default 0.1)"},
       {"--refine", "MODE",
        "stereo (find the photo-consistent surface inside the volumetric hull; default) or none (default with --hull "
        "polyhedral)"},
       {"--planes", "N", "stereo: number of depth hypotheses, 16 to 128 in steps of 4 (default 64; fewer are faster)"},
       {"--fairing", "N", "rounds of smoothing that preserve the silhouettes, 0 to 100 (default 0)"},
       {"--jobs", "N", "worker threads; 0: one per core (default 0)"},
       {"--resume", nullptr, "continue an interrupted run with the same settings"}}};
  return text;
}

ReconstructOptions readOptions(Args& args) {
  ReconstructOptions o;
  o.capture_folder = args.positional();
  o.folder = args.required("-o");
  o.sequences = args.list("--sequences");
  o.leave_out = args.list("--leave-out");
  o.mattes_alone = args.has("--mattes-alone");
  o.any_silhouettes = args.has("--any-silhouettes");
  o.hull = choice(args, "--hull", o.hull, {{"polyhedral", HullKind::Polyhedral}, {"volumetric", HullKind::Volumetric}});
  o.contour_tolerance_px = args.number("--contour-tolerance", o.contour_tolerance_px, 0.25, 8);
  if (args.has("--voxel-mm")) o.voxel_m = args.number("--voxel-mm", 5, 1e-3, 1e4) / 1e3;
  o.faces = args.integer("--faces", o.faces, 1000, 10'000'000);
  o.adaptivity = args.number("--adaptivity", o.adaptivity, 0, 1);
  o.stereo = choice(args, "--refine", o.hull == HullKind::Volumetric, {{"stereo", true}, {"none", false}});
  o.synchronise = choice(args, "--synchronise", true, {{"on", true}, {"off", false}});
  o.refine_cameras = choice(args, "--refine-cameras", true, {{"on", true}, {"off", false}});
  o.planes = args.integer("--planes", o.planes, 16, 128);
  if (o.planes % 4 != 0) args.complain("--planes must be a multiple of 4");
  o.fairing = args.integer("--fairing", o.fairing, 0, 100);
  o.jobs = args.integer("--jobs", o.jobs, 0, 1024);
  o.resume = args.has("--resume");
  return o;
}

}  // namespace

ReconstructCommandLine readReconstructCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  ReconstructCommandLine line{readOptions(args), std::nullopt};
  if (const std::string wrong = line.options.check(); args.problem().empty() && !args.wantsHelp() && !wrong.empty())
    args.complain(wrong);
  line.exit_code = helpOrProblem(help(), args);
  return line;
}

reconstruct::ReconstructEnvironment reconstructEnvironment(const GpuSession& gpu, ProgressLine& line) {
  reconstruct::ReconstructEnvironment environment;
  environment.device = gpu.device.get();
  environment.open_video = videoOpener();
  environment.progress = [&line](const reconstruct::ReconstructProgress& p) {
    line.show({p.stage, p.done, p.total, p.frames_per_s, p.left_s});
  };
  environment.note = [](const std::string& text) { note("%s", text.c_str()); };
  environment.stop = listenForStop();
  return environment;
}

void printReconstructSummary(const std::string& folder, const reconstruct::ReconstructSummary& s) {
  for (const std::string& warning : s.warnings) warn("%s", warning.c_str());
  const uint32_t made = s.frames - s.frames_kept;
  note(
      "%s: %u frames, %.1f s (%.2f s per frame), overlap with the silhouettes %.4f (lowest %.4f), which cover "
      "%.1f %% of the pictures; %.3g of the %.3g m³ that the cameras see",
      folder.c_str(), s.frames, s.wall_s, made ? s.wall_s / made : 0.0, s.mean_overlap, s.lowest_overlap,
      100 * s.mean_cover, s.volume_m3, s.seen_m3);
  note("figures: %s/reconstruct.html", folder.c_str());
}

int reconstructCommand(int argc, char** argv) {
  const auto [options, exit_code] = readReconstructCommand(argc, argv);
  if (exit_code) return *exit_code;
  GpuSession gpu;
  if (options.stereo) {
    auto opened = openGpu();
    if (!opened.ok()) return fail(opened.error());
    gpu = opened.take();
  }
  ProgressLine line;
  const auto summary = reconstruct::reconstruct(options, reconstructEnvironment(gpu, line));
  line.end();
  if (!summary.ok()) return fail(summary.error());
  printReconstructSummary(options.folder, summary.value());
  return kOk;
}

}  // namespace fourdvt::tools
