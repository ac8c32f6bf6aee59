// SPDX-License-Identifier: Apache-2.0
// The GPU as fourdvt sees it: textures, index lists, programs, targets and draws, on GLES 3.0 = WebGL2.
//
// Does: own resources (move-only handles), check every call, count calls and bytes, label everything. A misused call is
// recorded (takeErrors) and dropped, so that all devices agree on what is legal.
// Does NOT: own the context (platform/egl_context or the page does), use vertex buffers (vertices are pulled with
// texelFetch and gl_VertexID, which is a draw's index if it has indices), know about characters.
// Order of calls: create resources → beginPass → draw… → endPass. updateTexture and updateIndices are legal
// outside passes only.
// Row order: memory row 0 of an updated texture is the picture's top row and is stored as GL row 0, so shaders sample
// with v down (glTF). Targets are drawn y-up as GL does; readPixels returns the TOP row first.
#pragma once

#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "base/result.h"
#include "gpu/commands.h"

namespace fourdvt::gpu {

// A texture, as the hooks of a device see it.
struct TextureRecord {
  TextureDesc desc;  // desc.label points to `label`'s text only inside hooks of creation; use `label`
  std::string label;
  int levels = 1;
  uint64_t bytes = 0;
  uint32_t native = 0;  // set by the hooks
};

// Likewise a target.
struct TargetRecord {
  TargetDesc desc;
  std::string label;
  int width = 0, height = 0, samples = 0;
  bool own_color = false, own_depth = false;
  uint64_t bytes = 0;                                            // of the renderbuffers
  std::vector<PixelFormat> formats;                              // of the colour attachments
  uint32_t framebuffer = 0, color_buffer = 0, depth_buffer = 0;  // set by the hooks
};

// Receives the beginning and the end of every pass and upload, for measurements.
class DeviceObserver {
 public:
  virtual ~DeviceObserver() = default;
  virtual void begins(const char* label) = 0;  // the pass's label, or "upload"
  virtual void ends() = 0;
};

// Checks and counts calls; draws nothing by itself. What draws derives from it (gles_device.cpp).
class Device {
 public:
  // Capabilities of a device that draws nothing. float_targets: of both kinds in Caps.
  static Caps capsOfNone(bool float_targets = true);
  explicit Device(Caps caps) : caps_(std::move(caps)) {}
  virtual ~Device() = default;
  const Caps& caps() const { return caps_; }
  Result<TextureId> createTexture(const TextureDesc& desc);
  // Replaces a region. stride_bytes: from row to row, 0 if they are tightly packed. layer: of an array texture.
  void updateTexture(TextureId texture, const Region& region, const void* pixels, int stride_bytes = 0, int layer = 0);
  void generateMipmaps(TextureId texture);
  void destroyTexture(TextureId texture);
  IndexBufferId createIndexBuffer();                                            // without indices
  void updateIndices(IndexBufferId buffer, std::span<const uint32_t> indices);  // replaces all
  void destroyIndexBuffer(IndexBufferId buffer);
  // GLSL ES 3.00 texts without the #version line; `defines` ("LAYERS 3\n…", one per line, no "#define") go first,
  // then highp as the default precision. Programs of the same texts are one, which is compiled once and destroyed as
  // often as it was created. Error: GpuFailure with the label and the compiler's log.
  Result<ProgramId> createProgram(std::string_view label, std::string_view vertex_text, std::string_view fragment_text,
                                  std::string_view defines = {});
  void destroyProgram(ProgramId program);
  Result<TargetId> createTarget(const TargetDesc& desc);
  void destroyTarget(TargetId target);
  void beginPass(const Pass& pass);
  void draw(const Draw& draw);
  void endPass();
  // Copies the colour of `from` at (0,0) into `region` of `to`; formats must be the same. A multisampled `from` is
  // resolved, to (0,0) only (a canvas: alpha, no antialias), and loses what it held: clear it before drawing.
  void blit(TargetId from, TargetId to, const Region& region);
  // Reads colour attachment 0 as stored (RGBA8: 4 bytes; RGBA32F: 16; R32UI: 4 with `format`), top row first. 16F
  // formats are read as 32-bit floats.
  Status readPixels(TargetId target, PixelFormat format, const Region& region, void* out);
  // Starts to copy a rectangle of an RGBA8 target out, as readPixels would, without waiting for the GPU. 0: refused.
  ReadId beginRead(TargetId target, const Region& region);
  // True once the copy is there: it is written to `out` and forgotten. out null: it is forgotten, at once.
  bool endRead(ReadId read, void* out);
  // The context's own name of a texture (GLuint), for edges that upload video frames themselves.
  uint32_t nativeTexture(TextureId texture) const;
  // Drops cached GL state after foreign code touched the context.
  virtual void invalidateState() {}
  void observe(DeviceObserver* observer) { observer_ = observer; }  // borrowed; null: none
  const Counters& counters() const { return counters_; }
  void resetCounters();  // live_… keep their values
  // Misuse seen since the last call, one line per case; empty: none. A misused call is dropped. Slow on GLES
  // (glGetError).
  std::string takeErrors();

 protected:
  // Hooks, called with valid arguments only. Those of this class draw nothing and read zeros.
  virtual Status onCreateTexture(TextureRecord& texture);
  virtual void onUpdateTexture(const TextureRecord&, const Region&, const void*, int, int) {}
  virtual void onGenerateMipmaps(const TextureRecord&) {}
  virtual void onDestroyTexture(const TextureRecord&) {}
  virtual IndexBufferId onCreateIndexBuffer() { return ++natives_; }  // the context's own name
  virtual void onUpdateIndices(IndexBufferId, std::span<const uint32_t>) {}
  virtual void onDestroyIndexBuffer(IndexBufferId) {}
  // label, vertex text, fragment text
  virtual Status onCreateProgram(ProgramId, const std::string&, const std::string&, const std::string&) { return {}; }
  virtual void onDestroyProgram(ProgramId) {}
  virtual Status onCreateTarget(TargetRecord&) { return {}; }
  virtual void onDestroyTarget(const TargetRecord&) {}
  virtual void onBeginPass(const Pass&, const TargetRecord*) {}  // target null: the default one
  virtual void onDraw(const Draw&) {}
  virtual void onBlit(const TargetRecord*, const TargetRecord*, const Region&) {}  // from, to
  virtual Status onReadPixels(const TargetRecord* target, PixelFormat format, const Region& region, void* out);
  virtual void onBeginRead(ReadId, const TargetRecord*, const Region&) {}
  virtual bool onEndRead(ReadId read, const Region& region, void* out);  // out null: forget it
  virtual std::string onTakeErrors() { return {}; }

  const TextureRecord* texture(TextureId id) const;
  const TargetRecord* target(TargetId id) const;

 private:
  Caps caps_;
  uint32_t natives_ = 0;  // names that stand for a context's
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
  // Indices of the buffers, and one more; 0: there is no such buffer. By id.
  std::vector<uint32_t> index_counts_;
  struct ProgramRecord {
    uint64_t key = 0;     // of its texts
    uint32_t owners = 1;  // programs of the same texts are one
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

// Needs a current GLES 3.0 / WebGL2 context. Only gles_*.cpp call gl*.
Result<std::unique_ptr<Device>> createGlesDevice();
// Draws nothing; see Device.
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
