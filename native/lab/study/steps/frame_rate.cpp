// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/frame_rate.h"

#include <algorithm>

#include "bake/texels/picture_crop.h"
#include "base/robust.h"
#include "base/text.h"
#include "base/watch.h"
#include "lab/measure/character_frame.h"
#include "lab/study/run/gpu_drain.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "render/cameras/fvvr.h"
#include "render/plain_figure.h"

namespace fourdvt::study {
namespace {

constexpr uint32_t kDistinctFrames = 4;  // kept in memory; the measured frames cycle through them
constexpr int kWarmUp = 3;

// A decoded frame of the character.
struct LayeredFrame {
  Positions positions;
  std::vector<uint8_t> labels;
  std::vector<uint8_t> planes;  // y, u, v, tightly packed

  I420View picture(const package::Rendition& rendition) const {
    const int width = rendition.width, height = rendition.height;
    const uint8_t* y = planes.data();
    const uint8_t* u = y + size_t(width) * height;
    return {width, height, y, u, u + size_t(width / 2) * (height / 2), width, width / 2, width / 2};
  }
};

struct LoadedCharacter {
  measure::CharacterStream stream;
  package::Rendition rendition;
  std::vector<LayeredFrame> frames;  // 0, 1, …
};

void appendPlane(std::vector<uint8_t>& out, const uint8_t* plane, int stride, int width, int height) {
  for (int y = 0; y < height; ++y)
    out.insert(out.end(), plane + ptrdiff_t(y) * stride, plane + ptrdiff_t(y) * stride + width);
}

// Reads positions, labels and pictures of the first chunk's first frames.
Status readFirstChunk(const std::string& folder, LoadedCharacter& out) {
  const package::StreamIndex& index = out.stream.index;
  FOURDVT_ASSIGN(const package::ChunkFrames c, measure::readCharacterChunk(out.stream, 0));
  out.frames.resize(std::min(kDistinctFrames, c.frame_count));
  const size_t label_count = size_t(c.layer_count) * c.face_count;
  for (size_t f = 0; f < out.frames.size(); ++f) {
    for (uint32_t v = 0; v < c.vertex_count; ++v)
      out.frames[f].positions.push_back(index.position_origin +
                                        index.position_step_m * glm::vec3(c.positions[f * c.vertex_count + v]));
    out.frames[f].labels.assign(c.labels.begin() + f * label_count, c.labels.begin() + (f + 1) * label_count);
  }
  const package::SampleTable& table = index.renditions.back();
  FOURDVT_ASSIGN(auto decoder,
                 platform::SampleDecoder::create(
                     out.rendition.codec, table.decoder_description, [&](const I420View& picture, int64_t number) {
                       if (number < 0 || number >= int64_t(out.frames.size())) return;
                       std::vector<uint8_t>& planes = out.frames[number].planes;
                       appendPlane(planes, picture.y, picture.stride_y, picture.width, picture.height);
                       appendPlane(planes, picture.u, picture.stride_u, picture.width / 2, picture.height / 2);
                       appendPlane(planes, picture.v, picture.stride_v, picture.width / 2, picture.height / 2);
                     }));
  const std::string video = folder + "/" + out.rendition.video_uri;
  for (uint32_t s = table.chunk_first_sample[0]; s < table.chunk_first_sample[1]; ++s) {
    const package::VideoSample& sample = table.samples[s];
    FOURDVT_ASSIGN(auto coded, platform::readFileRange(video, sample.offset, sample.bytes));
    FOURDVT_TRY(decoder->decode(coded, sample.frame, sample.key));
  }
  FOURDVT_TRY(decoder->flush());
  const size_t picture_bytes = size_t(out.rendition.width) * out.rendition.height * 3 / 2;
  for (const LayeredFrame& frame : out.frames)
    if (frame.planes.size() != picture_bytes)
      return Error{ErrorId::VideoInvalid, video + ": does not decode to its first frames; bake it again"};
  return {};
}

Result<LoadedCharacter> loadCharacter(const std::string& folder, std::string sequence) {
  LoadedCharacter out;
  FOURDVT_ASSIGN(const auto character, measure::readCharacter(folder));
  if (sequence.empty() && !character.sequences.empty()) sequence = character.sequences[0].name;
  if (!character.find(sequence))
    return Error{ErrorId::InvalidArgument, folder + "/character.gltf: has no sequence \"" + sequence + "\"; bake it"};
  FOURDVT_TRY(measure::openCharacterStream(folder, sequence, out.stream));
  out.rendition = out.stream.sequence->renditions.back();
  FOURDVT_TRY(readFirstChunk(folder, out));
  return out;
}

// Captured frames of the same numbers, with clean matte edges.
Result<std::vector<mattes::CaptureFrame>> readCapturedFrames(const capture::Capture& capture,
                                                             const OpenVideo& open_video,
                                                             const LoadedCharacter& character) {
  const capture::CaptureSequence* sequence = capture.find(character.stream.sequence->name);
  if (!sequence)
    return Error{ErrorId::InvalidArgument, capture.folder + ": has no sequence \"" + character.stream.sequence->name +
                                               "\"; name the capture that the character was baked from"};
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, *sequence, open_video));
  std::vector<mattes::CaptureFrame> frames;
  while (frames.size() < character.frames.size()) {
    FOURDVT_ASSIGN(auto frame, reader->next());
    for (Image& picture : frame.pictures) bake::replaceEdgeColours(picture);
    frames.push_back(std::move(frame));
  }
  return frames;
}

