// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/plane_sweep.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace fourdvt::reconstruct {
namespace {

constexpr int kTableWidth = 1024;
constexpr size_t kMostCompared = 32;  // cameras whose mattes bound the depths: what uniforms hold on every GPU
const char kTableDefine[] = "TABLE_WIDTH 1024\n";

int rowsFor(size_t texels) { return std::max(1, int((texels + kTableWidth - 1) / kTableWidth)); }

// Replaces the table's texture where it has too few rows, and uploads whole rows of `table`, which is padded.
template <class T>
Status uploadTable(gpu::Device& device, gpu::PixelFormat format, const char* label, std::vector<T>& table, int& rows,
                   gpu::Texture& texture) {
  const int needed = rowsFor(table.size());
  table.resize(size_t(needed) * kTableWidth);
  if (needed > rows) {
    rows = needed + needed / 4;
    FOURDVT_ASSIGN(texture,
                   gpu::makeTexture(device, {.format = format, .width = kTableWidth, .height = rows, .label = label}));
  }
  device.updateTexture(texture.id(), {.width = kTableWidth, .height = needed}, table.data());
  return {};
}

// Picture coordinates in pixels times depth, and depth, from (x z, y z, z, 1) of the reference.
glm::mat4 pixelFromReference(const PinholeCamera& camera, const PinholeCamera& reference) {
  const auto intrinsics = [](const PinholeCamera& c) {
    glm::dmat4 k(1.0);
    k[0][0] = c.fx, k[1][1] = c.fy, k[2][0] = c.cx, k[2][1] = c.cy;
    return k;
  };
  return glm::mat4(intrinsics(camera) * camera.cam_from_world * glm::inverse(reference.cam_from_world) *
                   glm::inverse(intrinsics(reference)));
}

// The sources, then others: all, or some all over the list where there are too many.
std::vector<size_t> comparedOrder(size_t cameras, const std::vector<size_t>& sources) {
  std::vector<size_t> others, order = sources;
  for (size_t c = 0; c < cameras; ++c)
    if (std::find(sources.begin(), sources.end(), c) == sources.end()) others.push_back(c);
  const size_t room = std::min(cameras, kMostCompared) - sources.size();
  for (size_t k = 0; k < room; ++k) order.push_back(others[k * others.size() / room]);
  return order;
}

}  // namespace

Result<PlaneSweep> PlaneSweep::create(gpu::Device& device, std::span<const PinholeCamera> cameras,
                                      const PlaneSweepOptions& options) {
  PlaneSweep out;
  out.device_ = &device;
  out.cameras_.assign(cameras.begin(), cameras.end());
  out.options_ = options;
  for (const PinholeCamera& camera : cameras) {
    out.layer_width_ = std::max(out.layer_width_, camera.width);
    out.layer_height_ = std::max(out.layer_height_, camera.height);
  }
  if (!device.caps().float_targets) return Error{ErrorId::GpuFailure, "stereo needs float targets on the GPU"};
  FOURDVT_ASSIGN(out.front_program_, gpu::makeProgram(device, "stereo front", gpu::shaderText("stereo_front.vert"),
                                                      gpu::shaderText("stereo_front.frag"), kTableDefine));
  FOURDVT_ASSIGN(out.pictures_, gpu::makeTexture(device, {.format = gpu::PixelFormat::RGBA8,
                                                          .width = out.layer_width_,
                                                          .height = out.layer_height_,
                                                          .layers = int(cameras.size()),
                                                          .filter = gpu::Filter::Linear,
                                                          .label = "stereo pictures"}));
  return out;
}

Result<gpu::ProgramId> PlaneSweep::programFor(size_t sources) {
  if (cost_programs_.size() <= sources) cost_programs_.resize(sources + 1);
  if (!cost_programs_[sources]) {
    const std::string defines = "CAMERAS " + std::to_string(std::min(cameras_.size(), kMostCompared)) + "\nSOURCES " +
                                std::to_string(sources) + "\nRADIUS " + std::to_string(options_.radius) +
                                "\nSPACING float(" + std::to_string(options_.spacing) + ")\nCORRELATION_SHARE float(" +
                                std::to_string(options_.correlation_share) + ")\n";
    FOURDVT_ASSIGN(cost_programs_[sources],
                   gpu::makeProgram(*device_, "stereo costs", gpu::shaderText("fullscreen.vert"),
                                    gpu::shaderText("stereo_costs.frag"), defines));
  }
  return cost_programs_[sources].id();
}

Status PlaneSweep::setFrame(std::span<const Image> pictures, const TriangleMesh& hull) {
  for (size_t c = 0; c < pictures.size(); ++c)
    device_->updateTexture(pictures_.id(), {.width = pictures[c].width, .height = pictures[c].height},
                           pictures[c].pixels.data(), 0, int(c));
  hull_ = hull.positions;
  std::vector<uint32_t> corners;
  corners.reserve(hull.faces.size() * 3 + kTableWidth);
  for (const glm::uvec3& face : hull.faces)
    for (int k = 0; k < 3; ++k) corners.push_back(face[k]);
  corner_count_ = int(corners.size());
  std::vector<glm::vec4> points;
  points.reserve(hull_.size() + kTableWidth);
  for (const glm::vec3& p : hull_) points.emplace_back(p, 1);
  FOURDVT_TRY(uploadTable(*device_, gpu::PixelFormat::R32UI, "stereo corners", corners, corner_rows_, corners_));
  return uploadTable(*device_, gpu::PixelFormat::RGBA32F, "stereo positions", points, position_rows_, positions_);
}

