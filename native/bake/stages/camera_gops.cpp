// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/camera_gops.h"

#include <algorithm>
#include <atomic>

#include "bake/run/renditions.h"
#include "bake/stages/camera_plan.h"
#include "bake/stages/mesh_limit.h"
#include "bake/texels/picture_crop.h"
#include "encode/surfaces.h"
#include "package/barcode.h"
#include "platform/files.h"

namespace fourdvt::bake {

struct CameraGops::OpenGop {
  uint32_t number = 0;
  encode::I420Picture picture;
  std::unique_ptr<LadderEncoder> encoder;  // made with the first frame
  std::vector<package::QuantisedSurface> surfaces;
  GopArtefact artefact;
  std::future<Status> encoding;  // of the frame before; the last field: it ends before the others are destroyed
};

Status CameraGops::run() {
  started_s_ = run_.progress.seconds();
  for (const StreamPlan& plan : job_.streams) FOURDVT_TRY(bakeStream(plan));
  return {};
}

bool CameraGops::isFinished(const StreamPlan& plan, uint32_t gop) const {
  return run_.work.has(gopFile(plan.name, gop)) && run_.work.has(chunkFile(plan.name, gop));
}

Status CameraGops::runOne(const StreamPlan& plan, uint32_t gop) {
  if (isFinished(plan, gop)) return {};
  FOURDVT_ASSIGN(const auto reader,
                 capture::FrameReader::open(job_.capture, *plan.motion.members[0].source, run_.environment.open_video,
                                            plan.gop_first_frames[gop]));
  FOURDVT_ASSIGN(const auto open, drawGop(plan, gop, *reader));
  return saveGop(*open, plan, gop);
}

Status CameraGops::bakeStream(const StreamPlan& plan) {
  std::unique_ptr<capture::FrameReader> reader;
  for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
    const uint32_t first = plan.gop_first_frames[g];
    if (isFinished(plan, g)) {
      run_.progress.frames_done += plan.gopEnd(g) - first;
      run_.progress.skip((plan.gopEnd(g) - first) * encodeWork(job_.options));
      continue;
    }
    if (!reader) {
      FOURDVT_ASSIGN(reader, capture::FrameReader::open(job_.capture, *plan.motion.members[0].source,
                                                        run_.environment.open_video, first));
    } else {
      reader->skipTo(first);
    }
    FOURDVT_ASSIGN(const auto open, drawGop(plan, g, *reader));
    FOURDVT_TRY(saveGop(*open, plan, g));
    FOURDVT_TRY(run_.checkStop());
  }
  return {};
}

Result<std::unique_ptr<CameraGops::OpenGop>> CameraGops::drawGop(const StreamPlan& plan, uint32_t gop,
                                                                 capture::FrameReader& reader) {
  auto open = std::make_unique<OpenGop>();
  open->number = gop;
  const auto read = [&] {
    StageClock::Span span(run_.clock, Stage::Decode);
    return reader.next();
  };
  const uint32_t first = plan.gop_first_frames[gop], end = plan.gopEnd(gop);
  std::future<Result<capture::CaptureFrame>> next = std::async(lane(), read);  // futures join on every way out
  for (uint32_t f = first; f < end; ++f) {
    FOURDVT_ASSIGN(const auto frame, next.get());
    if (f + 1 < end) next = std::async(lane(), read);
    FOURDVT_TRY(drawFrame(*open, plan, frame));
    tellFrame(plan, f + 1);
    if (f + 1 < end) FOURDVT_TRY(run_.checkStop());
  }
  FOURDVT_TRY(open->encoding.get());
  return open;
}

