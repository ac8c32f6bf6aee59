// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

#include <algorithm>
#include <cstring>

#include "base/hash.h"

namespace fourdvt::gpu {
namespace {

ShaderReader shader_reader = nullptr;

bool isFloat(PixelFormat format) {
  return format == PixelFormat::R32F || format == PixelFormat::RG32F || format == PixelFormat::RGBA32F;
}

bool isHalfFloat(PixelFormat format) { return format == PixelFormat::RG16F || format == PixelFormat::RGBA16F; }

bool isFilterable(PixelFormat format) {
  return format == PixelFormat::R8 || format == PixelFormat::RG8 || format == PixelFormat::RGBA8 || isHalfFloat(format);
}

int levelCount(const TextureDesc& desc) {
  int levels = 1;
  if (desc.filter == Filter::LinearMipmap)
    for (int side = std::max(desc.width, desc.height); side > 1; side /= 2) ++levels;
  return levels;
}

uint64_t byteCount(const TextureDesc& desc, int levels) {
  uint64_t bytes = 0;
  for (int level = 0; level < levels; ++level) {
    const uint64_t width = std::max(1, desc.width >> level), height = std::max(1, desc.height >> level);
    bytes += width * height * std::max(1, desc.layers) * bytesPerPixel(desc.format);
  }
  return bytes;
}

// Prepends "#version", "#define" lines and default precisions; #line keeps compiler messages at source line numbers.
std::string wholeShader(std::string_view defines, std::string_view source) {
  std::string text = "#version 300 es\n";
  for (size_t at = 0; at < defines.size();) {
    const size_t end = std::min(defines.find('\n', at), defines.size());
    if (end > at) text.append("#define ").append(defines.substr(at, end - at)).append("\n");
    at = end + 1;
  }
  text +=
      "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp usampler2D;\n"
      "precision highp sampler2DArray;\n#line 1\n";
  return text.append(source);
}

std::string sized(const std::string& label, int width, int height) {
  return "'" + label + "' (" + std::to_string(width) + " x " + std::to_string(height) + ")";
}

bool isEmpty(const Region& region) { return region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1; }

bool fits(const Region& region, int width, int height) {
  return !isEmpty(region) && region.x <= width - region.width && region.y <= height - region.height;
}

}  // namespace

int bytesPerPixel(PixelFormat format) {
  constexpr uint8_t kBytes[] = {1, 2, 4, 4, 8, 16, 4, 4, 4, 8};  // in the order of PixelFormat
  return kBytes[static_cast<size_t>(format)];
}

int readBytesPerPixel(PixelFormat format) {
  const bool is_half = format == PixelFormat::RG16F || format == PixelFormat::RGBA16F;
  return bytesPerPixel(format) * (is_half ? 2 : 1);
}

// --- null device ---

Caps Device::capsOfNone(bool float_targets) {
  return {.max_texture_size = 4096,
          .max_samples = 4,
          .float_targets = float_targets,
          .half_float_targets = float_targets,
          .renderer = "null"};
}

std::unique_ptr<Device> createNullDevice(bool float_targets) {
  return std::make_unique<Device>(Device::capsOfNone(float_targets));
}

Status Device::onCreateTexture(TextureRecord& texture) {
  texture.native = ++natives_;
  return {};
}

Status Device::onReadPixels(const TargetRecord*, PixelFormat format, const Region& region, void* out) {
  std::memset(out, 0, static_cast<size_t>(region.width) * region.height * readBytesPerPixel(format));
  return {};
}

bool Device::onEndRead(ReadId, const Region& region, void* out) {
  if (out) std::memset(out, 0, size_t{4} * static_cast<size_t>(region.width) * static_cast<size_t>(region.height));
  return true;
}

// --- checks ---

const TextureRecord* Device::texture(TextureId id) const {
  auto it = textures_.find(id);
  return it == textures_.end() ? nullptr : &it->second;
}

const TargetRecord* Device::target(TargetId id) const {
  auto it = targets_.find(id);
  return it == targets_.end() ? nullptr : &it->second;
}

void Device::misuse(const std::string& line) {
  constexpr size_t kKeptBytes = 4096;
  if (errors_.size() < kKeptBytes) errors_ += line + "\n";
}

std::string Device::takeErrors() {
  std::string all = std::move(errors_) + onTakeErrors();
  errors_.clear();
  return all;
}

void Device::resetCounters() {
  counters_.draws = counters_.vertices = counters_.passes = 0;
  counters_.texture_updates = counters_.uploaded_bytes = 0;
}

std::string Device::whyNotTexture(const TextureDesc& desc) const {
  const int limit = caps_.max_texture_size;
  if (desc.width < 1 || desc.height < 1 || desc.layers < 0) return "its size must be positive";
  if (desc.width > limit || desc.height > limit)
    return "this GPU's textures end at " + std::to_string(limit) + " texels; use a smaller size";
  if (desc.respecifiable &&
      (desc.layers > 0 || desc.format != PixelFormat::RGBA8 || desc.filter == Filter::LinearMipmap))
    return "only a plain RGBA8 texture can be respecified";
  if (desc.filter != Filter::Nearest && !isFilterable(desc.format)) return "its format allows Filter::Nearest only";
  return {};
}

Result<TextureId> Device::createTexture(const TextureDesc& desc) {
  TextureRecord record{desc, desc.label ? desc.label : "", levelCount(desc), 0, 0};
  if (const std::string why = whyNotTexture(desc); !why.empty())
    return Error{ErrorId::GpuFailure, "texture " + sized(record.label, desc.width, desc.height) + ": " + why};
  record.bytes = byteCount(desc, record.levels);
  FOURDVT_TRY(onCreateTexture(record));
  record.desc.label = nullptr;
  const TextureId id = next_id_++;
  counters_.live_textures += 1;
  counters_.live_texture_bytes += record.bytes;
  textures_[id] = std::move(record);
  return id;
}

void Device::updateTexture(TextureId id, const Region& region, const void* pixels, int stride_bytes, int layer) {
  const TextureRecord* record = texture(id);
  if (!record) return misuse("updateTexture: no such texture");
  const TextureDesc& desc = record->desc;
  const int row_bytes = region.width * bytesPerPixel(desc.format);
  if (in_pass_) return misuse("updateTexture inside a pass: " + record->label);
  if (!pixels || desc.format == PixelFormat::Depth24) return misuse("updateTexture: no pixels for " + record->label);
  if (!fits(region, desc.width, desc.height))
    return misuse("updateTexture: rectangle outside " + sized(record->label, desc.width, desc.height));
  if (desc.layers > 0 && (layer < 0 || layer >= desc.layers)) return misuse("updateTexture: no such layer");
  if (stride_bytes != 0 && stride_bytes < row_bytes) return misuse("updateTexture: stride shorter than a row");
  counters_.texture_updates += 1;
  counters_.uploaded_bytes += static_cast<uint64_t>(row_bytes) * region.height;
  if (observer_) observer_->begins("upload");
  onUpdateTexture(*record, region, pixels, stride_bytes ? stride_bytes : row_bytes, layer);
  if (observer_) observer_->ends();
}

void Device::generateMipmaps(TextureId id) {
  const TextureRecord* record = texture(id);
  if (!record || record->desc.filter != Filter::LinearMipmap)
    return misuse("generateMipmaps: needs a texture with Filter::LinearMipmap");
  if (in_pass_) return misuse("generateMipmaps inside a pass: " + record->label);
  onGenerateMipmaps(*record);
}

void Device::destroyTexture(TextureId id) {
  const TextureRecord* record = texture(id);
  if (!record) return misuse("destroyTexture: no such texture");
  onDestroyTexture(*record);
  counters_.live_textures -= 1;
  counters_.live_texture_bytes -= record->bytes;
  textures_.erase(id);
}

IndexBufferId Device::createIndexBuffer() {
  const IndexBufferId id = onCreateIndexBuffer();
  if (id >= index_counts_.size()) index_counts_.resize(id + 1);
  index_counts_[id] = 1;
  counters_.live_index_buffers += 1;
  return id;
}

void Device::updateIndices(IndexBufferId id, std::span<const uint32_t> indices) {
  if (!hasIndices(id, 0) || in_pass_) return misuse("updateIndices: no such index buffer, or inside a pass");
  counters_.uploaded_bytes += indices.size_bytes();
  index_counts_[id] = static_cast<uint32_t>(indices.size() + 1);
  onUpdateIndices(id, indices);
}

void Device::destroyIndexBuffer(IndexBufferId id) {
  if (!hasIndices(id, 0)) return misuse("destroyIndexBuffer: no such index buffer");
  onDestroyIndexBuffer(id);
  counters_.live_index_buffers -= 1;
  index_counts_[id] = 0;
}

Result<ProgramId> Device::createProgram(std::string_view label, std::string_view vertex_text,
                                        std::string_view fragment_text, std::string_view defines) {
  const std::string name(label);
  if (vertex_text.empty() || fragment_text.empty())
    return Error{ErrorId::GpuFailure, "program '" + name + "': empty text; is the shader file embedded?"};
  const std::string vertex = wholeShader(defines, vertex_text), fragment = wholeShader(defines, fragment_text);
  const uint64_t key = fnv1a(fragment, fnv1a(vertex));
  for (auto& [id, program] : programs_) {
    if (program.key != key) continue;
    ++program.owners;
    return id;
  }
  const ProgramId id = next_id_++;
  FOURDVT_TRY(onCreateProgram(id, name, vertex, fragment));
  counters_.live_programs += 1;
  programs_[id] = {key};
  return id;
}

void Device::destroyProgram(ProgramId id) {
  const auto found = programs_.find(id);
  if (found == programs_.end()) return misuse("destroyProgram: no such program");
  if (--found->second.owners) return;
  programs_.erase(found);
  onDestroyProgram(id);
  counters_.live_programs -= 1;
}

// Fills size and formats; returns an error message, or an empty string.
std::string Device::describeTarget(TargetRecord& record) const {
  const TargetDesc& desc = record.desc;
  record.own_color = desc.colors.empty() && desc.depth == 0;
  record.own_depth = record.own_color || (desc.own_depth && desc.depth == 0);
  if (record.own_color) {
    record.width = desc.width;
    record.height = desc.height;
    record.samples = std::clamp(desc.samples, 0, caps_.max_samples);
    record.formats = {PixelFormat::RGBA8};
    const int limit = caps_.max_texture_size;
    if (desc.width < 1 || desc.height < 1) return "needs textures or a size";
    if (desc.width > limit || desc.height > limit) return "larger than this GPU's " + std::to_string(limit);
    return {};
  }
  if (desc.samples > 1) return "textures cannot be multisampled";
  std::vector<TextureId> attachments = desc.colors;
  if (desc.depth) attachments.push_back(desc.depth);
  for (TextureId id : attachments) {
    const TextureRecord* attached = texture(id);
    if (!attached) return "an attachment does not exist";
    const bool is_depth_slot = id == desc.depth;
    if (is_depth_slot != (attached->desc.format == PixelFormat::Depth24)) return "depth and colour are mixed up";
    if (isFloat(attached->desc.format) && !caps_.float_targets)
      return "this GPU cannot draw into float textures (EXT_color_buffer_float)";
    if (isHalfFloat(attached->desc.format) && !caps_.half_float_targets)
      return "this GPU cannot draw into half-float textures (EXT_color_buffer_half_float)";
    if (record.width && (attached->desc.width != record.width || attached->desc.height != record.height))
      return "its attachments differ in size";
    if (attached->desc.layers > 0 && (is_depth_slot ? desc.depth_layer : desc.color_layer) >= attached->desc.layers)
      return "no such layer";
    record.width = attached->desc.width;
    record.height = attached->desc.height;
    if (!is_depth_slot) record.formats.push_back(attached->desc.format);
  }
  return {};
}

Result<TargetId> Device::createTarget(const TargetDesc& desc) {
  TargetRecord record;
  record.desc = desc;
  record.label = desc.label ? desc.label : "";
  if (const std::string why = describeTarget(record); !why.empty())
    return Error{ErrorId::GpuFailure, "target '" + record.label + "': " + why};
  const uint64_t pixel_bytes =
      record.own_color * bytesPerPixel(PixelFormat::RGBA8) + record.own_depth * bytesPerPixel(PixelFormat::Depth24);
  record.bytes = uint64_t(record.width) * record.height * std::max(record.samples, 1) * pixel_bytes;
  FOURDVT_TRY(onCreateTarget(record));
  record.desc.label = nullptr;
  const TargetId id = next_id_++;
  counters_.live_targets += 1;
  counters_.live_target_bytes += record.bytes;
  targets_[id] = std::move(record);
  return id;
}

void Device::destroyTarget(TargetId id) {
  const TargetRecord* record = target(id);
  if (!record) return misuse("destroyTarget: no such target");
  if (in_pass_ && pass_target_ == id) misuse("destroyTarget: its pass is open: " + record->label);
  onDestroyTarget(*record);
  counters_.live_targets -= 1;
  counters_.live_target_bytes -= record->bytes;
  targets_.erase(id);
}

void Device::beginPass(const Pass& pass) {
  if (in_pass_) return misuse(std::string("beginPass inside a pass: ") + pass.label);
  const TargetRecord* record = target(pass.target);
  if (pass.target != kDefaultTarget && !record) return misuse(std::string("beginPass: no such target: ") + pass.label);
  Pass full = pass;
  if (record && full.width == 0 && full.height == 0) full.width = record->width, full.height = record->height;
  if (full.width < 1 || full.height < 1) return misuse(std::string("beginPass: empty viewport: ") + pass.label);
  if (record) {
    for (TextureId id : record->desc.colors)
      if (!texture(id)) return misuse("beginPass: a destroyed texture is attached to " + record->label);
  }
  if (observer_) observer_->begins(pass.label);
  in_pass_ = true;
  pass_target_ = pass.target;
  counters_.passes += 1;
  onBeginPass(full, record);
}

std::string Device::whyNotDraw(const Draw& draw) const {
  if (!in_pass_) return "outside a pass";
  if (!programs_.count(draw.program)) return "no such program";
  if (draw.vertex_count < 3 || draw.vertex_count % 3 != 0) return "vertex_count is no positive multiple of 3";
  if (draw.indices && !hasIndices(draw.indices, size_t(draw.vertex_count)))
    return "no such indices, or fewer than vertex_count";
  if (draw.depth_write && !draw.depth_test) return "depth_write needs depth_test";
  const TargetRecord* record = target(pass_target_);
  for (const TextureBinding& binding : draw.textures) {
    if (!texture(binding.texture)) return std::string("no such texture for ") + binding.sampler;
    if (!record) continue;
    const auto& colors = record->desc.colors;
    if (binding.texture == record->desc.depth ||
        std::find(colors.begin(), colors.end(), binding.texture) != colors.end())
      return std::string("reads the texture it draws into: ") + binding.sampler;
  }
  for (const Uniform& value : draw.uniforms)
    if (!value.name || !value.data || value.count < 1) return "empty uniform";
  return {};
}

void Device::draw(const Draw& draw) {
  if (const std::string why = whyNotDraw(draw); !why.empty()) return misuse("draw: " + why);
  counters_.draws += 1;
  counters_.vertices += static_cast<uint64_t>(draw.vertex_count);
  onDraw(draw);
}

void Device::endPass() {
  if (!in_pass_) return misuse("endPass without beginPass");
  in_pass_ = false;
  if (observer_) observer_->ends();
}

std::string Device::whyNotBlit(TargetId from, TargetId to, const Region& region) const {
  const TargetRecord* source = target(from);
  const TargetRecord* destination = target(to);
  if (in_pass_) return "inside a pass";
  if ((from != kDefaultTarget && !source) || (to != kDefaultTarget && !destination) || from == to)
    return "no such target";
  if (isEmpty(region)) return "empty or negative rectangle";
  if (source && (region.width > source->width || region.height > source->height)) return "larger than its source";
  if (destination && !fits(region, destination->width, destination->height)) return "outside its destination";
  if (destination && destination->samples > 1) return "its destination is multisampled";
  if (source && source->samples > 1 && (region.x != 0 || region.y != 0)) return "a multisampled source cannot be moved";
  if (source && destination &&
      (source->formats.empty() || destination->formats.empty() || source->formats[0] != destination->formats[0]))
    return "formats differ";
  return {};
}

void Device::blit(TargetId from, TargetId to, const Region& region) {
  if (const std::string why = whyNotBlit(from, to, region); !why.empty()) return misuse("blit: " + why);
  onBlit(target(from), target(to), region);
}

std::string Device::whyNotRead(TargetId id, PixelFormat format, const Region& region) const {
  const TargetRecord* record = target(id);
  if (in_pass_) return "inside a pass";
  if (id != kDefaultTarget && !record) return "no such target";
  if (isEmpty(region)) return "empty rectangle";
  if (record && !fits(region, record->width, record->height)) return "rectangle outside the target";
  if (record && record->samples > 1) return "multisampled; blit it first";
  if (record && (record->formats.empty() || record->formats[0] != format)) return "the target has another format";
  return {};
}

Status Device::readPixels(TargetId id, PixelFormat format, const Region& region, void* out) {
  const TargetRecord* record = target(id);
  const std::string why = out ? whyNotRead(id, format, region) : "no memory to read into";
  if (!why.empty()) return Error{ErrorId::GpuFailure, "readPixels of '" + (record ? record->label : "") + "': " + why};
  return onReadPixels(record, format, region, out);
}

ReadId Device::beginRead(TargetId id, const Region& region) {
  if (const std::string why = whyNotRead(id, PixelFormat::RGBA8, region); !why.empty()) {
    misuse("beginRead: " + why);
    return 0;
  }
  const ReadId read = next_id_++;
  reads_[read] = region;
  onBeginRead(read, target(id), region);
  return read;
}

bool Device::endRead(ReadId read, void* out) {
  const auto known = reads_.find(read);
  if (known == reads_.end()) {
    misuse("endRead: no such read");
    return false;
  }
  if (!onEndRead(read, known->second, out)) return false;
  reads_.erase(known);
  return true;
}

uint32_t Device::nativeTexture(TextureId id) const {
  const TextureRecord* record = texture(id);
  return record ? record->native : 0;
}

// --- owners ---

Result<Texture> makeTexture(Device& device, const TextureDesc& desc) {
  auto id = device.createTexture(desc);
  if (!id) return id.error();
  return Texture(device, id.value());
}

Result<Program> makeProgram(Device& device, std::string_view label, std::string_view vertex_text,
                            std::string_view fragment_text, std::string_view defines) {
  auto id = device.createProgram(label, vertex_text, fragment_text, defines);
  if (!id) return id.error();
  return Program(device, id.value());
}

Result<Target> makeTarget(Device& device, const TargetDesc& desc) {
  auto id = device.createTarget(desc);
  if (!id) return id.error();
  return Target(device, id.value());
}

IndexBuffer makeIndexBuffer(Device& device) { return IndexBuffer(device, device.createIndexBuffer()); }

void readShadersBy(ShaderReader reader) { shader_reader = reader; }

std::string_view readShader(std::string_view name, std::string_view embedded) {
  return shader_reader ? shader_reader(name) : embedded;
}

}  // namespace fourdvt::gpu
