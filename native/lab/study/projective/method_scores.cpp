// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/method_scores.h"

#include <cmath>

#include "bake/method/frame_drawing.h"
#include "base/text.h"
#include "base/watch.h"
#include "lab/measure/held_out_truth.h"
#include "mattes/frame_reader.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::study {
namespace {

// Scores of one method on one sequence.
struct SequenceLanes {
  measure::ScoreLane held_out, left_one_out;
  double seconds = 0;
};

}  // namespace

Result<std::vector<MethodScore>> scoreMethods(gpu::Device& device, const capture::Capture& capture,
                                              const OpenVideo& open_video, const MethodScoreOptions& options,
                                              const std::function<void(const std::string&, uint32_t)>& on_frame) {
  FOURDVT_ASSIGN(const auto test_cameras, capture::readTestCameras(capture));
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : capture.cameras) cameras.push_back(camera.pinhole);
  FOURDVT_ASSIGN(auto stage, bake::FrameDrawing::create(device, cameras));
  std::vector<MethodScore> out;
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    if (sequence.test_frames.empty()) continue;
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video));
    std::vector<SequenceLanes> lanes(options.methods.size());
    for (const uint32_t frame : sequence.test_frames) {
      reader->skipTo(frame);
      FOURDVT_ASSIGN(const auto captured, reader->next());
      FOURDVT_ASSIGN(const TriangleMesh surface, capture::readSurfaceFrame(capture, sequence, frame));
      FOURDVT_TRY(stage->setFrame(surface, captured.pictures));
      for (size_t m = 0; m < options.methods.size(); ++m) {
        FOURDVT_ASSIGN(auto method, render::makeCameraMethod(device, options.methods[m]));
        stage->setMethod(std::move(method));
        stage->leaveOut({});
        FOURDVT_TRY(stage->render(test_cameras[0], options.method));  // creates programs and targets, untimed
        for (const PinholeCamera& camera : test_cameras) {
          FOURDVT_ASSIGN(auto truth, measure::heldOutTruth(sequence, camera, frame));
          const Watch watch;
          FOURDVT_ASSIGN(auto picture, stage->render(camera, options.method));
          lanes[m].seconds += watch.seconds();
          lanes[m].held_out.add(std::move(truth), std::move(picture));
        }
        for (size_t c = 0; options.leaves_one_out && c < cameras.size(); ++c) {
          stage->leaveOut({&c, 1});
          FOURDVT_ASSIGN(auto picture, stage->render(cameras[c], options.method));
          lanes[m].left_one_out.add(captured.pictures[c], std::move(picture));
        }
      }
      if (on_frame) on_frame(sequence.name, frame);
      if (options.quick) break;
    }
    for (size_t m = 0; m < options.methods.size(); ++m) {
      const measure::MeanScores held_out = lanes[m].held_out.finishMean();
      MethodScore score{options.methods[m], sequence.name, held_out.count(), held_out.mean()};
      double sum = 0;
      measure::MeanScores mean;
      for (const auto& [tag, one] : lanes[m].left_one_out.finish()) {
        mean.add(one);
        sum += std::pow(10, -one.psnr_fg_db / 20);
      }
      score.left_one_out = mean.mean();
      score.rmse_left_one_out = sum / double(mean.count());
      score.picture_s = lanes[m].seconds / double(held_out.count());
      out.push_back(std::move(score));
    }
  }
  if (!out.empty()) return out;
  return Error{ErrorId::FileMissing,
               capture.folder + "/capture.json: no sequence has \"test_frames\", frames with held-out pictures"};
}

std::string methodTable(const std::vector<MethodScore>& scores) {
  std::string out =
      "sequence     method          views  held out: dB     SSIM  common dB  left out: RMSE      dB     SSIM  s\n";
  for (const MethodScore& s : scores) {
    out += printed("%-12s %-14s %6zu %13.3f %8.4f %10.3f %15.4f %7.3f %8.4f  %.3f\n", s.sequence.c_str(),
                   s.method.c_str(), s.views, s.held_out.psnr_fg_db, s.held_out.ssim_fg, s.held_out.psnr_common_db,
                   s.rmse_left_one_out, s.left_one_out.psnr_fg_db, s.left_one_out.ssim_fg, s.picture_s);
  }
  return out;
}

}  // namespace fourdvt::study
