// SPDX-License-Identifier: Apache-2.0
#include "lab/study/run/scene.h"

#include <algorithm>
#include <filesystem>
#include <future>

#include "bake/stages/stages.h"
#include "base/text.h"
#include "lab/study/run/run_steps.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"

namespace fourdvt::study {

std::string viewSetting(const PinholeCamera& camera, uint32_t frame) {
  return "view=" + camera.name + " frame=" + std::to_string(frame);
}

std::vector<PinholeCamera> captureCameras(const StudyContext& context) {
  std::vector<PinholeCamera> cameras;
  for (const auto& camera : context.capture->cameras) cameras.push_back(camera.pinhole);
  return cameras;
}

std::vector<const capture::CaptureSequence*> studySequences(const StudyContext& context) {
  std::vector<const capture::CaptureSequence*> out;
  for (const capture::CaptureSequence& sequence : context.capture->sequences) {
    const auto& names = context.options.sequences;
    if (names.empty() || std::find(names.begin(), names.end(), sequence.name) != names.end()) out.push_back(&sequence);
  }
  return out;
}

const capture::CaptureSequence& shortestSequence(const StudyContext& context) {
  const auto all = studySequences(context);
  return **std::min_element(all.begin(), all.end(),
                            [](const auto* a, const auto* b) { return a->frame_count < b->frame_count; });
}

Result<std::vector<RingView>> studyRing(const StudyContext& context, const capture::CaptureSequence& sequence) {
  BoundingBox bounds;
  for (uint32_t f = 0; f < sequence.frame_count; ++f) {
    FOURDVT_ASSIGN(auto positions, capture::readMeshFrame(*context.capture, sequence, f));
    if (f == 0) bounds = {positions[0], positions[0]};
    bounds.grow(positions);
  }
  return ringViews(captureCameras(context), bounds, sequence.frame_count,
                   context.options.quick ? 8 : context.options.ring_views);
}

std::string referencePath(const StudyContext& context, const std::string& sequence, const RingView& view) {
  return referencePath(context, sequence, view.camera.name, view.frame);
}

std::string referencePath(const StudyContext& context, const std::string& sequence, const std::string& camera,
                          uint32_t frame) {
  const std::string name = printed("_%04u.png", frame);
  return context.work() + "/reference/" + sequence + "/" + camera + name;
}

std::string seenPath(const StudyContext& context, const std::string& sequence, const std::string& camera,
                     uint32_t frame) {
  return referencePath(context, sequence, camera + "_seen", frame);
}

Result<Image> readReference(const std::string& path) {
  auto picture = platform::readImage(path);
  if (!picture)
    return Error{picture.error().id, picture.error().message + "; delete the report folder and run the study again"};
  return picture;
}

Result<std::vector<PinholeCamera>> heldOutCameras(const StudyContext& context) {
  bool any = false;
  for (const auto* sequence : studySequences(context)) any |= !sequence->test_frames.empty();
  if (!any) return std::vector<PinholeCamera>();
  return capture::readTestCameras(*context.capture);
}

void cleanEdges(std::vector<Image>& pictures) {
  std::vector<std::future<void>> running;
  for (Image& picture : pictures)
    running.push_back(std::async(std::launch::async, [&picture] { bake::replaceEdgeColours(picture); }));
}

Result<mattes::CaptureFrame> nextCleanFrame(mattes::FrameReader& reader) {
  auto frame = reader.next();
  if (frame) cleanEdges(frame.value().pictures);
  return frame;
}

Result<std::unique_ptr<render::Fvvr>> makeFvvr(const StudyContext& context) {
  return render::Fvvr::create(*context.device, captureCameras(context), context.capture->topology);
}

Result<Image> drawSeen(render::Fvvr& fvvr, const PinholeCamera& view) {
  return fvvr.renderStill(render::viewFromCamera(view), {.unseen = render::Unseen::Transparent});
}

measure::Mask seenMask(const Image& seen) { return measure::unionOfSilhouettes(seen, seen); }

bake::BakeOptions defaultBake(const StudyContext& context, const std::string& character_folder) {
  bake::BakeOptions options;
  options.capture_folder = context.options.capture_folder;
  options.character_folder = character_folder;
  options.appearance = package::AppearanceKind::Layers;
  options.jobs = context.options.jobs;
  options.refine = context.options.refine;
  options.resume = true;
  return options;
}

bake::BakeOptions studyBake(const StudyContext& context, const std::string& name) {
  bake::BakeOptions options = defaultBake(context, context.work() + "/methods/" + name);
  for (const auto* sequence : studySequences(context)) options.sequences.push_back(sequence->name);
  options.gop = kStudyGop;
  options.crf = kStudyCrf;
  options.layers = kPaperLayers;
  options.classes.bake = false;
  options.survey_folder = context.work() + "/survey";
  return options;
}

bake::BakeEnvironment bakeEnvironment(const StudyContext& context) {
  bake::BakeEnvironment environment;
  environment.device = context.device;
  environment.open_video = context.open_video;
  environment.stop = context.stop;
  environment.refinement = context.refinement;
  return environment;
}

Result<bake::BakeReport> runBake(const StudyContext& context, const bake::BakeOptions& options, const TellBake& tell) {
  FOURDVT_TRY(platform::makeFolder(std::filesystem::path(options.character_folder).parent_path().string()));
  bake::BakeEnvironment environment = bakeEnvironment(context);
  environment.progress = [&](const FrameProgress& p) { tell(p.stage, p.total ? double(p.done) / p.total : 0); };
  return bake::bake(options, environment);
}

bool isCharacter(const std::string& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder + "/character.gltf", ignored);
}

