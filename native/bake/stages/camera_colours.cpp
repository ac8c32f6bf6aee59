// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bake/run/job.h"
#include "bake/stages/stages.h"
#include "bake/stages/survey.h"
#include "bake/texels/frame_baker.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"

namespace fourdvt::bake {
namespace {

MeshTopology topologyOf(const Job& job, const mattes::CaptureFrame& frame) {
  MeshTopology t;
  t.vertex_count = static_cast<uint32_t>(frame.positions.size());
  t.uvs = {{0, 0}};  // visibility needs none
  t.face_vertices = frame.faces.empty() ? job.capture.topology.face_vertices : frame.faces;
  t.face_uvs.assign(t.face_vertices.size(), glm::uvec3(0));
  return t;
}

Status addFrame(BakeRun& run, const mattes::CaptureFrame& frame, ColourCalibrator& calibrator) {
  const Job& job = run.job;
  const MeshTopology topology = topologyOf(job, frame);
  std::vector<PictureCrop> crops;
  for (size_t c = 0; c < job.cameras.size(); ++c)
    crops.push_back(cropPicture(job.cameras[c], frame.positions, frame.pictures[c]));
  FOURDVT_ASSIGN(const auto baker, FrameBaker::create(run.device(), job.cameras, topology, frame.positions,
                                                      {.length_scale = float(job.length_scale)}));
  baker->setFrame(frame.positions, crops);
  FOURDVT_ASSIGN(const auto fractions, baker->measureVisibility());
  calibrator.add(job.cameras, topology, frame.positions, fractions, frame.pictures);
  return {};
}

Result<std::vector<ColourMap>> measure(BakeRun& run, StageProgress& progress) {
  const Job& job = run.job;
  ColourCalibrator calibrator(job.cameras.size());
  double before = 0;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    FOURDVT_ASSIGN(const auto reader, mattes::FrameReader::open(job.capture, sequence, run.environment.open_video));
    const uint32_t end = std::min(sequence.frame_count, kColourFrames);
    for (uint32_t f = 0; f < end; f += kColourEvery) {
      if (run.stopped()) return Error{ErrorId::Interrupted, "stopped; nothing was written"};
      reader->skipTo(f);
      FOURDVT_ASSIGN(const auto frame, reader->next());
      FOURDVT_TRY(addFrame(run, frame, calibrator));
      progress.done((before + double(f) / end) / job.capture.sequences.size(), "colours " + sequence.name);
    }
    before += 1;
  }
  return calibrator.solve();
}

}  // namespace

Result<std::vector<ColourMap>> calibrateColours(BakeRun& run) {
  const Job& job = run.job;
  std::vector<ColourMap> maps;
  if (!job.options.colour_calibration || job.cameras.size() < 2) return maps;
  StageProgress progress(
      run.progress, infoOf(Stage::Visibility).work_s * job.capture.sequences.size() * kColourFrames / kColourEvery);
  StageClock::Span span(run.clock, Stage::Colours);
  std::string key = "camera colours";
  for (const capture::CaptureSequence& sequence : job.capture.sequences) key += captureKey(job, sequence);
  const std::string path = store::keyedPath(job.surveyFolder(), "camera_colours", key);
  if (auto kept = store::load<std::vector<ColourMap>>(path); kept && kept.value().size() == job.cameras.size())
    return kept;
  FOURDVT_ASSIGN(maps, measure(run, progress));
  FOURDVT_TRY(platform::makeFolder(job.surveyFolder()));
  FOURDVT_TRY(store::save(path, maps));
  return maps;
}

}  // namespace fourdvt::bake
