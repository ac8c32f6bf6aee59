// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/studio.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lab/studio/room.h"
#include "lab/studio/sensor.h"
#include "lab/studio/truth.h"
#include "lab/studio/video.h"
#include "platform/files.h"
#include "platform/folders.h"

namespace fourdvt::studio {
namespace {

using Json = nlohmann::ordered_json;

bool isFolderName(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find_first_of("/\\") == std::string::npos;
}

std::string wrongClass(const StudioClass& c) {
  if (!isFolderName(c.name) || c.parameter.empty() || c.members.size() < 2 || c.members.size() > 4)
    return "a class needs a name, a parameter and two to four members, like locomotion=speed_mps:walk,run";
  for (const std::string& member : c.members)
    if (std::count(c.members.begin(), c.members.end(), member) > 1)
      return "class \"" + c.name + "\" lists \"" + member + "\" twice";
  return {};
}

Json knobsJson(const StudioKnobs& k) {
  return {{"seed", k.seed},
          {"drift_mm", k.drift_mm},
          {"wrinkles", k.wrinkles},
          {"specular", k.specular},
          {"shading", k.shading},
          {"rotation_deg", k.rotation_deg},
          {"translation_mm", k.translation_mm},
          {"focal_percent", k.focal_percent},
          {"proxy_mm", k.proxy_mm},
          {"mesh_cell_mm", k.mesh_cell_mm},
          {"gain_percent", k.gain_percent},
          {"noise_levels", k.noise_levels},
          {"erosion_pixels", k.erosion_pixels}};
}

// Metres, rounded.
Json millimetres(const glm::dvec3& v) {
  Json out;
  for (int i = 0; i < 3; ++i) out.push_back(std::round(1e3 * v[i]) / 1e3 + 0.0);  // no negative zero
  return out;
}

class Run {
 public:
  Run(const StudioOptions& options, StudioSet& set, const OutputFolder& out, Ticker& ticker)
      : options_(options), set_(set), out_(out), ticker_(ticker) {}

  Status write() {
    FOURDVT_TRY(calibration());
    FOURDVT_TRY(plates());
    for (size_t m = 0; m < set_.actor().motions().size(); ++m) FOURDVT_TRY(sequence(m));
    FOURDVT_TRY(writeTruth(set_, options_, out_, ticker_));
    return platform::writeFileAtomic(out_.path() + "/capture.json", captureJson().dump(1) + "\n");
  }
  uint32_t frames() const { return frames_; }

 private:
  Status calibration() {
    FOURDVT_TRY(writeColmap(out_.path() + "/cameras", miscalibrated(set_.rig().ring, options_.knobs)));
    FOURDVT_TRY(writeColmap(out_.path() + "/cameras_true", set_.rig().ring));
    return writeColmap(out_.path() + "/cameras_test", set_.rig().test);
  }

  Status plates() {
    FOURDVT_TRY(out_.makeFolder("background"));
    if (options_.room) return roomPlates();
    for (size_t c = 0; c < set_.rig().ring.size(); ++c) {
      sensors_.emplace_back(options_.knobs, int(c), options_.width, options_.height);
      FOURDVT_TRY(platform::writeImage(out_.path() + "/background/" + set_.rig().ring[c].name + ".png",
                                       sensors_.back().plate()));
    }
    return {};
  }

  // background/camNN.png, or background/camNN/000000.png … of several.
  Status roomPlates() {
    room_ = std::make_unique<Room>(options_.knobs.seed, set_.rig(), set_.groundY_m(), set_.actor());
    for (size_t c = 0; c < set_.rig().ring.size(); ++c) {
      sensors_.emplace_back(options_.knobs, int(c), room_->empty(c));
      const std::string stem = out_.path() + "/background/" + set_.rig().ring[c].name;
      const bool several = options_.plates > 1;
      if (several) FOURDVT_TRY(platform::makeFolder(stem));
      for (uint32_t take = 0; take < uint32_t(options_.plates); ++take)
        FOURDVT_TRY(platform::writeImage(several ? stem + numberedName("/%06u.png", take) : stem + ".png",
                                         sensors_.back().recordedPlate(take)));
    }
    return {};
  }

  Status openFiles(const std::string& name) {
    const std::string folder = out_.path() + "/" + name;
    const std::string matte_folder = options_.room ? out_.path() + "/mattes_true/" + name : folder;
    if (options_.room) FOURDVT_TRY(out_.makeFolder("mattes_true/" + name));
    colour_.clear();
    mattes_.clear();
    for (const PinholeCamera& camera : set_.rig().ring)
      for (const int channels : {3, 1}) {
        const std::string stem = channels == 3 ? camera.name : "mask" + camera.name.substr(3);
        const std::string& in = channels == 3 ? folder : matte_folder;
        FOURDVT_ASSIGN(auto file, PictureFile::create(in + "/" + stem, {options_.width, options_.height, channels,
                                                                        options_.fps, options_.images}));
        (channels == 3 ? colour_ : mattes_).push_back(std::move(file));
      }
    return {};
  }

