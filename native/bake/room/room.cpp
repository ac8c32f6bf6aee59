// SPDX-License-Identifier: Apache-2.0
#include "bake/room/room.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "package/character.h"

namespace fourdvt::bake {
namespace {

constexpr int kGutter = 8, kAlign = 16;  // texels; aligned so that each block of the coded picture belongs to one face
constexpr int kSide = 3;                 // each texel is the mean of kSide² samples
constexpr int kBlock = 16;               // texels a side of the blocks at whose corners RoomFill is sampled
constexpr double kGrain_m = 0.05;
// Weight below which a point is blended with the fill, so that the seen area ends softly.
constexpr float kWholeWeight = 0.1f;

glm::vec3 inwardOf(int face) {
  glm::vec3 normal(0);
  normal[face / 2] = face % 2 ? -1.0f : 1.0f;
  return normal;
}

int roundedUp(int texels) { return (texels + kAlign - 1) / kAlign * kAlign; }

package::Rect inColumn(int column_x, int y, double width_m, double height_m, double texels_per_m) {
  const auto texels = [&](double metres) { return std::max(1, static_cast<int>(std::lround(metres * texels_per_m))); };
  return {column_x + kGutter, y + kGutter, texels(width_m), texels(height_m)};
}

// Lays out floor and ceiling, then the walls along z, then those along x: two columns of three rows.
package::Room laidOut(const BoundingBox& box, double texels_per_m) {
  package::Room room;
  room.box = box;
  const glm::vec3 size = box.max - box.min;
  const double wide = std::max(size.x, size.z);
  const int column = roundedUp(static_cast<int>(std::ceil(wide * texels_per_m)) + 2 * kGutter);
  int y = 0;
  for (const int axis : {1, 0, 2}) {
    const double width_m = axis == 0 ? size.z : size.x, height_m = axis == 1 ? size.z : size.y;
    for (const int high : {0, 1})
      room.faces[size_t(2 * axis + high)] = inColumn(high * column, y, width_m, height_m, texels_per_m);
    y += roundedUp(room.faces[size_t(2 * axis)].height + 2 * kGutter);
  }
  room.width = 2 * column;
  room.height = y;
  return room;
}

// One face in progress, in float.
struct Face {
  int width = 0, height = 0;
  std::vector<glm::vec4> texels;  // colour, weight
  glm::vec4& at(int x, int y) { return texels[size_t(y) * size_t(width) + size_t(x)]; }
};

Face lookUp(const BoundingBox& box, int number, const package::Rect& rect, const RoomLookup& lookup) {
  Face face{rect.width, rect.height, std::vector<glm::vec4>(size_t(rect.width) * size_t(rect.height), glm::vec4(0))};
  const glm::dvec3 inward(inwardOf(number));
  inParallel(face.height, [&](int y) {
    for (int x = 0; x < face.width; ++x) {
      glm::vec3 colour(0);
      float weight = 0;
      int seen = 0;
      for (int k = 0; k < kSide * kSide; ++k) {
        const float u = (float(x) + (float(k % kSide) + 0.5f) / kSide) / float(face.width);
        const float v = (float(y) + (float(k / kSide) + 0.5f) / kSide) / float(face.height);
        const RoomLookup::Seen point = lookup.at(glm::dvec3(package::roomPoint(box, number, u, v)), inward);
        if (!(point.weight > 0)) continue;
        colour += point.colour;
        weight += point.weight;
        ++seen;
      }
      if (seen > 0) face.at(x, y) = glm::vec4(colour / float(seen), weight / float(kSide * kSide));
    }
  });
  return face;
}

glm::vec3 pointOf(const BoundingBox& box, int number, const Face& face, float x, float y) {
  return package::roomPoint(box, number, x / float(face.width), y / float(face.height));
}

// Adds the mean of every block of visible texels to the fill.
void tellSeen(const BoundingBox& box, int number, Face& face, RoomFill& fill) {
  for (int y = 0; y < face.height; y += kBlock)
    for (int x = 0; x < face.width; x += kBlock) {
      glm::vec3 colour(0);
      glm::vec2 middle(0);
      float count = 0;
      for (int j = y; j < std::min(y + kBlock, face.height); ++j)
        for (int i = x; i < std::min(x + kBlock, face.width); ++i) {
          const glm::vec4& texel = face.at(i, j);
          const float share = std::min(texel.w / kWholeWeight, 1.0f);
          colour += share * glm::vec3(texel);
          middle += share * glm::vec2(float(i) + 0.5f, float(j) + 0.5f);
          count += share;
        }
      if (count > 0) fill.add(pointOf(box, number, face, middle.x / count, middle.y / count), colour / count, count);
    }
}

bool isWhole(const glm::vec4& texel) { return texel.w >= kWholeWeight; }

// Replaces invisible texels, and blends texels of low weight with the fill, which is sampled at the corners of the
// blocks.
void fillUnseen(const BoundingBox& box, int number, Face& face, const RoomFill& fill) {
  if (std::all_of(face.texels.begin(), face.texels.end(), isWhole)) return;
  const int columns = face.width / kBlock + 2, rows = face.height / kBlock + 2;
  std::vector<glm::vec3> corners(size_t(columns) * size_t(rows));
  inParallel(rows, [&](int j) {
    for (int i = 0; i < columns; ++i)
      corners[size_t(j * columns + i)] = fill.at(pointOf(box, number, face, float(i * kBlock), float(j * kBlock)));
  });
  for (int y = 0; y < face.height; ++y)
    for (int x = 0; x < face.width; ++x) {
      glm::vec4& texel = face.at(x, y);
      if (isWhole(texel)) continue;
      const glm::vec2 at = (glm::vec2(float(x), float(y)) + 0.5f) / float(kBlock), t = glm::fract(at);
      const glm::vec3* c = &corners[size_t(int(at.y) * columns + int(at.x))];
      const glm::vec3 filled = glm::mix(glm::mix(c[0], c[1], t.x), glm::mix(c[columns], c[columns + 1], t.x), t.y);
      texel = glm::vec4(glm::mix(filled, glm::vec3(texel), texel.w / kWholeWeight), 1);
    }
}

// Writes a face and its gutter, which repeats the face's border.
void write(Face& face, const package::Rect& rect, Image& picture) {
  for (int y = -kGutter; y < rect.height + kGutter; ++y)
    for (int x = -kGutter; x < rect.width + kGutter; ++x) {
      const glm::vec4& texel = face.at(std::clamp(x, 0, rect.width - 1), std::clamp(y, 0, rect.height - 1));
      for (int c = 0; c < 3; ++c)
        picture.at(rect.x + x, rect.y + y)[c] =
            static_cast<uint8_t>(std::lround(255 * std::clamp(texel[c], 0.0f, 1.0f)));
    }
}

}  // namespace

struct RoomLookup::Plate {
  const RoomPlate* given;
  glm::dvec3 centre;
  cv::Mat weights;  // CV_32F, at pixel centres; negative where the camera sees nothing
};

namespace {

// Distance of every pixel's centre from the area where the camera sees nothing, over the feather's width, at most 1;
// 0 for the outermost pixels.
cv::Mat featherWeights(const Image& picture, const RoomOptions& options) {
  cv::Mat sees(picture.height + 2, picture.width + 2, CV_8U, cv::Scalar(0)), distance;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) sees.at<uint8_t>(y + 1, x + 1) = picture.at(x, y)[3] == 255 ? 1 : 0;
  cv::distanceTransform(sees, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const double width = options.feather * std::min(picture.width, picture.height);
  cv::Mat weights = distance(cv::Rect(1, 1, picture.width, picture.height)).clone();
  for (float& w : cv::Mat_<float>(weights)) {
    if (w == 0)
      w = -1;
    else
      w = options.blend == RoomBlend::Feathered ? std::min(1.0f, float((w - 1) / width)) : 1;
  }
  return weights;
}

}  // namespace

RoomLookup::RoomLookup(std::span<const RoomPlate> plates, const RoomOptions& options) : blend_(options.blend) {
  for (const RoomPlate& plate : plates)
    plates_.push_back({&plate, plate.camera.centreInWorld(), featherWeights(plate.picture, options)});
}

RoomLookup::~RoomLookup() = default;

RoomLookup::Seen RoomLookup::at(const glm::dvec3& point, const glm::dvec3& inward) const {
  Seen out;
  float share = 1;  // Recurrence: share of the next camera
  for (const Plate& plate : plates_) {
    if (!(glm::dot(plate.centre - point, inward) > 0)) continue;
    const glm::dvec3 at = plate.given->camera.project(point);
    const Image& picture = plate.given->picture;
    const double px = at.x - 0.5, py = at.y - 0.5;
    if (!(at.z > 0 && px >= 0 && py >= 0 && px < picture.width - 1 && py < picture.height - 1)) continue;
    const int x = int(px), y = int(py);
    const float tx = float(px - x), ty = float(py - y);
    const float* w[2] = {plate.weights.ptr<float>(y) + x, plate.weights.ptr<float>(y + 1) + x};
    if (std::min({w[0][0], w[0][1], w[1][0], w[1][1]}) < 0) continue;
    const float weight = glm::mix(glm::mix(w[0][0], w[0][1], tx), glm::mix(w[1][0], w[1][1], tx), ty);
    const auto pixel = [&](int dx, int dy) {
      const uint8_t* p = picture.at(x + dx, y + dy);
      return glm::vec3(p[0], p[1], p[2]) / 255.0f;
    };
    const glm::vec3 raw = glm::mix(glm::mix(pixel(0, 0), pixel(1, 0), tx), glm::mix(pixel(0, 1), pixel(1, 1), tx), ty);
    const glm::vec3 colour = plate.given->colour_matrix * raw + plate.given->colour_offset;
    ++out.cameras;
    out.weight += weight;
    if (blend_ == RoomBlend::Recurrence) {
      out.colour = glm::mix(out.colour, colour, share);
      share = 0.06f + share / 2;
    } else {
      out.colour += weight * colour;
    }
  }
  if (blend_ != RoomBlend::Recurrence && out.weight > 0) out.colour /= out.weight;
  return out;
}

package::Room layOutRoom(const BoundingBox& box, double texels_per_m) {
  package::Room room = laidOut(box, texels_per_m);
  while (std::max(room.width, room.height) > package::kMaxPictureSide) {
    texels_per_m *= 0.98 * package::kMaxPictureSide / std::max(room.width, room.height);
    room = laidOut(box, texels_per_m);
  }
  return room;
}

RoomPicture makeRoomPicture(const BoundingBox& box, std::span<const RoomPlate> plates, const RoomOptions& options) {
  RoomPicture out{layOutRoom(box, options.texels_per_m), {}};
  out.picture = Image(out.room.width, out.room.height, 3);
  const RoomLookup lookup(plates, options);
  RoomFill fill(kGrain_m);
  std::vector<Face> faces;
  for (int f = 0; f < 6; ++f) {
    faces.push_back(lookUp(box, f, out.room.faces[size_t(f)], lookup));
    tellSeen(box, f, faces.back(), fill);
  }
  for (int f = 0; f < 6; ++f) {
    fillUnseen(box, f, faces[size_t(f)], fill);
    write(faces[size_t(f)], out.room.faces[size_t(f)], out.picture);
  }
  return out;
}

glm::vec3 RoomFill::at(const glm::vec3& point) const {
  const float nearest2 = static_cast<float>(grain_m_ * grain_m_);
  glm::vec3 sum(0);
  float total = 0;
  for (const Known& k : known_) {
    const glm::vec3 d = k.point - point;
    const float distance2 = glm::dot(d, d) + nearest2, weight = k.weight / (distance2 * distance2);
    sum += weight * k.colour;
    total += weight;
  }
  return total > 0 ? sum / total : glm::vec3(0.5f);
}

}  // namespace fourdvt::bake
