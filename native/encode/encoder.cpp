// SPDX-License-Identifier: Apache-2.0
#include "encode/encoder.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "base/text.h"
#include "platform/ffmpeg_handles.h"

extern "C" {
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
}

namespace fourdvt::encode {
namespace {

enum class Pass { Only, First, Second };

constexpr const char* kX264Presets[] = {"ultrafast", "superfast", "veryfast", "faster",  "fast",
                                        "medium",    "slow",      "slower",   "veryslow"};
// Faster presets of SVT-AV1 1.4 skip residuals of whole blocks, and with them the barcode's cells (encode_test).
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
  // Measured on rendered views (mbtree, aq-mode and psy off, because an atlas has no background and is never viewed
  // as it is; chroma as fine as RGB-PSNR requires): a quarter fewer bits at the same SSIM than x264's own defaults.
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
  av_opt_set_int(c.priv_data, "arnr-max-frames", 0, 0);  // no temporal filter, for key pictures either
  av_opt_set(c.priv_data, "aom-params", "enable-keyframe-filtering=0", 0);
}

void configureSvt(const EncodeSettings& s, AVCodecContext& c) {
  quietSvt();
  av_opt_set(c.priv_data, "preset", presetOf(s).c_str(), 0);
  av_opt_set_int(c.priv_data, "crf", s.crf, 0);
  std::string params = "lp=1:scd=0:enable-tf=0";  // the temporal filter would denoise pictures that are shown
  if (!s.extra.empty()) params += ":" + s.extra;
  av_opt_set(c.priv_data, "svtav1-params", params.c_str(), 0);
}

// Sets "key=value:key=value" in the wrapper's own options.
Status setExtra(const EncodeSettings& s, AVCodecContext& c) {
  if (s.codec == Codec::H264 || encoderName(s).name == std::string("libsvtav1") || s.extra.empty()) return {};
  if (av_set_options_string(c.priv_data, s.extra.c_str(), "=", ":") >= 0) return {};
  return Error{ErrorId::InvalidArgument, std::string(encoderName(s).name) + " has no option \"" + s.extra + "\""};
}

// Errors: Unsupported, with the package to install; InvalidArgument (preset).
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

// Configures the context up to avcodec_open2 and the first pass's statistics, which the caller supplies. Errors:
// InvalidArgument (`extra`).
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

class AvEncoder final : public GopEncoder {
 public:
  explicit AvEncoder(const EncodeSettings& settings) : settings_(settings) {}
  Status open();
  Status push(const I420View& picture) override;
  Result<EncodedGop> finish() override;

 private:
  Status openPass(Pass pass);
  Result<platform::AvFrame> copied(const I420View& picture) const;
  Status send(const AVFrame* frame);
  Status drain(bool to_end, bool keep);
  Status secondPass();
  Status checkGop() const;
  Error failure(const char* what, int code) const;

