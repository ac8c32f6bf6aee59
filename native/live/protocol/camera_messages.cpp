// SPDX-License-Identifier: Apache-2.0
#include "live/protocol/camera_messages.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"

namespace fourdvt::live {
namespace {

enum class Kind : uint8_t { Hello = 1, ClockAnswer, Picture, ClockQuestion, Settings };

constexpr int kMaxSide = 4095;

Error invalid(const char* what) {
  return {ErrorId::StreamInvalid,
          std::string("live camera: ") + what + "; use the same version of fourdvt on all sides"};
}

void writeRect(ByteWriter& out, const package::Rect& r) {
  for (const int side : {r.x, r.y, r.width, r.height}) out.u16(static_cast<uint16_t>(side));
}

package::Rect readRect(ByteReader& in) {
  package::Rect r;
  for (int* side : {&r.x, &r.y, &r.width, &r.height}) *side = in.u16();
  return r;
}

bool isSane(const package::Rect& r) {
  return (r.width == 0) == (r.height == 0) && r.x + r.width <= kMaxSide && r.y + r.height <= kMaxSide;
}

struct WriteFromCamera {
  ByteWriter& out;
  void operator()(const Hello& m) const {
    out.u8(uint8_t(Kind::Hello));
    out.u16(kCameraProtocol);
    out.u16(static_cast<uint16_t>(m.width));
    out.u16(static_cast<uint16_t>(m.height));
    out.u8(static_cast<uint8_t>(m.camera.size()));
    out.bytes({reinterpret_cast<const uint8_t*>(m.camera.data()), m.camera.size()});
  }
  void operator()(const ClockAnswer& m) const {
    out.u8(uint8_t(Kind::ClockAnswer));
    out.u64(static_cast<uint64_t>(m.server_us));
    out.u64(static_cast<uint64_t>(m.camera_us));
  }
  void operator()(const CameraPicture& m) const {
    out.u8(uint8_t(Kind::Picture));
    out.u32(m.number);
    out.u64(static_cast<uint64_t>(m.captured_us));
    out.u32(m.keyed_us);
    writeRect(out, m.crop);
    out.u16(static_cast<uint16_t>(m.rings.size()));
    for (const Ring16& ring : m.rings) {
      out.u16(static_cast<uint16_t>(ring.size()));
      for (const Point16& p : ring) out.u16(p.x), out.u16(p.y);
    }
    out.bytes(m.jpeg);
  }
};

struct WriteToCamera {
  ByteWriter& out;
  void operator()(const ClockQuestion& m) const {
    out.u8(uint8_t(Kind::ClockQuestion));
    out.u64(static_cast<uint64_t>(m.server_us));
  }
  void operator()(const CameraSettings& m) const {
    out.u8(uint8_t(Kind::Settings));
    out.f32(static_cast<float>(m.tolerance_px));
    out.u8(static_cast<uint8_t>(m.jpeg_quality));
    writeRect(out, m.region);
  }
};

Result<FromCamera> readHello(ByteReader& in) {
  if (in.u16() != kCameraProtocol)
    return Error{ErrorId::Unsupported, "live camera of another version; use the same version of fourdvt on all sides"};
  Hello m;
  m.width = in.u16();
  m.height = in.u16();
  const auto name = in.bytes(in.u8());
  m.camera.assign(name.begin(), name.end());
  const auto isPlain = [](char c) { return c > 0x20 && c < 0x7f && c != '"' && c != '\\' && c != '/'; };
  if (!in.ok() || m.camera.empty() || m.camera.size() > 128 || !std::all_of(m.camera.begin(), m.camera.end(), isPlain))
    return invalid("bad name");
  if (m.width < 1 || m.height < 1 || m.width > kMaxSide || m.height > kMaxSide) return invalid("bad picture size");
  return FromCamera(std::move(m));
}

Result<FromCamera> readPicture(ByteReader& in) {
  CameraPicture m;
  m.number = in.u32();
  m.captured_us = static_cast<int64_t>(in.u64());
  m.keyed_us = in.u32();
  m.crop = readRect(in);
  const size_t rings = in.u16();
  if (!in.ok() || rings > kMaxRings) return invalid("too many rings");
  if (!isSane(m.crop)) return invalid("bad crop");
  size_t points = 0;
  for (size_t r = 0; r < rings; ++r) {
    const size_t count = in.u16();
    points += count;
    if (!in.ok() || count < 3 || points > kMaxRingPoints || in.remaining() < 4 * count) return invalid("bad ring");
    Ring16& ring = m.rings.emplace_back(count);
    for (Point16& p : ring) {
      p.x = in.u16();
      p.y = in.u16();
    }
  }
  const auto jpeg = in.bytes(in.remaining());
  m.jpeg.assign(jpeg.begin(), jpeg.end());
  if (m.jpeg.empty() != (m.crop.width == 0)) return invalid("crop and picture do not match");
  return FromCamera(std::move(m));
}

}  // namespace

std::vector<uint8_t> writeFromCamera(const FromCamera& message) {
  ByteWriter out;
  std::visit(WriteFromCamera{out}, message);
  return out.take();
}

std::vector<uint8_t> writeToCamera(const ToCamera& message) {
  ByteWriter out;
  std::visit(WriteToCamera{out}, message);
  return out.take();
}

Result<FromCamera> readFromCamera(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxCameraMessageBytes) return invalid("message too long");
  ByteReader in(bytes);
  const auto kind = static_cast<Kind>(in.u8());
  if (kind == Kind::Picture) return readPicture(in);
  FromCamera out;
  if (kind == Kind::Hello) {
    FOURDVT_ASSIGN(out, readHello(in));
  } else if (kind == Kind::ClockAnswer) {
    ClockAnswer m;
    m.server_us = static_cast<int64_t>(in.u64());
    m.camera_us = static_cast<int64_t>(in.u64());
    out = m;
  } else {
    return invalid("unknown message");
  }
  if (!in.ok() || in.remaining() > 0) return invalid("message of a wrong length");
  return out;
}

Result<ToCamera> readToCamera(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxServerMessageBytes) return invalid("message too long");
  ByteReader in(bytes);
  const auto kind = static_cast<Kind>(in.u8());
  ToCamera out;
  if (kind == Kind::ClockQuestion) {
    out = ClockQuestion{static_cast<int64_t>(in.u64())};
  } else if (kind == Kind::Settings) {
    CameraSettings m;
    m.tolerance_px = in.f32();
    m.jpeg_quality = in.u8();
    m.region = readRect(in);
    if (!(m.tolerance_px >= 0 && m.tolerance_px <= 64) || m.jpeg_quality < 1 || m.jpeg_quality > 100 ||
        !isSane(m.region))
      return invalid("settings out of range");
    out = m;
  } else {
    return invalid("unknown message");
  }
  if (!in.ok() || in.remaining() > 0) return invalid("message of a wrong length");
  return out;
}

}  // namespace fourdvt::live
