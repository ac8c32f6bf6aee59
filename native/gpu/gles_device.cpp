// SPDX-License-Identifier: Apache-2.0
// GLES 3.0 = WebGL2 device. GL state set by the device is cached; invalidateState() drops the cache.
#include <GLES3/gl3.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "gpu/device.h"
#include "gpu/gles_platform.h"

namespace fourdvt::gpu {
namespace {

constexpr int kMaxUnits = 16;  // minimum of the fragment stage in GLES 3.0

struct GlFormat {
  GLenum internal, format, type;
};

const GlFormat& glFormat(PixelFormat format) {
  static constexpr GlFormat kFormats[] = {
      // Indexed by PixelFormat.
      {GL_R8, GL_RED, GL_UNSIGNED_BYTE},     {GL_RG8, GL_RG, GL_UNSIGNED_BYTE},
      {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE}, {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT},
      {GL_RG32F, GL_RG, GL_FLOAT},           {GL_RGBA32F, GL_RGBA, GL_FLOAT},
      {GL_R32F, GL_RED, GL_FLOAT},           {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT},
      {GL_RG16F, GL_RG, GL_HALF_FLOAT},      {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT},
  };
  return kFormats[static_cast<size_t>(format)];
}

GLenum glTarget(const TextureRecord& texture) { return texture.desc.layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D; }

struct GlProgram {
  struct UniformSlot {
    std::string name;
    GLint location = -1;
    int unit = -1;                  // samplers only
    GLenum target = GL_TEXTURE_2D;  // samplers only
  };
  GLuint name = 0;
  std::vector<UniformSlot> uniforms, samplers;
};

// "u_rects[0]" → "u_rects"
std::string plainName(const char* name) {
  std::string text(name);
  return text.substr(0, text.find('['));
}

bool isSampler(GLenum type) {
  return type == GL_SAMPLER_2D || type == GL_UNSIGNED_INT_SAMPLER_2D || type == GL_INT_SAMPLER_2D ||
         type == GL_SAMPLER_2D_ARRAY || type == GL_UNSIGNED_INT_SAMPLER_2D_ARRAY;
}

GLenum samplerTarget(GLenum type) {
  return type == GL_SAMPLER_2D_ARRAY || type == GL_UNSIGNED_INT_SAMPLER_2D_ARRAY ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
}

void setUniform(GLint location, const Uniform& value) {
  const auto* floats = static_cast<const GLfloat*>(value.data);
  switch (value.kind) {
    case Uniform::Kind::Int:
      glUniform1iv(location, value.count, static_cast<const GLint*>(value.data));
      break;
    case Uniform::Kind::UInt:
      glUniform1uiv(location, value.count, static_cast<const GLuint*>(value.data));
      break;
    case Uniform::Kind::Float:
      glUniform1fv(location, value.count, floats);
      break;
    case Uniform::Kind::Vec2:
      glUniform2fv(location, value.count, floats);
      break;
    case Uniform::Kind::Vec3:
      glUniform3fv(location, value.count, floats);
      break;
    case Uniform::Kind::Vec4:
      glUniform4fv(location, value.count, floats);
      break;
    case Uniform::Kind::Mat4:
      glUniformMatrix4fv(location, value.count, GL_FALSE, floats);
      break;
  }
}

Error gpuError(const std::string& message) { return Error{ErrorId::GpuFailure, message}; }

void setCapability(GLenum capability, bool on) { on ? glEnable(capability) : glDisable(capability); }

class GlesDevice final : public Device {
 public:
  explicit GlesDevice(const Caps& caps) : Device(caps) { invalidateState(); }

