// SPDX-License-Identifier: Apache-2.0
#include "bake/align/looks.h"

#include <opencv2/imgproc.hpp>

#include "render/passes.h"
#include "render/table.h"

namespace fourdvt::bake {
namespace {

constexpr float kNeighbourhood = 0.03f;  // side of the window of local contrast, in picture heights
constexpr float kLeastContrast = 8;      // grey: deviation at which texture starts to count
constexpr float kContrast = 40;          // grey: deviation of textured places in the result

// Two texels per corner, as CharacterModel::corners has them; looks that move by their own texture coordinates need no
// uv_from_tangents.
std::vector<glm::vec4> cornersWith(const MeshTopology& topology, const std::vector<glm::vec2>& uvs) {
  std::vector<glm::vec4> table;
  render::resizeToRows(table, 6ull * topology.faceCount(), glm::vec4(0));
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec2& uv = uvs[topology.face_uvs[face][corner]];
      table[2 * (3 * face + corner)] = {uv.x, uv.y, static_cast<float>(topology.face_vertices[face][corner]), 0};
    }
  return table;
}

class Drawer final : public LookDrawer {
 public:
  Drawer(gpu::Device& device, const MeshTopology& topology, render::CharacterModel model, gpu::Program depth)
      : device_(device), topology_(topology), model_(std::move(model)), depth_(std::move(depth)) {
    options_.align = render::Align::None;
  }

  Status setFrame(const Positions& positions, const std::vector<std::vector<glm::vec2>>& member_uvs) override {
    model_.setPositions(device_, positions);
    while (corners_.size() < member_uvs.size()) {
      FOURDVT_ASSIGN(auto corners, render::makeTable(device_, gpu::PixelFormat::RGBA32F, 6ull * model_.face_count,
                                                     "alignment corners"));
      corners_.push_back(std::move(corners));
    }
    corners_.resize(member_uvs.size());
    for (size_t member = 0; member < corners_.size(); ++member)
      render::uploadTable(device_, corners_[member], cornersWith(topology_, member_uvs[member]));
    return {};
  }

  Result<std::vector<cv::Mat>> draw(const PinholeCamera& camera, const render::Appearance& appearance,
                                    const render::PictureTextures& picture) override {
    FOURDVT_TRY(resize(camera.width, camera.height));
    const render::View view = render::viewFromCamera(camera, {model_.length_scale, model_.length_scale});
    drawDepth(view);
    std::vector<cv::Mat> looks;
    for (size_t member = 0; member < corners_.size(); ++member) {
      FOURDVT_TRY(drawMember(member, view, appearance, picture));
      cv::Mat rgba(camera.height, camera.width, CV_8UC4);
      FOURDVT_TRY(device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8,
                                     {.width = camera.width, .height = camera.height}, rgba.data));
      looks.push_back(rgba);
    }
    return looks;
  }

 private:
  // Looks differ only in their texture coordinates. Their common depth is drawn first, so that hidden surface is never
  // shaded; the colours of this pass do not matter, because every look draws over the same pixels.
  void drawDepth(const render::View& view) {
    device_.beginPass({.target = target_.id(), .clear_color = true, .clear_depth = true, .label = "look depth"});
    device_.draw(
        {.program = depth_.id(),
         .textures = {{"u_corners", model_.corners.id()}, {"u_positions_normals", model_.positions_normals.id()}},
         .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_world)},
         .vertex_count = static_cast<int>(3 * model_.face_count),
         .depth_test = true,
         .depth_write = true,
         .cull = model_.closed_surface ? gpu::Cull::Back : gpu::Cull::None});
    device_.endPass();
  }

  Status drawMember(size_t member, const render::View& view, const render::Appearance& appearance,
                    const render::PictureTextures& picture) {
    std::vector<float> weights(corners_.size(), 0.0f);
    weights[member] = 1;
    const render::Look look{&appearance, &picture, weights};
    FOURDVT_TRY(render::checkFigure({&model_, std::span(&look, 1)}, options_.recipe));
    const render::Part part{&look, {{static_cast<int>(member), 1.0f}}};
    const render::CharacterView unmoved{view.clip_from_world, view.eye_in_world};  // the character stands in the origin
    FOURDVT_TRY(layered_.prepare(device_, model_, part, unmoved, options_));
    device_.beginPass({.target = target_.id(), .label = "look"});
    std::swap(model_.corners, corners_[member]);
    layered_.draw(device_, model_, part, unmoved, options_);
    std::swap(model_.corners, corners_[member]);
    device_.endPass();
    return {};
  }

  Status resize(int width, int height) {
    if (color_ && width == width_ && height == height_) return {};
    target_.reset();
    FOURDVT_ASSIGN(color_, gpu::makeTexture(device_, {.width = width, .height = height, .label = "alignment look"}));
    FOURDVT_ASSIGN(target_,
                   gpu::makeTarget(device_, {.colors = {color_.id()}, .own_depth = true, .label = "alignment look"}));
    width_ = width;
    height_ = height;
    return {};
  }

  gpu::Device& device_;
  const MeshTopology& topology_;
  render::CharacterModel model_;
  gpu::Program depth_;
  render::LayeredPass layered_;
  render::DrawOptions options_;
  std::vector<gpu::Texture> corners_;  // [member], with the member's texture coordinates
  gpu::Texture color_;
  gpu::Target target_;
  int width_ = 0, height_ = 0;
};

}  // namespace

cv::Mat evenLuma(const cv::Mat& rgba) {
  const int side = int(kNeighbourhood * float(rgba.rows)) | 1;
  const cv::Size window(side, side);
  cv::Mat luma, alpha, inside, share, mean, variance, even;
  cv::cvtColor(rgba, luma, cv::COLOR_RGBA2GRAY);
  cv::extractChannel(rgba, alpha, 3);
  luma.convertTo(luma, CV_32F);
  alpha.convertTo(inside, CV_32F, 1.0 / 255);
  cv::blur(inside, share, window);
  share += 1e-6;
  cv::blur(luma.mul(inside), mean, window);
  const cv::Mat deviation = (luma - mean / share).mul(inside);
  cv::blur(deviation.mul(deviation), variance, window);
  cv::sqrt(variance / share, variance);
  cv::Mat(deviation / (variance + kLeastContrast) * kContrast + 128).convertTo(even, CV_8U);
  return even;
}

Result<std::unique_ptr<LookDrawer>> LookDrawer::create(gpu::Device& device, const package::Character& character,
                                                       const package::BaseMesh& mesh) {
  FOURDVT_ASSIGN(auto model, render::CharacterModel::create(device, character, mesh));
  FOURDVT_ASSIGN(auto depth, render::makeEmbeddedProgram(device, "mesh_picture.vert", "bake_depth.frag"));
  return std::unique_ptr<LookDrawer>(
      std::make_unique<Drawer>(device, mesh.topology, std::move(model), std::move(depth)));
}

}  // namespace fourdvt::bake
