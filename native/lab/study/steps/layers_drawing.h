// SPDX-License-Identifier: Apache-2.0
// Draws layers without encoding: all of one size, side by side in one RGBA picture.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bake/run/job.h"
#include "gpu/device.h"
#include "render/plain_figure.h"
#include "render/still_target.h"

namespace fourdvt::study {

class LayerDrawing {
 public:
  // `job` is borrowed. Errors: GpuFailure.
  static Result<std::unique_ptr<LayerDrawing>> create(gpu::Device& device, const bake::Job& job, int size,
                                                      int max_layers);
  // Sets the geometry and the labels, [layer][face] for exactly `layers` layers. Vertices in decoded order.
  Status setGeometry(const Positions& positions, const std::vector<uint8_t>& labels, int layers);
  // Sets layers 0..n-1, RGBA or RGB of `size`².
  Status show(const std::vector<Image>& layers);
  // RGBA straight alpha. Errors: GpuFailure.
  Result<Image> draw(const PinholeCamera& camera, int layers);
  // Bytes of a player's textures for this many layers: the model's tables and one decoded 4:2:0 picture.
  Result<uint64_t> gpuBytes(int layers);

 private:
  LayerDrawing(gpu::Device& device, const bake::Job& job, int size)
      : device_(device), job_(job), size_(size), still_(device) {}
  Result<render::PlainFigure*> figureOf(int layers);

  gpu::Device& device_;
  const bake::Job& job_;
  int size_, max_layers_ = 0;
  std::unique_ptr<render::Recipe> recipe_;
  std::map<int, render::PlainFigure> figures_;  // by number of layers
  render::PictureTextures picture_;
  render::StillTarget still_;
};

// Reference, picture and |difference| × 4 as a heat map, side by side and cropped to the performer. RGB.
Image errorMap(const Image& reference, const Image& picture);

}  // namespace fourdvt::study
