// SPDX-License-Identifier: Apache-2.0

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "bake/method/camera_choice.h"
#include "bake/motion/class_plan.h"
#include "bake/run/character_files.h"
#include "bake/run/options.h"
#include "bake/run/renditions.h"
#include "bake/stages/stages.h"
#include "base/mesh.h"
#include "base/text.h"
#include "capture/mesh_sequence.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "render/character_model.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

Error bad(const std::string& message) { return {ErrorId::InvalidArgument, message}; }

Status checkOutput(const BakeOptions& options) {
  std::error_code error;
  const fs::path target(options.character_folder);
  if (!fs::exists(target, error)) return {};
  if (!fs::is_directory(target, error))
    return bad(options.character_folder + ": exists and is not a folder; choose another output folder");
  if (fs::is_empty(target, error) || fs::exists(target / "character.gltf", error)) return {};
  return bad(options.character_folder +
             ": exists and is not a character folder (no character.gltf inside); choose another output folder");
}

// Rejects a path that is no work folder of a bake: the folder is deleted at the end.
Status checkWorkFolder(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error) || fs::exists(fs::path(path) / "settings.txt", error)) return {};
  if (fs::is_directory(path, error) && fs::is_empty(path, error)) return {};
  return bad(path + ": exists and is not a bake's work folder; move it away or choose another output folder");
}

// Rejects a folder with any content but an earlier report: the whole folder is replaced.
Status checkReportFolder(const std::string& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return {};
  const auto isOurs = [](const std::string& name) {
    return name.starts_with("report") || name.starts_with("room.") || name == kPosterFile || name == kRefinedCameras;
  };
  bool ours = fs::is_directory(fs::symlink_status(path, error));
  for (fs::directory_iterator entry(path, error), end; ours && !error && entry != end; entry.increment(error))
    ours = isOurs(entry->path().filename().string());
  if (ours && !error) return {};
  return bad(path + ": exists and is not only a bake's report, which is replaced; move it away or choose another " +
             "output folder");
}

double layeredBytes(const Job& job) {
  const double texels = job.layout.width * job.layout.height * ladderTexels(job.options);
  const double frame = texels * kVideoBytesPerTexel + 8.0 * job.mesh.source_vertex.size();
  double frames = job.total_frames;
  for (const capture::CaptureClass* c : bakedClasses(job)) frames += c->members.size() * expectedPhases(job, *c);
  return frame * frames;
}

// Checks that names are unique and valid as file names: those of sequences and classes share one folder.
Status checkNames(const Job& job) {
  std::vector<std::string> names;
  for (const capture::CaptureSequence& s : job.capture.sequences) names.push_back(s.name);
  for (const capture::CaptureClass* c : bakedClasses(job)) names.push_back(c->name);
  const std::string json = job.capture.folder + "/capture.json: ";
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (!isFileName(*name))
      return Error{ErrorId::CaptureJson, json + "sequence or class name '" + *name +
                                             "' cannot be a file name; use letters, digits, '_' and '-'"};
    if (*name == "mesh" || *name == "motion" || *name == "tiles")
      return Error{ErrorId::CaptureJson, json + "a sequence or class cannot be called '" + *name +
                                             "': the character has a file of that name; rename it"};
    if (std::find(names.begin(), name, *name) != name)
      return Error{ErrorId::CaptureJson,
                   json + "two sequences or classes are called '" + *name + "'; give each a name of its own"};
  }
  return {};
}

// Files of lower renditions append a suffix to the sequence's or class's name.
Status checkRenditionNames(const Job& job) {
  std::vector<std::string> names;
  for (const capture::CaptureSequence& s : job.capture.sequences) names.push_back(s.name);
  for (const capture::CaptureClass* c : bakedClasses(job)) names.push_back(c->name);
  for (const std::string& name : names) {
    for (const LowerRendition& r : job.options.lower_renditions) {
      const std::string file = name + fileSuffix(r, job.options);
      if (std::find(names.begin(), names.end(), file) == names.end()) continue;
      return Error{ErrorId::CaptureJson, job.capture.folder + "/capture.json: '" + file +
                                             "' is also the name of a rendition of '" + name + "'; rename one of them"};
    }
  }
  return {};
}