  Status sequence(size_t index) {
    const Motion& motion = set_.actor().motions()[index];
    ticker_.begin(motion.name);
    const uint32_t count = frameCount(motion, options_.fps);
    const std::string folder = out_.path() + "/" + motion.name;
    FOURDVT_TRY(out_.makeFolder(motion.name + "/mesh"));
    for (const PinholeCamera& camera : set_.rig().test) FOURDVT_TRY(out_.makeFolder(motion.name + "/" + camera.name));
    FOURDVT_TRY(openFiles(motion.name));
    std::vector<double> shares(set_.actor().motions().size(), 0);
    shares[index] = 1;
    std::vector<uint8_t> packed;
    for (uint32_t frame = 0; frame < count; ++frame) {
      set_.pose(shares, framePhase(motion, frame, count));
      const Positions mesh = set_.captured();
      appendPacked(mesh, set_.unitsPerMetre(), packed);
      if (frames_ == 0)
        FOURDVT_TRY(platform::writeFileAtomic(out_.path() + "/mesh_topology.obj",
                                              objText(set_.actor().tracked().topology, mesh)));
      FOURDVT_TRY(photograph());
      if (frame % options_.test_every == 0) FOURDVT_TRY(holdOut(folder, frame));
      ++frames_;
    }
    for (auto* files : {&colour_, &mattes_})
      for (const auto& file : *files) FOURDVT_TRY(file->finish());
    return platform::writeFileAtomic(folder + "/mesh/positions.i16", packed);
  }

  Status photograph() {
    if (room_) room_->setShadow(set_.surfacePose());
    for (size_t c = 0; c < sensors_.size(); ++c) {
      FOURDVT_ASSIGN(auto picture, set_.draw(set_.rig().ring[c]));
      const Image backdrop = room_ ? room_->withShadow(c) : Image();
      FOURDVT_TRY(colour_[c]->write(sensors_[c].expose(picture, frames_, room_ ? &backdrop : nullptr)));
      FOURDVT_TRY(mattes_[c]->write(sensors_[c].matte(picture)));
      FOURDVT_TRY(ticker_.tick());
    }
    return {};
  }

  Status holdOut(const std::string& folder, uint32_t frame) {
    for (const PinholeCamera& camera : set_.rig().test) {
      FOURDVT_ASSIGN(auto picture, set_.draw(camera));
      FOURDVT_TRY(platform::writeImage(folder + "/" + camera.name + numberedName("/%04u.png", frame),
                                       unpremultiplied(picture)));
      FOURDVT_TRY(ticker_.tick());
    }
    return {};
  }

  Json sequenceJson(const Motion& motion) const {
    const uint32_t count = frameCount(motion, options_.fps);
    const glm::dvec3 v = motion.root_velocity_mps;
    Json node = {{"name", motion.name}, {"frames", count}, {"loop", motion.loop}};
    node["duration_s"] = motion.duration_s;
    node["root_velocity"] = {v.x, v.y, v.z};
    node["video"] = motion.name + "/camNN" + (options_.images ? "/%06d.png" : ".mp4");
    node[options_.room ? "mask_without_error" : "mask"] =
        (options_.room ? "mattes_true/" : "") + motion.name + "/maskNN" + (options_.images ? "/%06d.png" : ".mkv");
    node["mesh"] = {{"topology", "mesh_topology.obj"},
                    {"positions", motion.name + "/mesh/positions.i16"},
                    {"units_per_metre", set_.unitsPerMetre()}};
    for (uint32_t frame = 0; frame < count; frame += options_.test_every) node["test_frames"].push_back(frame);
    node["test_images"] = motion.name + "/testNN/%04d.png";
    return node;
  }

