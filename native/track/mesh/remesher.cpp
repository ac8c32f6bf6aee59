// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/remesher.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace fourdvt::track {
namespace {

constexpr float kLong = 4.0f / 3, kShort = 4.0f / 5;  // relative to the target length
constexpr int kMaxPasses = 40;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr float kMinFacing = 0.0f;   // cosine between a vertex normal and the face that the vertex is placed on
constexpr float kMinTurn = 0.2f;     // cosine between a face's normals before and after a change
constexpr float kMinUpright = 0.5f;  // instead: cosine between its normal after and the vertex normal
constexpr float kMinHeight = 0.1f;   // height of a face over its longest side, about the sine of its smallest angle
constexpr float kMinShare = 0.5f;    // instead, in a collapse: of its height before
constexpr float kMinFlat = 0.5f;     // cosine between a flipped edge's faces and the mean of its faces before

float squared(const glm::vec3& v) { return glm::dot(v, v); }

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

// Twice the area over the square of the longest side.
float height(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const float longest = std::max({squared(b - a), squared(c - b), squared(a - c)});
  return longest > 0 ? glm::length(glm::cross(b - a, c - a)) / longest : 0;
}

}  // namespace

Remesher::Remesher(const TriangleMesh& surface, std::span<const float> size, HalfEdges mesh, Positions positions)
    : mesh_(std::move(mesh)),
      positions_(std::move(positions)),
      sizes_(positions_.size(), 1.0f),
      surface_(surface),
      surface_sizes_(size),
      nearest_(surface) {
  if (size.empty()) return;
  for (uint32_t f = 0; f < surface.faces.size(); ++f)  // face f has the half-edges from 3 f on
    for (int k = 0; k < 3; ++k) sizes_[mesh_.from(3 * f + k)] = size[surface.faces[f][k]];
}

std::optional<Remesher::Place> Remesher::placed(const glm::vec3& point, const glm::vec3& normal, float within_m) const {
  const auto hit = nearest_.nearestFacing(point, normal, kMinFacing, within_m);
  if (!hit) return std::nullopt;
  float size = 1;
  if (!surface_sizes_.empty()) {
    const glm::uvec3& face = surface_.faces[hit->face];
    size = 0;
    for (int k = 0; k < 3; ++k) size += hit->barycentric[k] * surface_sizes_[face[k]];
  }
  return Place{hit->point, size};
}

glm::vec3 Remesher::twiceArea(uint32_t h) const {
  const glm::vec3& a = positions_[mesh_.from(h)];
  return glm::cross(positions_[mesh_.to(h)] - a, positions_[mesh_.opposite(h)] - a);
}

glm::vec3 Remesher::ringNormal(uint32_t v) const {
  glm::vec3 sum(0);
  mesh_.around(v, [&](uint32_t h) { sum += twiceArea(h); });
  return unit(sum);
}

float Remesher::relativeLength(uint32_t h) const {
  const uint32_t a = mesh_.from(h), b = mesh_.to(h);
  return 2 * glm::distance(positions_[a], positions_[b]) / (sizes_[a] + sizes_[b]);
}

double Remesher::relativeArea() const {
  double area = 0;
  for (uint32_t h = 0; h < mesh_.halfEdgeCount(); h += 3) {
    if (!mesh_.hasHalfEdge(h)) continue;
    const double size = (double(sizes_[mesh_.from(h)]) + sizes_[mesh_.to(h)] + sizes_[mesh_.opposite(h)]) / 3;
    area += glm::length(twiceArea(h)) / 2 / (size * size);
  }
  return area;
}

TriangleMesh Remesher::result() const { return {positions_, mesh_.faces()}; }

// Returns every edge longer than `min_length` and shorter than `max_length` once, the shortest first.
std::vector<Remesher::Candidate> Remesher::edges(float min_length, float max_length) const {
  std::vector<Candidate> out;
  for (uint32_t h = 0; h < mesh_.halfEdgeCount(); ++h) {
    if (!mesh_.hasHalfEdge(h) || mesh_.twin(h) < h) continue;
    const float length = relativeLength(h);
    if (length > min_length && length < max_length) out.push_back({length, h});
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return a.length != b.length ? a.length < b.length : a.half_edge < b.half_edge;
  });
  return out;
}

