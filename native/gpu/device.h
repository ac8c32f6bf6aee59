// SPDX-License-Identifier: Apache-2.0
// GPU abstraction: textures, index lists, programs, targets and draws, on GLES 3.0 = WebGL2.
//
// Owns resources (move-only handles), checks every call, counts calls and bytes, labels everything. Misuse is recorded
// (takeErrors) and the call dropped, so that all devices accept the same calls. The context belongs to
// platform/egl_context or the page. There are no vertex buffers: vertices are pulled with texelFetch and gl_VertexID,
// which is the index in draws with indices.
// Order of calls: create resources → beginPass → draw… → endPass. updateTexture and updateIndices are legal outside
// passes only.
// Row order: memory row 0 of an updated texture is the picture's top row and is stored as GL row 0, so shaders sample
// with v down (glTF). Targets are drawn y-up as in GL; readPixels returns the TOP row first.
#pragma once

#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "base/result.h"
#include "gpu/commands.h"

namespace fourdvt::gpu {

// Texture data for a device's hooks.
struct TextureRecord {
  TextureDesc desc;  // desc.label is valid in creation hooks only; use `label`
  std::string label;
  int levels = 1;
  uint64_t bytes = 0;
  uint32_t native = 0;  // set by the hooks
};

// Target data for a device's hooks.
struct TargetRecord {
  TargetDesc desc;
  std::string label;
  int width = 0, height = 0, samples = 0;
  bool own_color = false, own_depth = false;
  uint64_t bytes = 0;                                            // renderbuffers only
  std::vector<PixelFormat> formats;                              // colour attachments
  uint32_t framebuffer = 0, color_buffer = 0, depth_buffer = 0;  // set by the hooks
};

// Receives the beginning and the end of every pass and upload, for measurements.
class DeviceObserver {
 public:
  virtual ~DeviceObserver() = default;
  virtual void begins(const char* label) = 0;  // label of the pass, or "upload"
  virtual void ends() = 0;
};

// Checks and counts calls, and is itself the null device; drawing devices derive from it (gles_device.cpp).
class Device {
 public:
  // Returns the capabilities of the null device; float_targets sets Caps::float_targets and half_float_targets.
  static Caps capsOfNone(bool float_targets = true);
  explicit Device(Caps caps) : caps_(std::move(caps)) {}
  virtual ~Device() = default;
  const Caps& caps() const { return caps_; }
  Result<TextureId> createTexture(const TextureDesc& desc);
  // Replaces a region. stride_bytes: distance between rows, 0 if tightly packed. layer: for array textures.
  void updateTexture(TextureId texture, const Region& region, const void* pixels, int stride_bytes = 0, int layer = 0);
  void generateMipmaps(TextureId texture);
  void destroyTexture(TextureId texture);
  IndexBufferId createIndexBuffer();                                            // empty
  void updateIndices(IndexBufferId buffer, std::span<const uint32_t> indices);  // replaces all indices
  void destroyIndexBuffer(IndexBufferId buffer);
  // Compiles GLSL ES 3.00 texts without the #version line. `defines`: one per line, without "#define", e.g. "LAYERS 3";
  // they go first, then highp as the default precision. Equal texts share one program, which counts its references:
  // one destroyProgram per createProgram. Error: GpuFailure with the label and the compiler's log.
  Result<ProgramId> createProgram(std::string_view label, std::string_view vertex_text, std::string_view fragment_text,
                                  std::string_view defines = {});
  void destroyProgram(ProgramId program);
  Result<TargetId> createTarget(const TargetDesc& desc);
  void destroyTarget(TargetId target);
  void beginPass(const Pass& pass);
  void draw(const Draw& draw);
  void endPass();
  // Copies the colour of `from` at (0,0) into `region` of `to`; requires equal formats. Resolves a multisampled `from`,
  // then to (0,0) only (on a canvas with alpha, without antialias); its contents become undefined: clear it before
  // drawing.
  void blit(TargetId from, TargetId to, const Region& region);
  // Reads colour attachment 0 as stored (RGBA8: 4 bytes; RGBA32F: 16; R32UI: 4 with `format`), top row first. 16F
  // formats are read as 32-bit floats.
  Status readPixels(TargetId target, PixelFormat format, const Region& region, void* out);
  // Starts an asynchronous read of a rectangle of an RGBA8 target, in readPixels' layout. Returns 0 if refused.
  ReadId beginRead(TargetId target, const Region& region);
  // Returns true once the read is complete, writes it to `out` and frees it. out null: cancels and frees the read at
  // once.
  bool endRead(ReadId read, void* out);
  // Returns the context's own name of a texture (GLuint), for platform code that uploads video frames itself.
  uint32_t nativeTexture(TextureId texture) const;
  // Drops cached GL state after foreign code touched the context.
  virtual void invalidateState() {}
  void observe(DeviceObserver* observer) { observer_ = observer; }  // borrowed; null: none
  const Counters& counters() const { return counters_; }
  void resetCounters();  // live_… are kept
  // Returns misuse since the last call, one line per case; empty: none. A misused call is dropped. Slow on GLES
  // (glGetError).
  std::string takeErrors();

