// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/room.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "base/image.h"
#include "lab/studio/random.h"

namespace fourdvt::studio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kWallBehindCameras = 1.25;  // wall distance as a multiple of the farthest camera's
constexpr int kPaletteColours = 6;
constexpr double kSamples[4][2] = {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};

// Hash of integers, 0…1.
double hash(uint32_t seed, int a, int b, int c = 0) {
  const uint64_t key =
      uint64_t(uint32_t(a)) * 0x9e3779b1u ^ (uint64_t(uint32_t(b)) << 24) ^ (uint64_t(uint32_t(c)) << 52);
  return double(randomBits(seed, key) >> 40) / double(1 << 24);
}

// Bilinear value noise, 0…1, period 1.
double noise(uint32_t seed, const glm::dvec2& p) {
  const glm::dvec2 base = glm::floor(p), t = p - base, f = t * t * (3.0 - 2.0 * t);
  const int x = int(base.x), y = int(base.y);
  const double top = glm::mix(hash(seed, x, y), hash(seed, x + 1, y), f.x);
  return glm::mix(top, glm::mix(hash(seed, x, y + 1), hash(seed, x + 1, y + 1), f.x), f.y);
}

// Noise of four octaves, -0.5…0.5.
double grain(uint32_t seed, glm::dvec2 p) {
  double sum = 0, weight = 0.5;
  for (uint32_t k = 0; k < 4; ++k, p = 2.17 * p, weight *= 0.55) sum += weight * (noise(seed + k, p) - 0.5);
  return sum;
}

double encoded(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }
uint8_t levelOf(double v) { return static_cast<uint8_t>(std::clamp(std::lround(255 * v), 0l, 255l)); }

// Lamp direction, 40 to 55 degrees above the floor.
glm::dvec3 lightOf(uint32_t seed) {
  const double azimuth = 2 * kPi * hash(seed, 1, 78), elevation = kPi / 180 * (40 + 15 * hash(seed, 2, 78));
  return -glm::dvec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                     std::cos(azimuth) * std::cos(elevation));
}

// Calls `at`(x, y) for each pixel, on OpenCV's threads.
template <typename Function>
void forEachPixel(const PinholeCamera& camera, const Function& at) {
  cv::parallel_for_(cv::Range(0, camera.height), [&](const cv::Range& rows) {
    for (int y = rows.start; y < rows.end; ++y)
      for (int x = 0; x < camera.width; ++x) at(x, y);
  });
}

// Mean colours of the actor's texture at random places of its surface.
std::vector<glm::dvec3> paletteOf(const Actor& actor, uint32_t seed) {
  std::vector<glm::dvec3> out;
  const MeshTopology& t = actor.surface().topology;
  const Image& texture = actor.texture();
  for (int k = 0; k < kPaletteColours; ++k) {
    const glm::uvec3 f = t.face_uvs[size_t(hash(seed, k, 77) * (t.faceCount() - 1))];
    const glm::vec2 uv = (t.uvs[f.x] + t.uvs[f.y] + t.uvs[f.z]) / 3.0f;
    glm::dvec3 sum(0);
    int count = 0;
    for (int dy = -6; dy <= 6; dy += 3)
      for (int dx = -6; dx <= 6; dx += 3, ++count) {
        const uint8_t* p = texture.at(std::clamp(int(uv.x * texture.width) + dx, 0, texture.width - 1),
                                      std::clamp(int(uv.y * texture.height) + dy, 0, texture.height - 1));
        sum += glm::dvec3(p[0], p[1], p[2]) / 255.0;
      }
    out.push_back(sum / double(count));
  }
  return out;
}

}  // namespace

double Room::leastSize_m(const Rig& rig) {
  double half_m = 0;
  for (const PinholeCamera& camera : rig.ring) {
    const glm::dvec3 eye = camera.centreInWorld();
    half_m = std::max({half_m, std::abs(eye.x), std::abs(eye.z)});
  }
  return 2 * half_m;
}

Room::Room(uint32_t seed, const Rig& rig, double ground_y_m, const Actor& actor, double size_m, double penumbra_m,
           const Lens& lens)
    : seed_(seed),
      ground_m_(ground_y_m),
      half_m_(size_m > 0 ? 0.5 * size_m : kWallBehindCameras * 0.5 * leastSize_m(rig)),
      lens_(lens),
      light_(lightOf(seed)),
      penumbra_m_(penumbra_m),
      shadow_(light_, actor.surface().topology.face_vertices, penumbra_m),
      palette_(paletteOf(actor, seed)) {
  for (const PinholeCamera& camera : rig.ring) views_.push_back(makeView(camera));
}

