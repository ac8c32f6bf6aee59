// SPDX-License-Identifier: Apache-2.0
// bench_room [OUT]: error of the room's picture that a bake makes from the virtual studio's plates, against the
// studio's own colours: mean (1/N), recurrence and feathering, for exact cameras, for cameras with gain and noise, and
// for cameras with calibration errors as well. Writes the pictures into the folder OUT.
#include "bake/room/room.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "lab/studio/room.h"
#include "lab/studio/sensor.h"
#include "lab/studio/set.h"
#include "or_stop.h"
#include "package/character.h"
#include "platform/egl_context.h"
#include "platform/files.h"

namespace {

using namespace fourdvt;
using namespace fourdvt::testing;
using bake::RoomBlend;

constexpr double kTexels_per_m = 96;
constexpr int kCeiling = 3;

struct Case {
  const char* name;
  studio::StudioKnobs knobs;
};

std::vector<Case> cases() {
  studio::StudioKnobs recorded;
  recorded.gain_percent = 3;
  recorded.noise_levels = 2;
  studio::StudioKnobs miscalibrated = recorded;
  miscalibrated.rotation_deg = 0.1;
  miscalibrated.translation_mm = 3;
  return {{"exact", {}}, {"gain 3 %, noise 2", recorded}, {"also 0.1 deg, 3 mm", miscalibrated}};
}

struct Blend {
  const char* name;
  bake::RoomOptions options;
};

std::vector<Blend> blends() {
  std::vector<Blend> out{{"1/N", {RoomBlend::Mean}}, {"recurrence", {RoomBlend::Recurrence}}};
  for (const auto& [name, width] : {std::pair{"feathered 0.1", 0.1}, {"feathered 0.3", 0.3}})
    out.push_back({name, {RoomBlend::Feathered, width}});
  for (Blend& blend : out) blend.options.texels_per_m = kTexels_per_m;
  return out;
}

// Truth per texel of the picture: the studio's colour, and the set of cameras that see the texel.
struct Truth {
  package::Room room;
  Image picture;
  std::vector<uint32_t> cameras;  // bit set; 0: none, or no texel of the floor or a wall
};

Truth truthOf(const studio::Room& room, const std::vector<bake::RoomPlate>& plates) {
  Truth out{bake::layOutRoom(room.box(), kTexels_per_m), {}, {}};
  out.picture = Image(out.room.width, out.room.height, 3);
  out.cameras.assign(size_t(out.room.width) * size_t(out.room.height), 0);
  for (int f = 0; f < 6; ++f) {
    if (f == kCeiling) continue;
    const package::Rect& r = out.room.faces[size_t(f)];
    glm::dvec3 inward(0);
    inward[f / 2] = f % 2 ? -1 : 1;
    for (int y = 0; y < r.height; ++y)
      for (int x = 0; x < r.width; ++x) {
        glm::dvec3 sum(0);
        for (int k = 0; k < 9; ++k)
          sum +=
              room.colourAt(package::roomPoint(out.room.box, f, (float(x) + (float(k % 3) + 0.5f) / 3) / float(r.width),
                                               (float(y) + (float(k / 3) + 0.5f) / 3) / float(r.height)));
        for (int c = 0; c < 3; ++c) out.picture.at(r.x + x, r.y + y)[c] = uint8_t(std::lround(255 * sum[c] / 9));
      }
  }
  for (size_t p = 0; p < plates.size(); ++p) {
    const bake::RoomLookup lookup({&plates[p], 1}, {RoomBlend::Mean});
    for (int f = 0; f < 6; ++f) {
      if (f == kCeiling) continue;
      const package::Rect& r = out.room.faces[size_t(f)];
      glm::dvec3 inward(0);
      inward[f / 2] = f % 2 ? -1 : 1;
      for (int y = 0; y < r.height; ++y)
        for (int x = 0; x < r.width; ++x) {
          const glm::vec3 point = package::roomPoint(out.room.box, f, (float(x) + 0.5f) / float(r.width),
                                                     (float(y) + 0.5f) / float(r.height));
          if (lookup.at(glm::dvec3(point), inward).cameras > 0)
            out.cameras[size_t(r.y + y) * size_t(out.room.width) + size_t(r.x + x)] |= 1u << p;
        }
    }
  }
  return out;
}

struct Score {
  double psnr_db = 0, seam = 0;  // over texels that cameras see; levels
};

// Seam: step across the border of a camera's view that the picture has and the truth lacks. Detail that the cameras do
// not resolve makes such steps everywhere; hence the signed steps between two sets of cameras are averaged over all of
// their border first. The result is the mean of the averages' magnitudes over all borders and channels.
Score scoreOf(const Image& picture, const Truth& truth) {
  struct Step {
    glm::dvec3 sum{0};
    size_t count = 0;
  };
  std::map<std::pair<uint32_t, uint32_t>, Step> borders;
  double squares = 0;
  size_t texels = 0;
  const auto camerasAt = [&](int x, int y) { return truth.cameras[size_t(y) * size_t(truth.room.width) + size_t(x)]; };
  const auto error = [&](int x, int y) {
    glm::dvec3 out;
    for (int c = 0; c < 3; ++c) out[c] = double(picture.at(x, y)[c]) - double(truth.picture.at(x, y)[c]);
    return out;
  };
  for (const package::Rect& r : truth.room.faces)
    for (int y = r.y + 1; y < r.y + r.height - 2; ++y)
      for (int x = r.x + 1; x < r.x + r.width - 2; ++x) {
        const uint32_t here = camerasAt(x, y);
        if (!here) continue;
        ++texels;
        squares += glm::dot(error(x, y), error(x, y)) / 3;
        for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
          const uint32_t there = camerasAt(x + dx, y + dy);
          if (!there || here == there || camerasAt(x - dx, y - dy) != here ||
              camerasAt(x + 2 * dx, y + 2 * dy) != there)
            continue;
          Step& step = borders[std::minmax(here, there)];
          step.sum += (here < there ? 1.0 : -1.0) * (error(x + 2 * dx, y + 2 * dy) - error(x - dx, y - dy));
          ++step.count;
        }
      }
  glm::dvec3 steps(0);
  size_t count = 0;
  for (const auto& [sets, step] : borders) {
    steps += glm::abs(step.sum);
    count += step.count;
  }
  return {10 * std::log10(255.0 * 255.0 * double(texels) / squares), (steps.x + steps.y + steps.z) / 3 / double(count)};
}

