// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/plane_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/parallel.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kTableWidth = 1024;
constexpr size_t kMaxCompared =
    32;  // maximum number of cameras whose mattes bound the depths, by the uniforms available on every GPU
const char kTableDefine[] = "TABLE_WIDTH 1024\n", kCellDefine[] = "CELL 4\n";
static_assert(kSweepCell == 4);
constexpr uint8_t kBackground = 89;  // alpha; below it also between pixels background to stereo_costs.frag

int rowsFor(size_t texels) { return std::max(1, int((texels + kTableWidth - 1) / kTableWidth)); }

// Uploads whole rows of `table`, padded; replaces the texture if it has too few rows.
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

// Maps (x z, y z, z, 1) of the reference to (pixel times depth, depth) of the camera.
glm::dmat4 pixelFromReference(const PinholeCamera& camera, const PinholeCamera& reference) {
  const auto intrinsics = [](const PinholeCamera& c) {
    glm::dmat4 k(1.0);
    k[0][0] = c.fx, k[1][1] = c.fy, k[2][0] = c.cx, k[2][1] = c.cy;
    return k;
  };
  return intrinsics(camera) * camera.cam_from_world * glm::inverse(reference.cam_from_world) *
         glm::inverse(intrinsics(reference));
}

// Indices of the cameras to compare: all sources, then the other cameras, evenly spaced ones if they exceed the
// maximum.
std::vector<size_t> comparedOrder(size_t cameras, const std::vector<size_t>& sources) {
  std::vector<size_t> others, order = sources;
  for (size_t c = 0; c < cameras; ++c)
    if (std::find(sources.begin(), sources.end(), c) == sources.end()) others.push_back(c);
  const size_t room = std::min(cameras, kMaxCompared) - sources.size();
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
  out.corners_ = gpu::makeIndexBuffer(device);
  FOURDVT_ASSIGN(out.front_program_, gpu::makeProgram(device, "stereo front", gpu::shaderText("stereo_front.vert"),
                                                      gpu::shaderText("stereo_front.frag"), kTableDefine));
  FOURDVT_ASSIGN(out.outside_program_, gpu::makeProgram(device, "stereo outside", gpu::shaderText("fullscreen.vert"),
                                                        gpu::shaderText("stereo_outside.frag"), kCellDefine));
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
    const std::string defines = "CAMERAS " + std::to_string(std::min(cameras_.size(), kMaxCompared)) + "\nSOURCES " +
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
  mattes_.clear();
  for (const Image& picture : pictures) mattes_.emplace_back(picture, kBackground);
  hull_ = hull.positions;
  corner_count_ = int(hull.faces.size() * 3);
  if (corner_count_ > 0) device_->updateIndices(corners_.id(), {&hull.faces[0].x, size_t(corner_count_)});
  std::vector<glm::vec4> points;
  points.reserve(hull_.size() + kTableWidth);
  for (const glm::vec3& p : hull_) points.emplace_back(p, 1);
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
  draw.textures = {{"u_positions", positions_.id()}};
  draw.uniforms = {gpu::uniform("u_clip_from_world", clip)};
  draw.vertex_count = corner_count_;
  draw.indices = corners_.id();
  draw.depth_test = draw.depth_write = true;
  device_->draw(draw);
  device_->endPass();
  return {};
}

