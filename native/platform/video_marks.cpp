// SPDX-License-Identifier: Apache-2.0
#include "platform/video_marks.h"

#include <cmath>

#include "platform/ffmpeg_frames.h"

extern "C" {
#include <libavutil/display.h>
}

namespace fourdvt::platform {
namespace {

// Decomposes a display matrix, which maps a stored (x, y) to the shown (a x + c y, b x + d y), in 16.16; y points down.
std::optional<PictureMarks> turnsOf(const int32_t* matrix) {
  const double scale = std::hypot(matrix[0], matrix[1]);
  if (scale == 0) return std::nullopt;
  const auto unit = [&](int i) { return static_cast<int>(std::lround(matrix[i] / scale)); };
  int a = unit(0), b = unit(1);
  const int c = unit(3), d = unit(4);
  PictureMarks marks;
  marks.mirrored = a * d - b * c < 0;
  if (marks.mirrored) a = -a, b = -b;  // the remaining rotation maps (1, 0) to (a, b)
  if (std::abs(a) + std::abs(b) != 1 || a != d || b != -c) return std::nullopt;
  marks.quarter_turns = a == 1 ? 0 : b == 1 ? 1 : a == -1 ? 2 : 3;
  return marks;
}

std::string rangeOf(const AVFrame& frame) {
  const auto* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  return format && isFullRange(frame, *format) ? "full" : "limited";
}

}  // namespace

std::optional<PictureMarks> marksOf(AVFormatContext& format, AVStream& stream) {
  std::optional<PictureMarks> marks = PictureMarks();
  if (const uint8_t* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr))
    marks = turnsOf(reinterpret_cast<const int32_t*>(data));
  const AVRational aspect = av_guess_sample_aspect_ratio(&format, &stream, nullptr);
  if (marks && aspect.num > 0 && aspect.den > 0) marks->pixel_aspect = av_q2d(aspect);
  return marks;
}

Conversion deinterlacing(const AVStream& stream, const AVFrame& first) {
  const AVFieldOrder order = stream.codecpar->field_order;
  const bool marked = order == AV_FIELD_TT || order == AV_FIELD_BB || order == AV_FIELD_TB || order == AV_FIELD_BT;
  if (!marked && !first.interlaced_frame) return {};
  return {"bwdif=mode=send_frame:parity=auto:deint=interlaced", "interlaced: the first field of each picture"};
}

Conversion toBt709(const AVFrame& frame) {
  const bool hlg = frame.color_trc == AVCOL_TRC_ARIB_STD_B67, pq = frame.color_trc == AVCOL_TRC_SMPTE2084;
  const bool p3 = frame.color_primaries == AVCOL_PRI_SMPTE432 || frame.color_primaries == AVCOL_PRI_SMPTE431;
  const bool wide = p3 || frame.color_primaries == AVCOL_PRI_BT2020;
  if (!hlg && !pq && !wide) return {};
  const std::string transfer = hlg ? "arib-std-b67" : pq ? "smpte2084" : "bt709";
  const std::string primaries = frame.color_primaries == AVCOL_PRI_SMPTE431   ? "smpte431"
                                : frame.color_primaries == AVCOL_PRI_SMPTE432 ? "smpte432"
                                : wide                                        ? "bt2020"
                                                                              : "bt709";
  const bool is_rgb = frame.colorspace == AVCOL_SPC_RGB;
  const bool is_2020 = frame.colorspace == AVCOL_SPC_BT2020_NCL || frame.colorspace == AVCOL_SPC_BT2020_CL;
  const std::string matrix = is_rgb ? "gbr" : is_2020 ? "bt2020nc" : isBt601(frame) ? "470bg" : "bt709";
  const std::string in = "zscale=tin=" + transfer + ":pin=" + primaries + ":min=" + matrix + ":rin=" + rangeOf(frame) +
                         ":t=linear:npl=203,format=gbrpf32le,zscale=p=bt709";
  const std::string tone = hlg || pq ? ",tonemap=tonemap=mobius:param=0.8:peak=5:desat=0" : "";
  const std::string from = std::string(hlg  ? "HLG"
                                       : pq ? "PQ"
                                            : "") +
                           (hlg || pq ? (wide ? ", " : "") : "") +
                           (p3     ? "P3"
                            : wide ? "BT.2020"
                                   : "");
  return {in + tone + ",zscale=t=bt709:m=gbr:r=full,format=gbrp", from + " → BT.709"};
}

}  // namespace fourdvt::platform
