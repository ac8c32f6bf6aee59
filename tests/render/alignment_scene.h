// SPDX-License-Identifier: Apache-2.0
// A class of two motions whose textures are displaced against each other by a known field D: a closed, bent body of
// revolution with a fine texture in four charts, two layers per member, filmed by a ring of eight. The content of
// surface point p + D(p)/2 appears at p in member 0, that of p − D(p)/2 in member 1: half way, the content is in its
// true place.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/mesh.h"
#include "quad_scene.h"

namespace fourdvt::testing {

struct AlignmentSceneOptions {
  double drift_m = 0.012;               // length of D, except at the two ends
  double view_error_m = 0;              // displacement of each camera's pictures of a member, each in its own direction
  double wrinkles = 0;                  // share of shading by which the members differ
  double plain_from = 1, plain_to = 0;  // range of the height without texture, as shares
  int members = 2;
  int rings = 60, segments = 64;  // of the mesh
  int layer_size = 1024;          // texels; layer 2: half
};

// Smooth noise of about unit variance, period 64 cells.
class Noise {
 public:
  Noise() : values_(64 * 64 * 64) {
    uint32_t state = 1;
    for (float& value : values_) {
      state = state * 1664525u + 1013904223u;
      value = float(state >> 8) / float(1 << 23) - 1;
    }
  }
  float at(const glm::vec3& p) const {
    const glm::vec3 cell = glm::floor(p);
    const glm::vec3 f = p - cell, s = f * f * (3.0f - 2.0f * f);
    const glm::ivec3 i(cell);
    float sum = 0;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 o(k & 1, k >> 1 & 1, k >> 2);
      const glm::ivec3 n = (i + o) & 63;
      sum +=
          values_[(n.z * 64 + n.y) * 64 + n.x] * (o.x ? s.x : 1 - s.x) * (o.y ? s.y : 1 - s.y) * (o.z ? s.z : 1 - s.z);
    }
    return sum;
  }

 private:
  std::vector<float> values_;
};

class AlignmentScene {
 public:
  static constexpr int kCharts = 4, kCameras = 8, kLayers = 2;
  static constexpr double kHeight_m = 1.5, kRadius_m = 0.17, kUvPerMetre = 0.5, kChartPitch = 0.245;

  explicit AlignmentScene(const AlignmentSceneOptions& o) : options(o) {
    makeProfile();
    makeMesh();
    makeCharacter();
    makePicture();
  }

  AlignmentSceneOptions options;
  package::Character character;
  package::BaseMesh mesh;
  package::Rendition rendition;
  Positions middle;             // bent and twisted
  std::vector<uint8_t> labels;  // [member][layer][face]
  Image picture;                // RGBA, tiled

  // [vertex] true displacement along its tangents, metres; zero near the ends.
  std::vector<glm::vec2> truth() const {
    const SurfaceFrames frames = computeSurfaceFrames(mesh.topology, mesh.positions);
    std::vector<glm::vec2> field;
    for (uint32_t v = 0; v < mesh.topology.vertex_count; ++v) {
      const Place place = placeOf(v);
      const glm::dvec2 d = drift(place);
      const glm::dvec3 step = pointAt({place.turn + 1e-4, place.along}) - pointAt({place.turn - 1e-4, place.along});
      const glm::dvec3 rise = pointAt({place.turn, place.along + 1e-3}) - pointAt({place.turn, place.along - 1e-3});
      field.push_back(glm::vec3(d.x * unit(step) + d.y * unit(rise)) * frames.tangents[v]);
    }
    return field;
  }
  // Share of the height at a vertex, 0 bottom … 1 top.
  double heightShare(uint32_t vertex) const { return placeOf(vertex).along / length_; }
  bool isPlain(double share) const { return share > options.plain_from && share < options.plain_to; }

 private:
  struct Place {
    double turn, along;  // radians; metres along the profile from the bottom
  };
  static glm::dvec3 unit(const glm::dvec3& v) { return v / std::max(glm::length(v), 1e-12); }

