// SPDX-License-Identifier: Apache-2.0
#include "bake/stages/poster.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "render/plain_figure.h"

namespace fourdvt::bake {
Result<Image> renderPoster(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh,
                           const package::Rendition& layout, const StillArtefact& still, const Positions& positions) {
  FOURDVT_ASSIGN(auto figure, render::PlainFigure::create(device, character, mesh));
  const I420View view = still.picture.view();
  FOURDVT_ASSIGN(auto picture,
                 render::createPicture(device, view.width, view.height, render::PictureTextures::Kind::I420));
  FOURDVT_ASSIGN(auto recipe, render::Recipe::create(device));
  gpu::TargetDesc desc;
  desc.width = kPosterWidth;
  desc.height = kPosterHeight;
  desc.label = "poster";
  FOURDVT_ASSIGN(auto target, gpu::makeTarget(device, desc));
  render::uploadPicture(device, picture, view);
  figure.setLayout(layout);
  figure.setFrame(device, positions, still.labels);
  const OrbitView orbit = defaultOrbit(character.bounds, double(kPosterWidth) / kPosterHeight);
  const PinholeCamera camera = cameraFromOrbit(orbit, kPosterWidth, kPosterHeight);
  const auto scale = static_cast<float>(character.length_scale);
  FOURDVT_TRY(figure.draw(*recipe, picture, render::viewFromCamera(camera, {scale, scale}), {}, target.id()));
  Image image(kPosterWidth, kPosterHeight, 4);
  FOURDVT_TRY(device.readPixels(target.id(), gpu::PixelFormat::RGBA8, {.width = kPosterWidth, .height = kPosterHeight},
                                image.pixels.data()));
  unpremultiply(image);
  return image;
}

Result<std::vector<uint8_t>> encodePicture(const Image& image, const std::string& extension, int quality) {
  const cv::Mat rgb(image.height, image.width, CV_8UC(image.channels), const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, image.channels == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGB2BGR);
  const int flag = extension == ".webp" ? cv::IMWRITE_WEBP_QUALITY : cv::IMWRITE_JPEG_QUALITY;
  std::vector<uint8_t> bytes;
  if (!cv::imencode(extension, bgr, bytes, {flag, quality}))
    return Error{ErrorId::Internal, "OpenCV cannot encode " + extension + " pictures; install a build with it"};
  return bytes;
}

}  // namespace fourdvt::bake
