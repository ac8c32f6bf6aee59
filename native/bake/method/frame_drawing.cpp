// SPDX-License-Identifier: Apache-2.0
#include "bake/method/frame_drawing.h"

#include <algorithm>
#include <cstring>

#include "bake/texels/picture_crop.h"
#include "encode/camera_layout.h"

namespace fourdvt::bake {

Result<std::unique_ptr<FrameDrawing>> FrameDrawing::create(gpu::Device& device, std::vector<PinholeCamera> cameras,
                                                           double length_scale) {
  std::unique_ptr<FrameDrawing> drawing(new FrameDrawing(device, std::move(cameras), length_scale));
  FOURDVT_ASSIGN(drawing->recipe_, render::Recipe::create(device));
  return drawing;
}

void FrameDrawing::setCameras(std::vector<PinholeCamera> cameras) {
  cameras_ = std::move(cameras);
  model_.reset();
}

Status FrameDrawing::setFrame(const TriangleMesh& surface, std::span<const Image> pictures,
                              std::span<const ColourMap> maps) {
  std::vector<package::Rect> regions;
  for (const PinholeCamera& camera : cameras_) regions.push_back(encode::regionOfInterest(camera, surface.positions));
  const encode::CameraLayout layout = encode::planCameraLayout(cameras_, {regions}, 1);
  if (std::max(layout.width, layout.height) > device_.caps().max_texture_size)
    return Error{ErrorId::InvalidArgument, "the cameras' pictures do not fit into one texture of this device"};

  Image tiled(layout.width, layout.height, 4, 128);
  sources_.assign(cameras_.size(), {});
  const glm::vec4 texels(layout.width, layout.height, layout.width, layout.height);
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const package::CameraTile& tile = layout.gops[0][c];
    if (tile.empty()) continue;
    const package::Rect cells = encode::cellsOf(tile.tile);
    const Image drawn = drawCameraTile(tile, pictures[c], maps.empty() ? nullptr : &maps[c]);
    for (int y = 0; y < drawn.height; ++y)
      for (int x = 0; x < drawn.width; ++x) std::memcpy(tiled.at(cells.x + x, cells.y + y), drawn.at(x, y), 3);
    sources_[c] = {glm::vec4(tile.source.x, tile.source.y, tile.source.width, tile.source.height),
                   glm::vec4(tile.tile.x, tile.tile.y, tile.tile.width, tile.tile.height) / texels};
  }
  if (layout.width != width_ || layout.height != height_) {
    FOURDVT_ASSIGN(picture_,
                   render::createPicture(device_, layout.width, layout.height, render::PictureTextures::Kind::Rgba));
    width_ = layout.width;
    height_ = layout.height;
  }
  device_.updateTexture(picture_.rgba.id(), {.width = width_, .height = height_}, tiled.pixels.data());
  leaveOut(std::vector<size_t>(left_out_));

  const uint32_t vertices = static_cast<uint32_t>(surface.positions.size()),
                 faces = static_cast<uint32_t>(surface.faces.size());
  if (!model_ || vertices > model_->maxVertices() || faces > model_->maxFaces()) {
    package::Character body;
    body.cameras = cameras_;
    body.length_scale = length_scale_;
    body.vertex_count = vertices + vertices / 4;
    body.face_count = faces + faces / 4;
    FOURDVT_ASSIGN(auto model, render::CharacterModel::createForSurfaces(device_, body));
    model_ = std::make_unique<render::CharacterModel>(std::move(model));
  }
  if (model_->faces() != surface.faces) FOURDVT_TRY(model_->setTopology(device_, surface.faces, vertices));
  model_->setPositions(device_, surface.positions);
  return {};
}

void FrameDrawing::leaveOut(std::span<const size_t> cameras) {
  std::vector<size_t> left_out(cameras.begin(), cameras.end());
  left_out_ = std::move(left_out);
  used_ = sources_;
  for (size_t c : left_out_)
    if (c < used_.size()) used_[c] = {};
  ++serial_;
}

Status FrameDrawing::draw(const render::View& view, const render::MethodOptions& options, gpu::TargetId target) {
  const render::CameraLook look{cameras_, used_, &picture_, glm::vec2(width_, height_), serial_};
  render::Figure figure;
  figure.model = model_.get();
  figure.cameras = &look;
  const render::DrawOptions draw{.recipe = {.ground_shadow = false}, .method = options};
  return recipe_->draw({&figure, 1}, nullptr, view, draw, target);
}

Result<Image> FrameDrawing::render(const PinholeCamera& view, const render::MethodOptions& options) {
  const render::View seen = render::viewFromCamera(view);
  return still_.render(seen, [&](gpu::TargetId target) { return draw(seen, options, target); });
}

}  // namespace fourdvt::bake
