// SPDX-License-Identifier: Apache-2.0
#include "package/live_manifest.h"

#include "package/field_reader.h"

namespace fourdvt::package {
namespace {

Error invalidLive(const std::string& problem) {
  return {ErrorId::ManifestInvalid, "live stream: " + problem + "; update its server, or connect to another"};
}

void readStream(FieldReader& in, const std::string& at, LiveCharacter& live) {
  live.session = in.hash(at, "/session");
  Sequence& s = live.character.sequences.emplace_back();
  s.name = "live";
  s.frame_count = 1;
  s.fps = in.number(at, "/fps", 0.1, 1000);
  readLayout(in, at, s);
  readPicture(in, at, 0, s.renditions.emplace_back());
  s.renditions[0].video_uri = "live stream";  // name in messages
  StreamIndex& index = live.index;
  index.frame_count = 1;
  index.vertex_count = live.character.vertex_count;
  index.face_count = live.character.face_count;
  index.chunks = {{0, 1, 0, 0}};
  index.position_origin = glm::vec3(in.vec3(at, "/origin"));
  index.position_step_m = float(in.number(at, "/step", 1e-6, 1));
}

}  // namespace

Result<LiveCharacter> readLiveManifest(const FlatJson& manifest) {
  const std::string at = std::string("/extensions/") + kExtensionName;
  if (manifest.string("/asset/version").value_or("") != "2.0" || !manifest.has(at + "/live"))
    return invalidLive("its first message is no manifest of one");
  FieldReader in(manifest);
  LiveCharacter live;
  live.character.version = int(in.integer(at, "/version", kLiveFormatVersion, 1 << 20));
  if (in.ok() && live.character.version > kLiveFormatVersion)
    return Error{ErrorId::Unsupported, "live stream: version " + std::to_string(live.character.version) +
                                           " is newer than this player; update the player"};
  live.character.appearance = AppearanceKind::Cameras;
  readBody(in, at, live.character);
  readStream(in, at + "/live", live);
  if (!in.ok()) return invalidLive(in.problem());
  return live;
}

}  // namespace fourdvt::package
