// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bake/motion/class_plan.h"
#include "bake/motion/root_track.h"
#include "bake/run/stream_reader.h"
#include "bake/sound/segment_encoder.h"
#include "bake/stages/stages.h"
#include "base/hash.h"
#include "base/text.h"
#include "platform/audio_input.h"

namespace fourdvt::bake {
namespace {

constexpr double kSegment_s = 5;     // maximum length of a segment, which a page decodes at once
constexpr double kOverlap_s = 0.02;  // overlap of a segment with the next one, for cross-fading
constexpr double kShortestStep_s = 0.01, kLongestStep_s = 2;
constexpr double kShortfall_s = 0.1;  // minimum silence at the end that is reported as a note

// Reads samples of a file by their numbers, in ascending order. Samples outside the file are silent.
class SampleWindow {
 public:
  static Result<SampleWindow> open(const std::string& path) {
    FOURDVT_ASSIGN(auto reader, platform::AudioReader::open(path, kSoundRate));
    return SampleWindow(std::move(reader));
  }
  int channels() const { return reader_->channels(); }
  // Number of samples of the file, once its end was read.
  std::optional<int64_t> length() const { return length_; }

  // Reads samples, and releases those before `first`.
  Result<std::vector<float>> samples(int64_t first, int64_t count) {
    const size_t c = size_t(channels());
    FOURDVT_TRY(skipTo(first));
    FOURDVT_TRY(readUpTo(first + count));
    std::vector<float> out(size_t(count) * c, 0);
    const int64_t from = std::max(first, held_first_), to = std::min(first + count, heldEnd());
    if (from < to)
      std::copy_n(held_.begin() + (from - held_first_) * int64_t(c), size_t(to - from) * c,
                  out.begin() + (from - first) * int64_t(c));
    return out;
  }

 private:
  explicit SampleWindow(std::unique_ptr<platform::AudioReader> reader) : reader_(std::move(reader)) {}
  int64_t heldEnd() const { return held_first_ + int64_t(held_.size() / size_t(channels())); }

  Status skipTo(int64_t first) {
    while (!length_ && heldEnd() < first) {
      drop(heldEnd());
      FOURDVT_TRY(readUpTo(std::min(first, heldEnd() + kSoundRate)));
    }
    drop(first);
    return {};
  }
  void drop(int64_t before) {
    const int64_t count = std::clamp<int64_t>(before - held_first_, 0, heldEnd() - held_first_);
    held_.erase(held_.begin(), held_.begin() + count * channels());
    held_first_ += count;
  }
  Status readUpTo(int64_t end) {
    const int64_t missing = end - heldEnd();
    if (length_ || missing <= 0) return {};
    const size_t before = held_.size(), c = size_t(channels());
    held_.resize(before + size_t(missing) * c);
    FOURDVT_ASSIGN(const size_t got, reader_->read(std::span(held_).subspan(before)));
    held_.resize(before + got * c);
    if (int64_t(got) < missing) length_ = heldEnd();
    return {};
  }