  void makeProfile() {
    for (int i = 0; i <= options.rings; ++i) {
      const double t = 0.5 - 0.5 * std::cos(M_PI * i / options.rings);
      const double round = std::sqrt(std::max(0.0, 1 - std::pow(2 * t - 1, 6)));
      profile_.push_back({kRadius_m * round * (1 + 0.15 * std::sin(7 * t)), kHeight_m * t});
      along_.push_back(i ? along_.back() + glm::length(profile_[i] - profile_[i - 1]) : 0);
    }
    length_ = along_.back();
  }
  glm::dvec2 profileAt(double along) const {
    const double a = std::clamp(along, 0.0, length_);
    const size_t i =
        std::clamp<size_t>(std::upper_bound(along_.begin(), along_.end(), a) - along_.begin(), 1, profile_.size() - 1);
    return glm::mix(profile_[i - 1], profile_[i], (a - along_[i - 1]) / (along_[i] - along_[i - 1]));
  }
  glm::dvec3 pointAt(const Place& place) const {
    const glm::dvec2 p = profileAt(place.along);
    return {p.x * std::sin(place.turn), p.y, p.x * std::cos(place.turn)};
  }
  // Drift at the place, metres: round the body, along the profile.
  glm::dvec2 drift(const Place& place) const {
    const double share = std::clamp(place.along / length_, 0.0, 1.0);
    const double fade = glm::smoothstep(0.1, 0.2, share) * (1 - glm::smoothstep(0.8, 0.9, share));
    const double phase = place.turn + 3 * place.along;
    return options.drift_m * fade * glm::dvec2(std::cos(phase), std::sin(phase));
  }

  // Vertices: bottom pole, rings 1 … rings - 1, top pole.
  Place placeOf(uint32_t vertex) const {
    if (vertex == 0) return {0, 0};
    const int ring = 1 + int(vertex - 1) / options.segments;
    return {2 * M_PI * ((vertex - 1) % options.segments) / options.segments, along_[ring]};
  }
  uint32_t vertexAt(int ring, int segment) const {
    if (ring == 0) return 0;
    if (ring == options.rings) return uint32_t(1 + (options.rings - 1) * options.segments);
    return uint32_t(1 + (ring - 1) * options.segments + segment % options.segments);
  }
  double uvPerRadian() const { return kUvPerMetre * kRadius_m; }

  void makeMesh() {
    MeshTopology& topology = mesh.topology;
    for (uint32_t v = 0; v <= vertexAt(options.rings, 0); ++v) {
      const glm::dvec3 p = pointAt(placeOf(v));
      mesh.positions.emplace_back(p);
      const double twist = 0.3 * p.y, c = std::cos(twist), s = std::sin(twist);
      middle.emplace_back(c * p.x + s * p.z + 0.1 * p.y * p.y, p.y, c * p.z - s * p.x);
    }
    topology.vertex_count = uint32_t(mesh.positions.size());
    const int wide = options.segments / kCharts;
    for (int chart = 0; chart < kCharts; ++chart) {
      const uint32_t first = uint32_t(topology.uvs.size());
      for (int ring = 0; ring <= options.rings; ++ring)
        for (int s = 0; s <= wide; ++s)
          topology.uvs.emplace_back(0.05 + chart * kChartPitch + 2 * M_PI * s / options.segments * uvPerRadian(),
                                    0.98 - along_[ring] * kUvPerMetre);
      const auto add = [&](int ring_a, int a, int ring_b, int b, int ring_c, int c) {
        const auto uv = [&](int ring, int s) { return first + uint32_t(ring * (wide + 1) + s); };
        topology.face_vertices.push_back({vertexAt(ring_a, chart * wide + a), vertexAt(ring_b, chart * wide + b),
                                          vertexAt(ring_c, chart * wide + c)});
        topology.face_uvs.push_back({uv(ring_a, a), uv(ring_b, b), uv(ring_c, c)});
      };
      for (int ring = 0; ring < options.rings; ++ring)
        for (int s = 0; s < wide; ++s) {
          if (ring > 0) add(ring, s, ring, s + 1, ring + 1, s);
          if (ring + 1 < options.rings) add(ring, s + 1, ring + 1, s + 1, ring + 1, s);
        }
    }
  }

  void makeCharacter() {
    for (int camera = 0; camera < kCameras; ++camera) {
      const double turn = 2 * M_PI * camera / kCameras;
      character.cameras.push_back(lookAt({3 * std::sin(turn), 1 + 0.5 * (camera % 2), 3 * std::cos(turn)},
                                         {0, kHeight_m / 2, 0}, 480, 640, 800));
    }
    character.layer_count = kLayers;
    character.vertex_count = mesh.topology.vertex_count;
    character.face_count = mesh.topology.faceCount();
    character.bounds = {middle[0], middle[0]};
    for (const glm::vec3& p : middle) {
      character.bounds.min = glm::min(character.bounds.min, p);
      character.bounds.max = glm::max(character.bounds.max, p);
    }
    std::vector<uint8_t> member(size_t(kLayers) * character.face_count);
    for (uint32_t face = 0; face < character.face_count; ++face) {
      const glm::uvec3& f = mesh.topology.face_vertices[face];
      const glm::vec3 normal = glm::cross(middle[f.y] - middle[f.x], middle[f.z] - middle[f.x]);
      std::vector<std::pair<float, uint8_t>> rank;
      for (int camera = 0; camera < kCameras; ++camera)
        rank.emplace_back(
            -glm::dot(normal, glm::normalize(glm::vec3(character.cameras[camera].centreInWorld()) - middle[f.x])),
            uint8_t(camera));
      std::sort(rank.begin(), rank.end());
      for (int layer = 0; layer < kLayers; ++layer)
        member[size_t(layer) * character.face_count + face] = rank[layer].second;
    }
    for (int m = 0; m < options.members; ++m) labels.insert(labels.end(), member.begin(), member.end());
  }

