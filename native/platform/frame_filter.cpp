// SPDX-License-Identifier: Apache-2.0
#include "platform/frame_filter.h"

#include "base/text.h"

extern "C" {
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
}

namespace fourdvt::platform {

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