struct Samples {
  std::vector<double> frame, upload, geometry, depth_maps, shading, readback;
};

PassTimes medians(const Samples& s) {
  return {median(s.frame),      median(s.upload),  median(s.geometry),
          median(s.depth_maps), median(s.shading), median(s.readback)};
}

// Both renderers on one device, with their frames.
class Race {
 public:
  Race(gpu::Device& device, const LoadedCharacter& loaded, const std::vector<mattes::CaptureFrame>& captured,
       const FrameRateOptions& options)
      : device_(device), loaded_(loaded), captured_(captured) {
    recipe_options_.ground_shadow = false;
    const int cameras = static_cast<int>(captured[0].pictures.size());
    for (int closest : options.closest) {
      if (closest >= cameras) closest = 0;
      const bool is_known =
          std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.options.closest == closest; });
      if (!is_known) entries_.push_back({{.closest = closest}, {}});
    }
  }

  Status prepare(const capture::Capture& capture, FrameRates& rates) {
    FOURDVT_TRY(drain_.prepare(device_));
    const uint64_t before = device_.counters().live_texture_bytes;
    FOURDVT_ASSIGN(figure_, render::PlainFigure::create(device_, loaded_.stream.character, loaded_.stream.mesh));
    figure_.setLayout(loaded_.rendition);
    FOURDVT_ASSIGN(picture_, render::createPicture(device_, loaded_.rendition.width, loaded_.rendition.height,
                                                   render::PictureTextures::Kind::I420));
    FOURDVT_ASSIGN(recipe_, render::Recipe::create(device_));
    const uint64_t between = device_.counters().live_texture_bytes;
    std::vector<PinholeCamera> cameras;
    for (const auto& camera : capture.cameras) cameras.push_back(camera.pinhole);
    FOURDVT_ASSIGN(fvvr_, render::Fvvr::create(device_, cameras, capture.topology));
    rates.layered_bytes = between - before;
    rates.fvvr_bytes = device_.counters().live_texture_bytes - between;
    return {};
  }

  Result<FrameRate> run(int width, int height, int frames, const std::atomic<bool>* stop) {
    FOURDVT_TRY(resize(width, height));
    Samples layered;
    for (int i = -kWarmUp; i < frames; ++i) {
      if (stop && *stop) return Error{ErrorId::Interrupted, "interrupted"};
      if (i <= 0) {
        layered = {};
        for (Entry& entry : entries_) entry.samples = {};
      }
      OrbitView orbit = defaultOrbit(loaded_.stream.character.bounds, double(width) / height);
      orbit.azimuth_deg += 360.0 * i / frames;
      const render::View view = render::viewFromCamera(cameraFromOrbit(orbit, width, height));
      const size_t frame = static_cast<size_t>(i + kWarmUp) % loaded_.frames.size();
      FOURDVT_TRY(layeredFrame(frame, view, layered));
      for (Entry& entry : entries_) FOURDVT_TRY(fvvrFrame(frame, view, entry));
      FOURDVT_TRY(layeredParts(frame, view, layered));
      for (Entry& entry : entries_) FOURDVT_TRY(fvvrParts(frame, view, entry));
    }
    FrameRate rate{width, height, medians(layered), {}};
    for (const Entry& entry : entries_) rate.fvvr.push_back({entry.options.closest, medians(entry.samples)});
    return rate;
  }

 private:
  struct Entry {  // FVVR with one M
    render::FvvrOptions options;
    Samples samples;
  };

  Status resize(int width, int height) {
    FOURDVT_ASSIGN(auto color, gpu::makeTexture(device_, {.width = width, .height = height, .label = "race"}));
    FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, {.colors = {color.id()}, .label = "race"}));
    color_ = std::move(color);
    read_.resize(size_t(width) * height * 4);
    return {};
  }

  void uploadLayers(size_t frame) {
    render::uploadPicture(device_, picture_, loaded_.frames[frame].picture(loaded_.rendition));
  }
  void setGeometry(size_t frame) {
    figure_.setFrame(device_, loaded_.frames[frame].positions, loaded_.frames[frame].labels);
  }
  Status drawLayers(const render::View& view) {
    return figure_.draw(*recipe_, picture_, view, recipe_options_, target_.id());
  }

  Status layeredFrame(size_t frame, const render::View& view, Samples& out) {
    return timed(out.frame, [&] {
      uploadLayers(frame);
      setGeometry(frame);
      return drawLayers(view);
    });
  }

  Status fvvrFrame(size_t frame, const render::View& view, Entry& entry) {
    return timed(entry.samples.frame, [&]() -> Status {
      const std::vector<size_t> used = fvvr_->camerasOf(view, entry.options);
      FOURDVT_TRY(fvvr_->setFrame(captured_[frame].positions, captured_[frame].pictures, used));
      return fvvr_->draw(view, entry.options, target_.id());
    });
  }

  // Runs one part on a drained GPU.
  template <class Part>
  Status timed(std::vector<double>& out, const Part& part) {
    const Watch watch;
    FOURDVT_TRY(part());
    FOURDVT_TRY(drain_.wait(device_));
    out.push_back(watch.ms());
    return {};
  }

  Status readBack(const render::View& view, Samples& out) {
    return timed(out.readback, [&] {
      return device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = view.width, .height = view.height},
                                read_.data());
    });
  }

  Status layeredParts(size_t frame, const render::View& view, Samples& out) {
    FOURDVT_TRY(timed(out.upload, [&] { return uploadLayers(frame), Status(); }));
    FOURDVT_TRY(timed(out.geometry, [&] { return setGeometry(frame), Status(); }));
    FOURDVT_TRY(timed(out.shading, [&] { return drawLayers(view); }));
    return readBack(view, out);
  }

  Status fvvrParts(size_t frame, const render::View& view, Entry& entry) {
    Samples& out = entry.samples;
    const std::vector<size_t> used = fvvr_->camerasOf(view, entry.options);
    FOURDVT_TRY(timed(out.geometry, [&] { return fvvr_->setGeometry(captured_[frame].positions, used); }));
    FOURDVT_TRY(timed(out.upload, [&] { return fvvr_->uploadPictures(captured_[frame].pictures); }));
    FOURDVT_TRY(timed(out.depth_maps, [&] { return fvvr_->drawDepthMaps(), Status(); }));
    FOURDVT_TRY(timed(out.shading, [&] { return fvvr_->draw(view, entry.options, target_.id()); }));
    return readBack(view, out);
  }

  gpu::Device& device_;
  const LoadedCharacter& loaded_;
  const std::vector<mattes::CaptureFrame>& captured_;
  std::vector<Entry> entries_;
  render::RecipeOptions recipe_options_;
  GpuDrain drain_;
  render::PlainFigure figure_;
  render::PictureTextures picture_;
  std::unique_ptr<render::Recipe> recipe_;
  std::unique_ptr<render::Fvvr> fvvr_;
  gpu::Texture color_;
  gpu::Target target_;
  std::vector<uint8_t> read_;
};

}  // namespace