  std::unique_ptr<platform::AudioReader> reader_;
  std::vector<float> held_;
  int64_t held_first_ = 0;  // number of the first buffered sample
  std::optional<int64_t> length_;
};

int64_t samplesOf(double seconds) { return std::llround(seconds * kSoundRate); }

// Index of the sample that is heard with frame 0.
int64_t firstSample(const capture::CaptureSequence& sequence, double fps) {
  return samplesOf(sequence.first_frame / fps - sequence.sound->offset_s);
}

struct SoundPiece {
  int64_t first = 0;  // index of the sample at time 0
  double duration_s = 0;
  bool loop = false;  // the end is followed by the beginning
};

// Encodes all segments in every codec, and writes a file for each codec.
Result<package::Sound> encodeAll(const BakeRun& run, const std::string& name, const std::string& path,
                                 const SoundPiece& piece) {
  FOURDVT_ASSIGN(auto window, SampleWindow::open(path));
  const auto segments = std::max<int64_t>(1, int64_t(std::ceil(piece.duration_s / kSegment_s)));
  package::Sound sound;
  sound.sample_rate = kSoundRate;
  sound.channels = window.channels();
  sound.segment_s = piece.duration_s / double(segments);
  const int64_t length = samplesOf(piece.duration_s), behind = samplesOf(kOverlap_s) + int64_t(kMaxPadding);
  const size_t channels = size_t(sound.channels);
  std::vector<std::vector<uint8_t>> files(std::size(kSoundCodecs));
  sound.encodings.resize(files.size());
  std::vector<float> beginning;
  for (int64_t i = 0; i < segments; ++i) {
    FOURDVT_TRY(run.checkStop());
    const int64_t from = samplesOf(double(i) * sound.segment_s),
                  end = std::min(length, samplesOf(double(i + 1) * sound.segment_s));
    FOURDVT_ASSIGN(auto samples, window.samples(piece.first + from, end - from + behind));
    if (i == 0)
      beginning.assign(samples.begin(), samples.begin() + std::min<int64_t>(behind, length) * int64_t(channels));
    if (piece.loop)
      for (size_t at = size_t(length - std::min(length, from)) * channels, b = 0; at < samples.size(); ++at, ++b)
        samples[at] = beginning[b % beginning.size()];
    for (size_t e = 0; e < files.size(); ++e) {
      const size_t kept = (size_t(end - from) + size_t(samplesOf(kOverlap_s))) * channels;
      FOURDVT_ASSIGN(const auto encoded,
                     encodeSegment(kSoundCodecs[e], std::span(samples).first(kept), sound.channels));
      sound.encodings[e].priming = encoded.priming;
      sound.encodings[e].segments.push_back({uint32_t(encoded.bytes.size()), encoded.samples});
      files[e].insert(files[e].end(), encoded.bytes.begin(), encoded.bytes.end());
    }
  }
  for (size_t e = 0; e < files.size(); ++e) {
    const SoundCodecInfo& info = infoOf(kSoundCodecs[e]);
    sound.encodings[e].mime_type = info.mime_type;
    sound.encodings[e].bytes = files[e].size();
    sound.encodings[e].hash = fnv1a(files[e]);
    FOURDVT_ASSIGN(sound.encodings[e].uri, writeNamed(run.job.resultFolder(), name + info.extension, files[e]));
  }
  return sound;
}

// Phases at which a foot of the member touches down.
Result<std::vector<double>> memberSteps(const Job& job, const StreamPlan& plan, const ClassMember& member,
                                        const ReadPositions& read) {
  const capture::CaptureSequence& source = *member.source;
  FOURDVT_ASSIGN(const auto track, rootTrack(job.capture, source, read));
  FOURDVT_ASSIGN(const auto frames, footfalls(job.capture, source, track, read));
  return stepPhases(frames, member.source_frame, source.loop ? source.frame_count : 0, plan.frameCount());
}

// Audible seconds of a footstep's file: its whole length, up to a limit.
Result<double> stepLength(const capture::CaptureSound& step, bool* cut = nullptr) {
  FOURDVT_ASSIGN(auto window, SampleWindow::open(step.path));
  FOURDVT_TRY(window.samples(0, samplesOf(kLongestStep_s) + 1));  // reads up to the end
  const double whole_s = double(window.length().value_or(samplesOf(kLongestStep_s))) / kSoundRate;
  if (cut) *cut = !window.length();
  return std::min(whole_s + step.offset_s, kLongestStep_s);
}

Result<package::Sound> writeSteps(BakeRun& run, const StreamPlan& plan) {
  const Job& job = run.job;
  const capture::CaptureSound& step = *plan.motion.source->footstep;
  MeshReader meshes(job);
  const ReadPositions read = meshes.function();
  std::vector<std::vector<double>> steps;
  for (const ClassMember& member : plan.motion.members) {
    FOURDVT_ASSIGN(auto of_member, memberSteps(job, plan, member, read));
    steps.push_back(std::move(of_member));
  }
  const std::vector<double> mean = meanSteps(steps, plan.motion.loop);
  if (mean.empty()) {
    run.job.notes.push_back("'" + plan.name + "' has no sound of steps: no foot is seen to come down.");
    return package::Sound();
  }
  FOURDVT_ASSIGN(const double length_s, stepLength(step));
  FOURDVT_ASSIGN(auto sound, encodeAll(run, plan.name, step.path, {samplesOf(-step.offset_s), length_s, false}));
  sound.steps = mean;
  return sound;
}

// Encodes the sound of one stream; no encodings if it has none.
Result<package::Sound> writeSound(BakeRun& run, const StreamPlan& plan) {
  if (plan.isClass()) {
    if (plan.motion.source && plan.motion.source->footstep) return writeSteps(run, plan);
    return package::Sound();
  }
  const capture::CaptureSequence& source = *plan.motion.members[0].source;
  if (!source.sound) return package::Sound();
  const double fps = run.job.capture.fps;
  return encodeAll(run, plan.name, source.sound->path,
                   {firstSample(source, fps), source.frame_count / fps, source.loop});
}

void addNote(Job& job, const BakeEnvironment& environment, const std::string& note) {
  job.notes.push_back(note);
  if (environment.note) environment.note(note);
}

}  // namespace

Status checkSounds(Job& job, const BakeEnvironment& environment) {
  for (const capture::CaptureClass* c : bakedClasses(job)) {
    if (!c->footstep) continue;
    bool cut = false;
    FOURDVT_ASSIGN(const double length_s, stepLength(*c->footstep, &cut));
    if (!(length_s >= kShortestStep_s) || c->footstep->offset_s > kLongestStep_s / 2)
      return Error{ErrorId::CaptureJson, job.capture.folder + "/capture.json: nothing of " + c->footstep->path +
                                             " is heard as a step of \"" + c->name +
                                             "\": correct \"offset_ms\" of its \"footsteps\", or take that out"};
    if (cut) addNote(job, environment, "the step of '" + c->name + "' is longer than 2 s; the rest is left out.");
  }
  for (const capture::CaptureSequence& sequence : job.capture.sequences) {
    if (!sequence.sound) continue;
    FOURDVT_ASSIGN(auto window, SampleWindow::open(sequence.sound->path));
    const int64_t first = firstSample(sequence, job.capture.fps),
                  length = samplesOf(sequence.frame_count / job.capture.fps);
    for (int64_t at = std::max<int64_t>(0, first); at < first + length && !window.length(); at += kSoundRate)
      FOURDVT_TRY(window.samples(at, std::min<int64_t>(kSoundRate, first + length - at)));
    const double last_s = double(window.length().value_or(first + length) - first) / kSoundRate;
    const double duration_s = double(length) / kSoundRate;
    if (last_s <= 0 || first + length <= 0)
      return Error{ErrorId::CaptureJson, job.capture.folder + "/capture.json: nothing of " + sequence.sound->path +
                                             " is heard in \"" + sequence.name +
                                             "\": correct \"offset_ms\", or take \"audio\" out"};
    if (last_s + kShortfall_s < duration_s) {
      const std::string text = printed("' ends after %.2f s of %.2f s; the rest is silent.", last_s, duration_s);
      addNote(job, environment, "the sound of '" + sequence.name + text);
    }
  }
  return {};
}

Result<package::Sounds> writeSounds(BakeRun& run, ReportInput& report) {
  package::Sounds out;
  for (const StreamPlan& plan : run.job.streams) {
    FOURDVT_ASSIGN(auto sound, writeSound(run, plan));
    for (const package::SoundEncoding& encoding : sound.encodings)
      report.figures.bytes_by_part[encoding.uri] = encoding.bytes;
    if (!sound.encodings.empty()) out[plan.name] = std::move(sound);
  }
  return out;
}

}  // namespace fourdvt::bake