  const EncodeSettings settings_;
  const AVCodec* codec_ = nullptr;
  std::string statistics_;  // first pass's statistics; borrowed by the context of the second pass
  platform::AvCodec context_;
  platform::AvPacket packet_{av_packet_alloc()};
  std::vector<platform::AvFrame> pictures_;  // kept for the second pass
  EncodedGop gop_;
  int64_t next_frame_ = 0;
};

Error AvEncoder::failure(const char* what, int code) const {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return {ErrorId::Internal, std::string(codec_->name) + " encoder: " + what + " failed: " + text};
}

Status AvEncoder::open() {
  av_log_set_level(AV_LOG_ERROR);  // otherwise x264 reports every GOP
  FOURDVT_ASSIGN(codec_, findEncoder(settings_));
  return openPass(encodesInTwoPasses(settings_) ? Pass::First : Pass::Only);
}

Status AvEncoder::openPass(Pass pass) {
  context_.reset(avcodec_alloc_context3(codec_));
  FOURDVT_TRY(configureEncoder(settings_, pass, *context_));
  if (pass == Pass::Second) context_->stats_in = statistics_.data();
  if (const int rc = avcodec_open2(context_.get(), codec_, nullptr); rc < 0) return failure("opening", rc);
  if (context_->extradata && settings_.codec != Codec::Vp9)
    gop_.parameter_sets.assign(context_->extradata, context_->extradata + context_->extradata_size);
  return {};
}

Result<platform::AvFrame> AvEncoder::copied(const I420View& picture) const {
  platform::AvFrame f(av_frame_alloc());
  f->format = AV_PIX_FMT_YUV420P;
  f->width = picture.width;
  f->height = picture.height;
  if (const int rc = av_frame_get_buffer(f.get(), 0); rc < 0) return failure("allocating a picture", rc);
  av_image_copy_plane(f->data[0], f->linesize[0], picture.y, picture.stride_y, f->width, f->height);
  av_image_copy_plane(f->data[1], f->linesize[1], picture.u, picture.stride_u, f->width / 2, f->height / 2);
  av_image_copy_plane(f->data[2], f->linesize[2], picture.v, picture.stride_v, f->width / 2, f->height / 2);
  return f;
}

Status AvEncoder::push(const I420View& picture) {
  if (picture.width != settings_.width || picture.height != settings_.height)
    return Error{ErrorId::Internal, std::string(codec_->name) + " encoder: picture size differs from the settings"};
  FOURDVT_ASSIGN(auto frame, copied(picture));
  frame->pts = next_frame_++;
  FOURDVT_TRY(send(frame.get()));
  const bool first_of_two = encodesInTwoPasses(settings_);
  if (first_of_two) pictures_.push_back(std::move(frame));
  return drain(false, !first_of_two);
}

Status AvEncoder::send(const AVFrame* frame) {
  if (const int rc = avcodec_send_frame(context_.get(), frame); rc < 0)
    return failure(frame ? "a picture" : "the end", rc);
  return {};
}

Status AvEncoder::drain(bool to_end, bool keep) {
  for (;;) {
    const int rc = avcodec_receive_packet(context_.get(), packet_.get());
    if (rc == AVERROR(EAGAIN) && !to_end) return {};
    if (rc == AVERROR_EOF && to_end) return {};
    if (rc < 0) return failure("a packet", rc);
    if (keep) {
      EncodedPacket out;
      out.frame = static_cast<uint32_t>(packet_->pts);
      out.key = packet_->flags & AV_PKT_FLAG_KEY;
      out.bytes.assign(packet_->data, packet_->data + packet_->size);
      gop_.packets.push_back(std::move(out));
    }
    av_packet_unref(packet_.get());
  }
}

Status AvEncoder::secondPass() {
  FOURDVT_TRY(send(nullptr));
  FOURDVT_TRY(drain(true, false));
  if (!context_->stats_out) return Error{ErrorId::Internal, std::string(codec_->name) + " encoder: no statistics"};
  statistics_ = context_->stats_out;
  FOURDVT_TRY(openPass(Pass::Second));
  for (platform::AvFrame& frame : pictures_) {
    FOURDVT_TRY(send(frame.get()));
    frame.reset();
    FOURDVT_TRY(drain(false, true));
  }
  return {};
}

Result<EncodedGop> AvEncoder::finish() {
  if (encodesInTwoPasses(settings_)) FOURDVT_TRY(secondPass());
  FOURDVT_TRY(send(nullptr));
  FOURDVT_TRY(drain(true, true));
  context_.reset();
  FOURDVT_TRY(checkGop());
  return std::move(gop_);
}

// Checks the assumptions of the sample table: one packet per frame, one key frame, which comes first, and little
// reordering.
Status AvEncoder::checkGop() const {
  const std::string encoder = std::string(codec_->name) + " encoder: ";
  if (gop_.packets.size() != size_t(next_frame_) || gop_.packets.empty() || !gop_.packets[0].key)
    return Error{ErrorId::Internal, encoder + "a GOP came out incomplete"};
  std::vector<uint8_t> seen(gop_.packets.size(), 0);
  for (size_t i = 0; i < gop_.packets.size(); ++i) {
    const uint32_t frame = gop_.packets[i].frame;
    if (frame >= seen.size() || seen[frame]++)
      return Error{ErrorId::Internal, encoder + "packets and frames of a GOP do not pair up"};
    if (i > frame + infoOf(settings_.codec).reorder_frames || (i > 0 && gop_.packets[i].key))
      return Error{ErrorId::Internal, encoder + "a GOP is not closed or reorders too far"};
  }
  return {};
}

}  // namespace

std::string codecNames() { return joined(kCodecInfos, ", ", &CodecInfo::name); }

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

std::vector<uint32_t> planGops(uint32_t frame_count, int gop) {
  const uint32_t count = (frame_count + gop - 1) / gop;
  std::vector<uint32_t> first;
  for (uint32_t g = 0; g < count; ++g) first.push_back(static_cast<uint32_t>(uint64_t(g) * frame_count / count));
  return first;
}

Status checkEncoder(Codec codec, const std::string& preset) {
  EncodeSettings settings;
  settings.codec = codec;
  settings.preset = preset;
  auto found = findEncoder(settings);
  return found ? Status() : Status(found.error());
}

Result<std::unique_ptr<GopEncoder>> GopEncoder::create(const EncodeSettings& settings) {
  auto encoder = std::make_unique<AvEncoder>(settings);
  FOURDVT_TRY(encoder->open());
  return std::unique_ptr<GopEncoder>(std::move(encoder));
}

}  // namespace fourdvt::encode