  glm::vec3 colorAt(const Place& place, bool plain) const {
    const glm::vec3 p(pointAt(place));
    float detail = 0;
    if (!plain) detail = noise_.at(p / 0.04f) + 0.8f * noise_.at(p / 0.018f + 7.0f) + 0.4f * noise_.at(p / 0.009f);
    return glm::clamp(128.0f + glm::vec3(110, 90, 70) * detail, 0.0f, 255.0f);
  }
  // Colour that a camera's picture of a member shows at a place on the surface.
  glm::vec3 lookAt_(int member, int camera, const Place& place) const {
    const double share = options.members > 1 ? double(member) / (options.members - 1) - 0.5 : 0;
    const double angle = 2.4 * camera + 1.7 * member;
    const glm::dvec2 shift =
        -share * drift(place) + options.view_error_m * glm::dvec2(std::cos(angle), std::sin(angle));
    const double radius = std::max(profileAt(place.along).x, 0.02);
    const Place content{place.turn + shift.x / radius, place.along + shift.y};
    const glm::vec3 color = colorAt(content, isPlain(content.along / length_));
    const double wrinkle = std::sin(60 * place.along + 25 * member + 3 * place.turn);
    return glm::clamp(color * float(1 + (member ? 1 : -1) * options.wrinkles * wrinkle), 0.0f, 255.0f);
  }

  // Fills every texel with its chart's content, gutters included.
  void makePicture() {
    const int size = options.layer_size;
    rendition.width = size + size / 2;
    rendition.height = size * options.members;
    picture = Image(rendition.width, rendition.height, 4, 255);
    for (int member = 0; member < options.members; ++member)
      for (int layer = 0; layer < kLayers; ++layer) {
        rendition.layers.push_back({layer ? size : 0, member * size, layer ? size / 2 : size, layer ? size / 2 : size});
        drawLayer(member, layer, rendition.layers.back());
      }
  }
  void drawLayer(int member, int layer, const package::Rect& rect) {
    for (int y = 0; y < rect.height; ++y)
      for (int x = 0; x < rect.width; ++x) {
        const glm::dvec2 uv((x + 0.5) / rect.width, (y + 0.5) / rect.height);
        const double chart = std::clamp(std::floor((uv.x - 0.02) / kChartPitch), 0.0, kCharts - 1.0);
        const double across = (uv.x - 0.05 - chart * kChartPitch) / uvPerRadian();
        if (across < -0.5 || across > 2 * M_PI / kCharts + 0.5) continue;
        const Place place{2 * M_PI * chart / kCharts + across, (0.98 - uv.y) / kUvPerMetre};
        const glm::vec3 color = lookAt_(member, cameraAt(layer, place), place);
        for (int c = 0; c < 3; ++c) picture.at(rect.x + x, rect.y + y)[c] = uint8_t(color[c] + 0.5f);
      }
  }
  // Camera that labels the face under a place in a layer, in every member. Face order: by chart, then by ring.
  int cameraAt(int layer, const Place& place) const {
    const int wide = options.segments / kCharts;
    double turn = std::fmod(place.turn, 2 * M_PI);
    if (turn < 0) turn += 2 * M_PI;
    const double segment = turn / (2 * M_PI) * options.segments;
    const int s = std::min(int(segment), options.segments - 1);
    const double along = std::clamp(place.along, 0.0, length_ * 0.9999);
    const int ring = std::clamp(int(std::upper_bound(along_.begin(), along_.end(), along) - along_.begin()) - 1, 0,
                                options.rings - 1);
    const bool upper = segment - s + (along - along_[ring]) / (along_[ring + 1] - along_[ring]) > 1;
    const size_t per_chart = size_t(2 * options.rings - 2) * wide;
    size_t face = (s / wide) * per_chart;
    if (ring == 0)
      face += s % wide;
    else if (ring + 1 == options.rings)
      face += wide + size_t(2 * (ring - 1)) * wide + s % wide;
    else
      face += wide + size_t(2 * (ring - 1)) * wide + 2 * (s % wide) + upper;
    return labels[size_t(layer) * character.face_count + face];
  }

  std::vector<glm::dvec2> profile_;  // [ring] radius, height
  std::vector<double> along_;        // [ring]
  double length_ = 0;
  Noise noise_;
};

}  // namespace fourdvt::testing
