// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/codec.h"

#include <cmath>
#include <future>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/ffmpeg_video.h"

namespace fourdvt::study {

Result<std::vector<uint8_t>> encodePng(const Image& image) {
  const cv::Mat rgb(image.height, image.width, CV_8UC(image.channels), const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, image.channels == 4 ? cv::COLOR_RGBA2BGR : cv::COLOR_RGB2BGR);
  std::vector<uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, 0}))
    return Error{ErrorId::Internal, "OpenCV did not encode a .png picture"};
  return bytes;
}

Result<uint64_t> codedBytes(const std::vector<Image>& pictures, const PictureCoder& code) {
  std::vector<std::future<Result<std::vector<uint8_t>>>> running;
  for (const Image& picture : pictures)
    running.push_back(std::async(std::launch::async, [&code, &picture] { return code(picture); }));
  std::vector<Result<std::vector<uint8_t>>> coded;
  for (auto& one : running) coded.push_back(one.get());
  uint64_t sum = 0;
  for (auto& one : coded) {
    if (!one) return one.error();
    sum += one.value().size();
  }
  return sum;
}

void fillI420(const Image& image, encode::I420Picture& out) {
  encode::drawLayer(image, {0, 0, image.width, image.height}, out);
}

uint64_t gopBytes(const encode::EncodedGop& gop) {
  uint64_t bytes = gop.parameter_sets.size();
  for (const encode::EncodedPacket& packet : gop.packets) bytes += packet.bytes.size();
  return bytes;
}

Result<size_t> decodeGop(encode::Codec codec, const encode::EncodedGop& gop,
                         const std::function<Status(uint32_t frame, const I420View&)>& on_picture) {
  Status first;
  size_t pictures = 0;
  FOURDVT_ASSIGN(auto decoder, platform::SampleDecoder::create(
                                   encode::infoOf(codec).kind, {}, [&](const I420View& picture, int64_t timestamp_us) {
                                     ++pictures;
                                     if (first.ok()) first = on_picture(static_cast<uint32_t>(timestamp_us), picture);
                                   }));
  for (const encode::EncodedPacket& packet : gop.packets) {
    std::vector<uint8_t> bytes;
    if (packet.key && codec == encode::Codec::H264) bytes = gop.parameter_sets;
    bytes.insert(bytes.end(), packet.bytes.begin(), packet.bytes.end());
    FOURDVT_TRY(decoder->decode(bytes, packet.frame, packet.key));
  }
  FOURDVT_TRY(decoder->flush());
  FOURDVT_TRY(first);
  return pictures;
}

void SquaredError::add(const Image& a, const Image& b, const std::vector<uint8_t>& inside) {
  uint64_t sum = 0, count = 0;
  for (size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i]) continue;
    const uint8_t *p = &a.pixels[i * a.channels], *q = &b.pixels[i * b.channels];
    for (int c = 0; c < 3; ++c) sum += static_cast<uint64_t>((p[c] - q[c]) * (p[c] - q[c]));
    count += 3;
  }
  squares += static_cast<double>(sum);
  samples += count;
}

double SquaredError::psnr_db() const {
  if (samples == 0) return std::numeric_limits<double>::quiet_NaN();
  if (squares == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(samples) / squares);
}

}  // namespace fourdvt::study
