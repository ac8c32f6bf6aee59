// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/carve.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "reconstruct/mesh_checks.h"
#include "reconstruct/surface_cleaning.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kBandVoxels = 3;
constexpr int kMaxLevels = 20;                       // 2^20 blocks along each side of space
constexpr int kCoarseLevels = 9, kCommonLevels = 7;  // halvings for the counts in an error message
constexpr size_t kNoView = SIZE_MAX;
// Error of distances to outlines that decides whether a camera can be left out: relative, and pixels.
constexpr double kDistanceError = 1.05, kDistanceError_px = 4;

enum class Share : uint8_t { Outside, Mixed, Inside };

class Carver {
 public:
  // Excludes the camera `without`.
  explicit Carver(std::span<const CarvingView> views, size_t without = kNoView)
      : views_(views), without_(without), needed_(views.size() / 2 + 1) {}

  // Conservative classification of a sphere: entirely outside, entirely inside, or undecided.
  Share judge(const glm::dvec3& centre, double radius) const {
    size_t seen = 0;
    bool inside = true;
    for (size_t i = 0; i < views_.size(); ++i) {
      if (i == without_) continue;
      const PinholeCamera& camera = views_[i].silhouette->camera;
      const glm::dvec3 p = camera.project(centre);
      if (p.z <= -radius) continue;
      if (p.z <= 1.5 * radius) {  // the sphere may contain the camera
        ++seen;
        inside = false;
        continue;
      }
      const double reach = 1.2 * std::max(camera.fx, camera.fy) * radius / (p.z - radius) + 1;
      const double beside = std::max({-p.x, p.x - camera.width, -p.y, p.y - camera.height});
      if (beside > reach) continue;
      ++seen;
      if (beside > -reach) {
        inside = false;  // the sphere projects partly beyond the picture's edge
        continue;
      }
      const float distance = views_[i].distance.at(p.x, p.y);
      if (distance < -reach) return Share::Outside;
      inside &= distance > reach;
    }
    if (seen < needed_) return Share::Outside;
    return inside ? Share::Inside : Share::Mixed;
  }

  // Cameras for the distances at points of a sphere. `deep`: those that see all of it, nowhere nearer to the outline
  // than the band; `near`: the others that may see some of it.
  struct Seen {
    size_t deep = 0;
    std::vector<const CarvingView*> near;
  };
  Seen seenIn(const glm::dvec3& centre, double radius, float band) const {
    Seen out;
    for (const CarvingView& view : views_) {
      const PinholeCamera& camera = view.silhouette->camera;
      const glm::dvec3 p = camera.project(centre);
      if (p.z <= -radius) continue;
      const double nearest = p.z - radius;
      if (nearest <= 0) {
        out.near.push_back(&view);
        continue;
      }
      const double slant = std::hypot((p.x - camera.cx) / camera.fx, (p.y - camera.cy) / camera.fy, 1.0);
      const double reach = slant * std::max(camera.fx, camera.fy) * radius / nearest + 1;
      const double beside = std::max({-p.x, p.x - camera.width, -p.y, p.y - camera.height});
      if (beside > reach) continue;
      const double band_px = band * (camera.fx + camera.fy) / 2 / nearest;
      if (beside < -reach && view.distance.at(p.x, p.y) > kDistanceError * (reach + band_px) + kDistanceError_px) {
        ++out.deep;
      } else {
        out.near.push_back(&view);
      }
    }
    return out;
  }

  float distanceAt(const glm::dvec3& point, float band, const Seen& cameras) const {
    size_t seen = cameras.deep;
    float nearest = band;
    for (const CarvingView* near : cameras.near) {
      const CarvingView& view = *near;
      const PinholeCamera& camera = view.silhouette->camera;
      const glm::dvec3 p = camera.project(point);
      if (p.z <= 0) continue;
      const float pixels = view.distance.at(p.x, p.y);
      if (pixels == silhouette::SilhouetteDistance::kOutside) continue;
      ++seen;
      nearest = std::min(nearest, pixels * float(p.z * 2 / (camera.fx + camera.fy)));
      if (nearest <= -band) return -band;
    }
    return seen >= needed_ ? nearest : -band;
  }

 private:
  std::span<const CarvingView> views_;
  size_t without_, needed_;
};