void compare(gpu::Device& device, const Case& one, const std::string& out) {
  studio::StudioOptions options;
  options.room = true;
  options.folder = "unused";
  options.knobs = one.knobs;
  const auto set = orStop(studio::StudioSet::open(options, device));
  const studio::Room room(one.knobs.seed, set->rig(), set->groundY_m(), set->actor());
  const std::vector<PinholeCamera> cameras = studio::miscalibrated(set->rig().ring, one.knobs);
  std::vector<bake::RoomPlate> plates;
  for (size_t c = 0; c < cameras.size(); ++c) {
    const Image rgb = studio::Sensor(one.knobs, int(c), room.empty(c)).recordedPlate(0);
    Image rgba(rgb.width, rgb.height, 4, 255);
    for (size_t i = 0; i < rgb.pixels.size(); ++i) rgba.pixels[i / 3 * 4 + i % 3] = rgb.pixels[i];
    plates.push_back({cameras[c], std::move(rgba)});
  }
  const Truth truth = truthOf(room, plates);
  const glm::vec3 size = truth.room.box.max - truth.room.box.min;
  size_t seen = 0, all = 0;
  for (const package::Rect& r : truth.room.faces) all += size_t(r.width) * size_t(r.height);
  for (const uint32_t set_of : truth.cameras) seen += set_of != 0;
  std::printf("%s: %zu cameras, room of %.2f x %.2f x %.2f m, picture %d x %d, seen %.0f %%\n", one.name,
              cameras.size(), size.x, size.y, size.z, truth.room.width, truth.room.height,
              100.0 * double(seen) / double(all));
  std::printf("%-14s %8s %12s\n", "", "PSNR dB", "seam, levels");
  for (const Blend& blend : blends()) {
    const Image picture = bake::makeRoomPicture(room.box(), plates, blend.options).picture;
    const Score score = scoreOf(picture, truth);
    std::printf("%-14s %8.2f %12.3f\n", blend.name, score.psnr_db, score.seam);
    if (out.empty()) continue;
    std::string file = std::string(one.name) + ", " + blend.name + ".png";
    for (char& c : file)
      if (c == ' ' || c == '/' || c == '%' || c == ',') c = '_';
    orStop(platform::writeImage(out + "/" + file, picture));
  }
  if (!out.empty()) orStop(platform::writeImage(out + "/truth.png", truth.picture));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2) return std::fprintf(stderr, "usage: bench_room [OUT]\n"), 2;
  const std::string out = argc > 1 ? argv[1] : "";
  if (!out.empty()) orStop(platform::makeFolder(out));
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  for (const Case& one : cases()) compare(*device, one, out);
  return 0;
}
