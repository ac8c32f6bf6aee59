// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/truth.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/bytes.h"
#include "base/text.h"
#include "capture/mesh_file.h"
#include "platform/files.h"

namespace fourdvt::studio {
namespace {

using Json = nlohmann::ordered_json;

std::vector<PinholeCamera> truthCameras(const Rig& rig, const StudioOptions& options) {
  std::vector<PinholeCamera> cameras = rig.test;
  const int ring = std::min(options.truth_ring, int(rig.ring.size()));
  for (int i = 0; i < ring; ++i) cameras.push_back(rig.ring[rig.ring.size() * i / ring]);
  return cameras;
}

class ClassTruth {
 public:
  ClassTruth(StudioSet& set, const StudioOptions& options, const StudioClass& motion_class, const OutputFolder& out,
             Ticker& ticker)
      : set_(set),
        options_(options),
        class_(motion_class),
        out_(out),
        ticker_(ticker),
        cameras_(truthCameras(set.rig(), options)),
        folder_("truth/" + motion_class.name) {}

  Status write() {
    ticker_.begin("truth of " + class_.name);
    FOURDVT_TRY(writeColmap(out_.path() + "/" + folder_ + "/cameras", cameras_, options_.scale));
    Json steps = Json::array(), alignment = Json::array();
    for (const double position : options_.truth_at) FOURDVT_TRY(step(position, steps));
    for (size_t m = 1; m < class_.members.size(); ++m) FOURDVT_TRY(align(m, alignment));
    Json root = description();
    root["steps"] = std::move(steps);
    root["alignment"] = std::move(alignment);
    return platform::writeFileAtomic(out_.path() + "/" + folder_ + "/truth.json", root.dump(1) + "\n");
  }

 private:
  // The last phase of a loop lies one step before its first; the last phase of any other motion is its end.
  double phase(int i) const {
    const bool loop = set_.actor().motions()[set_.motionIndex(class_.members[0])].loop;
    return double(i) / (loop ? options_.truth_phases : std::max(1, options_.truth_phases - 1));
  }

  Json description() const {
    Json root;
    root["class"] = class_.name;
    root["parameter"] = class_.parameter;
    root["members"] = class_.members;
    root["camera_folder"] = "cameras";
    for (const PinholeCamera& camera : cameras_) root["cameras"].push_back(camera.name);
    for (int i = 0; i < options_.truth_phases; ++i) root["phases"].push_back(phase(i));
    for (const std::string& name : class_.members) {
      const Motion& motion = set_.actor().motions()[set_.motionIndex(name)];
      const uint32_t frames = frameCount(motion, options_.fps);
      for (int i = 0; i < options_.truth_phases; ++i)
        root["member_frames"][name].push_back(phase(i) * double(motion.loop ? frames : frames - 1));
    }
    root["mesh"] = {{"topology", "../../mesh_topology.obj"},
                    {"units_per_metre", set_.unitsPerMetre() / options_.scale}};
    return root;
  }

  Status step(double position, Json& steps) {
    const std::string name = printed("w%03u", static_cast<uint32_t>(std::lround(100 * position)));
    const std::vector<double> shares = set_.sharesAt(class_, position);
    FOURDVT_TRY(out_.makeFolder(folder_ + "/" + name + "/mesh"));
    for (const PinholeCamera& camera : cameras_) FOURDVT_TRY(out_.makeFolder(folder_ + "/" + name + "/" + camera.name));
    std::vector<uint8_t> packed;
    for (int i = 0; i < options_.truth_phases; ++i) {
      set_.pose(shares, phase(i));
      capture::appendPacked(set_.truth(), set_.unitsPerMetre(), packed);
      FOURDVT_TRY(pictures(out_.path() + "/" + folder_ + "/" + name, printed("/%04u.png", uint32_t(i))));
    }
    const std::string positions = name + "/mesh/positions.i16";
    FOURDVT_TRY(platform::writeFileAtomic(out_.path() + "/" + folder_ + "/" + positions, packed));
    Json entry = {{"folder", name}, {"position", position}};
    double duration_s = 0;
    glm::dvec3 velocity(0);
    for (const std::string& member : class_.members) {
      const size_t index = set_.motionIndex(member);
      entry["weights"].push_back(shares[index]);
      duration_s += shares[index] * set_.actor().motions()[index].duration_s;
      velocity += options_.scale * shares[index] * set_.actor().motions()[index].root_velocity_mps;
    }
    if (class_.parameter == "speed_mps") entry["parameter_value"] = glm::length(velocity);
    entry["duration_s"] = duration_s;
    entry["root_velocity"] = {velocity.x, velocity.y, velocity.z};
    entry["pictures"] = name + "/CAMERA/%04d.png";
    entry["positions"] = positions;
    steps.push_back(std::move(entry));
    return {};
  }

  Status pictures(const std::string& folder, const std::string& file) {
    for (const PinholeCamera& camera : cameras_) {
      FOURDVT_ASSIGN(auto picture, set_.draw(camera));
      unpremultiply(picture);
      FOURDVT_TRY(platform::writeImage(folder + "/" + camera.name + file, picture));
      FOURDVT_TRY(ticker_.tick());
    }
    return {};
  }

  Status align(size_t member, Json& alignment) {
    const std::string& name = class_.members[member];
    const std::string folder = folder_ + "/alignment/" + name;
    FOURDVT_TRY(out_.makeFolder(folder));
    const double place = double(member) / double(class_.members.size() - 1);
    const Surface& mesh = set_.tracker().trackedSurface();
    double largest = 0, sum = 0;
    for (int i = 0; i < options_.truth_phases; ++i) {
      const auto points = set_.tracker().alignment(0, place, phase(i));
      ByteWriter bytes;
      for (size_t v = 0; v < points.size(); ++v) {
        bytes.u32(points[v].face);
        bytes.f32(static_cast<float>(points[v].share.y));
        bytes.f32(static_cast<float>(points[v].share.z));
        const double moved =
            options_.scale * glm::length(mesh.place(points[v], mesh.positions()) - glm::dvec3(mesh.positions()[v]));
        largest = std::max(largest, moved);
        sum += moved;
      }
      FOURDVT_TRY(
          platform::writeFileAtomic(out_.path() + "/" + folder + printed("/%04u.bin", uint32_t(i)), bytes.data()));
    }
    alignment.push_back({{"from", class_.members[0]},
                         {"to", name},
                         {"files", "alignment/" + name + "/%04d.bin"},
                         {"mean_mm", 1e3 * sum / double(mesh.positions().size() * options_.truth_phases)},
                         {"largest_mm", 1e3 * largest}});
    return {};
  }

  StudioSet& set_;
  const StudioOptions& options_;
  const StudioClass& class_;
  const OutputFolder& out_;
  Ticker& ticker_;
  const std::vector<PinholeCamera> cameras_;
  const std::string folder_;  // relative to the output folder
};

}  // namespace

uint32_t truthPictures(const StudioSet& set, const StudioOptions& options) {
  return static_cast<uint32_t>(set.classes().size() * options.truth_at.size() * options.truth_phases *
                               truthCameras(set.rig(), options).size());
}

Status writeTruth(StudioSet& set, const StudioOptions& options, const OutputFolder& out, Ticker& ticker) {
  if (options.truth_at.empty()) return {};
  for (const StudioClass& motion_class : set.classes()) {
    FOURDVT_TRY(out.makeFolder("truth/" + motion_class.name));
    FOURDVT_TRY(ClassTruth(set, options, motion_class, out, ticker).write());
  }
  return {};
}

}  // namespace fourdvt::studio
