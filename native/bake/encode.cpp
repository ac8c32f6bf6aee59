// SPDX-License-Identifier: Apache-2.0
#include "bake/encode.h"

#include <cstring>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

namespace fourdvt::bake {
namespace {

struct ContextDeleter {
  void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
};
struct FrameDeleter {
  void operator()(AVFrame* f) const { av_frame_free(&f); }
};
struct PacketDeleter {
  void operator()(AVPacket* p) const { av_packet_free(&p); }
};

Error failure(const char* what, int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return {ErrorId::Internal, std::string("H.264 encoder: ") + what + " failed: " + text};
}

void copyPlane(const uint8_t* from, int from_stride, uint8_t* to, int to_stride, int width, int height) {
  for (int y = 0; y < height; ++y) std::memcpy(to + size_t(y) * to_stride, from + size_t(y) * from_stride, width);
}

class X264Encoder final : public GopEncoder {
 public:
  Status open(const EncodeSettings& s);
  Status push(const I420View& picture) override;
  Result<EncodedGop> finish() override;

 private:
  void configure(const EncodeSettings& s);
  Status drain(bool to_end);
  std::unique_ptr<AVCodecContext, ContextDeleter> context_;
  std::unique_ptr<AVFrame, FrameDeleter> frame_;
  std::unique_ptr<AVPacket, PacketDeleter> packet_;
  EncodedGop gop_;
  int64_t next_frame_ = 0;
};

void X264Encoder::configure(const EncodeSettings& s) {
  AVCodecContext* c = context_.get();
  const AVRational fps = av_d2q(s.fps, 100000);
  c->width = s.width;
  c->height = s.height;
  c->pix_fmt = AV_PIX_FMT_YUV420P;
  c->time_base = av_inv_q(fps);
  c->framerate = fps;
  c->gop_size = 10000;  // one key picture: the first
  c->max_b_frames = 2;
  c->thread_count = 1;
  c->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
  c->color_range = AVCOL_RANGE_MPEG;
  c->color_primaries = AVCOL_PRI_BT709;
  c->color_trc = AVCOL_TRC_BT709;
  c->colorspace = AVCOL_SPC_BT709;
  c->chroma_sample_location = AVCHROMA_LOC_CENTER;
  av_opt_set(c->priv_data, "preset", "medium", 0);
  av_opt_set_double(c->priv_data, "crf", s.crf, 0);
  av_opt_set(c->priv_data, "x264-params", "scenecut=0:b-pyramid=none:rc-lookahead=8:threads=1:lookahead-threads=1", 0);
}

Status X264Encoder::open(const EncodeSettings& s) {
  av_log_set_level(AV_LOG_ERROR);  // x264 reports every GOP otherwise
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec)
    return Error{ErrorId::Unsupported, "FFmpeg has no libx264 encoder: install a build of libavcodec with it"};
  context_.reset(avcodec_alloc_context3(codec));
  frame_.reset(av_frame_alloc());
  packet_.reset(av_packet_alloc());
  configure(s);
  if (const int rc = avcodec_open2(context_.get(), codec, nullptr); rc < 0) return failure("opening", rc);
  frame_->format = AV_PIX_FMT_YUV420P;
  frame_->width = s.width;
  frame_->height = s.height;
  if (const int rc = av_frame_get_buffer(frame_.get(), 0); rc < 0) return failure("allocating a picture", rc);
  gop_.parameter_sets.assign(context_->extradata, context_->extradata + context_->extradata_size);
  return {};
}

Status X264Encoder::push(const I420View& picture) {
  AVFrame* f = frame_.get();
  if (picture.width != f->width || picture.height != f->height)
    return Error{ErrorId::Internal, "H.264 encoder: picture size differs from the settings"};
  if (const int rc = av_frame_make_writable(f); rc < 0) return failure("allocating a picture", rc);
  copyPlane(picture.y, picture.stride_y, f->data[0], f->linesize[0], f->width, f->height);
  copyPlane(picture.u, picture.stride_u, f->data[1], f->linesize[1], f->width / 2, f->height / 2);
  copyPlane(picture.v, picture.stride_v, f->data[2], f->linesize[2], f->width / 2, f->height / 2);
  f->pts = next_frame_++;
  if (const int rc = avcodec_send_frame(context_.get(), f); rc < 0) return failure("a picture", rc);
  return drain(false);
}

Status X264Encoder::drain(bool to_end) {
  for (;;) {
    const int rc = avcodec_receive_packet(context_.get(), packet_.get());
    if (rc == AVERROR(EAGAIN) && !to_end) return {};
    if (rc == AVERROR_EOF && to_end) return {};
    if (rc < 0) return failure("a packet", rc);
    EncodedPacket out;
    out.frame = static_cast<uint32_t>(packet_->pts);
    out.key = packet_->flags & AV_PKT_FLAG_KEY;
    out.bytes.assign(packet_->data, packet_->data + packet_->size);
    gop_.packets.push_back(std::move(out));
    av_packet_unref(packet_.get());
  }
}

Result<EncodedGop> X264Encoder::finish() {
  if (const int rc = avcodec_send_frame(context_.get(), nullptr); rc < 0) return failure("the end", rc);
  FOURDVT_TRY(drain(true));
  if (gop_.packets.size() != size_t(next_frame_) || gop_.packets.empty() || !gop_.packets[0].key)
    return Error{ErrorId::Internal, "H.264 encoder: a GOP came out incomplete"};
  for (size_t i = 0; i < gop_.packets.size(); ++i)
    if (i > gop_.packets[i].frame + kReorderFrames || (i > 0 && gop_.packets[i].key))
      return Error{ErrorId::Internal, "H.264 encoder: a GOP is not closed or reorders too far"};
  return std::move(gop_);
}

}  // namespace

Result<std::unique_ptr<GopEncoder>> GopEncoder::create(const EncodeSettings& settings) {
  auto encoder = std::make_unique<X264Encoder>();
  FOURDVT_TRY(encoder->open(settings));
  return std::unique_ptr<GopEncoder>(std::move(encoder));
}

}  // namespace fourdvt::bake
