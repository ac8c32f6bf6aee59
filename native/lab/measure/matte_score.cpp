// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/matte_score.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "capture/pictures.h"
#include "capture/undistort.h"
#include "mattes/frame_reader.h"

namespace fourdvt::measure {
namespace {

// True mattes of one camera, undistorted like the reader's pictures.
class TrueMattes {
 public:
  static Result<TrueMattes> open(const std::string& folder, const capture::CaptureSequence& sequence,
                                 const capture::CaptureCamera& camera, const OpenVideo& open_video) {
    const std::string stem = capture::matteStem(camera.pinhole.name);
    const auto place = capture::findPictures(folder, stem);
    if (!place)
      return Error{ErrorId::FileMissing,
                   folder + "/" + stem + ".mkv: no video and no folder with 000000.png; name the true mattes' folder " +
                       "with --against"};
    FOURDVT_ASSIGN(auto stream, capture::PictureStream::open(*place, sequence, camera, 1, open_video));
    return TrueMattes(std::move(stream), camera);
  }
  Result<Image> read(uint32_t frame) {
    FOURDVT_ASSIGN(auto matte, stream_.read(frame));
    return undistorter_.apply(std::move(matte));
  }

 private:
  TrueMattes(capture::PictureStream stream, const capture::CaptureCamera& camera)
      : stream_(std::move(stream)), camera_(camera), undistorter_(camera) {}

  capture::PictureStream stream_;
  capture::CaptureCamera camera_;
  capture::Undistorter undistorter_;
};

std::vector<MatteScore> withTotal(std::vector<MatteScore> scores) {
  if (scores.size() < 2) return scores;
  MatteScore total{"all", "", {}};
  for (const MatteScore& score : scores) total.agreement.add(score.agreement);
  scores.push_back(total);
  return scores;
}

}  // namespace

Result<std::vector<MatteScore>> scoreMattes(
    const capture::Capture& capture, const std::string& against, const OpenVideo& open_video,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame) {
  std::vector<MatteScore> out;
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    std::vector<TrueMattes> truth;
    std::vector<MatteScore> scores;
    for (const capture::CaptureCamera& camera : capture.cameras) {
      FOURDVT_ASSIGN(auto mattes, TrueMattes::open(against + "/" + sequence.name, sequence, camera, open_video));
      truth.push_back(std::move(mattes));
      scores.push_back({sequence.name, camera.pinhole.name, {}});
    }
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video));
    for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) {
      FOURDVT_ASSIGN(const auto captured, reader->next());
      for (size_t c = 0; c < truth.size(); ++c) {
        FOURDVT_ASSIGN(const auto matte, truth[c].read(frame));
        scores[c].agreement.add(captured.pictures[c], matte);
      }
      if (on_frame) on_frame(sequence.name, frame);
    }
    out.insert(out.end(), scores.begin(), scores.end());
  }
  return out;
}

std::string matteTable(const std::vector<MatteScore>& scores) {
  std::string out = "sequence     camera     frames     IoU  beyond 2 pixels of the edge  edge distance pixels\n";
  for (const MatteScore& score : withTotal(scores)) {
    const MatteAgreement& a = score.agreement;
    out += printed("%-12s %-10s %6zu %7.4f %28.4f %21.3f\n", score.sequence.c_str(), score.camera.c_str(), a.pictures(),
                   a.iou(), a.iouOutsideBand(), a.edgeDistance());
  }
  return out;
}

std::string matteJson(const std::vector<MatteScore>& scores) {
  nlohmann::ordered_json root;
  root["band_pixels"] = MatteAgreement::kBand_pixels;
  root["mattes"] = nlohmann::ordered_json::array();
  for (const MatteScore& score : withTotal(scores)) {
    const MatteAgreement& a = score.agreement;
    nlohmann::ordered_json row{{"sequence", score.sequence},
                               {"camera", score.camera},
                               {"frames", a.pictures()},
                               {"iou", a.iou()},
                               {"iou_outside_band", a.iouOutsideBand()}};
    row["edge_distance_pixels"] = a.edgeDistance();  // NaN is written as null
    root["mattes"].push_back(std::move(row));
  }
  return root.dump(1) + "\n";
}

}  // namespace fourdvt::measure