Room::Hit Room::hit(const glm::dvec3& eye, const glm::dvec3& direction) const {
  double nearest = 1e9;
  Hit out;
  if (direction.y < 0) nearest = (ground_m_ - eye.y) / direction.y;
  for (int wall = 1; wall <= 4; ++wall) {
    const int axis = wall <= 2 ? 0 : 2;
    const double side = wall % 2 ? half_m_ : -half_m_, t = (side - eye[axis]) / direction[axis];
    if (!(t > 0) || t >= nearest) continue;
    nearest = t;
    out.side = wall;
  }
  out.point = eye + nearest * direction;
  out.on_side = sidePlace(out.side, out.point);
  return out;
}

glm::dvec2 Room::sidePlace(int side, const glm::dvec3& p) const {
  return side == 0 ? glm::dvec2(p.x, p.z) : glm::dvec2(side <= 2 ? p.z : p.x, p.y - ground_m_);
}

// Floor colour: planks with grain and joints, a striped rug, and boards in the actor's colours.
glm::dvec3 Room::floorColour(const glm::dvec2& at) const {
  const glm::dvec2 rug = at - 0.8 * (glm::dvec2(hash(seed_, 3, 78), hash(seed_, 4, 78)) - 0.5);
  if (std::abs(rug.x) < 1.1 && std::abs(rug.y) < 0.7) {
    const double stripe = std::sin(2 * kPi * rug.x / 0.11) + 0.6 * std::sin(2 * kPi * (rug.x + rug.y) / 0.37);
    const glm::dvec3 ground = glm::mix(palette_[0], glm::dvec3(0.45, 0.42, 0.38), 0.5);
    return ground + (stripe > 0.4 ? 0.13 : -0.05) * glm::dvec3(1, 0.85, 0.7) + 0.22 * grain(seed_ + 21, 45.0 * at);
  }
  const int plank = int(std::floor(at.x / 0.14));
  const double along = at.y / 1.2 + hash(seed_, plank, 5);
  const int board = int(std::floor(along));
  const double gap = std::min(at.x / 0.14 - plank, (along - board) * 1.2 / 0.14);
  if (gap < 0.035) return glm::dvec3(0.16, 0.11, 0.08);
  const double kind = hash(seed_, plank, board, 6);
  glm::dvec3 base = glm::mix(glm::dvec3(0.52, 0.37, 0.24), glm::dvec3(0.70, 0.55, 0.38), hash(seed_, plank, board, 7));
  if (kind > 0.8) base = glm::mix(base, palette_[size_t(5.99 * (kind - 0.8) / 0.2)], 0.8);
  return base + 0.3 * grain(seed_ + 31 + uint32_t(plank & 15), {90.0 * at.x, 7.0 * at.y});
}

// Wall colour: wallpaper, skirting board, book shelves, and large low-contrast patches in the actor's colours.
glm::dvec3 Room::wallColour(int wall, const glm::dvec2& at) const {
  const uint32_t seed = seed_ + 100 * uint32_t(wall);
  if (at.y < 0.12) return glm::dvec3(0.80, 0.78, 0.72) * (at.y > 0.11 ? 0.6 : 1.0) + 0.05 * grain(seed, 20.0 * at);
  const int panel = int(std::floor(at.x / 0.9));
  const double kind = hash(seed, panel, 8), x = at.x - 0.9 * panel;
  const double fine = grain(seed + 40, 28.0 * at);
  if (kind < 0.3 && x > 0.06 && x < 0.84) {  // a shelf
    const int row = int(std::floor(at.y / 0.32)), book = int(std::floor(x / 0.045));
    const double height = 0.20 + 0.08 * hash(seed, 20 * panel + book, row, 9);
    if (at.y - 0.32 * row < 0.025) return glm::dvec3(0.38, 0.26, 0.16) + 0.2 * fine;
    if (at.y - 0.32 * row > height) return glm::dvec3(0.14, 0.11, 0.10) + 0.05 * fine;
    const glm::dvec3 random(hash(seed, book, row, 10), hash(seed, book, row, 11), hash(seed, book, row, 12));
    return 0.15 + 0.6 * random + 0.15 * fine;
  }
  if (kind >= 0.3 && kind < 0.75) {  // a curtain
    const double fold = std::sin(2 * kPi * (x / 0.15 + 0.3 * noise(seed + 50, 2.0 * at)));
    return palette_[size_t(5.99 * (kind - 0.3) / 0.45)] * (1 + 0.10 * fold) + 0.05 * fine;
  }
  const double paper = std::sin(2 * kPi * at.x / 0.18) * std::sin(2 * kPi * at.y / 0.24);
  return glm::dvec3(0.66, 0.62, 0.52) + (paper > 0.3 ? 0.08 : 0.0) * glm::dvec3(-1, -0.6, 0.2) + 0.12 * fine;
}

