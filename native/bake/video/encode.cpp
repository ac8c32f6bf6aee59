// SPDX-License-Identifier: Apache-2.0
#include "bake/video/encode.h"

#include <string>

#include "bake/video/encode_setup.h"

extern "C" {
#include <libavutil/imgutils.h>
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
using Context = std::unique_ptr<AVCodecContext, ContextDeleter>;
using Frame = std::unique_ptr<AVFrame, FrameDeleter>;

class AvEncoder final : public GopEncoder {
 public:
  explicit AvEncoder(const EncodeSettings& settings) : settings_(settings) {}
  Status open();
  Status push(const I420View& picture) override;
  Result<EncodedGop> finish() override;

 private:
  Status openPass(Pass pass);
  Result<Frame> copied(const I420View& picture) const;
  Status send(const AVFrame* frame);
  Status drain(bool to_end, bool keep);
  Status secondPass();
  Status checkGop() const;
  Error failure(const char* what, int code) const;

  const EncodeSettings settings_;
  const AVCodec* codec_ = nullptr;
  std::string statistics_;  // what the first pass found; the context of the second pass borrows it
  Context context_;
  std::unique_ptr<AVPacket, PacketDeleter> packet_{av_packet_alloc()};
  std::vector<Frame> pictures_;  // kept for the second pass
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

Result<Frame> AvEncoder::copied(const I420View& picture) const {
  Frame f(av_frame_alloc());
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
  for (Frame& frame : pictures_) {
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

// Checks what the sample table relies on: one packet per frame, one key frame, which comes first, and little
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

}  // namespace fourdvt::bake