  Json captureJson() const {
    Json root = {{"name", std::filesystem::path(options_.folder).lexically_normal().filename().string()},
                 {"kind", "virtual studio (rendered, not filmed)"},
                 {"fps", options_.fps},
                 {"units", "metre"},
                 {"up_axis", "Y"},
                 {"handedness", "right"},
                 {"facing", "+Z"},
                 {"image_size", {options_.width, options_.height}},
                 {"ground_y", std::round(1e3 * set_.bounds().min.y) / 1e3}};
    for (const Motion& motion : set_.actor().motions()) root["sequences"].push_back(sequenceJson(motion));
    for (const PinholeCamera& camera : set_.rig().ring) root["cameras"].push_back(camera.name);
    for (const PinholeCamera& camera : set_.rig().test) root["test_cameras"].push_back(camera.name);
    root["calibration"] = {{"format", "COLMAP text, PINHOLE"},
                           {"ring", "cameras/"},
                           {"ring_without_error", "cameras_true/"},
                           {"held_out", "cameras_test/"}};
    root["background"] = options_.plates > 1 ? "background/camNN/%06d.png" : "background/camNN.png";
    for (const StudioClass& c : set_.classes())
      root["classes"].push_back({{"name", c.name}, {"parameter", c.parameter}, {"members", c.members}});
    root["studio"] = {{"actor", std::filesystem::path(options_.actor).filename().string()},
                      {"knobs", knobsJson(options_.knobs)},
                      {"samples_a_pixel", 4}};
    if (room_) {
      const BoundingBox box = room_->box();
      root["room"] = {{"min", millimetres(box.min)}, {"max", millimetres(box.max)}};
      root["studio"]["room"] = {{"plates", options_.plates}};
    }
    if (options_.truth_at.empty()) return root;
    for (const StudioClass& c : set_.classes()) root["studio"]["truth"].push_back("truth/" + c.name + "/truth.json");
    return root;
  }

  const StudioOptions& options_;
  StudioSet& set_;
  const OutputFolder& out_;
  Ticker& ticker_;
  std::unique_ptr<Room> room_;  // null: the green studio
  std::vector<Sensor> sensors_;
  std::vector<std::unique_ptr<PictureFile>> colour_, mattes_;  // open files of the sequence that is being written
  uint32_t frames_ = 0;
};

uint32_t sequencePictures(const StudioSet& set, const StudioOptions& options) {
  uint32_t pictures = 0;
  for (const Motion& motion : set.actor().motions()) {
    const uint32_t frames = frameCount(motion, options.fps);
    pictures += frames * uint32_t(set.rig().ring.size());
    pictures += (frames - 1) / options.test_every * uint32_t(set.rig().test.size()) + uint32_t(set.rig().test.size());
  }
  return pictures;
}

}  // namespace

std::string StudioOptions::check() const {
  if (folder.empty()) return "a folder to write is needed";
  if (cameras < 2 || cameras > 99) return "cameras must be 2 to 99";
  if (width < 16 || height < 16 || width > 4096 || height > 4096 || width % 2 || height % 2)
    return "pictures need even sides from 16 to 4096";
  if (!(fps >= 1 && fps <= 1000)) return "fps must be 1 to 1000";
  if (test_every < 1 || truth_phases < 1 || truth_ring < 0) return "counts must not be negative";
  if (plates < 1 || plates > 99) return "plates must be 1 to 99";
  if (plates > 1 && !room) return "only the room has several plates; choose --room as well";
  if (room && knobs.erosion_pixels > 0) return "a capture in the room has no mattes that could be too small";
  if (!(knobs.mesh_cell_mm >= 8 && knobs.mesh_cell_mm <= 45)) return "the mesh's cell must be 8 to 45 mm";
  if (actor != "procedural" && knobs.mesh_cell_mm != StudioKnobs().mesh_cell_mm)
    return "only the procedural actor can be meshed anew; a model keeps its own faces";
  for (const double t : truth_at)
    if (!(t >= 0 && t <= 1)) return "the truth's positions must be 0 (first member) to 1 (last member)";
  for (const StudioClass& c : classes)
    if (const std::string wrong = wrongClass(c); !wrong.empty()) return wrong;
  for (size_t i = 0; i < sequences.size(); ++i)
    if (!isFolderName(sequences[i]) || std::count(sequences.begin(), sequences.end(), sequences[i]) > 1)
      return "sequences must be different plain names, not \"" + sequences[i] + "\"";
  return {};
}

Result<StudioReport> runStudio(const StudioOptions& options, const StudioEnvironment& environment) {
  if (const std::string wrong = options.check(); !wrong.empty()) return Error{ErrorId::InvalidArgument, wrong};
  FOURDVT_ASSIGN(auto out, OutputFolder::open(options.folder));
  FOURDVT_ASSIGN(auto set, StudioSet::open(options, *environment.device));
  Ticker ticker(environment, sequencePictures(*set, options) + truthPictures(*set, options));
  Run run(options, *set, out, ticker);
  FOURDVT_TRY(run.write());
  FOURDVT_TRY(out.keep());
  const MeshTopology& mesh = set->actor().tracked().topology;
  return StudioReport{mesh.vertex_count, mesh.faceCount(), run.frames(), ticker.done()};
}

}  // namespace fourdvt::studio
