// SPDX-License-Identifier: Apache-2.0
// bench_yardstick VIDEO…: a constant job, by whose CPU seconds published seconds are divided. Decodes the videos, one
// after the other, and encodes their frames as one video by x264, on one thread; discards the result. Prints a line of
// JSON for each of three runs: CPU and wall seconds, CPU seconds of all other programs meanwhile (omitted without
// /proc/stat), and `job`, a text that differs between runs that cannot be compared. Run by tests/bench/yardstick.mjs.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <optional>
#include <string>

#include "or_stop.h"
#include "platform/ffmpeg_handles.h"

using namespace fourdvt;
using namespace fourdvt::platform;
using fourdvt::testing::orStop;

namespace {

// Changing one of these starts a new series: results of older yardsticks are no longer comparable.
constexpr int kRuns = 3, kFps = 25;
constexpr const char *kEncoder = "libx264", *kPreset = "medium", *kCrf = "23";

void check(bool holds, const std::string& what) {
  if (!holds) orStop(Status(Error{ErrorId::VideoInvalid, what}));
}

// Encodes frames of the first one's size and format; counts the bytes.
class Sink {
 public:
  void put(AVFrame& frame) {
    if (!codec_) open(frame);
    frame.pict_type = AV_PICTURE_TYPE_NONE;
    frame.pts = frames++;
    send(&frame);
  }
  void end() { send(nullptr); }

  int frames = 0;
  int64_t bytes = 0;

 private:
  void open(const AVFrame& frame) {
    const AVCodec* encoder = avcodec_find_encoder_by_name(kEncoder);
    check(encoder, std::string("this FFmpeg has no ") + kEncoder + "; install one that has");
    codec_.reset(avcodec_alloc_context3(encoder));
    codec_->width = frame.width;
    codec_->height = frame.height;
    codec_->pix_fmt = AVPixelFormat(frame.format);
    codec_->time_base = {1, kFps};
    codec_->thread_count = 1;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "preset", kPreset, 0);
    av_dict_set(&options, "crf", kCrf, 0);
    const int opened = avcodec_open2(codec_.get(), encoder, &options);
    av_dict_free(&options);
    check(opened >= 0, std::string(kEncoder) + " does not take the videos' format");
  }
  void send(const AVFrame* frame) {
    check(codec_ && avcodec_send_frame(codec_.get(), frame) >= 0, "a frame is not encoded");
    while (avcodec_receive_packet(codec_.get(), packet_.get()) >= 0) {
      bytes += packet_->size;
      av_packet_unref(packet_.get());
    }
  }

  AvCodec codec_;
  AvPacket packet_{av_packet_alloc()};
};

void decode(const std::string& path, Sink& sink) {
  AVFormatContext* opened = nullptr;
  check(avformat_open_input(&opened, path.c_str(), nullptr, nullptr) >= 0,
        path + ": cannot be read; name videos of the sample's walk");
  const AvFormat file(opened);
  const AVCodec* decoder = nullptr;
  const int stream = av_find_best_stream(file.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  check(stream >= 0, path + ": has no video that this FFmpeg decodes");
  const AvCodec codec(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec.get(), file->streams[stream]->codecpar);
  codec->thread_count = 1;
  check(avcodec_open2(codec.get(), decoder, nullptr) >= 0, path + ": its decoder does not open");
  const AvPacket packet(av_packet_alloc());
  const AvFrame frame(av_frame_alloc());
  for (bool more = true; more;) {
    more = av_read_frame(file.get(), packet.get()) >= 0;
    if (more && packet->stream_index != stream) {
      av_packet_unref(packet.get());
      continue;
    }
    check(avcodec_send_packet(codec.get(), more ? packet.get() : nullptr) >= 0, path + ": a sample does not decode");
    av_packet_unref(packet.get());
    while (avcodec_receive_frame(codec.get(), frame.get()) >= 0) sink.put(*frame);
  }
}

double ownCpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// CPU seconds of all programs since the machine started, plus those stolen by its host.
std::optional<double> machineCpu_s() {
  std::ifstream stat("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft_interrupts = 0, stolen = 0;
  if (!(stat >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >> stolen))
    return {};
  return (user + nice + system + interrupts + soft_interrupts + stolen) / double(sysconf(_SC_CLK_TCK));
}

void run(int count, char** paths) {
  const auto began = std::chrono::steady_clock::now();
  const double cpu_before_s = ownCpu_s();
  const std::optional<double> machine_before_s = machineCpu_s();
  Sink sink;
  for (int i = 0; i < count; ++i) decode(paths[i], sink);
  sink.end();
  const double cpu_s = ownCpu_s() - cpu_before_s;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const std::optional<double> machine_s = machineCpu_s();
  std::printf("{\"cpu_s\":%.3f,\"wall_s\":%.3f,", cpu_s, wall_s);
  if (machine_s && machine_before_s) {
    std::printf("\"others_s\":%.2f,", std::max(0.0, *machine_s - *machine_before_s - cpu_s));
  }
  const unsigned version = avcodec_version();
  std::printf("\"job\":\"%d frames, %s %s crf %s, %lld bytes, libavcodec %u.%u.%u\"}\n", sink.frames, kEncoder, kPreset,
              kCrf, static_cast<long long>(sink.bytes), AV_VERSION_MAJOR(version), AV_VERSION_MINOR(version),
              AV_VERSION_MICRO(version));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_yardstick VIDEO…\n");
    return 2;
  }
  av_log_set_level(AV_LOG_ERROR);
  for (int i = 0; i < kRuns; ++i) run(argc - 1, argv + 1);
  return 0;
}
