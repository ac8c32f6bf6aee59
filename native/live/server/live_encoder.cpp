// SPDX-License-Identifier: Apache-2.0
#include "live/server/live_encoder.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "package/character.h"
#include "platform/ffmpeg_handles.h"

extern "C" {
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
}

namespace fourdvt::live {
namespace {

constexpr double kMaxBitsPerTexel = 0.5;  // average over half a second, for any crf
constexpr double kMinRate = 1e6;          // bits per second
constexpr int kWhole = 1 << 20;           // GOP length that suppresses automatic keyframes
constexpr uint8_t kParameterSet = 7;      // NAL unit type of a sequence parameter set

// RFC 6381 codec string of an Annex B sample with a sequence parameter set; else empty.
std::string codecOf(const std::vector<uint8_t>& sample) {
  for (size_t i = 0; i + 6 < sample.size(); ++i) {
    if (sample[i] != 0 || sample[i + 1] != 0 || sample[i + 2] != 1 || (sample[i + 3] & 31) != kParameterSet) continue;
    return printed("avc1.%02X%02X%02X", sample[i + 4], sample[i + 5], sample[i + 6]);
  }
  return {};
}

class X264Encoder final : public LiveEncoder {
 public:
  explicit X264Encoder(const EncoderRules& rules) : rules_(rules) {}

  Status begin() {
    FOURDVT_TRY(open());
    std::vector<uint8_t> grey(size_t(rules_.width) * rules_.height, 128);
    const I420View picture{rules_.width, rules_.height, grey.data(),      grey.data(),
                           grey.data(),  rules_.width,  rules_.width / 2, rules_.width / 2};
    FOURDVT_ASSIGN(const auto first, encode(picture, true));
    codec_ = codecOf(first.sample);
    if (codec_.empty()) return failure("writing parameter sets", AVERROR_INVALIDDATA);
    reopen_ = true;
    return {};
  }

  Result<EncodedPicture> encode(const I420View& picture, bool key) override {
    if (picture.width != rules_.width || picture.height != rules_.height)
      return Error{ErrorId::Internal, "live encoder: a picture of another size"};
    if (reopen_ && key) FOURDVT_TRY(open());
    auto out = encodeOpen(picture, key || after_error_);
    after_error_ = !out.ok();
    return out;
  }

  void setCrf(int crf) override {
    reopen_ = reopen_ || crf != rules_.crf;
    rules_.crf = crf;
  }

  const std::string& codec() const override { return codec_; }

 private:
  Error failure(const char* what, int code) const {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return {ErrorId::Internal, std::string("live encoder: ") + what + " failed: " + text};
  }

  Status open() {
    av_log_set_level(AV_LOG_ERROR);
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (!codec)
      return Error{ErrorId::Unsupported,
                   "this FFmpeg has no libx264 encoder: install an FFmpeg built with it (Debian: libavcodec-extra59 or "
                   "libavcodec59 with libx264-164)"};
    context_.reset(avcodec_alloc_context3(codec));
    configure(*context_);
    if (avcodec_open2(context_.get(), codec, nullptr) < 0)
      return Error{ErrorId::InvalidArgument, "libx264 does not take a picture of " + std::to_string(rules_.width) +
                                                 " x " + std::to_string(rules_.height) + " at crf " +
                                                 std::to_string(rules_.crf) + "; use a crf from 0 to 51"};
    packet_.reset(av_packet_alloc());
    reopen_ = false;
    return makeFrame();
  }

  void configure(AVCodecContext& c) const {
    const AVRational fps = av_d2q(rules_.fps, 100000);
    c.width = rules_.width;
    c.height = rules_.height;
    c.pix_fmt = AV_PIX_FMT_YUV420P;
    c.time_base = av_inv_q(fps);
    c.framerate = fps;
    c.gop_size = kWhole;
    c.max_b_frames = 0;
    c.thread_count = rules_.threads;
    c.color_range = AVCOL_RANGE_MPEG;
    c.color_primaries = AVCOL_PRI_BT709;
    c.color_trc = AVCOL_TRC_BT709;
    c.colorspace = AVCOL_SPC_BT709;
    c.chroma_sample_location = AVCHROMA_LOC_CENTER;
    const double rate = std::max(kMinRate, kMaxBitsPerTexel * rules_.width * rules_.height * rules_.fps);
    c.rc_max_rate = int64_t(rate);
    c.rc_buffer_size = int(std::min(rate / 2, 1e9));
    av_opt_set(c.priv_data, "preset", rules_.preset, 0);
    av_opt_set(c.priv_data, "tune", "zerolatency", 0);
    av_opt_set_double(c.priv_data, "crf", rules_.crf, 0);
    av_opt_set_int(c.priv_data, "forced-idr", 1, 0);
    // Keyframes on request only. "zerolatency" disables lookahead and macroblock-tree rate control, so bits are
    // distributed within each picture by its own blocks.
    av_opt_set(c.priv_data, "x264-params", "scenecut=0:keyint=infinite:repeat-headers=1:annexb=1:sliced-threads=0", 0);
  }

