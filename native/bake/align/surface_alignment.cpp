// SPDX-License-Identifier: Apache-2.0
#include "bake/align/surface_alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "bake/align/in_order.h"
#include "bake/align/tangent_field.h"
#include "bake/align/views.h"
#include "render/passes.h"
#include "render/table.h"

namespace fourdvt::bake {
namespace {

constexpr int kRounds[] = {2, 1};  // divisor of the picture height in each round, coarse to fine
constexpr int kDetailViews = 4;
constexpr float kInteriorReach_px = 8;    // at full height
constexpr float kHalfConfidence = 0.25f;  // information (VertexEstimate) at which confidence is one half

Status whyNot(const AlignmentOptions& options, const package::BaseMesh& mesh) {
  const auto invalid = [](const char* message) { return Error{ErrorId::InvalidArgument, message}; };
  if (options.views < 3) return invalid("alignment needs at least 3 views; set views to 8 or more");
  if (options.picture_height < 64) return invalid("alignment's picture_height is too small; use 64 or more");
  if (!(options.smoothness > 0)) return invalid("alignment's smoothness must be positive");
  if (!(options.max_displacement_m > 0)) return invalid("alignment's max_displacement_m must be positive");
  if (options.gutter_texels < 0) return invalid("alignment's gutter_texels must not be negative");
  if (mesh.topology.faceCount() == 0) return invalid("alignment needs a mesh with faces");
  return {};
}

// Smallest eigenvalue of a symmetric matrix.
float minInformation(const glm::mat2& m) {
  const float mean = 0.5f * (m[0][0] + m[1][1]), half = 0.5f * (m[0][0] - m[1][1]);
  return std::max(mean - std::hypot(half, m[0][1]), 0.0f);
}

// Two texels per corner, in the layout of CharacterModel::corners; uv_from_tangents is not needed, because the
// texture coordinates themselves are displaced.
std::vector<glm::vec4> cornersWith(const MeshTopology& topology, const std::vector<glm::vec2>& uvs) {
  std::vector<glm::vec4> table;
  render::resizeToRows(table, 6ull * topology.faceCount(), glm::vec4(0));
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec2& uv = uvs[topology.face_uvs[face][corner]];
      table[2 * (3 * face + corner)] = {uv.x, uv.y, static_cast<float>(topology.face_vertices[face][corner]), 0};
    }
  return table;
}

// Renders each member's appearance alone on the common mesh, with displaced texture coordinates, as the player shades
// it. Pictures of one view share their depth, so that only visible surface is shaded. Topology is borrowed.
class LookDrawer {
 public:
  LookDrawer(gpu::Device& device, const MeshTopology& topology, render::CharacterModel model, gpu::Program depth)
      : device_(device), topology_(topology), model_(std::move(model)), depth_(std::move(depth)) {
    options_.align = render::Align::None;
  }

  // Sets a frame: vertex positions, and for every member of the motion class one texture coordinate per UV of the
  // topology.
  Status setFrame(const Positions& positions, const std::vector<std::vector<glm::vec2>>& member_uvs) {
    model_.setPositions(device_, positions);
    while (corners_.size() < member_uvs.size()) {
      FOURDVT_ASSIGN(auto corners, render::makeTable(device_, gpu::PixelFormat::RGBA32F, 6ull * model_.face_count,
                                                     "alignment corners"));
      corners_.push_back(std::move(corners));
    }
    corners_.resize(member_uvs.size());
    for (size_t member = 0; member < corners_.size(); ++member)
      render::uploadTable(device_, corners_[member], cornersWith(topology_, member_uvs[member]));
    return {};
  }

  // [member] CV_8UC4, premultiplied.
  Result<std::vector<cv::Mat>> draw(const PinholeCamera& camera, const render::Appearance& appearance,
                                    const render::PictureTextures& picture) {
    FOURDVT_TRY(resize(camera.width, camera.height));
    const render::View view = render::viewFromCamera(camera, {model_.length_scale, model_.length_scale});
    drawDepth(view);
    std::vector<cv::Mat> looks;
    for (size_t member = 0; member < corners_.size(); ++member) {
      FOURDVT_TRY(drawMember(member, view, appearance, picture));
      cv::Mat rgba(camera.height, camera.width, CV_8UC4);
      FOURDVT_TRY(device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8,
                                     {.width = camera.width, .height = camera.height}, rgba.data));
      looks.push_back(rgba);
    }
    return looks;
  }

