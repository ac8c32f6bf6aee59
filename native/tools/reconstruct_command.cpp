// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tools/args.h"
#include "tools/commands.h"
#include "tools/planned_commands.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

using reconstruct::HullKind, reconstruct::ReconstructOptions;

Options silhouetteOptions(ReconstructOptions& o) {
  return {
      {"-o CAPTURE2", required(o.folder), "folder to write (required)"},
      sequencesOption(o.sequences),
      {"--leave-out A,B", list(o.leave_out), "cameras that the new capture shall not have"},
      {"--mattes-alone", flag(o.mattes_alone),
       "missing mattes are made by every camera by itself (default: cameras help each other, see fourdvt mattes)"},
      {"--any-silhouettes", flag(o.any_silhouettes),
       "go on although no common volume explains the silhouettes of the first frame"},
      {"--synchronise MODE", choice(o.synchronise, {{"on", true}, {"off", false}}),
       "on (default): find cameras that are off in time by their silhouettes (see fourdvt calibrate); off: as given"},
      {"--refine-cameras MODE", choice(o.refine_cameras, {{"on", true}, {"off", false}}),
       "on (default): turn cameras that the silhouettes clearly contradict; off: as given"},
  };
}

Options surfaceOptions(ReconstructOptions& o) {
  const auto readStereo = [&o](Args& args, const std::string& name) {
    o.stereo = o.hull == HullKind::Volumetric;
    choice(o.stereo, {{"stereo", true}, {"none", false}})(args, name);
  };
  const auto readPlanes = [&o](Args& args, const std::string& name) {
    number(o.planes, 16, 128)(args, name);
    if (o.planes % 4 != 0) args.complain(name + " must be a multiple of 4");
  };
  return {
      {"--hull KIND", choice(o.hull, {{"polyhedral", HullKind::Polyhedral}, {"volumetric", HullKind::Volumetric}}),
       "volumetric (voxels; default), or polyhedral (exact intersection of the silhouettes' cones, few triangles; "
       "volumetric in frames where the polyhedron fails its checks)"},
      {"--contour-tolerance PX", number(o.contour_tolerance_px, 0.25, 8),
       "polyhedral: largest distance of polygons from the outlines, pixels, 0.25 to 8 (default 1)"},
      {"--voxel-mm X", number(o.voxel_m, 1e-3, 1e4, 1e-3),
       "side of a voxel, 0.001 to 10000 (default: the size of a pixel on the performer in the sequence's first frame, "
       "or larger where the surface would have over four times --faces)"},
      {"--faces N", number(o.faces, 1000, 10'000'000),
       "most triangles of a surface, 1000 to 10000000; those beyond are simplified away (default 150000)"},
      {"--adaptivity X", number(o.adaptivity, 0, 1), "0 to 1: fewer triangles where the surface is flat (default 0.1)"},
      {"--refine MODE", readStereo,
       "stereo (find the photo-consistent surface inside the volumetric hull; default) or none (default with --hull "
       "polyhedral)"},
      {"--planes N", readPlanes,
       "stereo: number of depth hypotheses, 16 to 128 in steps of 4 (default 64; fewer are faster)"},
      {"--fairing N", number(o.fairing, 0, 100),
       "rounds of smoothing that preserve the silhouettes, 0 to 100 (default 0)"},
      jobsOption(o.jobs),
      resumeOption(o.resume),
  };
}

}  // namespace

std::optional<int> readReconstructCommand(int argc, char** argv, ReconstructOptions& o) {
  Args args({"reconstruct CAPTURE -o CAPTURE2 [options]",
             "Makes a surface for every frame from calibrated cameras and their pictures alone, and writes a capture "
             "folder with it: pictures are links into CAPTURE, meshes are PLY files. Meshes of CAPTURE are ignored. "
             "The folder appears when it is complete. After Ctrl-C, the same command with --resume continues. The "
             "report is CAPTURE2/reconstruct.html.",
             {&o.capture_folder},
             join({silhouetteOptions(o), surfaceOptions(o)})},
            argc, argv);
  args.complain(o.check());
  return args.helpOrProblem();
}

reconstruct::ReconstructEnvironment reconstructEnvironment(const GpuSession& gpu, ProgressLine& line) {
  reconstruct::ReconstructEnvironment environment;
  environment.device = gpu.device.get();
  environment.open_video = videoOpener();
  environment.progress = [&line](const FrameProgress& p) { line.show(p); };
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

Result<int> reconstructCommand(int argc, char** argv) {
  ReconstructOptions options;
  if (const auto code = readReconstructCommand(argc, argv, options)) return *code;
  GpuSession gpu;
  if (options.stereo) {
    FOURDVT_ASSIGN(gpu, openGpu());
  }
  ProgressLine line;
  FOURDVT_ASSIGN(const auto summary, reconstruct::reconstruct(options, reconstructEnvironment(gpu, line)));
  line.end();
  printReconstructSummary(options.folder, summary);
  return kOk;
}

}  // namespace fourdvt::tools
