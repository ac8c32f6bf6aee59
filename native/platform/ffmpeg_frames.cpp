// SPDX-License-Identifier: Apache-2.0
#include "platform/ffmpeg_frames.h"

#include "base/text.h"

extern "C" {
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
}

namespace fourdvt::platform {
namespace {

// Maps deprecated yuvj formats to their plain ones with full range.
AVPixelFormat plainFormat(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    default:
      return format;
  }
}

bool isGray(const AVPixFmtDescriptor& format) {
  return format.nb_components <= 2 && !(format.flags & AV_PIX_FMT_FLAG_RGB);
}

constexpr int kStandardDefinitionLines = 576;

int swsMatrix(const AVFrame& frame) {
  switch (frame.colorspace) {
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_BT470BG:
      return SWS_CS_ITU601;
    case AVCOL_SPC_FCC:
      return SWS_CS_FCC;
    case AVCOL_SPC_SMPTE240M:
      return SWS_CS_SMPTE240M;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return SWS_CS_BT2020;
    case AVCOL_SPC_UNSPECIFIED:  // by convention BT.601 for standard definition
      return frame.height <= kStandardDefinitionLines ? SWS_CS_ITU601 : SWS_CS_ITU709;
    default:
      return SWS_CS_ITU709;
  }
}

}  // namespace

bool isFullRange(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  if (plainFormat(static_cast<AVPixelFormat>(frame.format)) != frame.format) return true;
  if (frame.color_range != AVCOL_RANGE_UNSPECIFIED) return frame.color_range == AVCOL_RANGE_JPEG;
  return isGray(format) || (format.flags & AV_PIX_FMT_FLAG_RGB);
}

bool isBt601(const AVFrame& frame) { return swsMatrix(frame) == SWS_CS_ITU601; }

bool RgbConverter::convert(const AVFrame& frame, Image& out, int reduce) {
  const auto* description = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  if (!description) return false;
  const int exact = SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP, width = frame.width / reduce,
            height = frame.height / reduce;
  const int quality = reduce > 1 ? SWS_AREA | (fast_ ? 0 : exact) : fast_ ? SWS_FAST_BILINEAR : SWS_BICUBIC | exact;
  scaler_.reset(sws_getCachedContext(scaler_.release(), width * reduce, height * reduce,
                                     plainFormat(static_cast<AVPixelFormat>(frame.format)), width, height,
                                     AV_PIX_FMT_RGB24, quality, nullptr, nullptr, nullptr));
  if (!scaler_) return false;
  sws_setColorspaceDetails(scaler_.get(), sws_getCoefficients(swsMatrix(frame)), isFullRange(frame, *description),
                           sws_getCoefficients(SWS_CS_ITU709), 1, 0, 1 << 16, 1 << 16);
  if (out.width != width || out.height != height || out.channels != 3) out = Image(width, height, 3);
  uint8_t* planes[4] = {out.pixels.data(), nullptr, nullptr, nullptr};
  const int strides[4] = {out.width * 3, 0, 0, 0};
  return sws_scale(scaler_.get(), frame.data, frame.linesize, 0, height * reduce, planes, strides) > 0;
}

bool FrameFilter::open(const std::string& chain, const AVFrame& like) {
  const std::string arguments =
      printed("video_size=%dx%d:pix_fmt=%d:time_base=1/1000000:pixel_aspect=1/1", like.width, like.height, like.format);
  graph_.reset(avfilter_graph_alloc());
  graph_->nb_threads = 1;  // callers decode several files in parallel
  AVFilterInOut *in = nullptr, *out = nullptr;
  bool ok = avfilter_graph_create_filter(&source_, avfilter_get_by_name("buffer"), "in", arguments.c_str(), nullptr,
                                         graph_.get()) >= 0 &&
            avfilter_graph_create_filter(&sink_, avfilter_get_by_name("buffersink"), "out", nullptr, nullptr,
                                         graph_.get()) >= 0 &&
            avfilter_graph_parse2(graph_.get(), chain.c_str(), &in, &out) >= 0 && in && out &&
            avfilter_link(source_, 0, in->filter_ctx, in->pad_idx) >= 0 &&
            avfilter_link(out->filter_ctx, out->pad_idx, sink_, 0) >= 0 &&
            avfilter_graph_config(graph_.get(), nullptr) >= 0;
  avfilter_inout_free(&in);
  avfilter_inout_free(&out);
  if (!ok) graph_.reset();
  return ok;
}

bool FrameFilter::push(AVFrame* frame) { return av_buffersrc_add_frame(source_, frame) >= 0; }

int FrameFilter::pull(AVFrame& out) { return av_buffersink_get_frame(sink_, &out); }

}  // namespace fourdvt::platform