Status CameraGops::drawFrame(OpenGop& open, const StreamPlan& plan, const capture::CaptureFrame& frame) {
  const auto& tiles = plan.cameras.gops[open.number];
  std::vector<Image> drawn(tiles.size());
  std::atomic<size_t> next = 0;
  const auto drawSome = [&] {
    for (size_t c = next++; c < tiles.size(); c = next++)
      if (!tiles[c].empty())
        drawn[c] = drawCameraTile(tiles[c], frame.pictures[c], maps_.empty() ? nullptr : &maps_[c]);
  };
  {
    StageClock::Span span(run_.clock, Stage::Fill);
    std::vector<std::future<void>> others;
    for (int job = 1; job < job_.options.jobs; ++job) others.push_back(std::async(std::launch::async, drawSome));
    drawSome();
  }
  encode::I420Picture picture(plan.layout().width, plan.layout().height);
  {
    StageClock::Span span(run_.clock, Stage::Tile);
    for (size_t c = 0; c < tiles.size(); ++c)
      if (!tiles[c].empty()) encode::drawLayer(drawn[c], encode::cellsOf(tiles[c].tile), picture);
    package::drawBarcode(plan.layout().barcode, frame.index, picture.y.data(), picture.width);
  }
  const bool constant = job_.capture.meshes == capture::CaptureMeshes::ConstantTopology;
  const TriangleMesh surface = streamedSurface(job_, frame);
  const size_t used = std::min(surface.positions.size(), 3 * surface.faces.size());
  FOURDVT_TRY(checkSurface(meshFile(*plan.motion.members[0].source, frame.index), used, surface.faces.size()));
  open.surfaces.push_back(
      encode::quantisedSurface({glm::dvec3(job_.bounds.min), double(float(*job_.options.position_step_m))},
                               surface.positions, surface.faces, !constant));
  if (open.encoding.valid()) FOURDVT_TRY(open.encoding.get());
  open.encoding = std::async(lane(), [this, &open, &plan, index = frame.index, picture = std::move(picture),
                                      drawn = std::move(drawn)] { return encode(open, plan, index, picture, drawn); });
  return {};
}

Status CameraGops::encode(OpenGop& open, const StreamPlan& plan, uint32_t index, const encode::I420Picture& picture,
                          const std::vector<Image>& drawn) {
  StageClock::Span span(run_.clock, Stage::Encode);
  if (!open.encoder) {
    FOURDVT_ASSIGN(open.encoder, LadderEncoder::create(plan, open.number, lane()));
    if (index == 0) {
      FOURDVT_ASSIGN(open.artefact.picture_jpeg,
                     platform::encodeImage(encode::rgbFromTile(picture.view(), {0, 0, picture.width, picture.height}),
                                           ".jpg", 80));
    }
  }
  std::vector<const Image*> parts;
  for (size_t c = 0; c < drawn.size(); ++c)
    if (!plan.cameras.gops[open.number][c].empty()) parts.push_back(&drawn[c]);
  return open.encoder->push(picture.view(), parts, index);
}

Status CameraGops::saveGop(OpenGop& open, const StreamPlan& plan, uint32_t gop) {
  {
    StageClock::Span span(run_.clock, Stage::Encode);
    FOURDVT_ASSIGN(open.artefact.videos, open.encoder->finish());
    open.encoder.reset();
  }
  StageClock::Span span(run_.clock, Stage::Geometry);
  auto chunk = package::encodeSurfaceChunk(plan.cameras.gops[gop], open.surfaces);
  if (!chunk)
    return Error{chunk.error().id, plan.name + ", frames " + std::to_string(plan.gop_first_frames[gop]) + " to " +
                                       std::to_string(plan.gopEnd(gop) - 1) + ": " + chunk.error().message};
  open.artefact.frames.vertex_count = chunk.value().vertex_count;
  open.artefact.frames.face_count = chunk.value().face_count;
  FOURDVT_TRY(run_.work.save(chunkFile(plan.name, gop), chunk.value().bytes));
  return run_.work.save(gopFile(plan.name, gop), open.artefact);
}

void CameraGops::tellFrame(const StreamPlan& plan, uint32_t frame) {
  ++run_.progress.frames_done;
  ++baked_;
  run_.progress.worked(encodeWork(job_.options));
  const double elapsed = run_.progress.seconds() - started_s_;
  run_.progress.tell(plan.name + " " + std::to_string(frame) + "/" + std::to_string(plan.frameCount()),
                     elapsed > 0 ? baked_ / elapsed : 0);
}

}  // namespace fourdvt::bake
