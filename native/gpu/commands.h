// SPDX-License-Identifier: Apache-2.0
// Descriptions of textures, targets, draws and passes for a device (gpu/device.h); its capabilities and counters.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"

namespace fourdvt::gpu {

enum class PixelFormat { R8, RG8, RGBA8, R32UI, RG32F, RGBA32F, R32F, Depth24, RG16F, RGBA16F };
int bytesPerPixel(PixelFormat format);
int readBytesPerPixel(PixelFormat format);  // in Device::readPixels

enum class Filter { Nearest, Linear, LinearMipmap };

struct TextureDesc {
  PixelFormat format = PixelFormat::RGBA8;
  int width = 1, height = 1;
  int layers = 0;                   // 0: TEXTURE_2D, otherwise TEXTURE_2D_ARRAY of this many layers
  Filter filter = Filter::Nearest;  // integer and 32F formats: Nearest only. LinearMipmap: requires generateMipmaps
  // Allows foreign code to respecify the storage through the context's own name (nativeTexture); 2D only.
  bool respecifiable = false;
  const char* label = "";
};

// Handles are borrowed names, freed by the RAII owners of gpu/device.h. 0 is "none".
using TextureId = uint32_t;
using ProgramId = uint32_t;
using TargetId = uint32_t;
using ReadId = uint32_t;
using IndexBufferId = uint32_t;
constexpr TargetId kDefaultTarget = 0;  // the context's own framebuffer (the canvas); absent natively

struct TargetDesc {
  // Either existing textures (no multisampling) …
  std::vector<TextureId> colors;
  TextureId depth = 0;  // a Depth24 texture, readable by later passes
  int color_layer = 0;  // layer of array textures
  int depth_layer = 0;  // layer of `depth`
  // … or own renderbuffers, RGBA8 + depth, with `samples` > 1 (resolved by blit).
  int width = 0, height = 0, samples = 0;
  bool own_depth = false;  // a depth renderbuffer owned by the target
  const char* label = "";
};

enum class Blend { None, PremultipliedOver };
enum class Cull { None, Back };

struct TextureBinding {
  const char* sampler;
  TextureId texture;
};

struct Uniform {
  enum class Kind { Int, UInt, Float, Vec2, Vec3, Vec4, Mat4 };
  const char* name;
  Kind kind;
  int count;         // array length; 1 for a plain uniform
  const void* data;  // borrowed until draw() returns
};
inline Uniform uniform(const char* name, const int& v) { return {name, Uniform::Kind::Int, 1, &v}; }
inline Uniform uniform(const char* name, const uint32_t& v) { return {name, Uniform::Kind::UInt, 1, &v}; }
inline Uniform uniform(const char* name, const float& v) { return {name, Uniform::Kind::Float, 1, &v}; }
inline Uniform uniform(const char* name, const glm::vec2& v) { return {name, Uniform::Kind::Vec2, 1, &v}; }
inline Uniform uniform(const char* name, const glm::vec3& v) { return {name, Uniform::Kind::Vec3, 1, &v}; }
inline Uniform uniform(const char* name, const glm::vec4& v) { return {name, Uniform::Kind::Vec4, 1, &v}; }
inline Uniform uniform(const char* name, const glm::mat4& v) { return {name, Uniform::Kind::Mat4, 1, &v}; }
inline Uniform uniform(const char* name, std::span<const glm::vec4> v) {
  return {name, Uniform::Kind::Vec4, static_cast<int>(v.size()), v.data()};
}
inline Uniform uniform(const char* name, std::span<const glm::mat4> v) {
  return {name, Uniform::Kind::Mat4, static_cast<int>(v.size()), v.data()};
}

struct Draw {
  ProgramId program = 0;
  std::vector<TextureBinding> textures;
  std::vector<Uniform> uniforms;  // names missing in the program are ignored
  int vertex_count = 0;           // triangles: 3 per triangle, gl_VertexID counts from 0 …
  IndexBufferId indices = 0;      // … or is taken from the first vertex_count indices; equal indices are shaded once
  bool depth_test = false, depth_write = false;
  Blend blend = Blend::None;
  Cull cull = Cull::None;
};

struct Pass {
  TargetId target = kDefaultTarget;
  // Viewport, GL convention (y up from the bottom); clears are limited to it. May exceed the target, which then holds a
  // part of the picture. 0 × 0: the whole target (not for the default one).
  int x = 0, y = 0, width = 0, height = 0;
  bool clear_color = false, clear_depth = false;
  glm::vec4 color{0};
  const char* label = "";
};

struct Caps {
  int max_texture_size = 0, max_samples = 0;
  bool float_targets = false;       // R32F, RG32F, RGBA32F renderable
  bool half_float_targets = false;  // RG16F, RGBA16F renderable
  std::string renderer;
};

struct Counters {  // since creation or resetCounters
  uint64_t draws = 0, vertices = 0, passes = 0, texture_updates = 0, uploaded_bytes = 0;
  uint64_t live_textures = 0, live_texture_bytes = 0, live_programs = 0, live_targets = 0;
  uint64_t live_target_bytes = 0;  // renderbuffers owned by targets, with all samples
  uint64_t live_index_buffers = 0;
};

// Rectangle in pixels. In memory y counts from the top row, in a target from the bottom one, as in GL.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
};

}  // namespace fourdvt::gpu