std::vector<PinholeCamera> camerasOf(std::span<const CarvingView> views) {
  std::vector<PinholeCamera> out;
  for (const CarvingView& view : views) out.push_back(view.silhouette->camera);
  return out;
}

// Cubes of blocks, for recursive subdivision.
struct Cells {
  glm::dvec3 origin{0};  // grid origin
  double block_m = 0;
  int blocks_along = 0;            // blocks along a cell
  std::vector<glm::ivec3> at;      // origins, in blocks
  std::vector<glm::ivec3> inside;  // blocks entirely inside
  size_t judged = 0;               // cells classified so far
};

double radiusOf(const Cells& cells) { return std::sqrt(0.75) * cells.block_m * cells.blocks_along; }
glm::dvec3 centreOf(const Cells& cells, const glm::ivec3& at) {
  return cells.origin + (glm::dvec3(at) + 0.5 * cells.blocks_along) * cells.block_m;
}

void halve(const Carver& carver, Cells& cells) {
  cells.blocks_along /= 2;
  std::vector<glm::ivec3> parts;
  parts.reserve(cells.at.size() * 8);
  for (const glm::ivec3& at : cells.at)
    for (int k = 0; k < 8; ++k) parts.push_back(at + cells.blocks_along * glm::ivec3(k & 1, k >> 1 & 1, k >> 2));
  std::vector<Share> shares(parts.size());
  cells.judged += parts.size();
  const double radius = radiusOf(cells);
  inParallel(parts.size(), [&](int i) { shares[i] = carver.judge(centreOf(cells, parts[i]), radius); });
  cells.at.clear();
  for (size_t i = 0; i < parts.size(); ++i) {
    if (shares[i] == Share::Outside) continue;
    if (shares[i] == Share::Inside && cells.blocks_along == 1) {
      cells.inside.push_back(parts[i]);
    } else {
      cells.at.push_back(parts[i]);
    }
  }
}

// One cell around all visible space, aligned to the grid of blocks.
Cells wholeSpace(std::span<const CarvingView> views, double voxel_m) {
  const std::vector<PinholeCamera> cameras = camerasOf(views);
  const glm::dvec3 middle = middleOf(cameras);
  const double reach = reachOf(cameras, middle);
  Cells cells;
  cells.block_m = voxel_m * kBlock;
  cells.blocks_along = 1;
  for (int level = 0; level < kMaxLevels && cells.blocks_along * cells.block_m < 2 * reach; ++level)
    cells.blocks_along *= 2;
  const glm::dvec3 first = glm::floor(middle / cells.block_m) - 0.5 * cells.blocks_along;
  cells.at.push_back(glm::ivec3(first));
  return cells;
}

// The same space with a grid that depends on the rig alone; `levels` halvings give single blocks.
Cells rigSpace(std::span<const CarvingView> views, int levels) {
  const std::vector<PinholeCamera> cameras = camerasOf(views);
  const glm::dvec3 middle = middleOf(cameras);
  const double reach = reachOf(cameras, middle);
  Cells cells;
  cells.origin = middle - reach;
  cells.blocks_along = 1 << levels;
  cells.block_m = 2 * reach / cells.blocks_along;
  cells.at.emplace_back(0);
  return cells;
}

// True if the cell's centre is inside: a large cell may remain for its corners alone.
bool middleHeld(const Carver& carver, const Cells& cells, const glm::ivec3& at) {
  return carver.judge(centreOf(cells, at), radiusOf(cells) / 8) != Share::Outside;
}

