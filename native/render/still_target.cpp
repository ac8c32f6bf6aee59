// SPDX-License-Identifier: Apache-2.0
#include "render/still_target.h"

#include <algorithm>

namespace fourdvt::render {
Status StillTarget::prepare(int width, int height) {
  if (target_ && width == width_ && height == height_) return {};
  FOURDVT_ASSIGN(auto color, gpu::makeTexture(device_, {.width = width, .height = height, .label = "still"}));
  FOURDVT_ASSIGN(
      target_, gpu::makeTarget(device_, {.colors = {color.id()}, .width = width, .height = height, .label = "still"}));
  color_ = std::move(color);
  width_ = width;
  height_ = height;
  return {};
}

Result<Image> StillTarget::render(const View& view, const std::function<Status(gpu::TargetId)>& draw) {
  const int largest = device_.caps().max_texture_size;
  if (view.width < 1 || view.height < 1 || view.width > largest || view.height > largest) {
    return Error{ErrorId::InvalidArgument, "picture size must be between 1 and " + std::to_string(largest) + " pixels"};
  }
  FOURDVT_TRY(prepare(view.width, view.height));
  FOURDVT_TRY(draw(target_.id()));
  Image image(view.width, view.height, 4);
  FOURDVT_TRY(device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = view.width, .height = view.height},
                                 image.pixels.data()));
  unpremultiply(image);
  return image;
}

}  // namespace fourdvt::render