Status PlaneSweep::uploadCells(const std::vector<uint8_t>& cells, const PictureRegion& region) {
  const int across = (region.width + kSweepCell - 1) / kSweepCell, rows = int(cells.size()) / across;
  if (across > cells_width_ || rows > cells_height_) {
    cells_width_ = std::max(cells_width_, across), cells_height_ = std::max(cells_height_, rows);
    FOURDVT_ASSIGN(cells_, gpu::makeTexture(*device_, {.format = gpu::PixelFormat::R8,
                                                       .width = cells_width_,
                                                       .height = cells_height_,
                                                       .label = "stereo cells"}));
  }
  device_->updateTexture(cells_.id(), {.width = across, .height = rows}, cells.data());
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
    FOURDVT_ASSIGN(costs_target_,
                   gpu::makeTarget(*device_, {.colors = {costs_.id()}, .own_depth = true, .label = "stereo costs"}));
  }
  const std::vector<size_t> order = comparedOrder(cameras_.size(), reference.sources);
  std::vector<SweptCamera> swept;
  std::vector<glm::mat4> matrices;
  std::vector<glm::vec4> layers;
  for (size_t c : order) {
    swept.push_back({pixelFromReference(cameras_[c], reference.camera), &mattes_[c]});
    matrices.emplace_back(swept.back().pixel_from_reference);
    layers.emplace_back(float(c), float(cameras_[c].width), float(cameras_[c].height), 0);
  }
  std::vector<glm::vec4> front(size_t(region.width) * region.height);
  FOURDVT_TRY(device_->readPixels(front_target_.id(), gpu::PixelFormat::RGBA32F,
                                  {.width = region.width, .height = region.height}, front.data()));
  out.first_plane.resize(front.size());
  for (size_t i = 0; i < front.size(); ++i)
    out.first_plane[i] = front[i].x > 0 ? int(std::floor(front[i].x / options_.step_m)) : CostVolume::kNone;
  FOURDVT_TRY(uploadCells(openCells(swept, region, out.first_plane, blocks, options_.step_m), region));

  const glm::vec4 part(region.x, region.y, region.width, region.height);
  const glm::vec2 texel(1.0f / float(layer_width_), 1.0f / float(layer_height_));
  device_->beginPass({.target = costs_target_.id(),
                      .width = region.width,
                      .height = height,
                      .clear_depth = true,
                      .label = "stereo costs"});
  gpu::Draw outside;
  outside.program = outside_program_.id();
  outside.textures = {{"u_front", front_.id()}, {"u_cells", cells_.id()}};
  outside.uniforms = {gpu::uniform("u_region", part)};
  outside.vertex_count = 3;
  outside.depth_test = outside.depth_write = true;
  device_->draw(outside);
  gpu::Draw draw;
  draw.program = program;
  draw.textures = {{"u_pictures", pictures_.id()}, {"u_front", front_.id()}};
  draw.uniforms = {gpu::uniform("u_pixel_from_reference", std::span<const glm::mat4>(matrices)),
                   gpu::uniform("u_layers", std::span<const glm::vec4>(layers)), gpu::uniform("u_region", part),
                   gpu::uniform("u_texel", texel), gpu::uniform("u_step", options_.step_m)};
  draw.vertex_count = 3;
  draw.depth_test = true;
  device_->draw(draw);
  device_->endPass();

  std::vector<uint8_t> read(size_t(region.width) * height * 4);
  FOURDVT_TRY(device_->readPixels(costs_target_.id(), gpu::PixelFormat::RGBA8,
                                  {.width = region.width, .height = height}, read.data()));
  out.costs.resize(front.size() * out.labels);
  // Rows are read from the top: the last block is the topmost.
  const size_t block_bytes = front.size() * 4;
  for (int b = 0; b < blocks; ++b) {
    const uint8_t* from = read.data() + block_bytes * (blocks - 1 - b);
    for (size_t i = 0; i < front.size(); ++i) std::copy_n(from + 4 * i, 4, &out.costs[i * out.labels + 4 * b]);
  }
  return out;
}