Error nothingLeft(std::span<const CarvingView> views) {
  // Volume that remains on a coarse grid without one camera.
  const auto left = [&](size_t without) {
    const Carver carver(views, without);
    Cells cells = rigSpace(views, kCoarseLevels);
    while (cells.blocks_along > 1) halve(carver, cells);
    cells.at.insert(cells.at.end(), cells.inside.begin(), cells.inside.end());
    return std::count_if(cells.at.begin(), cells.at.end(),
                         [&](const glm::ivec3& at) { return middleHeld(carver, cells, at); });
  };
  Cells cells = rigSpace(views, kCommonLevels);
  const std::vector<PinholeCamera> cameras = camerasOf(views);
  const size_t needed = cameras.size() / 2 + 1;
  size_t common = 0;
  while (cells.blocks_along > 1) {
    std::vector<glm::ivec3> parts;
    cells.blocks_along /= 2;
    for (const glm::ivec3& at : cells.at)
      for (int k = 0; k < 8; ++k) {
        const glm::ivec3 part = at + cells.blocks_along * glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
        if (isSeen(cameras, needed, centreOf(cells, part), radiusOf(cells))) parts.push_back(part);
      }
    cells.at = std::move(parts);
    common = size_t(std::count_if(cells.at.begin(), cells.at.end(), [&](const glm::ivec3& at) {
      return isSeen(cameras, needed, centreOf(cells, at), radiusOf(cells) / 32);
    }));
  }
  if (common == 0) {
    return {ErrorId::NothingVisible,
            "no place in space is seen by more than half of the cameras; check the poses in images.txt "
            "(world-to-camera) and "
            "that cameras look at the performer"};
  }
  long most = 0;
  size_t odd = kNoView;
  for (size_t i = 0; i < views.size(); ++i) {
    const long count = left(i);
    if (count > most) most = count, odd = i;
  }
  const std::string what = "the silhouettes leave no place in space for the performer; ";
  if (odd == kNoView) {
    return {ErrorId::NothingVisible,
            what + "no single camera is to blame: check units, poses and synchronisation of all cameras"};
  }
  return {ErrorId::NothingVisible, what + "camera \"" + views[odd].silhouette->camera.name +
                                       "\" disagrees most with the others: check its pose, its matte and its "
                                       "synchronisation, or remove it from images.txt"};
}

}  // namespace

Result<CoarseBounds> coarseBounds(std::span<const CarvingView> views, int cells_along) {
  const Carver carver(views);
  Cells cells = rigSpace(views, kMaxLevels);
  while (cells.blocks_along > 1 && !cells.at.empty()) {
    halve(carver, cells);
    glm::ivec3 low(INT_MAX), high(INT_MIN);
    for (const glm::ivec3& at : cells.at) {
      if (!middleHeld(carver, cells, at)) continue;
      low = glm::min(low, at);
      high = glm::max(high, at + cells.blocks_along);
    }
    if (low.x > high.x) continue;  // nothing is left: voxels larger than the performer
    const glm::ivec3 along = (high - low) / cells.blocks_along;
    if (std::max({along.x, along.y, along.z}) < cells_along) continue;
    return CoarseBounds{cells.origin + glm::dvec3(low) * cells.block_m, cells.origin + glm::dvec3(high) * cells.block_m,
                        cells.blocks_along * cells.block_m};
  }
  return nothingLeft(views);
}

Result<SparseDistance> carve(std::span<const CarvingView> views, double voxel_m) {
  const Carver carver(views);
  Cells cells = wholeSpace(views, voxel_m);
  while (cells.blocks_along > 1 && !cells.at.empty()) halve(carver, cells);

  SparseDistance out;
  out.voxel_m = voxel_m;
  out.band_m = float(kBandVoxels * voxel_m);
  out.cells_judged = cells.judged;
  for (const glm::ivec3& at : cells.inside) out.inside.push_back(at * kBlock);
  out.blocks.resize(cells.at.size());
  std::vector<uint8_t> holds(cells.at.size());
  inParallel(cells.at.size(), [&](int b) {
    SparseDistance::Block& block = out.blocks[b];
    block.at = cells.at[b] * kBlock;
    const auto cameras = carver.seenIn(centreOf(cells, cells.at[b]), radiusOf(cells), out.band_m);
    for (size_t i = 0; i < block.values.size(); ++i) {
      block.values[i] = carver.distanceAt(glm::dvec3(voxelOf(block, i)) * voxel_m, out.band_m, cameras);
      holds[b] |= block.values[i] > -out.band_m;
    }
  });
  size_t kept = 0;
  bool any = !out.inside.empty();
  for (size_t b = 0; b < out.blocks.size(); ++b) {
    if (!holds[b]) continue;
    for (float v : out.blocks[b].values) any |= v > 0;
    if (kept != b) out.blocks[kept] = out.blocks[b];
    ++kept;
  }
  out.blocks.resize(kept);
  if (!any) return nothingLeft(views);
  return out;
}

namespace {

constexpr double kNearReach = 4, kFarReach = 32;  // multiples of the cameras' spread: converging rays, parallel rays
constexpr double kSideBySide = 0.94;              // minimum cosine between any two rays: the distance is undetermined
constexpr double kEverywhere = 1e9;               // pixels
constexpr size_t kEnoughCells = 20'000;
constexpr int kMaxHalvings = 20;

}  // namespace