Status bakeOnce(const StudyContext& context, const bake::BakeOptions& options, const TellBake& tell) {
  if (isCharacter(options.character_folder)) return {};
  FOURDVT_ASSIGN([[maybe_unused]] const auto report, runBake(context, options, tell));
  return {};
}

Result<std::unique_ptr<SurveyedJob>> surveyOnly(const StudyContext& context, const bake::BakeOptions& options) {
  const bake::BakeEnvironment environment = bakeEnvironment(context);
  FOURDVT_TRY(platform::makeFolder(context.work() + "/methods"));
  FOURDVT_ASSIGN(auto job, bake::validate(options, environment));
  auto out = std::make_unique<SurveyedJob>(std::move(job), environment);
  const Status refined = bake::refineJob(out->run);
  auto survey = refined.ok() ? bake::Survey::make(out->run) : Result<bake::Survey>(refined.error());
  platform::removeIfEmpty(out->job.workFolder());  // removed only if empty: no bake is in progress there
  if (!survey) return survey.error();
  out->survey = std::make_unique<bake::Survey>(survey.take());
  return out;
}

bake::FrameBakerOptions bakerOptions(const SurveyedJob& surveyed) {
  bake::FrameBakerOptions options;
  for (const package::Rect& rect : surveyed.job.layout.layers) options.layer_sizes.push_back(rect.width);
  options.gutter_texels = static_cast<float>(surveyed.job.options.gutter_texels);
  options.resample = surveyed.job.options.resample;
  options.length_scale = float(surveyed.job.length_scale);
  options.colour_maps = surveyed.survey->colourMaps();
  return options;
}

Result<std::unique_ptr<bake::FrameBaker>> makeBaker(const StudyContext& context, const bake::Job& job,
                                                    const bake::FrameBakerOptions& options) {
  const package::BaseMesh& mesh = job.mesh.decoded;
  return bake::FrameBaker::create(*context.device, job.cameras, mesh.topology, mesh.positions, options);
}

void setBakerFrame(bake::FrameBaker& baker, const bake::Job& job, const mattes::CaptureFrame& frame) {
  const Positions positions = bake::reordered(job.mesh, frame.positions);
  std::vector<bake::PictureCrop> crops;
  for (size_t c = 0; c < job.cameras.size(); ++c)
    crops.push_back(bake::cropPicture(job.cameras[c], positions, frame.pictures[c]));
  baker.setFrame(positions, crops);
}

render::RecipeOptions studyRecipe() {
  render::RecipeOptions recipe;
  recipe.ground_shadow = false;
  return recipe;
}

}  // namespace fourdvt::study