// Returns true where the faces round `v`, except those with the vertex `but`, keep their side and a height when `v`
// moves: kMinHeight, or `min_share` of the height before.
bool Remesher::keepsFaces(uint32_t v, uint32_t but, const glm::vec3& position, const glm::vec3& normal,
                          float min_share) const {
  bool keeps = true;
  mesh_.around(v, [&](uint32_t h) {
    const uint32_t b = mesh_.to(h), c = mesh_.opposite(h);
    if (!keeps || b == but || c == but) return;
    const glm::vec3 after = unit(glm::cross(positions_[b] - position, positions_[c] - position));
    const float high = height(position, positions_[b], positions_[c]);
    keeps = (glm::dot(after, unit(twiceArea(h))) > kMinTurn || glm::dot(after, normal) > kMinUpright) &&
            (high > kMinHeight || high >= min_share * height(positions_[v], positions_[b], positions_[c]));
  });
  return keeps;
}

bool Remesher::staysShort(uint32_t v, const Place& place, float max_length) const {
  bool stays = true;
  mesh_.around(v, [&](uint32_t h) {
    const uint32_t b = mesh_.to(h);
    stays &= 2 * glm::distance(place.position, positions_[b]) <= max_length * (place.size + sizes_[b]);
  });
  return stays;
}

bool Remesher::split(uint32_t h) {
  const uint32_t a = mesh_.from(h), b = mesh_.to(h);
  const glm::vec3 normal = unit(twiceArea(h) + twiceArea(mesh_.twin(h)));
  const auto place =
      placed(0.5f * (positions_[a] + positions_[b]), normal, 0.5f * glm::distance(positions_[a], positions_[b]));
  if (!place) return false;
  for (const uint32_t side : {h, mesh_.twin(h)}) {
    const glm::vec3 old = unit(twiceArea(side));
    const glm::vec3& c = positions_[mesh_.opposite(side)];
    for (const glm::vec3& after : {glm::cross(place->position - positions_[mesh_.from(side)], c - place->position),
                                   glm::cross(positions_[mesh_.to(side)] - place->position, c - place->position)})
      if (glm::dot(unit(after), old) <= kMinTurn && glm::dot(unit(after), normal) <= kMinUpright) return false;
  }
  mesh_.split(h);
  positions_.push_back(place->position);
  sizes_.push_back(place->size);
  return true;
}

// Merges the edge into its middle on the surface or, where that is not permitted, into one of its ends.
bool Remesher::collapse(uint32_t h, float max_length) {
  if (!mesh_.mayCollapse(h)) return false;
  const uint32_t a = mesh_.from(h), b = mesh_.to(h);
  const glm::vec3 normal = unit(ringNormal(a) + ringNormal(b));
  const auto merge = [&](const Place& place) {
    if (!staysShort(a, place, max_length) || !staysShort(b, place, max_length) ||
        !keepsFaces(a, b, place.position, normal, kMinShare) || !keepsFaces(b, a, place.position, normal, kMinShare))
      return false;
    mesh_.collapse(h);
    positions_[a] = place.position;
    sizes_[a] = place.size;
    return true;
  };
  const auto middle =
      placed(0.5f * (positions_[a] + positions_[b]), normal, 0.5f * glm::distance(positions_[a], positions_[b]));
  return (middle && merge(*middle)) || merge({positions_[a], sizes_[a]}) || merge({positions_[b], sizes_[b]});
}

// Changes the edges in their order where permitted, at most `max_changes` and none that shares a vertex with the
// surroundings of another. Returns the number of changes.
size_t Remesher::changeEdges(const std::vector<Candidate>& candidates, size_t max_changes, bool split,
                             float max_length) {
  std::vector<bool> changed(mesh_.vertexCount(), false);
  size_t changes = 0;
  for (const auto& [length, h] : candidates) {
    if (changes == max_changes) break;
    if (!mesh_.hasHalfEdge(h)) continue;
    const uint32_t a = mesh_.from(h), b = mesh_.to(h), c = mesh_.opposite(h), d = mesh_.opposite(mesh_.twin(h));
    if (changed[a] || changed[b] || (split && (changed[c] || changed[d]))) continue;
    if (!(split ? this->split(h) : collapse(h, max_length))) continue;
    ++changes;
    if (split)
      changed[a] = changed[b] = changed[c] = changed[d] = true;
    else
      mesh_.around(a, [&](uint32_t out) { changed[a] = changed[mesh_.to(out)] = true; });
    changed.resize(mesh_.vertexCount(), true);
  }
  return changes;
}

