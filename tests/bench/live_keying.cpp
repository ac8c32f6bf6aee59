// SPDX-License-Identifier: Apache-2.0
// Cost of live keying of a picture, on one core, and of the offline key of the same picture; and agreement of both
// mattes with the true ones. Pictures are scaled to the height and widened at their borders.
// Usage: bench_live_keying [CAPTURE [FOLDER_OF_TRUE_MATTES]]
#include <cstdio>
#include <ctime>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/pictures.h"
#include "live/camera/keyer.h"
#include "mattes/background_key.h"
#include "mattes/frame_reader.h"
#include "mattes/plate_key.h"
#include "or_stop.h"
#include "platform/ffmpeg_video.h"
#include "silhouette/contour.h"

using namespace fourdvt;
using fourdvt::testing::orStop;

namespace {

// Processor time, ms: unaffected by other processes.
double now_ms() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

cv::Mat wrapped(const Image& image) {
  return cv::Mat(image.height, image.width, CV_8UC(image.channels), const_cast<uint8_t*>(image.pixels.data()));
}

// Scales to the height; pads the sides with the border of `beside`, so that a picture equals its plate there.
Image fitted(const Image& from, const Image& beside, int width, int height) {
  const int inner = std::min(width, from.width * height / from.height), left = (width - inner) / 2;
  Image out(width, height, from.channels);
  cv::Mat whole = wrapped(out), scaled;
  cv::resize(wrapped(beside), scaled, {inner, height}, 0, 0, cv::INTER_AREA);
  cv::copyMakeBorder(scaled, whole, 0, 0, left, width - inner - left, cv::BORDER_REPLICATE);
  cv::Mat middle = whole(cv::Rect(left, 0, inner, height));
  cv::resize(wrapped(from), middle, {inner, height}, 0, 0, cv::INTER_AREA);
  return out;
}

struct Agreement {
  double both = 0, either = 0;
  void add(const Image& matte, const Image& truth) {
    for (size_t i = 0; i < matte.pixels.size(); ++i) {
      const bool a = matte.pixels[i] >= 128, b = truth.pixels[i] >= 128;
      both += a && b;
      either += a || b;
    }
  }
  double iou() const { return both / either; }
};

struct View {
  std::vector<Image> plates, pictures, mattes;
};

std::vector<View> readViews(const capture::Capture& capture, const std::string& truth) {
  std::vector<View> views;
  const capture::CaptureSequence& sequence = capture.sequences[0];
  for (const auto& camera : capture.cameras) {
    View view;
    view.plates = orStop(capture::readPlates(capture, camera, "needed")).pictures;
    const std::string& name = camera.pinhole.name;
    const auto place = orStop(capture::colourPlace(sequence, camera));
    const auto mattes = capture::findPictures(truth + "/" + sequence.name, capture::matteStem(name));
    if (!mattes) std::fprintf(stderr, "no true mattes of %s in %s\n", name.c_str(), truth.c_str()), std::exit(1);
    auto colour = orStop(capture::PictureStream::open(place, sequence, camera, 3, platform::openVideoFile));
    auto matte = orStop(capture::PictureStream::open(*mattes, sequence, camera, 1, platform::openVideoFile));
    for (uint32_t frame = 0; frame < sequence.frame_count; frame += 9) {
      view.pictures.push_back(orStop(colour.read(frame)));
      view.mattes.push_back(orStop(matte.read(frame)));
    }
    views.push_back(std::move(view));
  }
  return views;
}

// Minimum of several runs, since other processes only add time.
template <class Work>
double leastCost_ms(int runs, const Work& work) {
  double min_ms = 1e9;
  for (int run = 0; run < runs; ++run) {
    const double start_ms = now_ms();
    work();
    min_ms = std::min(min_ms, now_ms() - start_ms);
  }
  return min_ms;
}

void measure(const std::vector<View>& views, int width, int height) {
  double live_ms = 0, outline_ms = 0, offline_ms = 0, points = 0;
  Agreement live_truth, offline_truth;
  int pictures = 0;
  for (const View& view : views) {
    std::vector<Image> plates;
    for (const Image& plate : view.plates) plates.push_back(fitted(plate, plate, width, height));
    const auto keyer = orStop(live::Keyer::create(plates));
    const auto model = mattes::makeBackgroundModel(plates);
    const Image mean = mattes::meanPicture(model);
    const bool chroma = mattes::isChromaPlate(mean);
    for (size_t i = 0; i < view.pictures.size(); ++i, ++pictures) {
      const Image picture = fitted(view.pictures[i], view.plates[0], width, height);
      const Image truth = fitted(view.mattes[i], Image(view.mattes[i].width, view.mattes[i].height, 1), width, height);
      const Image* live = nullptr;
      live_ms += leastCost_ms(5, [&] { live = orStop(keyer->key(picture)); });
      silhouette::Outline outline;
      outline_ms += leastCost_ms(5, [&] { outline = silhouette::outlineOf(*live, {1, 4}); });
      for (const auto& ring : outline.rings) points += double(ring.size());
      Image offline;
      offline_ms += leastCost_ms(
          1, [&] { offline = chroma ? mattes::chromaKey(picture, mean) : mattes::backgroundKey(picture, model); });
      live_truth.add(*live, truth);
      offline_truth.add(offline, truth);
    }
  }
  std::printf("%4d x %-4d %8.2f ms %8.2f ms %6.0f %9.2f ms %8.1f %10.4f %10.4f\n", width, height, live_ms / pictures,
              outline_ms / pictures, points / pictures, offline_ms / pictures, offline_ms / live_ms, live_truth.iou(),
              offline_truth.iou());
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const std::string folder = argc > 1 ? argv[1] : "site/sample/actor_a", truth = argc > 2 ? argv[2] : folder;
  const auto capture = orStop(
      mattes::openCapture(folder, platform::openVideoFile, {}, capture::MeshNeed::Nothing, capture::MatteNeed::None));
  const std::vector<View> views = readViews(capture, truth);
  std::printf("pictures         live    outline points     offline offl/live   live IoU   offl IoU\n");
  measure(views, 320, 240);
  measure(views, 640, 480);
  measure(views, 1280, 720);
}
