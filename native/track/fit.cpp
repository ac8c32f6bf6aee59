// SPDX-License-Identifier: Apache-2.0
#include "track/fit.h"

#include <cmath>

#include "base/opencv_image.h"
#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::track {
namespace {

constexpr float kMinSeen = 0.2f;    // visibilityOf below which a place does not count: hidden surfaces are guesses
constexpr float kMinCosine = 0.5f;  // between the normals of matching points of two surfaces

// Interpolated unit normal at a point of a mesh.
glm::vec3 normalAt(const std::vector<glm::uvec3>& faces, std::span<const glm::vec3> normals,
                   const NearestSurface::Hit& hit) {
  const glm::uvec3& f = faces[hit.face];
  return glm::normalize(hit.barycentric.x * normals[f.x] + hit.barycentric.y * normals[f.y] +
                        hit.barycentric.z * normals[f.z] + glm::vec3(0, 1e-12f, 0));
}

constexpr double kLostLimb_m = 0.03, kLostHand_m = 0.06;     // distances of a limb's curve, mean and largest
constexpr double kLimbSigma_m = 0.02, kTrunkSigma_m = 0.04;  // vertices' deviations while limbs are moved

Image imageOf(const cv::Mat& grey) {
  Image out(grey.cols, grey.rows, 1);
  grey.copyTo(matrixOf(out));
  return out;
}

class Fit {
 public:
  Fit(const Template& model, const TargetFrame& target, const FitOptions& options, FittedFrame start)
      : model_(model),
        target_(target),
        options_(options),
        out_(std::move(start)),
        faces_(model.topology.face_vertices),
        surface_normals_(normalsOf(target.surface->faces, target.surface->positions)),
        surface_seen_(visibilityOf(*target.views, target.surface->faces, target.surface->positions, surface_normals_)) {
    for (const View& view : *target.views) mattes_.push_back({imageOf(view.matte), 0, 0});
    place();
    seen_ = visibilityOf(*target_.views, faces_, out_.positions, normalsOf(faces_, out_.positions));
  }

  // Replaces the matches by those with frames that are fitted already, in pictures reduced by a factor. Of a vertex in
  // a camera, the first source with a match counts.
  void match(std::span<const PosedViews> sources, int reduction) {
    FlowMatchOptions flow;
    flow.reduction = reduction;
    const size_t count = out_.positions.size();
    const std::vector<glm::vec3> normals = normalsOf(faces_, out_.positions);
    matches_.clear();
    std::vector<bool> matched(count * target_.views->size(), false);
    for (const PosedViews& source : sources) {
      const size_t before = matches_.size();
      for (const PixelMatch& m : matchByFlow(faces_, source, *target_.views, out_.positions, normals, flow))
        if (!matched[m.camera * count + m.vertex]) matches_.push_back(m);
      for (size_t i = before; i < matches_.size(); ++i) matched[matches_[i].camera * count + matches_[i].vertex] = true;
    }
    seen_ = visibilityOf(*target_.views, faces_, out_.positions, normals);
  }
  // Gauss-Newton steps of the graph; surface points farther than `reach_m` do not count.
  void poseGraph(int steps, double reach_m, double reach_px, double rigidity_sigma_m, double flow_share = 1,
                 double outline_px = 0) {
    for (int i = 0; i < steps; ++i) {
      const GraphWeights weights{1 / (rigidity_sigma_m * rigidity_sigma_m), 1e-4};
      std::vector<Pull> pulls = pullsHere(reach_m, reach_px, flow_share);
      addOutlinePulls(outline_px, pulls);
      fitGraph(model_.graph, model_.node_positions, rest_, pulls, weights, out_.pose);
      place();
    }
  }

  // Moves limbs onto those of the surface where they are elsewhere. Returns true if one has moved.
  bool poseLimbs(int steps) {
    std::vector<Limb> limbs = model_.limbs;
    follow(out_.positions, limbs);
    const std::vector<Limb> there = limbsOf(*target_.surface, LimbOptions{});
    std::vector<glm::dvec3> shifts(out_.positions.size(), glm::dvec3(0));
    std::vector<bool> moves(out_.positions.size(), false);
    bool moved = false;
    for (const auto& [from, to] : pairedLimbs(limbs, there)) {
      const size_t rings = std::min(limbs[from].rings.size(), there[to].rings.size());
      double apart = 0, farthest = 0;
      for (size_t k = 0; k < rings; ++k) {
        const double distance = glm::distance(limbs[from].rings[k].middle, there[to].rings[k].middle);
        apart += distance / double(rings);
        farthest = std::max(farthest, distance);
      }
      if (apart < kLostLimb_m && farthest < kLostHand_m) continue;
      moved = true;
      for (size_t k = 0; k < rings; ++k)
        for (const uint32_t v : limbs[from].rings[k].vertices) {
          shifts[v] = there[to].rings[k].middle - limbs[from].rings[k].middle;
          moves[v] = true;
        }
    }
    if (!moved) return false;
    const Positions before = out_.positions;
    for (int i = 0; i < steps; ++i) {
      std::vector<Pull> pulls(before.size());
      for (size_t v = 0; v < pulls.size(); ++v) {
        const double sigma_m = moves[v] ? kLimbSigma_m : kTrunkSigma_m;
        const glm::dvec3 residual = glm::dvec3(before[v]) + shifts[v] - glm::dvec3(out_.positions[v]);
        pulls[v].matrix = glm::dmat3(1 / (sigma_m * sigma_m));
        pulls[v].vector = residual / (sigma_m * sigma_m);
      }
      const double rigid = 2 * options_.rigidity_sigma_m;
      fitGraph(model_.graph, model_.node_positions, rest_, pulls, {1 / (rigid * rigid), 1e-4}, out_.pose);
      place();
    }
    return true;
  }

