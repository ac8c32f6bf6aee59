// SPDX-License-Identifier: Apache-2.0
#include "bake/run/survey_files.h"

#include <cstdio>

#include "base/bytes.h"
#include "base/hash.h"

namespace fourdvt::bake {
namespace {

void putList(ByteWriter& out, const std::vector<double>& list) {
  out.u32(static_cast<uint32_t>(list.size()));
  for (double v : list) out.f64(v);
}

std::vector<double> takeList(ByteReader& in) {
  std::vector<double> list;
  for (uint32_t left = in.u32(); left > 0 && in.ok(); --left) list.push_back(in.f64());
  return list;
}

}  // namespace

std::string keyedPath(const std::string& folder, const std::string& what, const std::string& key) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(key)));
  return folder + "/" + what + "_" + digits + ".bin";
}

std::vector<uint8_t> statisticsBytes(const LabelStatistics& s) {
  ByteWriter out;
  out.u32(s.frames);
  for (const auto* list : {&s.seam_percent, &s.flip_percent, &s.camera_seam_percent, &s.camera_flip_percent,
                           &s.seen_seam_percent, &s.seen_flip_percent, &s.mean_penalty})
    putList(out, *list);
  for (double v : {s.energy, s.empty_percent, s.seconds}) out.f64(v);
  return out.take();
}

bool statisticsFrom(std::span<const uint8_t> bytes, LabelStatistics& s) {
  ByteReader in(bytes);
  s.frames = in.u32();
  for (auto* list : {&s.seam_percent, &s.flip_percent, &s.camera_seam_percent, &s.camera_flip_percent,
                     &s.seen_seam_percent, &s.seen_flip_percent, &s.mean_penalty})
    *list = takeList(in);
  for (double* v : {&s.energy, &s.empty_percent, &s.seconds}) *v = in.f64();
  return in.ok() && in.remaining() == 0;
}

std::vector<uint8_t> coloursBytes(const std::vector<ColourMap>& maps) {
  ByteWriter out;
  for (const ColourMap& map : maps) {
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row) out.f32(map.matrix[column][row]);
    for (int row = 0; row < 3; ++row) out.f32(map.offset[row]);
  }
  return out.take();
}

bool coloursFrom(std::span<const uint8_t> bytes, std::vector<ColourMap>& maps) {
  ByteReader in(bytes);
  for (ColourMap& map : maps) {
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row) map.matrix[column][row] = in.f32();
    for (int row = 0; row < 3; ++row) map.offset[row] = in.f32();
  }
  return in.ok() && in.remaining() == 0;
}

}  // namespace fourdvt::bake