glm::dvec3 Room::colour(const Hit& at) const {
  const glm::dvec3 paint = at.side == 0 ? floorColour(at.on_side) : wallColour(at.side, at.on_side);
  const double fall = at.side == 0 ? 1.05 - 0.06 * glm::length(at.on_side) / half_m_ : 0.95 + 0.03 * (at.side - 2);
  return glm::clamp(fall * paint, 0.02, 1.0);
}

Room::Hit Room::hitOfPixel(const PinholeCamera& camera, const glm::dvec2& filmed_pixel) const {
  const glm::dvec2 pixel = lens_.pinholePixel(camera, filmed_pixel);
  const glm::dvec3 ray((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, 1);
  return hit(camera.centreInWorld(), glm::transpose(glm::dmat3(camera.cam_from_world)) * ray);
}

glm::dvec3 Room::meanColour(const PinholeCamera& camera, int x, int y) const {
  glm::dvec3 sum(0);
  for (const auto& s : kSamples) sum += colour(hitOfPixel(camera, {x + s[0], y + s[1]}));
  return sum / 4.0;
}

BoundingBox Room::box() const {
  double top = ground_m_;
  for (const View& view : views_) {
    const PinholeCamera& c = view.camera;
    for (int x = 0; x <= c.width; ++x) top = std::max(top, hitOfPixel(c, {x, 0}).point.y);
  }
  return {glm::vec3(-half_m_, ground_m_, -half_m_), glm::vec3(half_m_, top, half_m_)};
}

glm::dvec3 Room::colourAt(const glm::dvec3& point) const {
  const double distances[5] = {std::abs(point.y - ground_m_), std::abs(point.x - half_m_), std::abs(point.x + half_m_),
                               std::abs(point.z - half_m_), std::abs(point.z + half_m_)};
  Hit at;
  at.side = int(std::min_element(distances, distances + 5) - distances);
  at.on_side = sidePlace(at.side, point);
  return colour(at);
}

Image Room::emptySeenBy(const PinholeCamera& camera) const {
  Image out(camera.width, camera.height, 3);
  forEachPixel(camera, [&](int x, int y) {
    const glm::dvec3 mean = meanColour(camera, x, y);
    for (int c = 0; c < 3; ++c) out.at(x, y)[c] = levelOf(mean[c]);
  });
  return out;
}

Room::View Room::makeView(const PinholeCamera& camera) const {
  View view{camera, Image(camera.width, camera.height, 3), Image(camera.width, camera.height, 3)};
  forEachPixel(camera, [&](int x, int y) {
    const glm::dvec3 mean = meanColour(camera, x, y);
    for (int c = 0; c < 3; ++c) {
      view.lit.at(x, y)[c] = levelOf(mean[c]);
      view.shaded.at(x, y)[c] = levelOf(encoded(kShadowLight * linearFromSrgb(mean[c])));
    }
  });
  return view;
}

void Room::setShadow(const Positions& pose) { shadow_.setPose(pose); }

void Room::setOtherShadow(const Positions& pose, const std::vector<glm::uvec3>& faces) {
  if (!other_) other_.emplace(light_, faces, penumbra_m_);
  other_->setPose(pose);
}

double Room::shadowAt(const glm::dvec3& point) const {
  const double share = shadow_.shareAt(point);
  return other_ ? std::max(share, other_->shareAt(point)) : share;
}

Image Room::shadow(size_t camera) const {
  const PinholeCamera& c = views_[camera].camera;
  Image out(c.width, c.height, 1);
  forEachPixel(c, [&](int x, int y) {
    double share = 0;
    for (const auto& s : kSamples) share += shadowAt(hitOfPixel(c, {x + s[0], y + s[1]}).point);
    *out.at(x, y) = static_cast<uint8_t>(share * 255 / 4);
  });
  return out;
}

Image Room::withShadow(size_t camera) const {
  const View& view = views_[camera];
  const Image share = shadow(camera);
  Image out = view.lit;
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    const int s = share.pixels[i / 3];
    out.pixels[i] = static_cast<uint8_t>((view.lit.pixels[i] * (255 - s) + view.shaded.pixels[i] * s + 127) / 255);
  }
  return out;
}

}  // namespace fourdvt::studio
