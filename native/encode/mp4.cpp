// SPDX-License-Identifier: Apache-2.0
#include "encode/mp4.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>

#include "base/text.h"
#include "platform/ffmpeg_handles.h"

extern "C" {
#include <libavcodec/codec_desc.h>
}

namespace fourdvt::encode {
namespace {

std::string reason(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

Error writeError(const std::string& path, int code) {
  return {ErrorId::WriteFailed,
          path + ": cannot write the video: " + reason(code) + "; free disk space or choose another output folder"};
}

struct MuxerDeleter {
  void operator()(AVFormatContext* c) const {
    if (c->pb) avio_closep(&c->pb);
    avformat_free_context(c);
  }
};
using Muxer = std::unique_ptr<AVFormatContext, MuxerDeleter>;

AVCodecID codecId(Codec codec) { return avcodec_descriptor_get_by_name(infoOf(codec).name)->id; }

void describe(AVStream& stream, const EncodeSettings& s, const std::vector<uint8_t>& parameter_sets) {
  AVCodecParameters* p = stream.codecpar;
  p->codec_type = AVMEDIA_TYPE_VIDEO;
  p->codec_id = codecId(s.codec);
  p->format = 0;  // AV_PIX_FMT_YUV420P
  p->width = s.width;
  p->height = s.height;
  p->color_range = AVCOL_RANGE_MPEG;
  p->color_primaries = AVCOL_PRI_BT709;
  p->color_trc = AVCOL_TRC_BT709;
  p->color_space = AVCOL_SPC_BT709;
  p->video_delay = infoOf(s.codec).reorder_frames;
  if (!parameter_sets.empty()) {
    p->extradata = static_cast<uint8_t*>(av_mallocz(parameter_sets.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    std::memcpy(p->extradata, parameter_sets.data(), parameter_sets.size());
    p->extradata_size = static_cast<int>(parameter_sets.size());
  }
  const AVRational fps = av_d2q(s.fps, 100000);
  stream.time_base = av_inv_q(fps);
  stream.avg_frame_rate = fps;
}

Result<Muxer> openMuxer(const std::string& path, const EncodeSettings& settings, const EncodedGop& first) {
  AVFormatContext* raw = nullptr;
  avformat_alloc_output_context2(&raw, nullptr, "mp4", path.c_str());
  if (!raw) return Error{ErrorId::Unsupported, "FFmpeg has no mp4 muxer"};
  Muxer muxer(raw);
  muxer->flags |= AVFMT_FLAG_BITEXACT;
  AVStream* stream = avformat_new_stream(raw, nullptr);
  describe(*stream, settings, first.parameter_sets);
  if (const int rc = avio_open(&raw->pb, path.c_str(), AVIO_FLAG_WRITE); rc < 0) return writeError(path, rc);
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);
  const int rc = avformat_write_header(raw, &options);
  av_dict_free(&options);
  if (rc < 0) return writeError(path, rc);
  return muxer;
}

Status writeGop(AVFormatContext& muxer, const std::string& path, const EncodeSettings& settings, EncodedGop& gop,
                uint32_t first_frame) {
  const AVRational frame_base = av_inv_q(av_d2q(settings.fps, 100000));
  for (size_t i = 0; i < gop.packets.size(); ++i) {
    EncodedPacket& in = gop.packets[i];
    const platform::AvPacket packet(av_packet_alloc());
    packet->data = in.bytes.data();  // borrowed: av_write_frame copies the data that it needs
    packet->size = static_cast<int>(in.bytes.size());
    packet->pts = int64_t(first_frame) + in.frame;
    packet->dts = int64_t(first_frame) + int64_t(i) - infoOf(settings.codec).reorder_frames;
    packet->duration = 1;
    packet->flags = in.key ? AV_PKT_FLAG_KEY : 0;
    av_packet_rescale_ts(packet.get(), frame_base, muxer.streams[0]->time_base);
    if (const int rc = av_write_frame(&muxer, packet.get()); rc < 0) return writeError(path, rc);
  }
  return {};
}

Error broken(const std::string& path, const std::string& what) {
  return {ErrorId::Internal, path + ": the finished video does not read back: " + what};
}

Result<platform::AvFormat> openDemuxer(const std::string& path) {
  AVFormatContext* raw = nullptr;
  if (const int rc = avformat_open_input(&raw, path.c_str(), nullptr, nullptr); rc < 0) return broken(path, reason(rc));
  platform::AvFormat demuxer(raw);
  if (raw->nb_streams != 1) return broken(path, "not one stream");
  return demuxer;
}

struct Vp9Level {
  int level;  // ten times the level's number
  double luma_rate, luma_picture, bits_per_s;
  int side;
};

// Levels of Annex A of the VP9 bitstream specification.
constexpr Vp9Level kVp9Levels[] = {{10, 829440, 36864, 0.2e6, 512},          {11, 2764800, 73728, 0.8e6, 768},
                                   {20, 4608000, 122880, 1.8e6, 960},        {21, 9216000, 245760, 3.6e6, 1344},
                                   {30, 20736000, 552960, 7.2e6, 2048},      {31, 36864000, 983040, 12e6, 2752},
                                   {40, 83558400, 2228224, 18e6, 4160},      {41, 160432128, 2228224, 30e6, 4160},
                                   {50, 311951360, 8912896, 60e6, 8384},     {51, 588251136, 8912896, 120e6, 8384},
                                   {52, 1176502272, 8912896, 180e6, 8384},   {60, 1176502272, 35651584, 180e6, 16832},
                                   {61, 2353004544, 35651584, 240e6, 16832}, {62, 4706009088, 35651584, 480e6, 16832}};

// Profile 0, 8 bits, 4:2:0, BT.709, limited range: the encoder's only VP9 output.
std::string vp9Codec(const AVCodecParameters& p, double fps, double bits_per_s) {
  const double picture = double(p.width) * p.height;
  int level = kVp9Levels[std::size(kVp9Levels) - 1].level;
  for (const Vp9Level& l : kVp9Levels) {
    if (picture * fps > l.luma_rate || picture > l.luma_picture || bits_per_s > l.bits_per_s) continue;
    if (std::max(p.width, p.height) > l.side) continue;
    level = l.level;
    break;
  }
  return printed("vp09.00.%02d.08.01.01.01.01.00", level);
}

// Reads profile, level, tier and chroma from the av1C box; BT.709 and limited range are fixed by the encoder.
std::string av1Codec(const AVCodecParameters& p) {
  const uint8_t *box = p.extradata, chroma = box[2];
  return printed("av01.%d.%02d%c.08.0.%d%d%d.01.01.01.0", box[1] >> 5, box[1] & 31, chroma & 0x80 ? 'H' : 'M',
                 (chroma >> 3) & 1, (chroma >> 2) & 1, chroma & 3);
}

// Sets the codec string, and the decoder description where WebCodecs needs one.
Status describeCodec(const AVCodecParameters& p, const std::string& path, double fps, double bits_per_s,
                     Mp4Samples& out) {
  if (p.codec_id == AV_CODEC_ID_VP9) {
    out.codec = vp9Codec(p, fps, bits_per_s);
    return {};
  }
  if (p.codec_id == AV_CODEC_ID_AV1) {
    if (p.extradata_size < 4 || p.extradata[0] != 0x81) return broken(path, "no av1C");
    if (p.extradata[2] & 0x70) return broken(path, "not 8 bits in colour");
    out.codec = av1Codec(p);
    return {};
  }
  if (p.codec_id != AV_CODEC_ID_H264 || p.extradata_size < 8 || p.extradata[0] != 1) return broken(path, "no avcC");
  out.table.decoder_description.assign(p.extradata, p.extradata + p.extradata_size);
  out.codec = printed("avc1.%02x%02x%02x", p.extradata[1], p.extradata[2], p.extradata[3]);
  return {};
}

Status readSamples(AVFormatContext& demuxer, const std::string& path, double fps,
                   std::vector<package::VideoSample>& samples) {
  std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return broken(path, "cannot be opened");
  const AVRational frame_base = av_inv_q(av_d2q(fps, 100000));
  const platform::AvPacket packet(av_packet_alloc());
  std::vector<uint8_t> bytes;
  while (av_read_frame(&demuxer, packet.get()) >= 0) {
    const int64_t frame = av_rescale_q(packet->pts, demuxer.streams[0]->time_base, frame_base);
    bytes.resize(packet->size);
    const bool same = packet->pos >= 0 && std::fseek(file.get(), long(packet->pos), SEEK_SET) == 0 &&
                      std::fread(bytes.data(), 1, bytes.size(), file.get()) == bytes.size() &&
                      std::memcmp(bytes.data(), packet->data, bytes.size()) == 0;
    if (!same || frame < 0) return broken(path, "a sample is not where the file's table says");
    samples.push_back({static_cast<uint64_t>(packet->pos), static_cast<uint32_t>(packet->size),
                       static_cast<uint32_t>(frame), (packet->flags & AV_PKT_FLAG_KEY) != 0});
    av_packet_unref(packet.get());
  }
  return {};
}

// GOPs are closed: the samples of chunk g are the next `frames of g` in the file.
Status groupByChunk(const std::string& path, const std::vector<uint32_t>& first_frames, uint32_t frame_count,
                    package::SampleTable& table) {
  if (table.samples.size() != frame_count) return broken(path, "the number of samples is not the number of frames");
  table.chunk_first_sample = first_frames;
  table.chunk_first_sample.push_back(frame_count);
  std::vector<uint8_t> seen(frame_count, 0);
  for (size_t g = 0; g < first_frames.size(); ++g) {
    const uint32_t begin = table.chunk_first_sample[g], end = table.chunk_first_sample[g + 1];
    if (!table.samples[begin].key) return broken(path, "a GOP does not start on a key sample");
    for (uint32_t i = begin; i < end; ++i) {
      const package::VideoSample& s = table.samples[i];
      if (s.frame < begin || s.frame >= end || seen[s.frame]++) return broken(path, "frames out of their GOP");
      if (i > begin && s.offset != table.samples[i - 1].offset + table.samples[i - 1].bytes)
        return broken(path, "a GOP's samples are not contiguous");
    }
  }
  return {};
}

}  // namespace

Status writeMp4(const std::string& path, const EncodeSettings& settings, uint32_t gop_count, const LoadGop& load) {
  Muxer muxer;
  std::vector<uint8_t> parameter_sets;
  uint32_t first_frame = 0;
  for (uint32_t g = 0; g < gop_count; ++g) {
    FOURDVT_ASSIGN(EncodedGop gop, load(g));
    if (g == 0) {
      FOURDVT_ASSIGN(muxer, openMuxer(path, settings, gop));
      parameter_sets = gop.parameter_sets;
    }
    if (gop.parameter_sets != parameter_sets)
      return Error{ErrorId::Internal,
                   path + ": GOPs were encoded with different parameter sets; delete the work folder and bake again"};
    FOURDVT_TRY(writeGop(*muxer, path, settings, gop, first_frame));
    first_frame += static_cast<uint32_t>(gop.packets.size());
  }
  if (const int rc = av_write_trailer(muxer.get()); rc < 0) return writeError(path, rc);
  if (const int rc = avio_closep(&muxer->pb); rc < 0) return writeError(path, rc);
  return {};
}

Result<Mp4Samples> readMp4Samples(const std::string& path, double fps, const std::vector<uint32_t>& gop_first_frames,
                                  uint32_t frame_count) {
  FOURDVT_ASSIGN(auto opened, openDemuxer(path));
  AVFormatContext& demuxer = *opened;
  Mp4Samples out;
  out.file_bytes = static_cast<uint64_t>(std::max<int64_t>(0, avio_size(demuxer.pb)));
  FOURDVT_TRY(readSamples(demuxer, path, fps, out.table.samples));
  FOURDVT_TRY(groupByChunk(path, gop_first_frames, frame_count, out.table));
  const double bits_per_s = frame_count ? 8.0 * double(out.file_bytes) * fps / frame_count : 0;
  FOURDVT_TRY(describeCodec(*demuxer.streams[0]->codecpar, path, fps, bits_per_s, out));
  return out;
}

}  // namespace fourdvt::encode
