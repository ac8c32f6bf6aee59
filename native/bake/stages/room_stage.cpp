// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "bake/room/room.h"
#include "bake/stages/stages.h"
#include "base/hash.h"
#include "base/text.h"
#include "mattes/plate_key.h"
#include "platform/files.h"

namespace fourdvt::store {

void fields(Archive& a, bake::BakedRoom& r) { a(r.room.box, r.room.width, r.room.height, r.room.faces, r.picture); }

}  // namespace fourdvt::store

namespace fourdvt::bake {
namespace {

constexpr const char* kFile = "room.jpg";
constexpr int kQuality = 85;
constexpr size_t kLargestBytes = 300'000;  // a larger file is made again with fewer texels
constexpr int kTries = 4;
constexpr float kSunk_m =
    0.05f;  // feet of tracked meshes sink into the floor; a floor this near to the ground counts as the ground

Result<std::vector<RoomPlate>> readPlates(const Job& job, const std::vector<ColourMap>& colour_maps) {
  std::vector<RoomPlate> plates;
  for (const capture::CaptureCamera& camera : job.capture.cameras) {
    RoomPlate plate{camera.pinhole, {}};
    FOURDVT_ASSIGN(plate.picture, mattes::readRoomPlate(job.capture, camera));
    if (!colour_maps.empty()) {
      const ColourMap& map = colour_maps[plates.size()];
      plate.colour_matrix = map.matrix;
      plate.colour_offset = map.offset;
    }
    plates.push_back(std::move(plate));
  }
  return plates;
}

// Moves the floor to a ground near to it: shadows fall on the ground, and must not lie under the floor.
BoundingBox roomOf(const Job& job) {
  BoundingBox box = *job.capture.room;
  const auto ground = static_cast<float>(job.capture.ground_y_m);
  if (std::abs(box.min.y - ground) <= kSunk_m && ground < box.max.y) box.min.y = ground;
  return box;
}

constexpr const char* kResult = "room.result";

void nameFile(BakedRoom& room) {
  room.room.picture_uri = kFile;
  room.room.picture_bytes = room.picture.size();
  room.room.picture_hash = fnv1a(room.picture);
}

}  // namespace

Status checkRoom(const Job& job) {
  if (!job.capture.room) return {};
  const BoundingBox room = roomOf(job), &performer = job.bounds;
  const glm::vec3 lowest = room.min - glm::vec3(0, kSunk_m, 0);
  if (!glm::all(glm::lessThanEqual(lowest, performer.min)) || !glm::all(glm::lessThanEqual(performer.max, room.max))) {
    const std::string text = printed(
        ": \"room\" does not contain the performer: it is x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m, "
        "the meshes are x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m; give it in the world and unit of "
        "the cameras, or take it out",
        room.min.x, room.max.x, room.min.y, room.max.y, room.min.z, room.max.z, performer.min.x, performer.max.x,
        performer.min.y, performer.max.y, performer.min.z, performer.max.z);
    return Error{ErrorId::CaptureJson, job.capture.folder + "/capture.json" + text};
  }
  FOURDVT_ASSIGN(const auto plates, readPlates(job, {}));
  return {};
}

Result<std::optional<BakedRoom>> makeRoom(BakeRun& run, const std::vector<ColourMap>& colour_maps) {
  const Job& job = run.job;
  if (!job.capture.room) return std::optional<BakedRoom>();
  StageProgress progress(run.progress, infoOf(Stage::Room).work_s);
  StageClock::Span span(run.clock, Stage::Room);
  progress.done(0, "room");
  if (auto kept = run.work.load<BakedRoom>(kResult)) {
    BakedRoom out = kept.take();
    nameFile(out);
    return std::optional(std::move(out));
  }
  BakedRoom out;
  FOURDVT_ASSIGN(const auto plates, readPlates(job, colour_maps));
  RoomOptions options;
  for (int i = 0; i < kTries && (i == 0 || out.picture.size() > kLargestBytes); ++i) {
    FOURDVT_TRY(run.checkStop());
    if (i > 0) options.texels_per_m *= 0.97 * std::sqrt(double(kLargestBytes) / double(out.picture.size()));
    RoomPicture made = makeRoomPicture(roomOf(job), plates, options);
    out.room = made.room;
    FOURDVT_ASSIGN(out.picture, platform::encodeImage(made.picture, ".jpg", kQuality));
  }
  nameFile(out);
  FOURDVT_TRY(run.work.save(kResult, out));
  progress.done(1, "room");
  return std::optional(std::move(out));
}

}  // namespace fourdvt::bake
