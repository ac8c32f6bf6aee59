// SPDX-License-Identifier: Apache-2.0
// Polynomial-expansion flow. Gunnar Farnebäck: Two-Frame Motion Estimation Based on Polynomial Expansion. Scandinavian
// Conference on Image Analysis (SCIA), 2003. Levels run from coarse to fine. Each level: blur and shrink both pictures
// (2 passes), expand (2 passes), then iterate (3 passes each): matrices, average along x, average along y and solve.
#include <array>
#include <cmath>

#include "render/flow/gpu_flow.h"

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;
constexpr int kMinSide = 32;  // pixels; OpenCV's
constexpr int kMaxTaps = 8;   // size of u_taps: poly_n 7 and the centre

// Weights of the polynomial expansion and the required entries of the inverse moments (OpenCV's names).
struct Expansion {
  std::array<glm::vec4, kMaxTaps> taps{};
  glm::vec4 inverse{0};  // 11, 03, 33, 55
};

Expansion makeExpansion(int side, double sigma) {
  std::array<double, kMaxTaps> g{};
  double sum = 0;
  for (int x = 0; x <= side; ++x) sum += (g[x] = std::exp(-x * x / (2 * sigma * sigma))) * (x ? 2 : 1);
  double second = 0, fourth = 0;
  Expansion out;
  for (int x = 0; x <= side; ++x) {
    g[x] /= sum;
    second += 2 * g[x] * x * x;
    fourth += 2 * g[x] * x * x * x * x;
    out.taps[x] = glm::vec4(g[x], x * g[x], x * x * g[x], 0);
  }
  // Moments of 1, x², y²: [[1, s, s], [s, f, s²], [s, s², f]]; the rest is diagonal.
  const double mixed = second * second, determinant = fourth + mixed - 2 * second * second;
  out.inverse = glm::vec4(1 / second, -second / determinant, 0.5 * (1 / (fourth - mixed) + 1 / determinant), 1 / mixed);
  return out;
}

struct ExpansionLevel {
  FlowBuffer wide, expansion, average, flow;
  ShrunkPair luma;
};

class Farneback final : public FlowMethodPasses {
 public:
  explicit Farneback(const FlowOptions& options)
      : options_(options), expansion_(makeExpansion(options.poly_n, options.poly_sigma)) {}

  Status makePrograms(gpu::Device& device) {
    FOURDVT_TRY(makeFlowProgram(device, "flow_shrink.frag", shrink_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_expand_down.frag", expand_down_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_expand_across.frag", expand_across_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_matrices.frag", matrices_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_average.frag", average_));
    return makeFlowProgram(device, "flow_solve.frag", solve_);
  }

  Status resize(gpu::Device& device, int width, int height) override {
    count_ = 1;
    while (count_ <= options_.levels && std::ldexp(std::min(width, height), -count_) >= kMinSide) ++count_;
    levels_ = std::make_unique<ExpansionLevel[]>(count_);
    for (int k = 0; k < count_; ++k) FOURDVT_TRY(makeLevel(device, width, height, std::ldexp(1.0, -k), levels_[k]));
    return makeFlowBuffer(device, 1, 1, {PixelFormat::RG16F}, still_);
  }

  RawFlow run(gpu::Device& device, gpu::TextureId pictures) override {
    device.beginPass({.target = still_.target.id(), .clear_color = true, .label = "flow start"});
    device.endPass();
    gpu::TextureId flow = still_[0];
    for (int k = count_; k-- > 0; flow = levels_[k].flow[0]) {
      const ExpansionLevel& level = levels_[k];
      expand(device, level, pictures);
      for (int i = 0; i < options_.iterations; ++i)
        iterate(device, level, i == 0 ? flow : level.flow[0], i == 0 ? 2.0f : 1.0f);
    }
    return {flow, 1};
  }

 private:
  static Status makeLevel(gpu::Device& device, int width, int height, double scale, ExpansionLevel& level) {
    const int w = static_cast<int>(std::lrint(width * scale)), h = static_cast<int>(std::lrint(height * scale));
    constexpr auto kTwo = PixelFormat::RG16F, kFour = PixelFormat::RGBA16F;
    FOURDVT_TRY(level.luma.resize(device, {width, height}, {w, h}, scale));
    FOURDVT_TRY(makeFlowBuffer(device, w, h, {kFour, kFour}, level.wide));
    FOURDVT_TRY(makeFlowBuffer(device, w, h, {kFour, kFour, kTwo}, level.expansion));
    FOURDVT_TRY(makeFlowBuffer(device, w, h, {kFour, kTwo}, level.average));
    return makeFlowBuffer(device, w, h, {kTwo}, level.flow);
  }

  void expand(gpu::Device& device, const ExpansionLevel& level, gpu::TextureId pictures) const {
    level.luma.draw(device, shrink_, pictures);
    const gpu::Uniform taps = gpu::uniform("u_taps", std::span<const glm::vec4>(expansion_.taps));
    const gpu::Uniform side = gpu::uniform("u_side", options_.poly_n);
    runFlowPass(device, expand_down_.id(), level.wide.target.id(), {{"u_luma", level.luma.texture()}}, {taps, side});
    runFlowPass(device, expand_across_.id(), level.expansion.target.id(),
                {{"u_a", level.wide[0]}, {"u_b", level.wide[1]}},
                {taps, side, gpu::uniform("u_inverse", expansion_.inverse)});
  }

  void iterate(gpu::Device& device, const ExpansionLevel& level, gpu::TextureId flow, float gain) const {
    runFlowPass(
        device, matrices_.id(), level.wide.target.id(),
        {{"u_a", level.expansion[0]}, {"u_b", level.expansion[1]}, {"u_mixed", level.expansion[2]}, {"u_flow", flow}},
        {gpu::uniform("u_gain", gain)});
    const gpu::Uniform window = gpu::uniform("u_window", options_.window);
    runFlowPass(device, average_.id(), level.average.target.id(),
                {{"u_first", level.wide[0]}, {"u_second", level.wide[1]}},
                {window, gpu::uniform("u_step", glm::vec2(1.0f / level.flow.width, 0))});
    runFlowPass(device, solve_.id(), level.flow.target.id(),
                {{"u_first", level.average[0]}, {"u_second", level.average[1]}},
                {window, gpu::uniform("u_step", glm::vec2(0, 1.0f / level.flow.height))});
  }

  const FlowOptions options_;
  const Expansion expansion_;
  gpu::Program shrink_, expand_down_, expand_across_, matrices_, average_, solve_;
  std::unique_ptr<ExpansionLevel[]> levels_;  // count_; [0]: the full size
  int count_ = 0;
  FlowBuffer still_;  // zero flow
};

}  // namespace

Result<std::unique_ptr<FlowMethodPasses>> createFarneback(gpu::Device& device, const FlowOptions& options) {
  auto farneback = std::make_unique<Farneback>(options);
  FOURDVT_TRY(farneback->makePrograms(device));
  return std::unique_ptr<FlowMethodPasses>(std::move(farneback));
}

}  // namespace fourdvt::render
