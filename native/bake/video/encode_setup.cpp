// SPDX-License-Identifier: Apache-2.0
#include "bake/video/encode_setup.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>

extern "C" {
#include <libavutil/opt.h>
}

namespace fourdvt::bake {
namespace {

constexpr const char* kX264Presets[] = {"ultrafast", "superfast", "veryfast", "faster",  "fast",
                                        "medium",    "slow",      "slower",   "veryslow"};
// Faster presets of SVT-AV1 1.4 skip residuals of whole blocks, and with them the barcode's cells (bake_encode_test).
constexpr int kFastestSvt = 7;
constexpr const char* kAom = "aom-";
constexpr int kWholeGop = 10000;  // longer than any GOP: the first picture is the only key

// -1 if the text is not a whole number from 0 to `highest`.
int speed(const std::string& text, int highest) {
  if (text.empty() || text.size() > 2 || text.find_first_not_of("0123456789") != std::string::npos) return -1;
  const int value = std::atoi(text.c_str());
  return value <= highest ? value : -1;
}

bool isAom(const std::string& preset) { return preset.rfind(kAom, 0) == 0; }

std::string presetOf(const EncodeSettings& s) { return s.preset.empty() ? infoOf(s.codec).default_preset : s.preset; }

struct EncoderName {
  const char *name, *package;
};

EncoderName encoderName(const EncodeSettings& s) {
  switch (s.codec) {
    case Codec::H264:
      return {"libx264", "libx264 (Debian: libavcodec-extra59 or libavcodec59 with libx264-164)"};
    case Codec::Vp9:
      return {"libvpx-vp9", "libvpx (Debian: libavcodec59 with libvpx7)"};
    case Codec::Av1:
      if (isAom(presetOf(s))) return {"libaom-av1", "libaom (Debian: libavcodec59 with libaom3)"};
      return {"libsvtav1", "SVT-AV1 (Debian: libavcodec59 with libsvtav1enc1)"};
  }
  return {};
}

// Keeps SVT-AV1 from writing a banner to standard error for every encoder; errors are still written.
void quietSvt() {
  static std::once_flag once;
  std::call_once(once, [] { setenv("SVT_LOG", "1", 0); });
}

void setCommon(const EncodeSettings& s, AVCodecContext& c) {
  const AVRational fps = av_d2q(s.fps, 100000);
  c.width = s.width;
  c.height = s.height;
  c.pix_fmt = AV_PIX_FMT_YUV420P;
  c.time_base = av_inv_q(fps);
  c.framerate = fps;
  c.gop_size = kWholeGop;
  c.thread_count = 1;
  c.flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
  c.color_range = AVCOL_RANGE_MPEG;
  c.color_primaries = AVCOL_PRI_BT709;
  c.color_trc = AVCOL_TRC_BT709;
  c.colorspace = AVCOL_SPC_BT709;
  c.chroma_sample_location = AVCHROMA_LOC_CENTER;
}

void configureX264(const EncodeSettings& s, AVCodecContext& c) {
  c.max_b_frames = 3;
  av_opt_set(c.priv_data, "preset", presetOf(s).c_str(), 0);
  av_opt_set_double(c.priv_data, "crf", s.crf, 0);
  // Measured on rendered views (mbtree, aq-mode, psy: an atlas has no background to save on and no viewer's eye on
  // it; chroma as fine as RGB-PSNR wants it): a quarter fewer bits at the same SSIM than x264's own defaults.
  std::string params =
      "scenecut=0:b-pyramid=none:rc-lookahead=8:threads=1:lookahead-threads=1:mbtree=0:aq-mode=0:psy=0:"
      "chroma-qp-offset=-2:deblock=-3,-3:qcomp=0.64";
  if (!s.extra.empty()) params += ":" + s.extra;
  av_opt_set(c.priv_data, "x264-params", params.c_str(), 0);
}

void configureVpx(const EncodeSettings& s, AVCodecContext& c) {
  c.keyint_min = kWholeGop;  // equal to gop_size: libvpx adds no key pictures
  c.bit_rate = 0;            // constant quality
  av_opt_set_double(c.priv_data, "crf", s.crf, 0);
  av_opt_set(c.priv_data, "deadline", "good", 0);
  av_opt_set(c.priv_data, "cpu-used", presetOf(s).c_str(), 0);
  av_opt_set_int(c.priv_data, "lag-in-frames", 25, 0);
  av_opt_set_int(c.priv_data, "auto-alt-ref", 1, 0);
  av_opt_set_int(c.priv_data, "arnr-maxframes", 0, 0);  // no temporal filter
  av_opt_set_int(c.priv_data, "row-mt", 0, 0);
}

void configureAom(const EncodeSettings& s, AVCodecContext& c) {
  c.keyint_min = kWholeGop;
  c.bit_rate = 0;
  av_opt_set_double(c.priv_data, "crf", s.crf, 0);
  av_opt_set(c.priv_data, "usage", "good", 0);
  av_opt_set(c.priv_data, "cpu-used", presetOf(s).c_str() + std::strlen(kAom), 0);
  av_opt_set_int(c.priv_data, "lag-in-frames", 25, 0);
  av_opt_set_int(c.priv_data, "row-mt", 0, 0);
  av_opt_set_int(c.priv_data, "arnr-max-frames", 0, 0);  // no temporal filter, not even of key pictures
  av_opt_set(c.priv_data, "aom-params", "enable-keyframe-filtering=0", 0);
}

void configureSvt(const EncodeSettings& s, AVCodecContext& c) {
  quietSvt();
  av_opt_set(c.priv_data, "preset", presetOf(s).c_str(), 0);
  av_opt_set_int(c.priv_data, "crf", s.crf, 0);
  std::string params = "lp=1:scd=0:enable-tf=0";  // its temporal filter would denoise pictures that are shown
  if (!s.extra.empty()) params += ":" + s.extra;
  av_opt_set(c.priv_data, "svtav1-params", params.c_str(), 0);
}

// Sets "key=value:key=value" in the wrapper's own options.
Status setExtra(const EncodeSettings& s, AVCodecContext& c) {
  if (s.codec == Codec::H264 || encoderName(s).name == std::string("libsvtav1") || s.extra.empty()) return {};
  if (av_set_options_string(c.priv_data, s.extra.c_str(), "=", ":") >= 0) return {};
  return Error{ErrorId::InvalidArgument, std::string(encoderName(s).name) + " has no option \"" + s.extra + "\""};
}

}  // namespace

std::string codecNames() {
  std::string out;
  for (const CodecInfo& info : kCodecInfos) out += (out.empty() ? "" : ", ") + std::string(info.name);
  return out;
}

bool parseCodec(const std::string& name, Codec& codec) {
  for (size_t i = 0; i < kCodecs; ++i) {
    if (name != kCodecInfos[i].name) continue;
    codec = static_cast<Codec>(i);
    return true;
  }
  return false;
}

bool knowsPreset(Codec codec, const std::string& preset) {
  if (preset.empty()) return true;
  switch (codec) {
    case Codec::H264:
      return std::any_of(std::begin(kX264Presets), std::end(kX264Presets), [&](const char* p) { return preset == p; });
    case Codec::Vp9:
      return speed(preset, 5) >= 0;
    case Codec::Av1:
      return isAom(preset) ? speed(preset.substr(std::strlen(kAom)), 8) >= 0 : speed(preset, kFastestSvt) >= 0;
  }
  return false;
}

Result<const AVCodec*> findEncoder(const EncodeSettings& s) {
  if (!knowsPreset(s.codec, s.preset))
    return Error{ErrorId::InvalidArgument, std::string(infoOf(s.codec).name) + " has no preset \"" + s.preset +
                                               "\"; use " + infoOf(s.codec).presets};
  const EncoderName wanted = encoderName(s);
  if (const AVCodec* codec = avcodec_find_encoder_by_name(wanted.name)) return codec;
  return Error{ErrorId::Unsupported, std::string("this FFmpeg has no ") + wanted.name + " encoder for " +
                                         infoOf(s.codec).name + ": install an FFmpeg built with " + wanted.package +
                                         ", or bake with another --codec"};
}

bool encodesInTwoPasses(const EncodeSettings& s) {
  return s.codec == Codec::Vp9 || (s.codec == Codec::Av1 && isAom(presetOf(s)));
}

Status configureEncoder(const EncodeSettings& s, Pass pass, AVCodecContext& c) {
  setCommon(s, c);
  if (pass == Pass::First) c.flags |= AV_CODEC_FLAG_PASS1;
  if (pass == Pass::Second) c.flags |= AV_CODEC_FLAG_PASS2;
  switch (s.codec) {
    case Codec::H264:
      configureX264(s, c);
      break;
    case Codec::Vp9:
      configureVpx(s, c);
      break;
    case Codec::Av1:
      isAom(presetOf(s)) ? configureAom(s, c) : configureSvt(s, c);
      break;
  }
  return setExtra(s, c);
}

}  // namespace fourdvt::bake