namespace {

constexpr uint16_t kFar = 20000;     // exceeds all path costs
constexpr int kSameMinimum = 2;      // planes: labels this close to the best one are the same minimum
constexpr float kClearMargin = 254;  // margin over the second minimum, in a sum over eight directions, for weight 1
constexpr float kMinWeight = 0.05f;
using Path = std::array<uint16_t, kMaxLabels + 2>;  // label l at l + 1, kFar at both ends

struct PathState {
  Path costs{};
  uint16_t least = 0;
  int first_plane = CostVolume::kNone;
};

// One step along a path: shifts the state of `previous` to this pixel's planes and adds this pixel's costs.
void advance(const uint8_t* costs, int labels, int first_plane, const PathState& previous, int step_penalty,
             int jump_penalty, PathState& next, uint16_t* sums) {
  next.first_plane = first_plane;
  next.costs[0] = next.costs[labels + 1] = kFar;
  uint16_t least = kFar;
  if (previous.first_plane == CostVolume::kNone) {
    for (int l = 0; l < labels; ++l) next.costs[l + 1] = costs[l];
  } else {
    const int shift = first_plane - previous.first_plane;  // label l here is label l + shift there
    const uint16_t jump = uint16_t(previous.least + jump_penalty);
    Path shifted;
    const Path* from = &previous.costs;
    if (shift != 0) {
      for (int l = 0; l < labels + 2; ++l) {
        const int there = l + shift;
        shifted[l] = there < 1 || there > labels ? kFar : previous.costs[there];
      }
      from = &shifted;
    }
    const uint16_t* p = from->data();
    for (int l = 0; l < labels; ++l) {
      const uint16_t near = uint16_t(std::min(p[l], p[l + 2]) + step_penalty);
      const uint16_t best = std::min(std::min(p[l + 1], near), jump);
      next.costs[l + 1] = uint16_t(costs[l] + best - previous.least);
    }
  }
  for (int l = 0; l < labels; ++l) least = std::min(least, next.costs[l + 1]);
  next.least = least;
  for (int l = 0; l < labels; ++l) sums[l] = uint16_t(sums[l] + next.costs[l + 1]);
}

// Aggregates four directions: along the row, and from the three pixels of the previous row. `down`: rows from the top,
// else from the bottom (and columns from the right).
void scan(const CostVolume& volume, const SemiGlobalOptions& options, bool down, std::vector<uint16_t>& sums) {
  const int w = volume.width, h = volume.height, labels = volume.labels;
  sums.assign(volume.costs.size(), 0);
  std::vector<PathState> before[3], here[3];
  for (int k = 0; k < 3; ++k) before[k].resize(w + 2), here[k].resize(w + 2);
  for (int row = 0; row < h; ++row) {
    const int y = down ? row : h - 1 - row;
    PathState along[2];
    int now = 0;
    for (int column = 0; column < w; ++column) {
      const int x = down ? column : w - 1 - column;
      const size_t i = size_t(y) * w + x;
      const int first = volume.first_plane[i];
      if (first == CostVolume::kNone) {
        along[now].first_plane = CostVolume::kNone;
        for (int k = 0; k < 3; ++k) here[k][x + 1].first_plane = CostVolume::kNone;
        continue;
      }
      const uint8_t* costs = &volume.costs[i * labels];
      uint16_t* to = &sums[i * labels];
      advance(costs, labels, first, along[now], options.step_penalty, options.jump_penalty, along[1 - now], to);
      now = 1 - now;
      for (int k = 0; k < 3; ++k)
        advance(costs, labels, first, before[k][x + k], options.step_penalty, options.jump_penalty, here[k][x + 1], to);
    }
    for (int k = 0; k < 3; ++k) std::swap(before[k], here[k]);
  }
}

// Costs of a pixel, summed over all directions.
struct Sums {
  const uint8_t* costs = nullptr;  // costs without aggregation
  std::vector<int> sums;

  bool candidate(int label) const { return costs[label] != CostVolume::kOutside; }
  // Candidate with the minimum of sum plus `bias` per plane; -1: none.
  int best(int bias) const {
    int best = -1;
    for (int l = 0; l < int(sums.size()); ++l)
      if (candidate(l) && (best < 0 || sums[l] + l * bias < sums[best] + best * bias)) best = l;
    return best;
  }
  // Sub-label position of the minimum, planes, by two lines of equal slope.
  float offset(int label) const {
    if (label == 0 || label + 1 == int(sums.size())) return 0;
    const float before = float(sums[label - 1] - sums[label]), after = float(sums[label + 1] - sums[label]);
    const float steeper = std::max(before, after);
    return steeper > 0 ? std::clamp((before - after) / (2 * steeper), -0.5f, 0.5f) : 0;
  }
  float weight(int label, int bias) const {
    int rival = -1;
    for (int l = 0; l < int(sums.size()); ++l)
      if (std::abs(l - label) > kSameMinimum && candidate(l) &&
          (rival < 0 || sums[l] + l * bias < sums[rival] + rival * bias))
        rival = l;
    const float margin = rival < 0 ? 0 : float(sums[rival] + rival * bias - sums[label] - label * bias) / kClearMargin;
    const float match = 1 - float(costs[label]) / 254;
    return std::clamp(margin, kMinWeight, 1.0f) * match * match;
  }
};

}  // namespace

DepthMap semiGlobalDepth(const StereoReference& reference, const CostVolume& volume, const SemiGlobalOptions& options) {
  DepthMap out;
  out.camera = reference.camera;
  out.x = volume.x, out.y = volume.y, out.width = volume.width, out.height = volume.height;
  const int labels = volume.labels;
  std::vector<uint16_t> sums[2];
  inParallel(2, [&](int k) { scan(volume, options, k == 0, sums[k]); });
  const size_t pixels = volume.first_plane.size();
  out.depth_m.assign(pixels, 0), out.weight.assign(pixels, 0), out.front_m.assign(pixels, 0);
  Sums pixel;
  pixel.sums.resize(labels);
  for (size_t i = 0; i < pixels; ++i) {
    const int first = volume.first_plane[i];
    if (first == CostVolume::kNone) continue;
    out.front_m[i] = (float(first) + 0.5f) * volume.step_m;
    pixel.costs = &volume.costs[i * labels];
    for (int l = 0; l < labels; ++l) pixel.sums[l] = sums[0][i * labels + l] + sums[1][i * labels + l];
    const int best = pixel.best(options.front_bias);
    if (best < 0) continue;
    out.depth_m[i] = (float(first + best) + pixel.offset(best)) * volume.step_m;
    out.weight[i] = pixel.weight(best, options.front_bias);
  }
  return out;
}

