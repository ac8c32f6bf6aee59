// SPDX-License-Identifier: Apache-2.0
#include "platform/video_alpha.h"

#include <algorithm>
#include <vector>

#include "base/bytes.h"

extern "C" {
#include <libavutil/dict.h>
}

namespace fourdvt::platform {
namespace {

constexpr size_t kBeforeArrays = 22;  // bytes of an hvcC record before the number of its arrays
constexpr uint8_t kPrefixSei = 39, kAlphaChannelInformation = 165;

uint32_t bigEndian16(ByteReader& in) {
  const uint32_t high = in.u8();
  return high << 8 | in.u8();
}

// Reads a type or size of an SEI message: bytes of 255 and a last one, summed.
uint32_t seiNumber(ByteReader& in) {
  uint32_t sum = 0;
  uint8_t byte = 255;
  while (byte == 255 && in.remaining() > 0) sum += byte = in.u8();
  return sum;
}

bool seiHasAlpha(std::span<const uint8_t> unit) {
  ByteReader in(unit);
  in.bytes(2);  // header
  while (in.ok() && in.remaining() > 1) {
    if (seiNumber(in) == kAlphaChannelInformation) return true;
    in.bytes(seiNumber(in));
  }
  return false;
}

bool isVpx(AVCodecID id) { return id == AV_CODEC_ID_VP8 || id == AV_CODEC_ID_VP9; }

}  // namespace

bool hevcConfigHasAlpha(std::span<const uint8_t> hvcc) {
  ByteReader in(hvcc);
  in.bytes(kBeforeArrays);
  for (int arrays = in.u8(); arrays > 0 && in.ok(); --arrays) {
    const bool sei = (in.u8() & 63) == kPrefixSei;
    for (uint32_t units = bigEndian16(in); units > 0 && in.ok(); --units) {
      const auto unit = in.bytes(bigEndian16(in));
      if (sei && seiHasAlpha(unit)) return true;
    }
  }
  return false;
}

AlphaKind alphaKindOf(const AVStream& stream) {
  const AVCodecParameters& p = *stream.codecpar;
  const AVDictionaryEntry* mode = av_dict_get(stream.metadata, "alpha_mode", nullptr, 0);
  if (isVpx(p.codec_id)) return mode && std::string(mode->value) == "1" ? AlphaKind::InBlocks : AlphaKind::None;
  if (p.codec_id == AV_CODEC_ID_HEVC && hevcConfigHasAlpha({p.extradata, size_t(std::max(0, p.extradata_size))}))
    return AlphaKind::HevcLayer;
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(AVPixelFormat(p.format));
  return format && format->flags & AV_PIX_FMT_FLAG_ALPHA ? AlphaKind::InPictures : AlphaKind::None;
}

Result<const AVCodec*> decoderWithAlpha(const AVStream& stream, const AVCodec* usual, const std::string& path) {
  const AlphaKind kind = alphaKindOf(stream);
  const AVPixFmtDescriptor* pixels = av_pix_fmt_desc_get(AVPixelFormat(stream.codecpar->format));
  if (kind == AlphaKind::InPictures && pixels->flags & AV_PIX_FMT_FLAG_FLOAT) {
    return Error{ErrorId::FileUnreadable, path + ": alpha of floating-point numbers is not read; export it as ProRes " +
                                              "4444, or give mattes of their own"};
  }
  if (kind == AlphaKind::None || kind == AlphaKind::InPictures) return usual;
  const bool vp8 = stream.codecpar->codec_id == AV_CODEC_ID_VP8;
  if (kind == AlphaKind::InBlocks)
    if (const AVCodec* libvpx = avcodec_find_decoder_by_name(vp8 ? "libvpx" : "libvpx-vp9")) return libvpx;
  const std::string codec = kind == AlphaKind::HevcLayer ? "HEVC" : vp8 ? "VP8" : "VP9";
  return Error{ErrorId::FileUnreadable, path + ": " + codec +
                                            " with an alpha channel, which this build does not decode" +
                                            "; export it as ProRes 4444, or give mattes of their own"};
}

Image alphaOf(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(AVPixelFormat(frame.format));
  if (!format || !(format->flags & AV_PIX_FMT_FLAG_ALPHA)) return {};
  const bool palette = format->flags & AV_PIX_FMT_FLAG_PAL;
  const int component = palette ? 3 : format->nb_components - 1;
  if (!palette && format->comp[component].depth > 16) return {};
  const uint32_t most = palette ? 255 : (1u << format->comp[component].depth) - 1;
  const uint8_t* planes[4] = {frame.data[0], frame.data[1], frame.data[2], frame.data[3]};
  Image out(frame.width, frame.height, 1);
  std::vector<uint16_t> row(size_t(frame.width));
  for (int y = 0; y < frame.height; ++y) {
    av_read_image_line2(row.data(), planes, frame.linesize, format, 0, y, component, frame.width, palette, 2);
    for (int x = 0; x < frame.width; ++x) *out.at(x, y) = uint8_t((row[size_t(x)] * 255u + most / 2) / most);
  }
  return out;
}

bool isOpaque(const Image& alpha) {
  return std::all_of(alpha.pixels.begin(), alpha.pixels.end(), [](uint8_t v) { return v == 255; });
}

Image withAlpha(const Image& rgb, const Image& alpha) {
  Image out(rgb.width, rgb.height, 4, 255);
  for (size_t i = 0; i < size_t(rgb.width) * rgb.height; ++i) {
    std::copy_n(&rgb.pixels[3 * i], 3, &out.pixels[4 * i]);
    if (!alpha.empty()) out.pixels[4 * i + 3] = alpha.pixels[i];
  }
  return out;
}

}  // namespace fourdvt::platform