  // Moves single vertices.
  void moveVertices(double reach_m, double reach_px, double outline_px) {
    std::vector<Pull> pulls = pullsHere(reach_m, reach_px);
    addOutlinePulls(outline_px, pulls);
    const std::vector<glm::dmat3> rotations = vertexRotations(model_.graph, out_.pose);
    const double keep = 1 / (options_.offset_sigma_m * options_.offset_sigma_m);
    const double stiffness = 1 / (options_.smoothness_sigma_m * options_.smoothness_sigma_m);
    // Displacements add to offsets that are there: stiffness and keep act on the sum, in the frame's orientation.
    std::vector<glm::dvec3> turned(pulls.size());
    for (size_t v = 0; v < pulls.size(); ++v) {
      turned[v] = rotations[v] * out_.offsets[v];
      pulls[v].vector += pulls[v].matrix * turned[v];  // unknown: the whole offset
    }
    const std::vector<glm::dvec3> whole = fitVertices(model_.edges, pulls, {stiffness, keep});
    for (size_t v = 0; v < pulls.size(); ++v) out_.offsets[v] = glm::transpose(rotations[v]) * whole[v];
    place();
  }

  const FittedFrame& frame() const { return out_; }

 private:
  void place() {
    rest_.resize(model_.positions.size());
    for (size_t v = 0; v < rest_.size(); ++v) rest_[v] = model_.positions[v] + glm::vec3(out_.offsets[v]);
    out_.positions = deformed(model_.graph, model_.node_positions, rest_, out_.pose);
  }

  std::vector<Pull> pullsHere(double reach_m, double reach_px, double flow_share = 1) const {
    std::vector<Pull> pulls(model_.positions.size());
    if (flow_share > 0) addPulls(matches_, *target_.views, out_.positions, reach_px, pulls);
    for (Pull& pull : pulls) pull.matrix *= flow_share, pull.vector *= flow_share;
    if (reach_m > 0) addSurfacePulls(reach_m, pulls);
    return pulls;
  }

  // Moves outlines to the mattes' edges within `reach_px`.
  void addOutlinePulls(double reach_px, std::vector<Pull>& pulls) const {
    if (!(options_.outline_sigma_px > 0) || !(reach_px > 0)) return;
    refine::OutlineOptions outline;
    outline.reach_pixels = float(reach_px);
    const double weight = 1 / (options_.outline_sigma_px * options_.outline_sigma_px);
    const std::vector<glm::vec3> normals = normalsOf(faces_, out_.positions);
    const std::vector<View>& views = *target_.views;
    std::vector<std::vector<refine::OutlinePoint>> points(views.size());
    inParallel(views.size(), [&](size_t c) {
      if (!views[c].empty())
        points[c] = refine::outlinePoints(views[c].camera, faces_, model_.inner_edges, out_.positions, normals,
                                          mattes_[c], outline);
    });
    for (size_t c = 0; c < views.size(); ++c)
      for (const refine::OutlinePoint& point : points[c]) {
        const glm::vec3 place = glm::mix(out_.positions[point.from], out_.positions[point.to], point.to_share);
        const glm::dvec3 direction = pixelGradients(views[c].camera, place) * glm::dvec2(point.outward);
        const double robust = tukeyWeight(4.685 * std::abs(point.residual_pixels) / reach_px);
        pulls[point.from].add(direction, point.residual_pixels, weight * robust * (1 - point.to_share));
        pulls[point.to].add(direction, point.residual_pixels, weight * robust * point.to_share);
      }
  }