 private:
  // Renders the common depth first, so that hidden surface is never shaded: the members' pictures differ only in
  // their texture coordinates. The colours of this pass are overwritten.
  void drawDepth(const render::View& view) {
    device_.beginPass({.target = target_.id(), .clear_color = true, .clear_depth = true, .label = "look depth"});
    device_.draw(
        {.program = depth_.id(),
         .textures = {{"u_corners", model_.corners.id()}, {"u_positions_normals", model_.positions_normals.id()}},
         .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_world)},
         .vertex_count = static_cast<int>(3 * model_.face_count),
         .depth_test = true,
         .depth_write = true,
         .cull = model_.closed_surface ? gpu::Cull::Back : gpu::Cull::None});
    device_.endPass();
  }

  Status drawMember(size_t member, const render::View& view, const render::Appearance& appearance,
                    const render::PictureTextures& picture) {
    std::vector<float> weights(corners_.size(), 0.0f);
    weights[member] = 1;
    const render::Look look{&appearance, &picture, weights};
    FOURDVT_TRY(render::checkFigure({&model_, std::span(&look, 1)}, options_.recipe));
    const render::Part part{&look, {{static_cast<int>(member), 1.0f}}};
    const render::CharacterView unmoved{view.clip_from_world, view.eye_in_world};  // the character stands at the origin
    FOURDVT_TRY(layered_.prepare(device_, model_, part, unmoved, options_));
    device_.beginPass({.target = target_.id(), .label = "look"});
    std::swap(model_.corners, corners_[member]);
    layered_.draw(device_, model_, part, unmoved, options_);
    std::swap(model_.corners, corners_[member]);
    device_.endPass();
    return {};
  }

  Status resize(int width, int height) {
    if (color_ && width == width_ && height == height_) return {};
    target_.reset();
    FOURDVT_ASSIGN(color_, gpu::makeTexture(device_, {.width = width, .height = height, .label = "alignment look"}));
    FOURDVT_ASSIGN(target_,
                   gpu::makeTarget(device_, {.colors = {color_.id()}, .own_depth = true, .label = "alignment look"}));
    width_ = width;
    height_ = height;
    return {};
  }

  gpu::Device& device_;
  const MeshTopology& topology_;
  render::CharacterModel model_;
  gpu::Program depth_;
  render::LayeredPass layered_;
  render::DrawOptions options_;
  std::vector<gpu::Texture> corners_;  // [member], with the member's texture coordinates
  gpu::Texture color_;
  gpu::Target target_;
  int width_ = 0, height_ = 0;
};

}  // namespace

class SurfaceAligner::Views {
 public:
  Views(const package::BaseMesh& mesh, const AlignmentOptions& options, std::unique_ptr<LookDrawer> drawer)
      : mesh_(mesh),
        options_(options),
        frames_(computeSurfaceFrames(mesh.topology, mesh.positions)),
        smoother_(mesh.topology, mesh.positions, frames_, options.smoothness),
        drawer_(std::move(drawer)) {}

  Result<AlignedFrame> align(const Positions& middle, const render::Appearance& appearance,
                             const render::PictureTextures& picture) {
    const size_t vertices = mesh_.topology.vertex_count, others = size_t(appearance.member_count) - 1;
    if (middle.size() != vertices)
      return Error{ErrorId::InvalidArgument, "alignment: positions are not those of the character's mesh"};
    if (!appearance.ready()) return Error{ErrorId::InvalidArgument, "alignment: the appearance has no frame or layout"};
    AlignedFrame result{std::vector<glm::vec2>(others * vertices, glm::vec2(0)), {}};
    const int texels = int(std::lround(appearance.layer_rects_uv[0].z * appearance.picture_size.x));
    if (!limits_ || limits_->size() != texels) limits_.emplace(mesh_.topology, frames_, texels, options_.gutter_texels);
    const Shown shown{middle, appearance, picture};
    for (const int divisor : kRounds) FOURDVT_TRY(refine(shown, divisor, result));
    FOURDVT_TRY(compareDetail(shown, result));
    return result;
  }

 private:
  using Field = std::vector<glm::vec2>;                                // [vertex]
  using ViewObservations = std::vector<std::vector<FlowObservation>>;  // [other]: observations of one view
  struct Shown {                                                       // arguments of align
    const Positions& middle;
    const render::Appearance& appearance;
    const render::PictureTextures& picture;
  };
  struct Pose {  // per-mesh data of every view
    const Positions& positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::mat2x3> tangents;
  };

