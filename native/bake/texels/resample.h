// SPDX-License-Identifier: Apache-2.0
// Resamples camera pictures into texture layers in UV space on the GPU, by the labels. Unseen texels stay empty
// (fill.h).
#pragma once

#include "bake/texels/colour_calibration.h"
#include "bake/texels/gpu_capture.h"

namespace fourdvt::bake {

// Mipmap: trilinear. Bicubic: Catmull-Rom; background pixels have no weight. Bilinear and Bicubic use mipmaps only
// where texels span more than two pixels and the capture has them.
enum class ResampleFilter { Bilinear, Mipmap, Bicubic };

// Defaults by held-out SSIM / PSNR on the sample (run and walk, three layers, labels by penalty, no codec).
// Filter at 1024 texels, before the mesh was refined: bilinear .7733 / 22.52 dB, bicubic .7755 / 22.50, mipmap .7681 /
// 22.51; at 2048: .7797 / 22.53, .7797 / 22.49, .7796 / 22.54. algorithms/texels.md has those of the refined mesh.
// Contour 0, 1, 1.5, 2, 3 px: .7731, .7734, .7733, .7733, .7730. Matte .5 → .9: +.0002; its distance 0, 1, 2, 3 px:
// .7722, .7728, .7733, .7733. Contour step 20 → 10 mm: -.0001. Without kMinCosine: .7711.
struct ResampleOptions {
  ResampleFilter filter = ResampleFilter::Bicubic;
  float contour_pixels = 1;      // minimum distance of a texel from an occlusion boundary
  float contour_step_m = 0.02f;  // depth step, beyond the surface's own slope, that forms an occlusion boundary
  float matte_threshold = 0.9f;  // coverage below which a texel is background, 0..1
  float matte_pixels = 2;        // minimum distance of a texel from background
};

class Resampler {
 public:
  // sizes: side of each layer in texels. colour_maps: one per camera, applied to straight colour; empty: uncorrected.
  // Errors: GpuFailure, InvalidArgument.
  static Result<Resampler> create(gpu::Device& device, const GpuCapture& capture, const std::vector<int>& sizes,
                                  const ResampleOptions& options, const std::vector<ColourMap>& colour_maps);
  // labels: [layer][face]. Returns [layer], RGBA, with alpha 255 where resampled, else 0; row 0 is the first row of
  // UVs.
  Result<std::vector<Image>> resample(gpu::Device& device, const GpuCapture& capture,
                                      const std::vector<uint8_t>& labels);
  // Pictures of single cameras: [camera], RGBA of layer `l`'s size, with alpha rank + 1 where the camera shows the
  // texel, else 0. order: [rank][face], at most 254 ranks; package::kNoCamera: no camera.
  Result<std::vector<Image>> resampleByRank(gpu::Device& device, const GpuCapture& capture, size_t l,
                                            const std::vector<uint8_t>& order);
  size_t layerCount() const { return layers_.size(); }
  int layerSize(size_t l) const { return layers_[l].size; }

 private:
  struct Layer {
    int size = 0;
    gpu::Texture texture;
    gpu::Target target;
  };
  struct Batch {  // faces of one row of labels and one camera: a range of the face list
    size_t camera = 0;
    int first = 0, count = 0;
    float mark = 1;  // alpha written to the texels
  };
  // Appends to the face list the faces whose label is `camera`.
  Batch listFaces(const uint8_t* labels, size_t faces, size_t camera);
  void uploadList(gpu::Device& device);
  void drawBatches(gpu::Device& device, const GpuCapture& capture, const Layer& layer,
                   const std::vector<Batch>& batches) const;
  Result<Image> readLayer(gpu::Device& device, const Layer& layer) const;

  ResampleOptions options_;
  std::vector<glm::mat4> colour_maps_;  // [camera]
  gpu::Program program_;
  gpu::Texture face_list_;
  std::vector<Layer> layers_;
  std::vector<uint32_t> list_;
};

// Custom rule that resamples the layers of one frame. order: [rank][face], all cameras by penalty, package::kNoCamera
// after the last.
using TexelRule = Result<std::vector<Image>> (*)(Resampler& resampler, gpu::Device& device, const GpuCapture& capture,
                                                 const std::vector<uint8_t>& order);

}  // namespace fourdvt::bake
