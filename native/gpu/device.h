// SPDX-License-Identifier: Apache-2.0
// The GPU as fourdvt sees it: textures, index lists, programs, targets and draws, on GLES 3.0 = WebGL2.
//
// Does: own resources (move-only handles), cache uniform locations and state, count calls and bytes, label everything.
// Does NOT: own the context (platform/egl_context or the page does), use vertex buffers (vertices are pulled with
// texelFetch and gl_VertexID, which is a draw's index if it has indices), know about characters.
// Order of calls: create resources → beginPass → draw… → endPass. updateTexture and updateIndices are legal
// outside passes only.
// Row order: memory row 0 of an updated texture is the picture's top row and is stored as GL row 0, so shaders sample
// with v down (glTF). Targets are drawn y-up as GL does; readPixels returns the TOP row first.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::gpu {

enum class PixelFormat { R8, RG8, RGBA8, R32UI, RG32F, RGBA32F, R32F, Depth24, RG16F, RGBA16F };
int bytesPerPixel(PixelFormat format);
int readBytesPerPixel(PixelFormat format);  // of Device::readPixels

enum class Filter { Nearest, Linear, LinearMipmap };

struct TextureDesc {
  PixelFormat format = PixelFormat::RGBA8;
  int width = 1, height = 1;
  int layers = 0;                   // 0: TEXTURE_2D, otherwise TEXTURE_2D_ARRAY of this many layers
  Filter filter = Filter::Nearest;  // integer and 32F formats: Nearest only. LinearMipmap: call generateMipmaps
  // Its storage may be specified anew by foreign code that has the context's own name (nativeTexture); 2D only.
  bool respecifiable = false;
  const char* label = "";
};

// Handles are borrowed names; the RAII owners below free them. 0 is "none".
using TextureId = uint32_t;
using ProgramId = uint32_t;
using TargetId = uint32_t;
using ReadId = uint32_t;
using IndexBufferId = uint32_t;
constexpr TargetId kDefaultTarget = 0;  // the context's own framebuffer (the canvas); absent natively

struct TargetDesc {
  // Either: draw into existing textures (no multisampling) …
  std::vector<TextureId> colors;
  TextureId depth = 0;  // a Depth24 texture, which later passes can read
  int color_layer = 0;  // for array textures
  int depth_layer = 0;  // likewise, of `depth`
  // … or: own renderbuffers, RGBA8 + depth, with `samples` > 1 (resolved by blit).
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
  std::vector<Uniform> uniforms;  // names the program does not use are ignored
  int vertex_count = 0;           // triangles: 3 per triangle, gl_VertexID counts from 0 …
  IndexBufferId indices = 0;      // … or is what the first vertex_count of these say; equal ones are shaded once
  bool depth_test = false, depth_write = false;
  Blend blend = Blend::None;
  Cull cull = Cull::None;
};

struct Pass {
  TargetId target = kDefaultTarget;
  // Viewport, GL convention (y up from the bottom); clears touch only it. It may reach beyond the target, which then
  // holds a part of the picture. 0 × 0: the whole target (not the default one).
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

struct Counters {  // since creation, or since resetCounters
  uint64_t draws = 0, vertices = 0, passes = 0, texture_updates = 0, uploaded_bytes = 0;
  uint64_t live_textures = 0, live_texture_bytes = 0, live_programs = 0, live_targets = 0;
  uint64_t live_target_bytes = 0;  // of renderbuffers that targets own, with all samples
  uint64_t live_index_buffers = 0;
};

// A rectangle in pixels. Of memory: y counts from the top row; of a target: from the bottom one, as GL does.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
};

