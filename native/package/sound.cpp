// SPDX-License-Identifier: Apache-2.0
#include "package/sound.h"

#include "package/field_reader.h"

namespace fourdvt::package {
namespace {

constexpr double kMinSegment_s = 0.5, kMaxSegment_s = 60, kMaxSegmentBytes = 1 << 24,
                 kMaxFileBytes = 9007199254740992.0;

SoundEncoding readEncoding(FieldReader& in, const std::string& at) {
  SoundEncoding out;
  out.uri = in.uri(at, "/uri");
  out.bytes = uint64_t(in.integer(at, "/byteLength", 1, kMaxFileBytes));
  out.hash = in.hash(at, "/hash");
  out.mime_type = in.text(at, "/type", 128);
  out.priming = uint32_t(in.integer(at, "/priming", 0, 1 << 16));
  const int segments = in.arraySize(at, "/segments", 1, kMaxSoundSegments);
  uint64_t sum = 0;
  for (int i = 0; i < segments && in.ok(); ++i) {
    const std::vector<double> pair = in.numbers(item(at + "/segments", i), 2, 1, kMaxSegmentBytes);
    out.segments.push_back({uint32_t(pair[0]), uint32_t(pair[1])});
    sum += out.segments.back().bytes;
  }
  if (in.ok() && sum != out.bytes) in.fail(at, "/segments", "must add up to byteLength");
  return out;
}

}  // namespace

Result<Sound> readSound(const FlatJson& gltf, size_t sequence) {
  const std::string at =
      std::string("/extensions/") + kExtensionName + "/sequences/" + std::to_string(sequence) + "/sound";
  Sound out;
  if (!gltf.has(at)) return out;
  FieldReader in(gltf);
  out.sample_rate = int(in.integer(at, "/sampleRate", 8000, 192000));
  out.channels = int(in.integer(at, "/channels", 1, 2));
  out.segment_s = in.number(at, "/segmentDuration", 1e-3, kMaxSegment_s);
  const int encodings = in.arraySize(at, "/encodings", 1, kMaxSoundEncodings);
  for (int e = 0; e < encodings && in.ok(); ++e) out.encodings.push_back(readEncoding(in, item(at + "/encodings", e)));
  for (const SoundEncoding& encoding : out.encodings) {
    if (encoding.segments.size() != out.encodings[0].segments.size())
      in.fail(at, "/encodings", "must have as many segments each");
    if (encoding.segments.size() > 1 && out.segment_s < kMinSegment_s)
      in.fail(at, "/segmentDuration", "must be at least 0.5 where there are several");
  }
  if (in.has(at, "/steps")) {
    const int steps = in.arraySize(at, "/steps", 0, kMaxSteps);
    out.steps = in.numbers(at, "/steps", size_t(steps), 0, 1);
  }
  if (in.ok()) return out;
  return Error{ErrorId::ManifestInvalid,
               "character.gltf: " + in.problem() + "; bake the character again or upload all its files"};
}

}  // namespace fourdvt::package
