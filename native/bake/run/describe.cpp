// SPDX-License-Identifier: Apache-2.0
#include "bake/run/describe.h"

#include "base/hash.h"

namespace fourdvt::bake {

package::Character describeCharacter(const Job& job) {
  package::Character character;
  character.name = job.capture.name;
  if (job.fromCameras()) {
    character.appearance = package::AppearanceKind::Cameras;
    character.version = package::kCameraFormatVersion;
  } else {
    character.layer_count = job.options.layers;
    character.vertex_count = job.mesh.decoded.topology.vertex_count;
    character.face_count = job.mesh.decoded.topology.faceCount();
  }
  character.cameras = job.cameras;
  character.bounds = job.bounds;
  character.ground_y_m = job.capture.ground_y_m;
  character.length_scale = job.length_scale;
  character.mesh_uri = kMeshFile;
  character.mesh_bytes = job.mesh.bytes.size();
  character.mesh_hash = fnv1a(job.mesh.bytes);
  character.poster_uri = kPosterFile;
  return character;
}

package::Sequence describeStream(const StreamPlan& plan) {
  package::Sequence s;
  s.name = plan.name;
  s.frame_count = plan.frameCount();
  s.fps = plan.motion.fps;
  s.loop = plan.motion.loop;
  for (const ClassMember& member : plan.motion.members)
    s.root_velocity_mps += member.source->root_velocity_mps / double(plan.motion.members.size());
  s.stream_uri = plan.name + ".bin";
  s.members = plan.motion.manifest;
  s.space = plan.motion.space;
  s.detail_correlation = plan.detail_correlation;
  s.reference_count = static_cast<uint32_t>(plan.motion.reference_weights.size());
  s.layout_width = plan.cameras.width;
  s.layout_height = plan.cameras.height;
  for (const RenditionPlan& planned : plan.renditions) {
    package::Rendition& rendition = s.renditions.emplace_back();
    rendition.video_uri = plan.name + planned.suffix + ".mp4";
    rendition.width = planned.layout.width;
    rendition.height = planned.layout.height;
    rendition.layers = planned.layout.layers;
    rendition.barcode = planned.layout.barcode;
    rendition.tiles = planned.tiles;
  }
  return s;
}

}  // namespace fourdvt::bake