// Resolves the standard ladder if it is selected, once the appearance is chosen.
Status resolveRenditions(BakeOptions& o) {
  if (o.standard_renditions) o.lower_renditions = standardRenditions(o);
  if (const std::string wrong = checkRenditions(o); !wrong.empty()) return bad(wrong);
  for (const LowerRendition& r : o.lower_renditions) FOURDVT_TRY(encode::checkEncoder(r.codec, r.preset));
  return {};
}

Status checkClassPictures(const Job& job) {
  const BakeOptions& o = job.options;
  for (const capture::CaptureClass* c : bakedClasses(job)) {
    const std::string wrong =
        encode::checkTileLayout(o.layers, o.texture, o.equal_layers, static_cast<int>(c->members.size()));
    if (!wrong.empty()) return bad("class '" + c->name + "': " + wrong + ", or leave classes out with --no-classes");
  }
  return {};
}

// Keeps the cameras named by --cameras, or the best ones where there are more than a character holds. Afterwards
// options.camera_names has their names if some are left out, else none.
Status keepCameras(Job& job, const BakeEnvironment& environment) {
  constexpr auto kMax = size_t(package::kMaxCameras);
  std::vector<PinholeCamera> all;
  for (const capture::CaptureCamera& camera : job.capture.cameras) all.push_back(camera.pinhole);
  std::vector<std::string>& names = job.options.camera_names;
  const bool asked = !names.empty();
  if (all.empty())
    return Error{ErrorId::Unsupported, job.capture.folder + "/cameras: no cameras; a character needs one"};
  std::vector<size_t> chosen;
  if (asked) {
    FOURDVT_ASSIGN(chosen, camerasByName(all, names));
  } else if (all.size() <= kMax) {
    return {};
  } else {
    FOURDVT_ASSIGN(const auto surface, capture::readSurfaceFrame(job.capture, job.capture.sequences[0], 0));
    chosen = chooseCameras(all, surface.positions, kMax);
    if (chosen.empty())
      return Error{ErrorId::NothingVisible, job.capture.folder +
                                                ": no camera sees the first surface: check the axes and units of "
                                                "meshes and cameras"};
  }
  if (chosen.size() > kMax)
    return bad("--cameras: " + std::to_string(chosen.size()) + " cameras; a character holds 1 to " +
               std::to_string(kMax) + "; leave the option out to have the best ones chosen");
  names.clear();
  if (chosen.size() == all.size()) return {};
  std::vector<capture::CaptureCamera> kept;
  for (const size_t c : chosen) {
    kept.push_back(job.capture.cameras[c]);
    names.push_back(all[c].name);
  }
  job.capture.cameras = std::move(kept);
  std::string note = "The character has " + std::to_string(names.size()) + " of the capture's " +
                     std::to_string(all.size()) + " cameras:";
  for (const std::string& name : names) note += " " + name;
  job.notes.push_back(note + ".");
  if (environment.note) environment.note(job.notes.back());
  return {};
}

const char* nameOf(package::AppearanceKind kind) {
  return kind == package::AppearanceKind::Layers ? "layers" : "cameras";
}

