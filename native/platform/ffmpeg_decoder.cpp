// SPDX-License-Identifier: Apache-2.0
// SampleDecoder: libavcodec fed with encoded samples, as WebCodecs is in the browser.
#include <cstring>

#include "platform/ffmpeg_handles.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::platform {
namespace {

AVCodecID codecId(const std::string& codec) {
  const std::string kind = codec.substr(0, codec.find('.'));
  if (kind == "avc1" || kind == "avc3") return AV_CODEC_ID_H264;
  if (kind == "av01") return AV_CODEC_ID_AV1;
  if (kind == "vp09") return AV_CODEC_ID_VP9;
  return AV_CODEC_ID_NONE;
}

// libavcodec's native AV1 decoder is hardware-only: selects a software decoder by name.
const AVCodec* findDecoder(const std::string& codec) {
  const AVCodecID id = codecId(codec);
  if (id != AV_CODEC_ID_AV1) return avcodec_find_decoder(id);
  const AVCodec* dav1d = avcodec_find_decoder_by_name("libdav1d");
  return dav1d ? dav1d : avcodec_find_decoder_by_name("libaom-av1");
}

std::string unsupported(const std::string& codec) {
  const std::string message = "this FFmpeg has no software decoder for \"" + codec + "\"; ";
  if (codecId(codec) == AV_CODEC_ID_AV1) return message + "install one with libdav1d, or bake with --codec h264";
  return message + "bake with --codec h264";
}

Error invalid(const std::string& what) { return {ErrorId::VideoInvalid, "video samples: " + what + "; bake again"}; }

class Decoder final : public SampleDecoder {
 public:
  Status open(const AVCodec& codec, std::span<const uint8_t> description, OnPicture on_picture) {
    on_picture_ = std::move(on_picture);
    codec_.reset(avcodec_alloc_context3(&codec));
    codec_->thread_count = 2;
    codec_->thread_type = FF_THREAD_SLICE;                                      // frame threads delay output
    if (codec.id == AV_CODEC_ID_AV1) codec_->flags |= AV_CODEC_FLAG_LOW_DELAY;  // keeps dav1d from frame threads
    codec_->max_pixels = kMaxSamplePixels;
    codec_->pkt_timebase = {1, 1000000};
    codec_->err_recognition = AV_EF_EXPLODE | AV_EF_BITSTREAM | AV_EF_BUFFER;
    if (!description.empty()) {
      codec_->extradata =
          static_cast<uint8_t*>(av_mallocz(description.size() + AV_INPUT_BUFFER_PADDING_SIZE));  // owned by codec_
      std::memcpy(codec_->extradata, description.data(), description.size());
      codec_->extradata_size = static_cast<int>(description.size());
    }
    if (avcodec_open2(codec_.get(), &codec, nullptr) < 0) return invalid("the codec's description is not accepted");
    return {};
  }

  Status decode(std::span<const uint8_t> bytes, int64_t timestamp_us, bool key) override {
    if (needs_key_ && !key) return invalid("decoding must start at a key sample");
    if (bytes.empty() || av_new_packet(packet_.get(), static_cast<int>(bytes.size())) < 0) {
      return invalid("empty sample");
    }
    std::memcpy(packet_->data, bytes.data(), bytes.size());
    packet_->pts = timestamp_us;
    packet_->flags = key ? AV_PKT_FLAG_KEY : 0;
    needs_key_ = false;
    int sent = avcodec_send_packet(codec_.get(), packet_.get());
    if (sent == AVERROR(EAGAIN)) {
      if (Status drained = drain(); !drained.ok()) {
        av_packet_unref(packet_.get());
        return drained;
      }
      sent = avcodec_send_packet(codec_.get(), packet_.get());
    }
    av_packet_unref(packet_.get());
    if (sent < 0) return invalid("a sample does not decode");
    return drain();
  }

  Status flush() override {
    if (needs_key_) return {};
    avcodec_send_packet(codec_.get(), nullptr);
    const Status drained = drain();
    reset();
    return drained;
  }

  void reset() override {
    avcodec_flush_buffers(codec_.get());
    needs_key_ = true;
  }

 private:
  Status drain() {
    while (true) {
      const int received = avcodec_receive_frame(codec_.get(), frame_.get());
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return {};
      if (received < 0) return invalid("a sample does not decode");
      FOURDVT_TRY(deliver());
    }
  }

  Status deliver() {
    const AVFrame& f = *frame_;
    if (f.decode_error_flags != 0 || (f.flags & AV_FRAME_FLAG_CORRUPT)) return invalid("a picture is damaged");
    if (f.format != AV_PIX_FMT_YUV420P || f.width % 2 != 0 || f.height % 2 != 0) {
      return invalid("pictures must be 8-bit 4:2:0, limited range, of even size");
    }
    const I420View view{f.width,   f.height,      f.data[0],     f.data[1],
                        f.data[2], f.linesize[0], f.linesize[1], f.linesize[2]};
    on_picture_(view, f.pts);
    return {};
  }

  OnPicture on_picture_;
  AvCodec codec_;
  AvFrame frame_{av_frame_alloc()};
  AvPacket packet_{av_packet_alloc()};
  bool needs_key_ = true;
};

}  // namespace

Result<std::unique_ptr<SampleDecoder>> SampleDecoder::create(const std::string& codec,
                                                             std::span<const uint8_t> description,
                                                             OnPicture on_picture) {
  quietFfmpeg();
  const AVCodec* found = findDecoder(codec);
  if (!found) return Error{ErrorId::DecoderUnsupported, unsupported(codec)};
  auto decoder = std::make_unique<Decoder>();
  FOURDVT_TRY(decoder->open(*found, description, std::move(on_picture)));
  return std::unique_ptr<SampleDecoder>(std::move(decoder));
}

}  // namespace fourdvt::platform