glm::dvec3 middleOf(std::span<const PinholeCamera> cameras) {
  glm::dmat3 a(0);
  glm::dvec3 b(0);
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 axis = camera.middleRayInWorld(), c = camera.centreInWorld();
    const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis) * 0.999;
    a += across;
    b += across * c;
  }
  return glm::inverse(a) * b;
}

double reachOf(std::span<const PinholeCamera> cameras, const glm::dvec3& middle) {
  double spread = 0, from_middle = 0, min_cosine = 1;
  for (const PinholeCamera& a : cameras) {
    const glm::dvec3 centre = a.centreInWorld(), axis = a.middleRayInWorld();
    from_middle = std::max(from_middle, glm::distance(middle, centre));
    for (const PinholeCamera& b : cameras) {
      spread = std::max(spread, glm::distance(centre, b.centreInWorld()));
      min_cosine = std::min(min_cosine, glm::dot(axis, b.middleRayInWorld()));
    }
  }
  const double reach = std::max(2 * from_middle, spread * (min_cosine > kSideBySide ? kFarReach : kNearReach));
  return reach > 0 ? reach : 1;  // all cameras at one centre: any distance will do
}

bool isSeen(std::span<const PinholeCamera> cameras, size_t min_cameras, const glm::dvec3& centre, double radius) {
  size_t count = 0;
  for (const PinholeCamera& camera : cameras) {
    const glm::dvec3 p = camera.project(centre);
    if (p.z <= -radius) continue;
    const double reach = p.z > 1.5 * radius ? std::max(camera.fx, camera.fy) * radius / (p.z - radius) : kEverywhere;
    count += p.x > -reach && p.y > -reach && p.x < camera.width + reach && p.y < camera.height + reach;
  }
  return count >= min_cameras;
}

double seenVolume(std::span<const PinholeCamera> cameras) {
  const size_t needed = cameras.size() / 2 + 1;
  const glm::dvec3 middle = middleOf(cameras);
  double side = 2 * reachOf(cameras, middle);
  std::vector<glm::dvec3> centres{middle};
  for (int halving = 0; halving < kMaxHalvings && !centres.empty() && centres.size() < kEnoughCells; ++halving) {
    side /= 2;
    std::vector<glm::dvec3> parts;
    for (const glm::dvec3& centre : centres)
      for (int k = 0; k < 8; ++k) {
        const glm::dvec3 part = centre + side * (glm::dvec3(k & 1, k >> 1 & 1, k >> 2) - 0.5);
        if (isSeen(cameras, needed, part, std::sqrt(0.75) * side)) parts.push_back(part);
      }
    centres = std::move(parts);
  }
  const auto seen = std::count_if(centres.begin(), centres.end(),
                                  [&](const glm::dvec3& centre) { return isSeen(cameras, needed, centre, 0); });
  return double(seen) * side * side * side;
}

namespace {

// Merged faces may cross their neighbours; adaptivity is then reduced.
constexpr size_t kMaxChecked = 500'000;
constexpr double kAdaptivityShares[] = {1, 0.25, 0};

}  // namespace

TriangleMesh solidSurface(const SparseDistance& distance, double adaptivity,
                          const std::function<void(TriangleMesh&)>& drop) {
  TriangleMesh mesh;
  for (const double share : kAdaptivityShares) {
    mesh = zeroSurface(distance, share * adaptivity);
    drop(mesh);
    if (share * adaptivity == 0) break;
    if (mesh.faces.size() > kMaxChecked) continue;  // comparing all faces would take minutes
    if (isSolid(mesh)) break;
  }
  return mesh;
}

Result<VolumetricHull> volumetricHull(std::span<const CarvingView> views, const VolumetricOptions& options) {
  VolumetricHull out;
  FOURDVT_ASSIGN(out.distance, carve(views, options.voxel_m));
  std::vector<const silhouette::Silhouette*> silhouettes;
  for (const CarvingView& view : views) silhouettes.push_back(view.silhouette);
  out.mesh = solidSurface(out.distance, options.adaptivity, [&](TriangleMesh& mesh) {
    out.dropped = dropNeedless(mesh, silhouettes, kSpeckVoxels * std::pow(options.voxel_m, 3));
  });
  return out;
}

}  // namespace fourdvt::reconstruct
