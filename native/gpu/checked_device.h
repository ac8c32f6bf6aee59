// SPDX-License-Identifier: Apache-2.0
// What every device shares: handle tables, validation, counting. Each device implements the on… hooks, which are called
// with valid arguments only. Misuse is recorded (takeErrors) and the call dropped, so that the null device and GLES
// agree on what is legal.
#pragma once

#include <map>

#include "gpu/device.h"

namespace fourdvt::gpu {

struct TextureRecord {
  TextureDesc desc;  // desc.label points to `label`'s text only inside hooks of creation; use `label`
  std::string label;
  int levels = 1;
  uint64_t bytes = 0;
  uint32_t native = 0;  // set by the hooks
};

struct TargetRecord {
  TargetDesc desc;
  std::string label;
  int width = 0, height = 0, samples = 0;
  bool own_color = false, own_depth = false;
  uint64_t bytes = 0;                                            // of the renderbuffers
  std::vector<PixelFormat> formats;                              // of the colour attachments
  uint32_t framebuffer = 0, color_buffer = 0, depth_buffer = 0;  // set by the hooks
};

class CheckedDevice : public Device {
 public:
  const Caps& caps() const final { return caps_; }
  Result<TextureId> createTexture(const TextureDesc& desc) final;
  void updateTexture(TextureId texture, const Region& region, const void* pixels, int stride_bytes, int layer) final;
  void generateMipmaps(TextureId texture) final;
  void destroyTexture(TextureId texture) final;
  IndexBufferId createIndexBuffer() final;
  void updateIndices(IndexBufferId buffer, std::span<const uint32_t> indices) final;
  void destroyIndexBuffer(IndexBufferId buffer) final;
  Result<ProgramId> createProgram(std::string_view label, std::string_view vertex_text, std::string_view fragment_text,
                                  std::string_view defines) final;
  void destroyProgram(ProgramId program) final;
  Result<TargetId> createTarget(const TargetDesc& desc) final;
  void destroyTarget(TargetId target) final;
  void beginPass(const Pass& pass) final;
  void draw(const Draw& draw) final;
  void endPass() final;
  void blit(TargetId from, TargetId to, const Region& region) final;
  Status readPixels(TargetId target, PixelFormat format, const Region& region, void* out) final;
  ReadId beginRead(TargetId target, const Region& region) final;
  bool endRead(ReadId read, void* out) final;
  uint32_t nativeTexture(TextureId texture) const final;
  const Counters& counters() const final { return counters_; }
  void resetCounters() final;
  std::string takeErrors() final;

 protected:
  virtual Status onCreateTexture(TextureRecord& texture) = 0;
  virtual void onUpdateTexture(const TextureRecord& texture, const Region& region, const void* pixels, int stride_bytes,
                               int layer) = 0;
  virtual void onGenerateMipmaps(const TextureRecord& texture) = 0;
  virtual void onDestroyTexture(const TextureRecord& texture) = 0;
  virtual IndexBufferId onCreateIndexBuffer() = 0;  // the context's own name
  virtual void onUpdateIndices(IndexBufferId buffer, std::span<const uint32_t> indices) = 0;
  virtual void onDestroyIndexBuffer(IndexBufferId buffer) = 0;
  virtual Status onCreateProgram(ProgramId id, const std::string& label, const std::string& vertex_text,
                                 const std::string& fragment_text) = 0;
  virtual void onDestroyProgram(ProgramId id) = 0;
  virtual Status onCreateTarget(TargetRecord& target) = 0;
  virtual void onDestroyTarget(const TargetRecord& target) = 0;
  virtual void onBeginPass(const Pass& pass, const TargetRecord* target) = 0;  // target null: the default one
  virtual void onDraw(const Draw& draw) = 0;
  virtual void onBlit(const TargetRecord* from, const TargetRecord* to, const Region& region) = 0;
  virtual Status onReadPixels(const TargetRecord* target, PixelFormat format, const Region& region, void* out) = 0;
  virtual void onBeginRead(ReadId read, const TargetRecord* target, const Region& region) = 0;
  virtual bool onEndRead(ReadId read, const Region& region, void* out) = 0;  // out null: forget it
  virtual std::string onTakeErrors() { return {}; }

  const TextureRecord* texture(TextureId id) const;
  const TargetRecord* target(TargetId id) const;

  Caps caps_;

 private:
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
  Counters counters_;
  std::string errors_;
};

}  // namespace fourdvt::gpu
