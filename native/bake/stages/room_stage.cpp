// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/room_stage.h"

#include <cmath>
#include <cstdio>

#include "bake/room/room.h"
#include "base/bytes.h"
#include "base/hash.h"
#include "capture/plates.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

constexpr const char* kFile = "room.jpg";
constexpr int kQuality = 85;
constexpr size_t kLargestBytes = 300'000;  // a larger file is made again with fewer texels
constexpr int kTries = 4;
constexpr float kSunk_m = 0.05f;  // feet of tracked meshes sink into the floor; a floor this near to the ground is it

Result<std::vector<RoomPlate>> readPlates(const Job& job, const std::vector<ColourMap>& colour_maps) {
  std::vector<RoomPlate> plates;
  for (const capture::CaptureCamera& camera : job.capture.cameras) {
    RoomPlate plate{camera.pinhole, {}};
    FOURDVT_ASSIGN(plate.picture, capture::readRoomPlate(job.capture, camera));
    if (!colour_maps.empty()) {
      const ColourMap& map = colour_maps[plates.size()];
      plate.colour_matrix = map.matrix;
      plate.colour_offset = map.offset;
    }
    plates.push_back(std::move(plate));
  }
  return plates;
}

// Shadows fall on the ground, and must not lie under the floor.
BoundingBox roomOf(const Job& job) {
  BoundingBox box = *job.capture.room;
  const auto ground = static_cast<float>(job.capture.ground_y_m);
  if (std::abs(box.min.y - ground) <= kSunk_m && ground < box.max.y) box.min.y = ground;
  return box;
}

constexpr const char* kResult = "room";

std::vector<uint8_t> roomBytes(const BakedRoom& room) {
  ByteWriter out;
  for (const glm::vec3& corner : {room.room.box.min, room.room.box.max})
    for (int axis = 0; axis < 3; ++axis) out.f32(corner[axis]);
  for (const int side : {room.room.width, room.room.height}) out.u32(uint32_t(side));
  for (const package::Rect& r : room.room.faces)
    for (const int number : {r.x, r.y, r.width, r.height}) out.u32(uint32_t(number));
  out.bytes(room.picture);
  return out.take();
}

void nameFile(BakedRoom& room) {
  room.room.picture_uri = kFile;
  room.room.picture_bytes = room.picture.size();
  room.room.picture_hash = fnv1a(room.picture);
}

// False if there are too few bytes.
bool roomFrom(std::span<const uint8_t> bytes, BakedRoom& room) {
  ByteReader in(bytes);
  for (glm::vec3* corner : {&room.room.box.min, &room.room.box.max})
    for (int axis = 0; axis < 3; ++axis) (*corner)[axis] = in.f32();
  for (int* side : {&room.room.width, &room.room.height}) *side = int(in.u32());
  for (package::Rect& r : room.room.faces)
    for (int* number : {&r.x, &r.y, &r.width, &r.height}) *number = int(in.u32());
  const auto picture = in.bytes(in.remaining());
  room.picture.assign(picture.begin(), picture.end());
  nameFile(room);
  return in.ok() && !room.picture.empty();
}

}  // namespace

Status checkRoom(const Job& job) {
  if (!job.capture.room) return {};
  const BoundingBox room = roomOf(job), &performer = job.bounds;
  const glm::vec3 lowest = room.min - glm::vec3(0, kSunk_m, 0);
  if (!glm::all(glm::lessThanEqual(lowest, performer.min)) || !glm::all(glm::lessThanEqual(performer.max, room.max))) {
    char text[400];
    std::snprintf(text, sizeof text,
                  ": \"room\" does not contain the performer: it is x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m, "
                  "the meshes are x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m; give it in the world and unit of "
                  "the cameras, or take it out",
                  room.min.x, room.max.x, room.min.y, room.max.y, room.min.z, room.max.z, performer.min.x,
                  performer.max.x, performer.min.y, performer.max.y, performer.min.z, performer.max.z);
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
  BakedRoom out;
  if (const auto kept = run.work.loadResult(kResult); kept && roomFrom(kept.value(), out)) return std::optional(out);
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
  FOURDVT_TRY(run.work.saveResult(kResult, roomBytes(out)));
  progress.done(1, "room");
  return std::optional(std::move(out));
}

}  // namespace fourdvt::bake