Result<FrameRates> measureFrameRates(gpu::Device& device, const capture::Capture& capture, const OpenVideo& open_video,
                                     const std::string& character_folder, const FrameRateOptions& options) {
  FOURDVT_ASSIGN(auto loaded, loadCharacter(character_folder, options.sequence));
  FOURDVT_ASSIGN(auto captured, readCapturedFrames(capture, open_video, loaded));
  const package::Character& character = loaded.stream.character;
  FrameRates rates;
  rates.renderer = device.caps().renderer;
  rates.sequence = loaded.stream.sequence->name;
  rates.layers = character.layer_count;
  rates.layer_side = loaded.rendition.layers[0].width;
  rates.cameras = static_cast<int>(capture.cameras.size());
  rates.frames = options.frames;
  rates.faces = character.face_count;
  Race race(device, loaded, captured, options);
  FOURDVT_TRY(race.prepare(capture, rates));
  for (const auto& [width, height] : options.sizes) {
    FOURDVT_ASSIGN(auto rate, race.run(width, height, options.frames, options.stop));
    rates.sizes.push_back(rate);
  }
  return rates;
}

std::string frameRateTable(const FrameRates& r) {
  std::string text = printed("%s; %s, %u faces, %d layers of %d, %d cameras, %d frames\n", r.renderer.c_str(),
                             r.sequence.c_str(), r.faces, r.layers, r.layer_side, r.cameras, r.frames);
  text += printed("GPU textures: layered %.1f MB, FVVR %.1f MB\n", r.layered_bytes / 1e6, r.fvvr_bytes / 1e6);
  text += printed("%-9s %-12s %8s %8s | %8s %8s %8s %8s | %8s\n", "picture", "method", "frames/s", "frame ms", "upload",
                  "geometry", "depth", "shading", "readback");
  for (const FrameRate& rate : r.sizes) {
    const auto row = [&](const char* method, const PassTimes& t) {
      return printed("%-9s %-12s %8.1f %8.2f | %8.2f %8.2f %8.2f %8.2f | %8.2f\n",
                     printed("%dx%d", rate.width, rate.height).c_str(), method, t.framesPerSecond(), t.frame_ms,
                     t.upload_ms, t.geometry_ms, t.depth_maps_ms, t.shading_ms, t.readback_ms);
    };
    text += row("layered", rate.layered);
    for (const auto& [closest, times] : rate.fvvr) {
      text += row(printed("fvvr, M = %d", closest ? closest : r.cameras).c_str(), times);
      text += printed("          frame rate ratio %.2f, draw only (with depth maps) %.2f, shading only %.2f\n",
                      rate.ratio(times), rate.drawRatio(times), rate.shadingRatio(times));
    }
  }
  return text;
}

}  // namespace fourdvt::study
