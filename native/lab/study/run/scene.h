// SPDX-License-Identifier: Apache-2.0
// Inputs of the steps: frames of the capture, FVVR's pictures, held-out truth, plans of bakes, baked characters.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "bake/run/bake_run.h"
#include "bake/stages/survey.h"
#include "edge/character_player.h"
#include "lab/measure/held_out_truth.h"
#include "lab/study/run/context.h"
#include "lab/study/run/ring.h"
#include "mattes/frame_reader.h"
#include "measure/picture_score.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::study {

// "view=CAMERA frame=N"
std::string viewSetting(const PinholeCamera& camera, uint32_t frame);
std::vector<PinholeCamera> captureCameras(const StudyContext& context);
// The sequences of this study, in the capture's order.
std::vector<const capture::CaptureSequence*> studySequences(const StudyContext& context);
// Sequence with the fewest frames, for measures on one sequence only.
const capture::CaptureSequence& shortestSequence(const StudyContext& context);

// Views of a sequence in this study: 36, or 8 with `quick`. Reads all meshes for their bounds.
Result<std::vector<RingView>> studyRing(const StudyContext& context, const capture::CaptureSequence& sequence);

// Path of a picture of runReference (RGBA PNG): FVVR on the ring, or at a held-out camera.
std::string referencePath(const StudyContext& context, const std::string& sequence, const RingView& view);
std::string referencePath(const StudyContext& context, const std::string& sequence, const std::string& camera,
                          uint32_t frame);
// Path of a picture of drawSeen by runReference.
std::string seenPath(const StudyContext& context, const std::string& sequence, const std::string& camera,
                     uint32_t frame);
// Reads a picture of runReference. The error for a missing one suggests deleting the report folder.
Result<Image> readReference(const std::string& path);

// Returns capture::readTestCameras; empty if no sequence of the study has held-out frames.
Result<std::vector<PinholeCamera>> heldOutCameras(const StudyContext& context);

// Runs bake::replaceEdgeColours on all pictures in parallel.
void cleanEdges(std::vector<Image>& pictures);
// A captured frame with clean edges.
Result<mattes::CaptureFrame> nextCleanFrame(mattes::FrameReader& reader);

Result<std::unique_ptr<render::Fvvr>> makeFvvr(const StudyContext& context);
// Draws the surface that an input camera sees by the depth test and its matte, within 90 degrees of the view.
Result<Image> drawSeen(render::Fvvr& fvvr, const PinholeCamera& view);
// Mask of such a picture.
measure::Mask seenMask(const Image& seen);

// Layer size and number of Volino and Hilton 2013, as in the tables.
constexpr int kPaperTexture = 512, kPaperLayers = 3, kStudyCrf = 23, kStudyGop = 20;

// Default settings for a bake of the study's capture into `character_folder`, with the study's refinement.
bake::BakeOptions defaultBake(const StudyContext& context, const std::string& character_folder);
// Options of a bake into work()/methods/NAME that shares its survey with the study's other bakes.
bake::BakeOptions studyBake(const StudyContext& context, const std::string& name);
bake::BakeEnvironment bakeEnvironment(const StudyContext& context);
// Receives the name of the bake's stage and the share of the whole bake.
using TellBake = std::function<void(const std::string& stage, double share)>;
Result<bake::BakeReport> runBake(const StudyContext& context, const bake::BakeOptions& options, const TellBake& tell);
bool isCharacter(const std::string& folder);
// Runs runBake, unless the folder contains a character.
Status bakeOnce(const StudyContext& context, const bake::BakeOptions& options, const TellBake& tell);

// Plan and survey of a bake that is not run: labels and colour maps for layers without a codec.
struct SurveyedJob {
  SurveyedJob(bake::Job validated, const bake::BakeEnvironment& environment)
      : run(std::move(validated), environment), job(run.job) {}
  bake::BakeRun run;
  const bake::Job& job;                  // owned by the run
  std::unique_ptr<bake::Survey> survey;  // borrows the job
};
Result<std::unique_ptr<SurveyedJob>> surveyOnly(const StudyContext& context, const bake::BakeOptions& options);

// Options of the bake's FrameBaker; a FrameBaker for the job's cameras and mesh; the step that passes it a captured
// frame.
bake::FrameBakerOptions bakerOptions(const SurveyedJob& surveyed);
Result<std::unique_ptr<bake::FrameBaker>> makeBaker(const StudyContext& context, const bake::Job& job,
                                                    const bake::FrameBakerOptions& options);
void setBakerFrame(bake::FrameBaker& baker, const bake::Job& job, const mattes::CaptureFrame& frame);

// Recipe without shadow, with a transparent background.
render::RecipeOptions studyRecipe();

}  // namespace fourdvt::study
