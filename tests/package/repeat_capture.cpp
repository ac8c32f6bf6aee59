// SPDX-License-Identifier: Apache-2.0
// repeat_capture CAPTURE SEQUENCE TIMES FOLDER: writes a capture of one sequence of CAPTURE, repeated. Videos and
// mattes are stream-copied TIMES times in a row, meshes concatenated (packed positions) or linked (OBJ files); cameras
// and plates are copied, sound is omitted. For measurements of memory against length.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

extern "C" {
#include <libavformat/avformat.h>
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void stop(const std::string& message) {
  std::fprintf(stderr, "repeat_capture: %s\n", message.c_str());
  std::exit(1);
}

void check(int code, const std::string& path) {
  if (code >= 0) return;
  char text[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(code, text, sizeof text);
  stop(path + ": " + text);
}

AVFormatContext* openInput(const std::string& path) {
  AVFormatContext* in = nullptr;
  check(avformat_open_input(&in, path.c_str(), nullptr, nullptr), path);
  check(avformat_find_stream_info(in, nullptr), path);
  if (in->nb_streams != 1) stop(path + ": expected one stream");
  return in;
}

// Copies the video; frame k of repetition r has the timestamp of frame r · frames + k; every repetition starts on a key
// frame.
void repeatVideo(const std::string& from, const std::string& to, int times, double duration_s) {
  AVFormatContext* first = openInput(from);
  AVFormatContext* out = nullptr;
  check(avformat_alloc_output_context2(&out, nullptr, nullptr, to.c_str()), to);
  AVStream* stream = avformat_new_stream(out, nullptr);
  check(avcodec_parameters_copy(stream->codecpar, first->streams[0]->codecpar), to);
  stream->codecpar->codec_tag = 0;
  stream->time_base = first->streams[0]->time_base;
  stream->avg_frame_rate = first->streams[0]->avg_frame_rate;
  avformat_close_input(&first);
  check(avio_open(&out->pb, to.c_str(), AVIO_FLAG_WRITE), to);
  check(avformat_write_header(out, nullptr), to);
  AVPacket* packet = av_packet_alloc();
  for (int r = 0; r < times; ++r) {
    AVFormatContext* in = openInput(from);
    const AVRational base = in->streams[0]->time_base;
    const int64_t shift = llround(r * duration_s * base.den / base.num);
    while (av_read_frame(in, packet) >= 0) {
      packet->pts += shift;
      packet->dts += shift;
      packet->pos = -1;
      av_packet_rescale_ts(packet, base, stream->time_base);
      check(av_interleaved_write_frame(out, packet), to);
    }
    avformat_close_input(&in);
  }
  av_packet_free(&packet);
  check(av_write_trailer(out), to);
  check(avio_closep(&out->pb), to);
  avformat_free_context(out);
}

void repeatFile(const fs::path& from, const fs::path& to, int times) {
  fs::create_directories(to.parent_path());
  std::ofstream out(to, std::ios::binary);
  for (int r = 0; r < times; ++r) out << std::ifstream(from, std::ios::binary).rdbuf();
  if (!out.flush()) stop(to.string() + ": cannot write");
}

void linkMeshes(const fs::path& from, const fs::path& to, int frames, int times) {
  fs::create_directories(to);
  for (int f = 0; f < frames * times; ++f) {
    char source[32], target[32];
    std::snprintf(source, sizeof source, "%06d.obj", f % frames);
    std::snprintf(target, sizeof target, "%06d.obj", f);
    fs::create_symlink(fs::absolute(from / source), to / target);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 || std::atoi(argv[3]) < 1)
    return std::fprintf(stderr, "usage: repeat_capture CAPTURE SEQUENCE TIMES FOLDER\n"), 2;
  const fs::path from(argv[1]), to(argv[4]);
  const std::string name = argv[2];
  const int times = std::atoi(argv[3]);
  av_log_set_level(AV_LOG_ERROR);
  std::error_code failed;
  fs::remove_all(to, failed);
  fs::create_directories(to / name);
  Json json = Json::parse(std::ifstream(from / "capture.json"), nullptr, false);
  if (json.is_discarded()) stop((from / "capture.json").string() + ": cannot be read");
  Json sequence;
  for (const Json& s : json["sequences"])
    if (s.value("name", "") == name) sequence = s;
  if (sequence.is_null()) stop((from / "capture.json").string() + ": no sequence \"" + name + "\"");
  const int frames = sequence["frames"];
  for (const auto& entry : fs::directory_iterator(from / name))
    if (entry.path().extension() == ".mp4" || entry.path().extension() == ".mkv")
      repeatVideo(entry.path().string(), (to / name / entry.path().filename()).string(), times,
                  frames / json["fps"].get<double>());
  if (sequence["mesh"].is_object()) {
    const std::string positions = sequence["mesh"]["positions"], topology = sequence["mesh"]["topology"];
    repeatFile(from / positions, to / positions, times);
    repeatFile(from / topology, to / topology, 1);
  } else {
    linkMeshes(from / name / "mesh", to / name / "mesh", frames, times);
  }
  for (const char* folder : {"cameras", "background"})
    if (fs::exists(from / folder)) fs::copy(from / folder, to / folder, fs::copy_options::recursive);
  sequence["frames"] = frames * times;
  for (const char* left_out : {"test_frames", "audio"}) sequence.erase(left_out);
  json["sequences"] = Json::array({sequence});
  json.erase("classes");
  std::ofstream(to / "capture.json") << json.dump(1) << "\n";
  return 0;
}