// Opens the capture in the selected appearance, and selects one if the options leave it open.
Status openCapture(Job& job, const BakeEnvironment& environment) {
  BakeOptions& o = job.options;
  const bool any = o.appearance != package::AppearanceKind::Layers;
  FOURDVT_ASSIGN(job.capture,
                 mattes::openCapture(o.capture_folder, environment.open_video, o.sequences,
                                     any ? capture::MeshNeed::AnySurface : capture::MeshNeed::ConstantTopology));
  const bool constant = job.oneTopology();
  const bool chosen = !o.appearance;
  if (chosen) o.appearance = constant ? package::AppearanceKind::Layers : package::AppearanceKind::Cameras;
  if (!job.fromCameras()) return {};
  for (const capture::CaptureSequence& sequence : job.capture.sequences)
    if (sequence.travel)
      return bad(o.capture_folder + "/capture.json: \"travel\" of \"" + sequence.name +
                 "\": a character from cameras stays where its pictures show it, and does not play on the spot; bake " +
                 (constant ? "from layers (--appearance layers)" : "one mesh that moves (fourdvt track)") +
                 ", or take \"travel\" out");
  if (!constant && o.refine_asked && o.refine.any())
    return bad(o.capture_folder +
               ": its meshes have another topology in every frame, and --refine moves one mesh; leave out --refine, "
               "--refine-cameras and --matte-bias-px, or run `fourdvt calibrate` and `fourdvt reconstruct` again");
  if (!constant) o.refine = {.outline = false, .cameras = false};
  if (!chosen) return {};
  job.notes.push_back("The character is textured from " + std::string(nameOf(*o.appearance)) + ": the meshes of " +
                      job.capture.folder + " have another topology in every frame.");
  if (environment.note) environment.note(job.notes.back());
  return {};
}

Status checkClasses(const Job& job) {
  if (!job.fromCameras())
    for (const capture::CaptureClass* c : bakedClasses(job)) FOURDVT_TRY(checkClass(job.capture, *c));
  if (!job.fromCameras() || bakedClasses(job).empty()) return {};
  return bad(job.capture.folder + "/capture.json: class '" + bakedClasses(job)[0]->name +
             "': classes need layers; leave them out with --no-classes");
}

Status findBounds(Job& job, const BakeEnvironment& environment) {
  bool first = true;
  std::vector<double> sides_m;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    for (uint32_t f = 0; f < sequence.frame_count; ++f) {
      if (environment.stop && *environment.stop) return Error{ErrorId::Interrupted, "stopped; nothing was written"};
      FOURDVT_ASSIGN(auto positions, capture::readMeshFrameInPlace(job.capture, sequence, f));
      if (first) job.bounds = {positions[0], positions[0]};
      first = false;
      sides_m.push_back(longestSide(positions));
      job.bounds.grow(positions);
    }
  }
  return settleLengths(job, std::move(sides_m));
}

Status planMesh(Job& job) {
  const MeshTopology& topology = job.capture.topology;
  FOURDVT_TRY(checkLayeredMesh(meshFile(job.capture.sequences[0], 0), topology.vertex_count, topology.faceCount()));
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrameInPlace(job.capture, job.capture.sequences[0], 0));
  FOURDVT_ASSIGN(job.mesh, package::encodeBaseMesh(job.capture.topology, positions));
  return {};
}

constexpr uint64_t kPlayersTexels = kPlayersTextureSide * render::CharacterModel::kTableWidth;

Status refuseMesh(const std::string& file, uint64_t vertices, uint64_t faces, const std::string& remedy) {
  return Error{ErrorId::InvalidArgument, file + ": " + std::to_string(faces) + " faces and " +
                                             std::to_string(vertices) +
                                             " vertices are more than players hold in textures of " +
                                             std::to_string(kPlayersTextureSide) + " texels; " + remedy};
}

}  // namespace