 protected:
  // Hooks, called with valid arguments only. Those of the null device draw nothing and read zeros.
  virtual Status onCreateTexture(TextureRecord& texture);
  virtual void onUpdateTexture(const TextureRecord&, const Region&, const void*, int, int) {}
  virtual void onGenerateMipmaps(const TextureRecord&) {}
  virtual void onDestroyTexture(const TextureRecord&) {}
  virtual IndexBufferId onCreateIndexBuffer() { return ++natives_; }  // returns the context's own name
  virtual void onUpdateIndices(IndexBufferId, std::span<const uint32_t>) {}
  virtual void onDestroyIndexBuffer(IndexBufferId) {}
  // label, vertex text, fragment text
  virtual Status onCreateProgram(ProgramId, const std::string&, const std::string&, const std::string&) { return {}; }
  virtual void onDestroyProgram(ProgramId) {}
  virtual Status onCreateTarget(TargetRecord&) { return {}; }
  virtual void onDestroyTarget(const TargetRecord&) {}
  virtual void onBeginPass(const Pass&, const TargetRecord*) {}  // target null: default target
  virtual void onDraw(const Draw&) {}
  virtual void onBlit(const TargetRecord*, const TargetRecord*, const Region&) {}  // from, to
  virtual Status onReadPixels(const TargetRecord* target, PixelFormat format, const Region& region, void* out);
  virtual void onBeginRead(ReadId, const TargetRecord*, const Region&) {}
  virtual bool onEndRead(ReadId read, const Region& region, void* out);  // out null: cancel
  virtual std::string onTakeErrors() { return {}; }

  const TextureRecord* texture(TextureId id) const;
  const TargetRecord* target(TargetId id) const;

 private:
  Caps caps_;
  uint32_t natives_ = 0;  // counter of native names
  void misuse(const std::string& line);
  std::string whyNotTexture(const TextureDesc& desc) const;
  std::string describeTarget(TargetRecord& record) const;
  std::string whyNotRead(TargetId id, PixelFormat format, const Region& region) const;
  bool hasIndices(IndexBufferId id, size_t count) const {
    return id < index_counts_.size() && index_counts_[id] > count;
  }
  std::string whyNotDraw(const Draw& draw) const;
  std::string whyNotBlit(TargetId from, TargetId to, const Region& region) const;

  std::map<TextureId, TextureRecord> textures_;
  // Index count + 1 by buffer id; 0: no such buffer.
  std::vector<uint32_t> index_counts_;
  struct ProgramRecord {
    uint64_t key = 0;     // hash of the texts
    uint32_t owners = 1;  // equal programs are shared
  };
  std::map<ProgramId, ProgramRecord> programs_;
  std::map<TargetId, TargetRecord> targets_;
  std::map<ReadId, Region> reads_;
  uint32_t next_id_ = 1;
  bool in_pass_ = false;
  TargetId pass_target_ = kDefaultTarget;
  DeviceObserver* observer_ = nullptr;
  Counters counters_;
  std::string errors_;
};

// Requires a current GLES 3.0 / WebGL2 context. Only gles_*.cpp call gl*.
Result<std::unique_ptr<Device>> createGlesDevice();
// Makes a device that draws nothing; see Device.
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

// Returns an embedded shader file (shaders/gles/NAME, e.g. "layered.vert"); empty if there is none. The embedding
// script expands `#include "x.glsl"` lines at build time.
std::string_view shaderText(std::string_view name);

// Returns the text of a shader file, valid until the program ends.
using ShaderReader = std::string_view (*)(std::string_view name);
// Replaces the embedded shaders of a native program, for example by files of a folder; null restores them. Not
// thread-safe; call it before the first shader is compiled. Excluded from wasm.
void readShadersBy(ShaderReader reader);
// Returns the reader's text of that name, or `embedded` without a reader. Called by code generated by
// embed_shaders.cmake.
std::string_view readShader(std::string_view name, std::string_view embedded);

}  // namespace fourdvt::gpu