  Status makeFrame() {
    frame_.reset(av_frame_alloc());
    frame_->format = AV_PIX_FMT_YUV420P;
    frame_->width = rules_.width;
    frame_->height = rules_.height;
    const int code = av_frame_get_buffer(frame_.get(), 0);
    return code < 0 ? Status(failure("allocating a picture", code)) : Status();
  }

  Result<EncodedPicture> encodeOpen(const I420View& picture, bool key) {
    if (const int code = av_frame_make_writable(frame_.get()); code < 0) return failure("a picture", code);
    AVFrame& f = *frame_;
    av_image_copy_plane(f.data[0], f.linesize[0], picture.y, picture.stride_y, f.width, f.height);
    av_image_copy_plane(f.data[1], f.linesize[1], picture.u, picture.stride_u, f.width / 2, f.height / 2);
    av_image_copy_plane(f.data[2], f.linesize[2], picture.v, picture.stride_v, f.width / 2, f.height / 2);
    f.pts = next_pts_++;
    f.pict_type = key ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    if (const int code = avcodec_send_frame(context_.get(), &f); code < 0) return failure("a picture", code);
    if (const int code = avcodec_receive_packet(context_.get(), packet_.get()); code < 0)
      return failure("a sample", code);
    EncodedPicture out{(packet_->flags & AV_PKT_FLAG_KEY) != 0, {packet_->data, packet_->data + packet_->size}};
    const bool in_order = packet_->pts == f.pts;
    av_packet_unref(packet_.get());
    if (!in_order || (key && !out.key)) return failure("keeping the order", AVERROR_BUG);
    return out;
  }

  EncoderRules rules_;
  platform::AvCodec context_;
  platform::AvFrame frame_;
  platform::AvPacket packet_;
  std::string codec_;
  int64_t next_pts_ = 0;
  bool reopen_ = false, after_error_ = false;
};

}  // namespace

Result<std::unique_ptr<LiveEncoder>> LiveEncoder::create(const EncoderRules& rules) {
  auto encoder = std::make_unique<X264Encoder>(rules);
  FOURDVT_TRY(encoder->begin());
  return std::unique_ptr<LiveEncoder>(std::move(encoder));
}

namespace {

using Json = nlohmann::ordered_json;

constexpr int kLiveFormatVersion = 4;
constexpr size_t kLongestName = 128;  // bytes

Json rectJson(const package::Rect& r) { return {r.x, r.y, r.width, r.height}; }
Json pointJson(const glm::vec3& p) { return {p.x, p.y, p.z}; }

Json cameraJson(const PinholeCamera& camera) {
  Json matrix = Json::array();
  for (int i = 0; i < 16; ++i) matrix.push_back(camera.cam_from_world[i / 4][i % 4]);
  return {{"name", camera.name}, {"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},     {"cx", camera.cx},       {"cy", camera.cy},         {"camFromWorld", matrix}};
}

}  // namespace

std::string liveManifest(const Rig& rig, const ManifestInput& input) {
  Json cameras = Json::array();
  for (const RigCamera& camera : rig.cameras) cameras.push_back(cameraJson(camera.camera.pinhole));
  const Json live = {
      {"session", input.session},
      {"fps", rig.fps},
      {"layout", {input.size.tiles.width, input.size.tiles.height}},
      {"codec", input.codec},
      {"width", input.size.width},
      {"height", input.size.height},
      {"tiles", rectJson(input.size.tiles)},
      {"barcode", {{"rect", rectJson(input.size.barcode.rect)}, {"cellSize", input.size.barcode.cell_size}}},
      {"origin", pointJson(rig.bounds.min)},
      {"step", kPositionStep_m}};
  const Json extension = {{"version", kLiveFormatVersion},
                          {"appearance", "cameras"},
                          {"name", rig.name.empty() ? "live" : rig.name.substr(0, kLongestName)},
                          {"vertexCount", kMaxVertices},
                          {"faceCount", kMaxFaces},
                          {"bounds", {{"min", pointJson(rig.bounds.min)}, {"max", pointJson(rig.bounds.max)}}},
                          {"groundY", rig.ground_y_m},
                          {"lengthScale", 1},
                          {"method", {{"name", "fvvr"}}},
                          {"cameras", cameras},
                          {"live", live}};
  return Json{{"asset", {{"version", "2.0"}}},
              {"extensionsUsed", {package::kExtensionName}},
              {"extensions", {{package::kExtensionName, extension}}}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fourdvt::live