  void invalidateState() override {
    program_ = 0;
    units_.fill({});
    has_state_ = false;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glPixelStorei(GL_UNPACK_SKIP_ROWS, 0);
    glPixelStorei(GL_UNPACK_SKIP_PIXELS, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glBindVertexArray(0);
    for (GLenum capability : {GL_DITHER, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_POLYGON_OFFSET_FILL,
                              GL_RASTERIZER_DISCARD, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE})
      glDisable(capability);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glDepthRangef(0, 1);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glFrontFace(GL_CCW);
    glCullFace(GL_BACK);
  }

 protected:
  Status onCreateTexture(TextureRecord& texture) override {
    drainErrors();
    GLuint name = 0;
    glGenTextures(1, &name);
    if (name == 0) return gpuError("texture '" + texture.label + "': the GL context is lost or absent");
    texture.native = name;
    const GLenum target = glTarget(texture);
    const TextureDesc& desc = texture.desc;
    const GLenum internal = glFormat(desc.format).internal;
    bindUnit(0, target, name);
    if (desc.respecifiable)  // format that browsers copy video frames to fastest
      glTexImage2D(target, 0, GL_RGBA, desc.width, desc.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    else if (desc.layers > 0)
      glTexStorage3D(target, texture.levels, internal, desc.width, desc.height, desc.layers);
    else
      glTexStorage2D(target, texture.levels, internal, desc.width, desc.height);
    const bool nearest = desc.filter == Filter::Nearest;
    const GLint shrink = nearest ? GL_NEAREST : texture.levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR;
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, shrink);
    glTexParameteri(target, GL_TEXTURE_MAG_FILTER, nearest ? GL_NEAREST : GL_LINEAR);
    glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
      onDestroyTexture(texture);
      return gpuError("texture '" + texture.label + "': " + std::to_string(texture.bytes) +
                      " bytes refused (GL error " + std::to_string(error) + "); use smaller textures");
    }
    return {};
  }

  void onUpdateTexture(const TextureRecord& texture, const Region& region, const void* pixels, int stride_bytes,
                       int layer) override {
    const int pixel_bytes = bytesPerPixel(texture.desc.format);
    bindUnit(0, glTarget(texture), texture.native);
    if (stride_bytes % pixel_bytes == 0) {
      glPixelStorei(GL_UNPACK_ROW_LENGTH, stride_bytes / pixel_bytes);
      upload(texture, region, pixels, layer);
      glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
      return;
    }
    const auto* row = static_cast<const uint8_t*>(pixels);
    for (int i = 0; i < region.height; ++i, row += stride_bytes)
      upload(texture, {region.x, region.y + i, region.width, 1}, row, layer);
  }

  void onGenerateMipmaps(const TextureRecord& texture) override {
    bindUnit(0, glTarget(texture), texture.native);
    glGenerateMipmap(glTarget(texture));
  }

  void onDestroyTexture(const TextureRecord& texture) override {
    for (Unit& unit : units_)
      if (unit.texture == texture.native) unit = {};
    const GLuint name = texture.native;
    glDeleteTextures(1, &name);
  }

  IndexBufferId onCreateIndexBuffer() override {
    GLuint name = 0;
    glGenBuffers(1, &name);
    return name;
  }

  void onUpdateIndices(IndexBufferId buffer, std::span<const uint32_t> indices) override {
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                 GL_DYNAMIC_DRAW);
  }

  void onDestroyIndexBuffer(IndexBufferId buffer) override { glDeleteBuffers(1, &buffer); }

  Status onCreateProgram(ProgramId id, const std::string& label, const std::string& vertex_text,
                         const std::string& fragment_text) override {
    std::string log;
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_text, log);
    const GLuint fragment = log.empty() ? compile(GL_FRAGMENT_SHADER, fragment_text, log) : 0;
    GlProgram program;
    if (log.empty()) program.name = link(vertex, fragment, log);
    if (vertex) glDeleteShader(vertex);
    if (fragment) glDeleteShader(fragment);
    if (!log.empty()) return gpuError("program '" + label + "': " + log);
    if (const std::string why = findUniforms(program); !why.empty()) {
      glDeleteProgram(program.name);
      return gpuError("program '" + label + "': " + why);
    }
    programs_[id] = std::move(program);
    return {};
  }

  void onDestroyProgram(ProgramId id) override {
    const GLuint name = programs_[id].name;
    if (program_ == name) glUseProgram(0), program_ = 0;
    glDeleteProgram(name);
    programs_.erase(id);
  }

