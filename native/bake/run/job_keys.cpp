// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bake/run/job.h"
#include "bake/run/renditions.h"
#include "base/hash.h"
#include "base/text.h"
#include "capture/input_files.h"
#include "capture/mesh_sequence.h"
#include "platform/files.h"
#include "refine/refine.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

// Change these whenever results of older builds must not be reused.
constexpr const char* kSurveyVersion = "bake 3";
constexpr const char* kGopVersion = "gops 9";

std::string fingerprint(const fs::path& file) {
  std::error_code ignored;
  return file.string() + " " + std::to_string(fs::file_size(file, ignored)) + " " +
         std::to_string(fs::last_write_time(file, ignored).time_since_epoch().count()) + "\n";
}

// Covers all files below the folder, links included: captures of `fourdvt reconstruct` link to their pictures.
std::string fingerprints(const fs::path& folder) {
  std::vector<std::string> lines;
  std::error_code error, ignored;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (fs::recursive_directory_iterator it(folder, kFollow, error), end; !error && it != end; it.increment(error))
    if (it->is_regular_file(ignored)) lines.push_back(fingerprint(it->path()));
  std::sort(lines.begin(), lines.end());
  std::string all;
  for (const std::string& line : lines) all += line;
  return all;
}

// Meshes may lie outside the sequence's folder.
std::string meshFingerprints(const capture::CaptureSequence& sequence) {
  if (!sequence.packed_positions.empty()) return fingerprint(sequence.packed_positions);
  std::string all;
  for (uint32_t f = 0; f < sequence.frame_count && !sequence.mesh_pattern.empty(); ++f)
    all += fingerprint(capture::meshPath(sequence, f));
  return all;
}

template <class T>
uint64_t hashOf(const std::vector<T>& values, uint64_t hash) {
  return fnv1a({reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)}, hash);
}

uint64_t hashOf(const MeshTopology& t) {
  return hashOf(t.uvs, hashOf(t.face_uvs, hashOf(t.face_vertices, kFnv1aStart)));
}

std::string measuredCaptureKey(const Job& job, const capture::CaptureSequence& sequence) {
  std::string key = filesKey(job.capture, sequence);
  key.append(job.mesh.bytes.begin(), job.mesh.bytes.end());
  if (job.length_scale != 1) key += " lengths " + std::to_string(job.length_scale);
  if (job.refinement) key += " refined " + std::to_string(refine::changeHash(*job.refinement));
  return hexDigits(fnv1a(key));
}

}  // namespace

std::string filesKey(const capture::Capture& capture, const capture::CaptureSequence& sequence) {
  std::string key = kSurveyVersion;
  for (const std::string& part : {capture.cameras_folder, capture.background_folder, sequence.folder})
    key += fingerprints(part);
  for (const capture::CaptureCamera& camera : capture.cameras) key += camera.pinhole.name + "\n";
  key += meshFingerprints(sequence) + std::to_string(hashOf(capture.topology)) + "\n";
  if (auto json = platform::readText(capture.folder + "/capture.json"); json.ok()) key += json.value();
  return key;
}

std::string captureKey(const Job& job, const capture::CaptureSequence& sequence) {
  const auto known = job.capture_keys.find(sequence.name);
  return known != job.capture_keys.end() ? known->second : measuredCaptureKey(job, sequence);
}

void settleKeys(Job& job) {
  job.capture_keys.clear();
  job.input_digests.clear();
  job.mesh_digests.clear();
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    job.capture_keys[sequence.name] = measuredCaptureKey(job, sequence);
    auto& digests = job.input_digests[sequence.name];
    for (uint32_t f = 0; f < sequence.frame_count; f += kInputWindow)
      digests.push_back(
          capture::inputDigest(job.capture, sequence, f, std::min(f + kInputWindow, sequence.frame_count)));
  }
  for (const capture::CaptureSequence& sequence : job.capture.sequences)
    job.mesh_digests[sequence.name] = capture::meshDigest(sequence);
  job.common_input_digest = capture::commonInputDigest(job.capture);
  job.sound_digest = capture::soundDigest(job.capture);
  job.settings_key = settingsKey(job);
}

std::string labelKey(const BakeOptions& o) {
  const LabelOptions chosen;
  std::string all;
  for (const auto* by_rank : {&chosen.theta, &chosen.omega}) {
    for (const float weight : *by_rank) all += std::to_string(weight) + " ";
    all += "| ";
  }
  for (const float weight : {chosen.eta, chosen.tau, chosen.empty_penalty}) all += std::to_string(weight) + " ";
  for (const int number :
       {int(chosen.use_partial), int(chosen.label_unseen), chosen.window_frames, chosen.hop_frames, chosen.sweeps})
    all += std::to_string(number) + " ";
  const std::string hash = hexDigits(fnv1a(all));
  return std::string(" labels ") + o.labels->name + " penalty " + std::to_string(static_cast<int>(o.penalty)) +
         " layers " + std::to_string(o.layers) + " chosen " + hash;
}

std::string settingsKey(const Job& job) {
  const BakeOptions& o = job.options;
  char line[400];
  std::snprintf(line, sizeof line,
                "%s %s classes %d align %d blend %.9g alignment %.9g texture %d equal %d crf %d codec %d preset %.60s "
                "gop %d step %.9g/%.9g gutter %d fps %.9g colours %d "
                "filter %d detail %d contour %.9g/%.9g matte %.9g/%.9g",
                kGopVersion, labelKey(o).c_str(), int(o.classes.bake), int(o.classes.align), *o.classes.blend_error_m,
                *o.classes.alignment_step_m, o.texture, int(o.equal_layers), o.crf, static_cast<int>(o.codec),
                o.preset.c_str(), o.gop, *o.position_step_m, *o.coarse_step_m, o.gutter_texels, job.capture.fps,
                int(o.colour_calibration), static_cast<int>(o.resample.filter), int(o.common_detail),
                o.resample.contour_pixels, o.resample.contour_step_m, o.resample.matte_threshold,
                o.resample.matte_pixels);
  uint64_t hash = kFnv1aStart;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    const std::string key = captureKey(job, sequence);
    // Includes the terminating zero, so that keys do not run together.
    hash = fnv1a(std::string_view(key.c_str(), key.size() + 1), hash);
  }
  std::string text = hexDigits(hash) + line;
  for (const LowerRendition& r : o.lower_renditions) text += fileSuffix(r, o) + "/" + r.preset;
  text += "\n";
  if (!job.fromCameras()) return text;
  // Results of the surfaces: their box is the origin of positions, their regions are the tiles.
  uint64_t surfaces = fnv1a({reinterpret_cast<const uint8_t*>(&job.bounds), sizeof job.bounds});
  for (const auto& sequence : job.regions)
    for (const auto& frame : sequence)
      surfaces = fnv1a({reinterpret_cast<const uint8_t*>(frame.data()), frame.size() * sizeof(frame[0])}, surfaces);
  return text + ("surfaces " + std::to_string(surfaces) + " ") +
         ("cameras scale " + std::to_string(o.cameras.tile_scale)) + " faces " + std::to_string(o.cameras.faces) + "\n";
}

}  // namespace fourdvt::bake