float depthAt(const DepthMap& map, double x, double y) {
  const double column = std::floor(x) - map.x, row = std::floor(y) - map.y;
  if (!(column >= 0 && row >= 0 && column < map.width && row < map.height)) return 0;
  return map.depth_m[size_t(row) * map.width + size_t(column)];
}

namespace {

constexpr float kSlopeReach = 2;                 // pixels, for the slope estimate
constexpr float kOtherSurface_m = 0.1f;          // minimum difference between depths of separate surfaces
constexpr double kChance = 0.78, kSound = 0.92;  // shares of confirmed depths: by chance; with correct calibration
constexpr float kEdgeCosine = 0.2f;              // cosine assumed at such a discontinuity

// Squared cosine between normal and ray at a pixel, from neighbouring depths.
float facing(const DepthMap& map, int x, int y) {
  const int reach = int(kSlopeReach);
  if (x < reach || y < reach || x + reach >= map.width || y + reach >= map.height) return kEdgeCosine * kEdgeCosine;
  const float* at = &map.depth_m[size_t(y) * map.width + x];
  const float left = at[-reach], right = at[reach], up = at[-reach * map.width], down = at[reach * map.width];
  const float low = std::min(std::min(left, right), std::min(up, down)),
              high = std::max(std::max(left, right), std::max(up, down));
  if (low <= 0 || high - low > kOtherSurface_m) return kEdgeCosine * kEdgeCosine;
  const float pixel_m = 2 * kSlopeReach * *at / float(map.camera.fx);
  const float across = (right - left) / pixel_m, along = (down - up) / pixel_m;
  return 1 / (1 + across * across + along * along);
}

// Confidence of a whole map: depths of a miscalibrated camera are refuted about as often as confirmed.
float believedOf(double confirmed, double refuted) {
  if (confirmed <= 0) return 0;
  const double share = confirmed / (confirmed + refuted);
  return float(std::clamp((share - kChance) / (kSound - kChance), 0.0, 1.0));
}

}  // namespace

void weighByAngle(DepthMap& map) {
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const size_t i = size_t(y) * map.width + x;
      if (map.depth_m[i] > 0) map.weight[i] *= facing(map, x, y);
    }
}

void keepConsistent(std::span<DepthMap> maps, double tolerance_m) {
  std::vector<std::vector<float>> weights(maps.size());
  std::vector<glm::dmat4> world_from_cam;
  for (const DepthMap& map : maps) world_from_cam.push_back(glm::inverse(map.camera.cam_from_world));
  inParallel(maps.size(), [&](int m) {
    const DepthMap& map = maps[m];
    weights[m].assign(map.depth_m.size(), 0);
    double confirmed = 0, refuted = 0;
    for (size_t i = 0; i < map.depth_m.size(); ++i) {
      const double z = map.depth_m[i];
      if (z <= 0) continue;
      const double x = map.x + double(i % map.width) + 0.5, y = map.y + double(i / map.width) + 0.5;
      const glm::dvec3 point(world_from_cam[m] * glm::dvec4((x - map.camera.cx) / map.camera.fx * z,
                                                            (y - map.camera.cy) / map.camera.fy * z, z, 1));
      int agree = 0, against = 0;
      for (size_t o = 0; o < maps.size(); ++o) {
        if (int(o) == m) continue;
        const glm::dvec3 p = maps[o].camera.project(point);
        if (p.z <= 0) continue;
        const float there = depthAt(maps[o], p.x, p.y);
        if (there <= 0) continue;
        agree += std::abs(there - p.z) < tolerance_m;
        against += there > p.z + 2 * tolerance_m;
      }
      if (agree > 0 && agree >= against) {
        confirmed += map.weight[i];
        weights[m][i] = map.weight[i] * float(agree) / float(agree + against);
      } else if (against > 0) {
        refuted += map.weight[i];
      }
    }
    const float believed = believedOf(confirmed, refuted);
    for (float& weight : weights[m]) weight *= believed;
  });
  for (size_t m = 0; m < maps.size(); ++m)
    for (size_t i = 0; i < weights[m].size(); ++i) {
      maps[m].weight[i] = weights[m][i];
      if (weights[m][i] <= 0) maps[m].depth_m[i] = 0;
    }
}

}  // namespace fourdvt::reconstruct