  Status onCreateTarget(TargetRecord& target) override {
    glGenFramebuffers(1, &target.framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    std::vector<GLenum> buffers;
    for (size_t i = 0; i < target.desc.colors.size(); ++i) {
      const GLenum slot = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
      attachTexture(slot, *texture(target.desc.colors[i]), target.desc.color_layer);
      buffers.push_back(slot);
    }
    if (target.own_color) {
      target.color_buffer = attachBuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, target);
      buffers.push_back(GL_COLOR_ATTACHMENT0);
    }
    if (target.own_depth) target.depth_buffer = attachBuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, target);
    if (target.desc.depth) attachTexture(GL_DEPTH_ATTACHMENT, *texture(target.desc.depth), target.desc.depth_layer);
    if (buffers.empty()) buffers.push_back(GL_NONE);
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
    glReadBuffer(buffers[0]);
    const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state == GL_FRAMEBUFFER_COMPLETE) return {};
    onDestroyTarget(target);
    return gpuError("target '" + target.label + "': framebuffer incomplete (" + std::to_string(state) +
                    "); this GPU cannot draw into these formats");
  }

  void onDestroyTarget(const TargetRecord& target) override {
    glDeleteFramebuffers(1, &target.framebuffer);
    if (target.color_buffer) glDeleteRenderbuffers(1, &target.color_buffer);
    if (target.depth_buffer) glDeleteRenderbuffers(1, &target.depth_buffer);
  }

  void onBeginPass(const Pass& pass, const TargetRecord* target) override {
    glBindFramebuffer(GL_FRAMEBUFFER, target ? target->framebuffer : 0);
    glViewport(pass.x, pass.y, pass.width, pass.height);
    if (!pass.clear_color && !pass.clear_depth) return;
    glEnable(GL_SCISSOR_TEST);
    glScissor(pass.x, pass.y, pass.width, pass.height);
    const size_t count = target ? target->formats.size() : 1;
    for (size_t i = 0; pass.clear_color && i < count; ++i)
      clearColor(static_cast<GLint>(i), target ? target->formats[i] : PixelFormat::RGBA8, pass.color);
    if (pass.clear_depth && (!target || target->own_depth || target->desc.depth)) {
      setDepthWrite(true);
      const GLfloat far_end = 1;
      glClearBufferfv(GL_DEPTH, 0, &far_end);
    }
    glDisable(GL_SCISSOR_TEST);
  }

  void onDraw(const Draw& draw) override {
    const GlProgram& program = programs_[draw.program];
    if (program_ != program.name) glUseProgram(program_ = program.name);
    for (const GlProgram::UniformSlot& sampler : program.samplers)
      bindUnit(sampler.unit, sampler.target, boundTo(draw, sampler));
    for (const Uniform& value : draw.uniforms)
      for (const GlProgram::UniformSlot& slot : program.uniforms)
        if (slot.name == value.name) setUniform(slot.location, value);
    setState(draw);
    if (!draw.indices) return glDrawArrays(GL_TRIANGLES, 0, draw.vertex_count);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, draw.indices);
    glDrawElements(GL_TRIANGLES, draw.vertex_count, GL_UNSIGNED_INT, nullptr);
  }

  void onBlit(const TargetRecord* from, const TargetRecord* to, const Region& region) override {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from ? from->framebuffer : 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to ? to->framebuffer : 0);
    glBlitFramebuffer(0, 0, region.width, region.height, region.x, region.y, region.x + region.width,
                      region.y + region.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    // Discards the samples, which tiled GPUs then need not store. Otherwise ANGLE on Vulkan applies the next clear of
    // `from` to `to`.
    constexpr GLenum kSamples[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    if (from && from->samples > 1) glInvalidateFramebuffer(GL_READ_FRAMEBUFFER, 2, kSamples);
  }

  Status onReadPixels(const TargetRecord* target, PixelFormat format, const Region& region, void* out) override {
    const auto [x, y, width, height] = region;
    // Reads four channels, the only layouts guaranteed to be readable, and keeps the format's channels.
    drainErrors();
    const bool is_byte = glFormat(format).type == GL_UNSIGNED_BYTE;
    const size_t channel_bytes = is_byte ? 1 : 4;
    const size_t pixel_bytes = readBytesPerPixel(format), row_bytes = pixel_bytes * width;
    std::vector<uint8_t> whole(4 * channel_bytes * width * height);
    glBindFramebuffer(GL_FRAMEBUFFER, target ? target->framebuffer : 0);
    const bool is_integer = format == PixelFormat::R32UI;
    glReadPixels(x, y, width, height, is_integer ? GL_RGBA_INTEGER : GL_RGBA,
                 is_integer ? GL_UNSIGNED_INT
                 : is_byte  ? GL_UNSIGNED_BYTE
                            : GL_FLOAT,
                 whole.data());
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      return gpuError("readPixels of '" + (target ? target->label : "") + "': GL error " + std::to_string(error));
    for (int row = 0; row < height; ++row) {
      const uint8_t* source = whole.data() + 4 * channel_bytes * width * (height - 1 - row);
      uint8_t* destination = static_cast<uint8_t*>(out) + row_bytes * row;
      for (int i = 0; i < width; ++i)
        std::memcpy(destination + pixel_bytes * i, source + 4 * channel_bytes * i, pixel_bytes);
    }
    return {};
  }

  void onBeginRead(ReadId read, const TargetRecord* target, const Region& region) override {
    PendingRead& pending = reads_[read];
    glGenBuffers(1, &pending.buffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, pending.buffer);
    glBufferData(GL_PIXEL_PACK_BUFFER, bytesOf(region), nullptr, GL_STREAM_READ);
    glBindFramebuffer(GL_FRAMEBUFFER, target ? target->framebuffer : 0);
    glReadPixels(region.x, region.y, region.width, region.height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    pending.fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
  }

  bool onEndRead(ReadId read, const Region& region, void* out) override {
    const PendingRead pending = reads_[read];
    if (out) {
      const GLenum state = glClientWaitSync(pending.fence, 0, 0);
      if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED) return false;
      copyRows(pending.buffer, region, static_cast<uint8_t*>(out));
    }
    glDeleteSync(pending.fence);
    glDeleteBuffers(1, &pending.buffer);
    reads_.erase(read);
    return true;
  }

  std::string onTakeErrors() override {
    std::string lines = std::move(pending_);
    pending_.clear();
    for (int i = 0; i < 16; ++i) {
      const GLenum error = glGetError();
      if (error == GL_NO_ERROR) break;
      lines += "GL error " + std::to_string(error) + "\n";
    }
    return lines;
  }

 private:
  struct PendingRead {
    GLuint buffer = 0;
    GLsync fence = nullptr;
  };

  static GLsizeiptr bytesOf(const Region& region) { return GLsizeiptr{4} * region.width * region.height; }

  // Copies rows from the buffer's GL order to top row first.
  static void copyRows(GLuint buffer, const Region& region, uint8_t* out) {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
    const int row_bytes = 4 * region.width;
    for (int row = 0; row < region.height; ++row)
      readPackBuffer(row_bytes * (region.height - 1 - row), row_bytes, out + ptrdiff_t{row_bytes} * row);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  }

  struct Unit {
    GLenum target = 0;
    GLuint texture = 0;
  };

  // Keeps earlier errors for takeErrors, so that the next glGetError reports the next call.
  void drainErrors() { pending_ = onTakeErrors(); }

  void bindUnit(int unit, GLenum target, GLuint name) {
    Unit& cached = units_[unit];
    if (cached.target == target && cached.texture == name) return;
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(target, name);
    cached = {target, name};
    if (unit != 0) glActiveTexture(GL_TEXTURE0);
  }

  // Requires the texture bound at unit 0, which bindUnit leaves active.
  static void upload(const TextureRecord& texture, const Region& region, const void* pixels, int layer) {
    const auto [x, y, width, height] = region;
    const GlFormat format = glFormat(texture.desc.format);
    if (texture.desc.layers > 0)
      glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, x, y, layer, width, height, 1, format.format, format.type, pixels);
    else
      glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, width, height, format.format, format.type, pixels);
  }

  GLuint boundTo(const Draw& draw, const GlProgram::UniformSlot& sampler) const {
    for (const TextureBinding& binding : draw.textures)
      if (sampler.name == binding.sampler) return texture(binding.texture)->native;
    return 0;
  }

  static GLuint compile(GLenum stage, const std::string& source, std::string& log) {
    const GLuint shader = glCreateShader(stage);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok) return shader;
    std::array<char, 2048> buffer{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(buffer.size()) - 1, nullptr, buffer.data());
    log = std::string(stage == GL_VERTEX_SHADER ? "vertex" : "fragment") + " shader: " + buffer.data();
    return shader;
  }

  static GLuint link(GLuint vertex, GLuint fragment, std::string& log) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, vertex);
    glAttachShader(program, fragment);
    glLinkProgram(program);
    GLint ok = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (ok) return program;
    std::array<char, 2048> buffer{};
    glGetProgramInfoLog(program, static_cast<GLsizei>(buffer.size()) - 1, nullptr, buffer.data());
    glDeleteProgram(program);
    log = std::string("link: ") + buffer.data();
    return 0;
  }

  // Assigns every sampler its own texture unit. Returns an error message, or an empty string.
  std::string findUniforms(GlProgram& program) {
    glUseProgram(program_ = program.name);
    GLint count = 0;
    glGetProgramiv(program.name, GL_ACTIVE_UNIFORMS, &count);
    for (GLint i = 0; i < count; ++i) {
      std::array<char, 128> name{};
      GLint size = 0;
      GLenum type = 0;
      glGetActiveUniform(program.name, static_cast<GLuint>(i), static_cast<GLsizei>(name.size()), nullptr, &size, &type,
                         name.data());
      GlProgram::UniformSlot slot{plainName(name.data()), glGetUniformLocation(program.name, name.data())};
      if (slot.location < 0) continue;
      if (!isSampler(type)) {
        program.uniforms.push_back(std::move(slot));
        continue;
      }
      if (size != 1) return "arrays of samplers are not supported: " + slot.name;
      slot.unit = static_cast<int>(program.samplers.size());
      slot.target = samplerTarget(type);
      if (slot.unit >= kMaxUnits) return "more than 16 samplers";
      glUniform1i(slot.location, slot.unit);
      program.samplers.push_back(std::move(slot));
    }
    return {};
  }

  static void attachTexture(GLenum slot, const TextureRecord& texture, int layer) {
    if (texture.desc.layers > 0)
      glFramebufferTextureLayer(GL_FRAMEBUFFER, slot, texture.native, 0, layer);
    else
      glFramebufferTexture2D(GL_FRAMEBUFFER, slot, GL_TEXTURE_2D, texture.native, 0);
  }

  static GLuint attachBuffer(GLenum slot, GLenum internal, const TargetRecord& target) {
    GLuint buffer = 0;
    glGenRenderbuffers(1, &buffer);
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    if (target.samples > 1)
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, target.samples, internal, target.width, target.height);
    else
      glRenderbufferStorage(GL_RENDERBUFFER, internal, target.width, target.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, slot, GL_RENDERBUFFER, buffer);
    return buffer;
  }

  static void clearColor(GLint index, PixelFormat format, const glm::vec4& color) {
    if (format != PixelFormat::R32UI) return glClearBufferfv(GL_COLOR, index, &color[0]);
    std::array<GLuint, 4> value{};
    for (int i = 0; i < 4; ++i)
      value[i] = color[i] >= 4294967295.0f ? 0xffffffffu : static_cast<GLuint>(std::max(color[i], 0.0f));
    glClearBufferuiv(GL_COLOR, index, value.data());
  }

  void setDepthWrite(bool on) {
    if (!has_state_ || depth_write_ != on) glDepthMask(on ? GL_TRUE : GL_FALSE);
    depth_write_ = on;
  }

  void setState(const Draw& draw) {
    setDepthWrite(draw.depth_write);
    if (!has_state_ || depth_test_ != draw.depth_test) setCapability(GL_DEPTH_TEST, draw.depth_test);
    if (!has_state_ || blend_ != draw.blend) setCapability(GL_BLEND, draw.blend != Blend::None);
    if (!has_state_ || cull_ != draw.cull) setCapability(GL_CULL_FACE, draw.cull == Cull::Back);
    depth_test_ = draw.depth_test;
    blend_ = draw.blend;
    cull_ = draw.cull;
    has_state_ = true;
  }

  std::map<ProgramId, GlProgram> programs_;
  std::map<ReadId, PendingRead> reads_;
  std::array<Unit, kMaxUnits> units_{};
  GLuint program_ = 0;
  bool has_state_ = false;
  bool depth_test_ = false, depth_write_ = false;
  Blend blend_ = Blend::None;
  Cull cull_ = Cull::None;
  std::string pending_;
};

}  // namespace

Result<std::unique_ptr<Device>> createGlesDevice() {
  FOURDVT_ASSIGN(const Caps caps, readCaps());
  return std::unique_ptr<Device>(std::make_unique<GlesDevice>(caps));
}

}  // namespace fourdvt::gpu