Result<Job> validate(const BakeOptions& options, const BakeEnvironment& environment) {
  if (const std::string wrong = options.check(); !wrong.empty()) return bad(wrong);
  Job job;
  job.options = options;
  if (job.options.jobs == 0) job.options.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  FOURDVT_TRY(checkOutput(job.options));
  FOURDVT_TRY(encode::checkEncoder(job.options.codec, job.options.preset));
  FOURDVT_TRY(openCapture(job, environment));
  FOURDVT_TRY(resolveRenditions(job.options));
  FOURDVT_TRY(checkClasses(job));
  FOURDVT_TRY(keepCameras(job, environment));
  FOURDVT_TRY(checkNames(job));
  FOURDVT_TRY(checkRenditionNames(job));
  if (!job.fromCameras()) FOURDVT_TRY(checkClassPictures(job));
  job.options.sequences.clear();
  for (const capture::CaptureCamera& camera : job.capture.cameras) job.cameras.push_back(camera.pinhole);
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    job.options.sequences.push_back(sequence.name);
    job.total_frames += sequence.frame_count;
  }
  job.layout = encode::makeTileLayout(options.layers, options.texture, options.equal_layers);
  job.encode = {job.layout.width, job.layout.height, job.capture.fps, options.crf, options.codec, options.preset};
  FOURDVT_TRY(checkWorkFolder(job.workFolder()));
  FOURDVT_TRY(checkReportFolder(reportFolderOf(job.options.character_folder)));
  FOURDVT_TRY(platform::makeFolder(job.workFolder()));
  if (access(job.workFolder().c_str(), W_OK) != 0)
    return Error{ErrorId::WriteFailed, job.workFolder() + ": not writable; choose another output folder"};
  FOURDVT_TRY(planSurface(job, environment));
  FOURDVT_TRY(checkRoom(job));
  FOURDVT_TRY(checkSounds(job, environment));
  if (!job.fromCameras()) FOURDVT_TRY(checkSpace(job, layeredBytes(job)));
  return job;
}

Status planSurface(Job& job, const BakeEnvironment& environment) {
  if (job.fromCameras()) return planCameraSurfaces(job, environment);
  FOURDVT_TRY(planMesh(job));
  return findBounds(job, environment);
}

Status checkSpace(const Job& job, double character_bytes) {
  constexpr double kCopies = 2;  // work folder and result
  const double needed = kCopies * character_bytes + (8 << 20);
  std::error_code error;
  const fs::space_info space = fs::space(job.workFolder(), error);
  if (error || double(space.available) >= needed) return {};
  const std::string text =
      printed(": %.0f MB free, about %.0f MB needed; free disk space or choose another output folder",
              space.available / 1e6, needed / 1e6);
  return Error{ErrorId::WriteFailed, job.options.character_folder + text};
}

Status settleLengths(Job& job, std::vector<double> longest_sides_m) {
  BakeOptions& o = job.options;
  if (job.length_scale == 0) {
    const double scale = job.length_scale = lengthScale(std::move(longest_sides_m));
    const auto settle = [&](std::optional<double>& length, double person_m) {
      length = length.value_or(scale * person_m);
    };
    settle(o.position_step_m, job.fromCameras() ? kCamerasStep_m : kLayersStep_m);
    settle(o.coarse_step_m, kCoarseStep_m);
    settle(o.classes.blend_error_m, kBlendError_m);
    settle(o.classes.alignment_step_m, kAlignmentStep_m);
    o.resample.contour_step_m *= float(scale);
  }
  const glm::vec3 cells = (job.bounds.max - job.bounds.min) / float(gridStep_m(o));
  if (std::max({cells.x, cells.y, cells.z}) > float(1 << 24))
    return Error{ErrorId::InvalidArgument, job.capture.folder +
                                               ": the mesh spans more than 2^24 position steps; wrong units "
                                               "in capture.json, or the position step is too small"};
  return {};
}

Status checkLayeredMesh(const std::string& file, uint64_t vertices, uint64_t faces) {
  if (render::layeredTableTexels(vertices, faces) <= kPlayersTexels) return {};
  return refuseMesh(
      file, vertices, faces,
      "simplify the mesh to at most " + std::to_string(kPlayersTexels / 6) + " faces, the same way in all frames");
}

Status checkSurface(const std::string& file, uint64_t vertices, uint64_t faces) {
  if (render::surfaceTableTexels(vertices, faces) <= kPlayersTexels) return {};
  return refuseMesh(file, vertices, faces,
                    "simplify the mesh, or, if the topology is per-frame, bake with --faces 150000 or fewer");
}

std::string meshFile(const capture::CaptureSequence& sequence, uint32_t frame) {
  return sequence.packed_positions.empty() ? capture::meshPath(sequence, frame) : sequence.packed_positions;
}

}  // namespace fourdvt::bake