void Remesher::splitLong(float length_m) {
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    std::vector<Candidate> candidates = edges(kLong * length_m, kNoLimit);
    std::reverse(candidates.begin(), candidates.end());
    if (changeEdges(candidates, candidates.size(), true, kNoLimit) == 0) return;
  }
}

void Remesher::collapseShort(float length_m) {
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::vector<Candidate> candidates = edges(-1, kShort * length_m);
    const size_t changes = changeEdges(candidates, candidates.size(), false, kLong * length_m);
    if (changes == 0) return;
    if (changes > mesh_.faceCount() / 100) flipEdges(true);
  }
}

void Remesher::trim(size_t faces, float length_m) {
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const bool few = faceCount() + 1 < faces, many = faceCount() > faces + 1;
    if (!few && !many) return;
    std::vector<Candidate> candidates = edges(-1, kNoLimit);
    if (few) std::reverse(candidates.begin(), candidates.end());
    const size_t wanted = (few ? faces - faceCount() : faceCount() - faces) / 2;
    const float max_length = length_m * kLong * (1 + 0.1f * float(pass));
    if (changeEdges(candidates, wanted, few, max_length) == 0 && pass > 10) return;
  }
}

bool Remesher::flipGains(uint32_t h, bool for_valence) const {
  const uint32_t t = mesh_.twin(h), a = mesh_.from(h), b = mesh_.to(h), c = mesh_.opposite(h), d = mesh_.opposite(t);
  if (!mesh_.mayFlip(h)) return false;
  if (for_valence) {
    const int va = mesh_.valence(a) - 6, vb = mesh_.valence(b) - 6, vc = mesh_.valence(c) - 6,
              vd = mesh_.valence(d) - 6;
    const auto squares = [](int i, int j, int k, int l) { return i * i + j * j + k * k + l * l; };
    if (squares(va - 1, vb - 1, vc + 1, vd + 1) >= squares(va, vb, vc, vd)) return false;
  }
  const glm::vec3 &pa = positions_[a], &pb = positions_[b], &pc = positions_[c], &pd = positions_[d];
  const float before = std::min(height(pa, pb, pc), height(pb, pa, pd));
  const float after = std::min(height(pa, pd, pc), height(pd, pb, pc));
  if (for_valence ? after < std::min(before, 2 * kMinHeight) : after <= 1.05f * before) return false;
  const glm::vec3 old_one = unit(twiceArea(h)), old_two = unit(twiceArea(t)), mean = unit(old_one + old_two);
  const glm::vec3 one = unit(glm::cross(pd - pa, pc - pa)), two = unit(glm::cross(pb - pd, pc - pd));
  return glm::dot(one, mean) > kMinFlat && glm::dot(two, mean) > kMinFlat &&
         glm::dot(one, two) > std::min(kMinFlat, glm::dot(old_one, old_two));
}

void Remesher::flipEdges(bool for_valence) {
  for (uint32_t h = 0; h < mesh_.halfEdgeCount(); ++h)
    if (mesh_.hasHalfEdge(h) && h < mesh_.twin(h) && flipGains(h, for_valence)) mesh_.flip(h);
}

// Moves each vertex towards the mean of its neighbours, weighted by the relative areas round them, in its tangent
// plane, and back to the surface. Later vertices see the new positions of earlier ones.
void Remesher::relax() {
  std::vector<float> weights(mesh_.vertexCount(), 0);
  for (uint32_t h = 0; h < mesh_.halfEdgeCount(); ++h)
    if (mesh_.hasHalfEdge(h)) weights[mesh_.from(h)] += glm::length(twiceArea(h));
  for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) weights[v] /= sizes_[v] * sizes_[v];
  for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
    if (!mesh_.hasVertex(v)) continue;
    glm::vec3 sum(0);
    float weight = 0;
    mesh_.around(v, [&](uint32_t h) {
      sum += weights[mesh_.to(h)] * (positions_[mesh_.to(h)] - positions_[v]);
      weight += weights[mesh_.to(h)];
    });
    const glm::vec3 normal = ringNormal(v);
    if (weight <= 0) continue;
    glm::vec3 step = sum / weight;
    step -= glm::dot(step, normal) * normal;
    const auto place = placed(positions_[v] + step, normal, glm::length(step));
    if (!place || !keepsFaces(v, HalfEdges::kNone, place->position, normal, 1)) continue;
    positions_[v] = place->position;
    sizes_[v] = place->size;
  }
}

}  // namespace fourdvt::track