class Device {
 public:
  virtual ~Device() = default;
  virtual const Caps& caps() const = 0;
  virtual Result<TextureId> createTexture(const TextureDesc& desc) = 0;
  // Replaces a region. stride_bytes: from row to row, 0 if they are tightly packed. layer: of an array texture.
  virtual void updateTexture(TextureId texture, const Region& region, const void* pixels, int stride_bytes = 0,
                             int layer = 0) = 0;
  virtual void generateMipmaps(TextureId texture) = 0;
  virtual void destroyTexture(TextureId texture) = 0;
  virtual IndexBufferId createIndexBuffer() = 0;                                            // without indices
  virtual void updateIndices(IndexBufferId buffer, std::span<const uint32_t> indices) = 0;  // replaces all
  virtual void destroyIndexBuffer(IndexBufferId buffer) = 0;
  // GLSL ES 3.00 texts without the #version line; `defines` ("LAYERS 3\n…", one per line, no "#define") go first,
  // then highp as the default precision. Programs of the same texts are one, which is compiled once and destroyed as often
  // as it was created. Error: GpuFailure with the label and the compiler's log.
  virtual Result<ProgramId> createProgram(std::string_view label, std::string_view vertex_text,
                                          std::string_view fragment_text, std::string_view defines = {}) = 0;
  virtual void destroyProgram(ProgramId program) = 0;
  virtual Result<TargetId> createTarget(const TargetDesc& desc) = 0;
  virtual void destroyTarget(TargetId target) = 0;
  virtual void beginPass(const Pass& pass) = 0;
  virtual void draw(const Draw& draw) = 0;
  virtual void endPass() = 0;
  // Copies the colour of `from` at (0,0) into `region` of `to`; formats must be the same. A multisampled `from` is
  // resolved, to (0,0) only (a canvas: alpha, no antialias), and loses what it held: clear it before drawing.
  virtual void blit(TargetId from, TargetId to, const Region& region) = 0;
  // Reads colour attachment 0 as stored (RGBA8: 4 bytes; RGBA32F: 16; R32UI: 4 with `format`), top row first. 16F
  // formats are read as 32-bit floats.
  virtual Status readPixels(TargetId target, PixelFormat format, const Region& region, void* out) = 0;
  // Starts to copy a rectangle of an RGBA8 target out, as readPixels would, without waiting for the GPU. 0: refused.
  virtual ReadId beginRead(TargetId target, const Region& region) = 0;
  // True once the copy is there: it is written to `out` and forgotten. out null: it is forgotten, at once.
  virtual bool endRead(ReadId read, void* out) = 0;
  // The context's own name of a texture (GLuint), for edges that upload video frames themselves.
  virtual uint32_t nativeTexture(TextureId texture) const = 0;
  // Drops cached GL state after foreign code touched the context.
  virtual void invalidateState() = 0;
  virtual const Counters& counters() const = 0;
  virtual void resetCounters() = 0;  // live_… keep their values
  // Misuse seen since the last call, one line per case; empty: none. A misused call is dropped. Slow on GLES
  // (glGetError).
  virtual std::string takeErrors() = 0;
};

// Needs a current GLES 3.0 / WebGL2 context. Only gles_*.cpp call gl*.
Result<std::unique_ptr<Device>> createGlesDevice();
// Draws nothing, but validates handles, sizes, the order of passes and counts. float_targets: of both kinds in Caps.
std::unique_ptr<Device> createNullDevice(bool float_targets = true);

// Move-only owners.
template <void (Device::*Destroy)(uint32_t)>
class Owned {
 public:
  Owned() = default;
  Owned(Device& device, uint32_t id) : device_(&device), id_(id) {}
  Owned(Owned&& o) noexcept : device_(o.device_), id_(o.id_) { o.id_ = 0; }
  Owned& operator=(Owned&& o) noexcept {
    if (this != &o) {
      reset();
      device_ = o.device_;
      id_ = o.id_;
      o.id_ = 0;
    }
    return *this;
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() { reset(); }
  void reset() {
    if (id_) (device_->*Destroy)(id_);
    id_ = 0;
  }
  uint32_t id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

 private:
  Device* device_ = nullptr;
  uint32_t id_ = 0;
};
using Texture = Owned<&Device::destroyTexture>;
using Program = Owned<&Device::destroyProgram>;
using Target = Owned<&Device::destroyTarget>;
using IndexBuffer = Owned<&Device::destroyIndexBuffer>;

Result<Texture> makeTexture(Device& device, const TextureDesc& desc);
Result<Program> makeProgram(Device& device, std::string_view label, std::string_view vertex_text,
                            std::string_view fragment_text, std::string_view defines = {});
Result<Target> makeTarget(Device& device, const TargetDesc& desc);
IndexBuffer makeIndexBuffer(Device& device);

// Embedded shader files (shaders/gles/NAME, e.g. "layered.vert"); empty if there is none. `#include "x.glsl"` lines
// are expanded at build time by the embedding script.
std::string_view shaderText(std::string_view name);

}  // namespace fourdvt::gpu
