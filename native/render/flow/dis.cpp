// SPDX-License-Identifier: Apache-2.0
// Dense inverse search. Till Kroeger, Radu Timofte, Dengxin Dai, Luc Van Gool: Fast Optical Flow Using Dense Inverse
// Search. European Conference on Computer Vision (ECCV), 2016. Levels run from coarse to fine. Each level: blur and
// shrink both pictures (2 passes), take slopes, search twice (from the coarser flow, then from the neighbouring
// patches), densify.
#include <algorithm>
#include <cmath>

#include "render/flow/gpu_flow.h"

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;
constexpr int kPatch = 8, kStride = 4;  // pixels, as in the shaders
constexpr int kIterations = 5;          // maximum per search

struct SearchLevel {
  FlowBuffer slopes, first, second, flow;
  ShrunkPair luma;
};

// Start of a search; uniforms of flow_dis_search.frag.
struct Start {
  gpu::TextureId flow;
  glm::vec4 place;
  float gain;
};

class Dis final : public FlowMethodPasses {
 public:
  explicit Dis(const FlowOptions& options) : options_(options), finest_(options.finest) {}

  Status makePrograms(gpu::Device& device) {
    FOURDVT_TRY(makeFlowProgram(device, "flow_shrink.frag", shrink_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_dis_slopes.frag", slopes_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_dis_search.frag", search_));
    return makeFlowProgram(device, "flow_dis_densify.frag", densify_);
  }

  Status resize(gpu::Device& device, int width, int height) override {
    // OpenCV's coarsest octave: motion up to a quarter of the longer side, and at least one patch fits.
    const int longest = std::max(width, height), shortest = std::min(width, height);
    int coarsest = 0;
    while (longest * M_SQRT1_2 >= (4 * kPatch << coarsest) && shortest >= (2 * kPatch << coarsest)) ++coarsest;
    if (shortest < kPatch) return Error{ErrorId::InvalidArgument, "flow: pictures of at least 8 x 8 pixels"};
    finest_ = std::min(options_.finest, coarsest);
    count_ = coarsest - finest_ + 1;
    levels_ = std::make_unique<SearchLevel[]>(count_);
    for (int k = 0; k < count_; ++k)
      FOURDVT_TRY(makeLevel(device, width, height, std::ldexp(1.0, -finest_ - k), levels_[k]));
    return makeFlowBuffer(device, 1, 1, {PixelFormat::RG16F}, still_);
  }

  RawFlow run(gpu::Device& device, gpu::TextureId pictures) override {
    device.beginPass({.target = still_.target.id(), .clear_color = true, .label = "flow start"});
    device.endPass();
    gpu::TextureId flow = still_[0];
    for (int k = count_; k-- > 0; flow = levels_[k].flow[0]) refine(device, levels_[k], pictures, flow);
    return {flow, std::ldexp(1.0f, finest_)};
  }

 private:
  static Status makeLevel(gpu::Device& device, int width, int height, double scale, SearchLevel& level) {
    const int w = static_cast<int>(width * scale), h = static_cast<int>(height * scale);
    const int columns = 1 + (w - kPatch) / kStride, rows = 1 + (h - kPatch) / kStride;
    constexpr auto kTwo = PixelFormat::RG16F;
    FOURDVT_TRY(level.luma.resize(device, {width, height}, {w, h}, scale));
    FOURDVT_TRY(makeFlowBuffer(device, w, h, {PixelFormat::RGBA16F}, level.slopes));
    FOURDVT_TRY(makeFlowBuffer(device, columns, rows, {kTwo}, level.first));
    FOURDVT_TRY(makeFlowBuffer(device, columns, rows, {kTwo}, level.second));
    return makeFlowBuffer(device, w, h, {kTwo}, level.flow);
  }

  void search(gpu::Device& device, const SearchLevel& level, const Start& start, const FlowBuffer& to) const {
    runFlowPass(device, search_.id(), to.target.id(), {{"u_slopes", level.slopes[0]}, {"u_start", start.flow}},
                {gpu::uniform("u_place", start.place), gpu::uniform("u_gain", start.gain),
                 gpu::uniform("u_iterations", kIterations)});
  }

  void refine(gpu::Device& device, const SearchLevel& level, gpu::TextureId pictures, gpu::TextureId start) const {
    level.luma.draw(device, shrink_, pictures);
    runFlowPass(device, slopes_.id(), level.slopes.target.id(), {{"u_luma", level.luma.texture()}}, {});
    // The first search starts from the coarser flow at the middle of the patch, the second from the patch's own flow.
    const glm::vec2 pixel(1.0f / level.flow.width, 1.0f / level.flow.height);
    const glm::vec2 patch(1.0f / level.first.width, 1.0f / level.first.height);
    const float to_middle = kPatch / 2 - kStride * 0.5f;
    search(device, level, {start, glm::vec4(float(kStride) * pixel, to_middle * pixel), 2}, level.first);
    search(device, level, {level.first[0], glm::vec4(patch, 0, 0), 1}, level.second);
    runFlowPass(device, densify_.id(), level.flow.target.id(),
                {{"u_slopes", level.slopes[0]}, {"u_patches", level.second[0]}}, {});
  }

  const FlowOptions options_;
  gpu::Program shrink_, slopes_, search_, densify_;
  int finest_;
  std::unique_ptr<SearchLevel[]> levels_;  // count_; finest first
  int count_ = 0;
  FlowBuffer still_;  // zero flow
};

}  // namespace

Result<std::unique_ptr<FlowMethodPasses>> createDis(gpu::Device& device, const FlowOptions& options) {
  auto dis = std::make_unique<Dis>(options);
  FOURDVT_TRY(dis->makePrograms(device));
  return std::unique_ptr<FlowMethodPasses>(std::move(dis));
}

}  // namespace fourdvt::render