  // Point to plane, from the template to the surface and back.
  void addSurfacePulls(double reach_m, std::vector<Pull>& pulls) const {
    const std::vector<glm::vec3> normals = normalsOf(faces_, out_.positions);
    const double weight = 1 / (options_.surface_sigma_m * options_.surface_sigma_m);
    inParallel(pulls.size(), [&](size_t v) {
      const glm::vec3& position = out_.positions[v];
      if (seen_[v] < kMinSeen) return;
      const auto hit = target_.nearest->nearestFacing(position, normals[v], kMinCosine, float(reach_m));
      if (!hit) return;
      const glm::dvec3 normal = normalAt(target_.surface->faces, surface_normals_, *hit);
      const double residual = glm::dot(normal, glm::dvec3(hit->point - position));
      pulls[v].add(normal, residual, weight * tukeyWeight(4.685 * hit->distance_m / reach_m));
    });
    const NearestSurface own({out_.positions, faces_});
    // Samples the surface at about as many points as the template has vertices.
    const size_t count = target_.surface->positions.size(), stride = std::max<size_t>(1, count / pulls.size());
    std::vector<std::optional<NearestSurface::Hit>> hits(count / stride);
    inParallel(hits.size(), [&](size_t i) {
      if (surface_seen_[i * stride] < kMinSeen) return;
      hits[i] = own.nearestFacing(target_.surface->positions[i * stride], surface_normals_[i * stride], kMinCosine,
                                  float(reach_m));
    });
    for (size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i]) continue;
      const glm::dvec3 normal = surface_normals_[i * stride];
      const double residual = glm::dot(normal, glm::dvec3(target_.surface->positions[i * stride] - hits[i]->point));
      const double robust = tukeyWeight(4.685 * hits[i]->distance_m / reach_m);
      for (int k = 0; k < 3; ++k)
        pulls[faces_[hits[i]->face][k]].add(normal, residual, 0.5 * weight * robust * double(hits[i]->barycentric[k]));
    }
  }

  const Template& model_;
  const TargetFrame& target_;
  const FitOptions& options_;
  FittedFrame out_;
  const std::vector<glm::uvec3>& faces_;
  const std::vector<glm::vec3> surface_normals_;
  std::vector<refine::MatteCrop> mattes_;  // [camera]
  std::vector<glm::vec3> rest_;
  const std::vector<float> surface_seen_;  // visibilityOf the surface
  std::vector<float> seen_;                // the template's, at the last match
  std::vector<PixelMatch> matches_;
};

}  // namespace

Template makeTemplate(MeshTopology topology, Positions positions, uint32_t node_count, const TriangleMesh& surface) {
  Template out{std::move(topology), std::move(positions), {}, {}, {}, {}, {}};
  out.graph = makeGraph(out.topology.face_vertices, out.positions, node_count);
  for (const uint32_t v : out.graph.nodes) out.node_positions.push_back(out.positions[v]);
  out.edges = edgesOf(out.topology.face_vertices);
  out.inner_edges = refine::innerEdges(out.topology.face_vertices);
  out.limbs = limbsOn(out.positions, surface, limbsOf(surface, LimbOptions{}));
  return out;
}

FittedFrame restFrame(const Template& model) {
  return {GraphPose::identity(model.graph.nodes.size()), std::vector<glm::dvec3>(model.positions.size(), glm::dvec3(0)),
          model.positions};
}

FittedFrame fitFrame(const Template& model, const FittedFrame& start, const PosedViews& parent,
                     const PosedViews& anchor, const TargetFrame& target, const FitOptions& options) {
  Fit fit(model, target, options, start);
  const double rigid = options.rigidity_sigma_m;
  const std::span<const PosedViews> from_parent(&parent, options.flow_from_parent ? 1 : 0);
  std::vector<PosedViews> both{anchor};
  both.insert(both.end(), from_parent.begin(), from_parent.end());
  if (options.flow_from_parent) {
    // Flow alone leads first: where parts move farther than they are thick, the nearest surface is another part's.
    for (int i = 0; i < 2; ++i) {
      fit.match(from_parent, 2);
      fit.poseGraph(3, 0, 60, 2 * rigid);
    }
    fit.match(from_parent, 1);
    fit.poseGraph(3, 0, 30, rigid);
  }
  if (options.wide && fit.poseLimbs(8) && options.flow_from_parent) {
    fit.poseGraph(4, 0.12, 0, rigid, 0);
    fit.match(from_parent, 2);
  }
  constexpr double kWideShare = 0.02;
  if (options.wide) fit.poseGraph(4, 0.12, 30, rigid, kWideShare);
  fit.poseGraph(4, 0.06, 20, rigid, options.wide ? kWideShare : 1);
  if (options.wide) fit.poseGraph(4, 0.03, 20, rigid, kWideShare);
  fit.match(from_parent, 1);
  fit.poseGraph(3, 0.03, 10, rigid);
  if (options.flow_from_anchor) {
    fit.match(both, 2);
    fit.poseGraph(3, 0.03, 10, rigid);
    fit.match(both, 1);
  }
  fit.poseGraph(3, 0.02, 8, rigid, 1, 12);
  for (const double reach_m : {0.04, 0.03, 0.02}) fit.moveVertices(reach_m, 6, 8);
  return fit.frame();
}

Positions refined(const Template& model, const TargetFrame& target, const FitOptions& options) {
  Fit fit(model, target, options, restFrame(model));
  for (int i = 0; i < 3; ++i) fit.moveVertices(0.015, 0, 8);
  return fit.frame().positions;
}

}  // namespace fourdvt::track