  // Texture coordinates per member, displaced to the place where all members meet at equal weights.
  std::vector<Field> movedUvs(const Field& displacement) const {
    const size_t vertices = mesh_.topology.vertex_count, members = displacement.size() / vertices + 1;
    Field mean(vertices, glm::vec2(0));
    for (size_t i = 0; i < displacement.size(); ++i) mean[i % vertices] += displacement[i] / float(members);
    std::vector<Field> uvs(members, mesh_.topology.uvs);
    for (size_t member = 0; member < members; ++member)
      for (uint32_t face = 0; face < mesh_.topology.faceCount(); ++face)
        for (int corner = 0; corner < 3; ++corner) {
          const uint32_t vertex = mesh_.topology.face_vertices[face][corner];
          const uint32_t uv = mesh_.topology.face_uvs[face][corner];
          const glm::vec2 own = member ? displacement[(member - 1) * vertices + vertex] : glm::vec2(0);
          uvs[member][uv] = mesh_.topology.uvs[uv] + frames_.uv_from_tangents[3 * face + corner] * (own - mean[vertex]);
        }
    return uvs;
  }

  // One round: renders with the displacement so far, adds the residual flow, and smooths the sum.
  Status refine(const Shown& shown, int divisor, AlignedFrame& result) {
    const size_t vertices = mesh_.topology.vertex_count, others = result.displacement_m.size() / vertices;
    FOURDVT_ASSIGN(auto seen, observe(shown, divisor, result.displacement_m));
    result.confidence.clear();
    for (size_t other = 0; other < others; ++other) {
      std::vector<std::vector<FlowObservation>> views;
      for (ViewObservations& view : seen) views.push_back(std::move(view[other]));
      const auto begin = result.displacement_m.begin() + ptrdiff_t(other * vertices);
      const auto estimates = liftFlow(views, Field(begin, begin + ptrdiff_t(vertices)));
      Field field = smoother_.solve(estimates);
      bound(field);
      std::copy(field.begin(), field.end(), begin);
      for (const VertexEstimate& estimate : estimates) {
        const float information = minInformation(estimate.information);
        result.confidence.push_back(information / (information + kHalfConfidence));
      }
    }
    return {};
  }

  // [view]; each view is measured while the next ones are rendered.
  Result<std::vector<ViewObservations>> observe(const Shown& shown, int divisor, const Field& displacement) {
    FOURDVT_TRY(drawer_->setFrame(shown.middle, movedUvs(displacement)));
    const Pose pose = poseOf(shown.middle);
    const float reach = kInteriorReach_px / float(divisor);
    InOrder<ViewObservations> views(options_.jobs);
    for (const PinholeCamera& camera :
         alignmentCameras(shown.middle, options_.views, options_.picture_height / divisor)) {
      FOURDVT_ASSIGN(auto looks, drawer_->draw(camera, shown.appearance, shown.picture));
      views.add(
          [this, &pose, camera, looks = std::move(looks), reach] { return observeView(pose, camera, looks, reach); });
    }
    return views.take();
  }

  Pose poseOf(const Positions& positions) const {
    Pose pose{positions, {}, poseTangents(mesh_.topology, mesh_.positions, frames_, positions)};
    computeVertexNormals(mesh_.topology.face_vertices, positions.data(), positions.size(), pose.normals);
    return pose;
  }

  ViewObservations observeView(const Pose& pose, const PinholeCamera& camera, const std::vector<cv::Mat>& looks,
                               float reach) const {
    const cv::Mat depth = drawDepth(camera, mesh_.topology, pose.positions);
    const cv::Mat interior = interiorOf(depth, reach);
    const auto seen = seenVertices(camera, depth, pose.positions, pose.normals, pose.tangents);
    const cv::Mat first = evenLuma(looks[0]);
    ViewObservations observations;
    for (size_t member = 1; member < looks.size(); ++member)
      observations.push_back(observeFlow(first, evenLuma(looks[member]), interior, seen));
    return observations;
  }

  Status compareDetail(const Shown& shown, AlignedFrame& result) {
    FOURDVT_TRY(drawer_->setFrame(shown.middle, movedUvs(result.displacement_m)));
    InOrder<DetailEnergy> views(options_.jobs);
    for (const PinholeCamera& camera : alignmentCameras(shown.middle, kDetailViews, options_.picture_height)) {
      FOURDVT_ASSIGN(auto looks, drawer_->draw(camera, shown.appearance, shown.picture));
      views.add([looks = std::move(looks)] { return detailEnergy(looks); });
    }
    result.detail_correlation = detailCorrelation(views.take());
    return {};
  }

  void bound(Field& field) const {
    for (glm::vec2& d : field) {
      const float length = glm::length(d), most = float(options_.max_displacement_m);
      if (length > most) d *= most / length;
    }
    limits_->cut(field);
  }

  const package::BaseMesh& mesh_;
  const AlignmentOptions options_;
  const SurfaceFrames frames_;
  TangentSmoother smoother_;
  std::unique_ptr<LookDrawer> drawer_;
  std::optional<ChartLimits> limits_;  // for the latest texture size
};