Status PlaneSweep::drawFront(const PinholeCamera& camera, const PictureRegion& region) {
  if (region.width != front_width_ || region.height != front_height_) {
    front_target_.reset();
    FOURDVT_ASSIGN(front_, gpu::makeTexture(*device_, {.format = gpu::PixelFormat::RGBA32F,
                                                       .width = region.width,
                                                       .height = region.height,
                                                       .label = "stereo front"}));
    FOURDVT_ASSIGN(front_target_,
                   gpu::makeTarget(*device_, {.colors = {front_.id()}, .own_depth = true, .label = "stereo front"}));
    front_width_ = region.width, front_height_ = region.height;
  }
  PinholeCamera part = camera;
  part.cx -= region.x, part.cy -= region.y;
  part.width = region.width, part.height = region.height;
  const glm::mat4 clip(clipFromWorld(part, region.near_m, region.far_m));
  device_->beginPass({.target = front_target_.id(), .clear_color = true, .clear_depth = true, .label = "stereo front"});
  gpu::Draw draw;
  draw.program = front_program_.id();
  draw.textures = {{"u_corner_vertices", corners_.id()}, {"u_positions", positions_.id()}};
  draw.uniforms = {gpu::uniform("u_clip_from_world", clip)};
  draw.vertex_count = corner_count_;
  draw.depth_test = draw.depth_write = true;
  device_->draw(draw);
  device_->endPass();
  return {};
}

Result<CostVolume> PlaneSweep::costs(const StereoReference& reference) {
  const PictureRegion region = regionOf(reference.camera, hull_);
  CostVolume out;
  if (region.empty() || corner_count_ == 0) return out;
  out.x = region.x, out.y = region.y, out.width = region.width, out.height = region.height;
  out.labels = options_.labels;
  out.step_m = options_.step_m;
  FOURDVT_TRY(drawFront(reference.camera, region));
  FOURDVT_ASSIGN(const gpu::ProgramId program, programFor(reference.sources.size()));
  const int blocks = out.labels / 4, height = region.height * blocks;
  if (region.width > costs_width_ || height > costs_height_) {
    costs_target_.reset();
    costs_width_ = std::max(costs_width_, region.width), costs_height_ = std::max(costs_height_, height);
    FOURDVT_ASSIGN(
        costs_, gpu::makeTexture(*device_, {.width = costs_width_, .height = costs_height_, .label = "stereo costs"}));
    FOURDVT_ASSIGN(costs_target_, gpu::makeTarget(*device_, {.colors = {costs_.id()}, .label = "stereo costs"}));
  }
  const std::vector<size_t> order = comparedOrder(cameras_.size(), reference.sources);
  std::vector<glm::mat4> matrices;
  std::vector<glm::vec4> layers;
  for (size_t c : order) {
    matrices.push_back(pixelFromReference(cameras_[c], reference.camera));
    layers.emplace_back(float(c), float(cameras_[c].width), float(cameras_[c].height), 0);
  }
  const glm::vec4 part(region.x, region.y, region.width, region.height);
  const glm::vec2 texel(1.0f / float(layer_width_), 1.0f / float(layer_height_));
  device_->beginPass({.target = costs_target_.id(), .width = region.width, .height = height, .label = "stereo costs"});
  gpu::Draw draw;
  draw.program = program;
  draw.textures = {{"u_pictures", pictures_.id()}, {"u_front", front_.id()}};
  draw.uniforms = {gpu::uniform("u_pixel_from_reference", std::span<const glm::mat4>(matrices)),
                   gpu::uniform("u_layers", std::span<const glm::vec4>(layers)), gpu::uniform("u_region", part),
                   gpu::uniform("u_texel", texel), gpu::uniform("u_step", options_.step_m)};
  draw.vertex_count = 3;
  device_->draw(draw);
  device_->endPass();

  std::vector<glm::vec4> front(size_t(region.width) * region.height);
  FOURDVT_TRY(device_->readPixels(front_target_.id(), gpu::PixelFormat::RGBA32F,
                                  {.width = region.width, .height = region.height}, front.data()));
  std::vector<uint8_t> read(size_t(region.width) * height * 4);
  FOURDVT_TRY(device_->readPixels(costs_target_.id(), gpu::PixelFormat::RGBA8,
                                  {.width = region.width, .height = height}, read.data()));
  out.first_plane.resize(front.size());
  out.costs.resize(front.size() * out.labels);
  for (size_t i = 0; i < front.size(); ++i)
    out.first_plane[i] = front[i].x > 0 ? int(std::floor(front[i].x / options_.step_m)) : CostVolume::kNone;
  // What is read has its top row first: the last block stands on top.
  const size_t block_bytes = front.size() * 4;
  for (int b = 0; b < blocks; ++b) {
    const uint8_t* from = read.data() + block_bytes * (blocks - 1 - b);
    for (size_t i = 0; i < front.size(); ++i) std::copy_n(from + 4 * i, 4, &out.costs[i * out.labels + 4 * b]);
  }
  return out;
}

}  // namespace fourdvt::reconstruct