SurfaceAligner::SurfaceAligner(std::unique_ptr<Views> views) : views_(std::move(views)) {}
SurfaceAligner::~SurfaceAligner() = default;

Result<AlignedFrame> SurfaceAligner::align(const Positions& middle, const render::Appearance& appearance,
                                           const render::PictureTextures& picture) {
  return views_->align(middle, appearance, picture);
}

Result<std::unique_ptr<SurfaceAligner>> SurfaceAligner::create(gpu::Device& device, const package::Character& character,
                                                               const package::BaseMesh& mesh,
                                                               const AlignmentOptions& options) {
  FOURDVT_TRY(whyNot(options, mesh));
  FOURDVT_ASSIGN(auto model, render::CharacterModel::create(device, character, mesh));
  FOURDVT_ASSIGN(auto depth, render::makeEmbeddedProgram(device, "mesh_picture.vert", "bake_depth.frag"));
  auto drawer = std::make_unique<LookDrawer>(device, mesh.topology, std::move(model), std::move(depth));
  auto views = std::make_unique<Views>(mesh, options, std::move(drawer));
  return std::unique_ptr<SurfaceAligner>(new SurfaceAligner(std::move(views)));
}

namespace {

constexpr float kSteadiness = 0.25f;     // pull towards each neighbour in time, relative to confidence 0..1
constexpr float kMinConfidence = 1e-3f;  // lower bound, so that a vertex that is never certain keeps its mean

// One tridiagonal system: confidence_t (x_t − d_t) + kSteadiness Σ (x_t − x_neighbour) = 0.
class TimeLine {
 public:
  TimeLine(size_t count, bool loop) : diagonal_(count), right_(count), loop_(loop && count > 2) {}

  void set(size_t t, float confidence, const glm::vec2& value) {
    const size_t last = diagonal_.size() - 1;
    const float neighbours = loop_ ? 2.0f : float(t > 0) + float(t < last);
    diagonal_[t] = confidence + kMinConfidence + kSteadiness * neighbours;
    right_[t] = (confidence + kMinConfidence) * value;
  }

  const std::vector<glm::vec2>& solve() {
    if (!loop_) {
      sweep(diagonal_, right_);
      return right_;
    }
    // Cyclic: Sherman–Morrison with u = (γ, 0, …, −s), v = (1, 0, …, −s/γ); γ = −diagonal_0.
    const size_t last = diagonal_.size() - 1;
    const float gamma = -diagonal_[0], ratio = -kSteadiness / gamma;
    std::vector<glm::vec2> correction(diagonal_.size(), glm::vec2(0));
    correction[0] = glm::vec2(gamma);
    correction[last] = glm::vec2(-kSteadiness);
    diagonal_[0] -= gamma;
    diagonal_[last] += kSteadiness * ratio;
    sweep(diagonal_, right_);
    sweep(diagonal_, correction);
    const glm::vec2 share = (right_[0] + ratio * right_[last]) / (1.0f + correction[0] + ratio * correction[last]);
    for (size_t t = 0; t <= last; ++t) right_[t] -= share * correction[t];
    return right_;
  }

 private:
  // Solves with off-diagonals −kSteadiness, in place.
  static void sweep(const std::vector<float>& diagonal, std::vector<glm::vec2>& values) {
    std::vector<float> upper(diagonal.size(), 0);
    float pivot = diagonal[0];
    values[0] /= pivot;
    for (size_t t = 1; t < diagonal.size(); ++t) {
      upper[t - 1] = -kSteadiness / pivot;
      pivot = diagonal[t] + kSteadiness * upper[t - 1];
      values[t] = (values[t] + kSteadiness * values[t - 1]) / pivot;
    }
    for (size_t t = diagonal.size() - 1; t-- > 0;) values[t] -= upper[t] * values[t + 1];
  }

  std::vector<float> diagonal_;
  std::vector<glm::vec2> right_;
  bool loop_ = false;
};

}  // namespace

void steadyAlignment(std::vector<AlignedFrame>& frames, bool loop) {
  if (frames.size() < 2) return;
  const size_t count = frames[0].displacement_m.size();
  for (size_t i = 0; i < count; ++i) {
    TimeLine line(frames.size(), loop);
    for (size_t t = 0; t < frames.size(); ++t) line.set(t, frames[t].confidence[i], frames[t].displacement_m[i]);
    const std::vector<glm::vec2>& steady = line.solve();
    for (size_t t = 0; t < frames.size(); ++t) frames[t].displacement_m[i] = steady[t];
  }
}

}  // namespace fourdvt::bake
