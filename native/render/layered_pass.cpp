// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

bool isAligned(const Part& part, const DrawOptions& options) {
  return options.align == Align::Baked && part.look->appearance->aligned && part.members.size() > 1;
}

std::vector<gpu::TextureBinding> bindings(const CharacterModel& model, const Part& part, bool aligned) {
  const Appearance& appearance = *part.look->appearance;
  std::vector<gpu::TextureBinding> list = {{"u_corners", model.corners.id()},
                                           {"u_positions_normals", model.positions_normals.id()},
                                           {"u_vertex_masks", appearance.vertex_masks.id()},
                                           {"u_labels", appearance.labels.id()}};
  if (aligned) list.push_back({"u_alignment", appearance.alignment.id()});
  addPicture(list, *part.look->picture);
  return list;
}

// Layer rectangles, member after member.
std::vector<glm::vec4> layerRects(const Part& part) {
  const Appearance& appearance = *part.look->appearance;
  std::vector<glm::vec4> rects;
  for (const WeightedMember& member : part.members) {
    const auto first = appearance.layer_rects_uv.begin() + member.member * appearance.layer_count;
    rects.insert(rects.end(), first, first + appearance.layer_count);
  }
  return rects;
}

// Contrast gain of uncorrelated detail, multiplied onto the weighted mean of the looks. Variance-preserving blend for
// looks of correlation c: 1 / sqrt(sum w² + c (1 - sum w²)) - 1. Eric Heitz, Fabrice Neyret: High-Performance
// By-Example Noise using a Histogram-Preserving Blending Operator. Proceedings of the ACM on Computer Graphics and
// Interactive Techniques 1(2) (High-Performance Graphics), 2018.
float lostDetail(const Part& part) {
  float squares = 0;
  for (const WeightedMember& member : part.members) squares += member.weight * member.weight;
  return 1 / std::sqrt(squares + part.look->appearance->detail_correlation * (1 - squares)) - 1;
}

LayeredVariant variantOf(const CharacterModel& model, const Part& part, const DrawOptions& options) {
  return {model.layer_count, static_cast<int>(part.members.size()), part.look->picture->kind, options.recipe.debug,
          isAligned(part, options)};
}

std::string definesOf(const LayeredVariant& variant) {
  std::string defines = "LAYERS " + std::to_string(variant.layers) + "\n";
  defines += "MEMBERS " + std::to_string(variant.members) + "\n";
  defines += "MAX_CAMERAS " + std::to_string(package::kMaxCameras) + "\n";
  defines += definesOf(variant.kind);
  if (variant.aligned) defines += "ALIGNED\n";
  if (variant.debug != DebugView::None)
    defines += "DEBUG_VIEW " + std::to_string(static_cast<int>(variant.debug)) + "\n";
  return defines;
}

}  // namespace

Status LayeredPass::prepare(gpu::Device& device, const LayeredVariant& variant) {
  if (has(variant)) return {};
  FOURDVT_ASSIGN(auto program, makeProgram(device, variant, definesOf(variant)));
  programs_.emplace(variant, std::move(program));
  return {};
}

Result<gpu::Program> LayeredPass::makeProgram(gpu::Device& device, const LayeredVariant&,
                                              const std::string& defines) const {
  return makeEmbeddedProgram(device, "layered.vert", "layered.frag", defines);
}

Status LayeredPass::prepare(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView&,
                            const DrawOptions& options) {
  return prepare(device, variantOf(model, part, options));
}

void LayeredPass::draw(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView& view,
                       const DrawOptions& options) const {
  const int vertex_count = static_cast<int>(model.vertex_count), face_count = static_cast<int>(model.face_count);
  const std::vector<glm::vec4> rects = layerRects(part);
  std::vector<glm::vec4> members;
  for (const WeightedMember& member : part.members) members.emplace_back(member.member, member.weight, 0, 0);
  const glm::vec2 exponents(options.recipe.facing_exponent, options.recipe.view_exponent);
  const float detail = options.recipe.keep_detail ? lostDetail(part) : 0.0f;
  gpu::Draw draw{
      .program = programs_.at(variantOf(model, part, options)).id(),
      .textures = bindings(model, part, isAligned(part, options)),
      .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                   gpu::uniform("u_eye", view.eye_in_character),
                   gpu::uniform("u_camera_centres", std::span<const glm::vec4>(model.camera_centres)),
                   gpu::uniform("u_exponents", exponents),
                   gpu::uniform("u_members", std::span<const glm::vec4>(members)), gpu::uniform("u_detail", detail),
                   gpu::uniform("u_vertex_count", vertex_count), gpu::uniform("u_face_count", face_count),
                   gpu::uniform("u_layer_rects", std::span<const glm::vec4>(rects)),
                   gpu::uniform("u_picture_size", part.look->appearance->picture_size),
                   gpu::uniform("u_debug_layer", std::min(options.recipe.debug_layer, model.layer_count - 1))},
      .vertex_count = 3 * face_count,
      .indices = part.look->appearance->corners.id(),
      .depth_test = true,
      .depth_write = true,
      .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None};
  addTo(draw, part);
  device.draw(draw);
}

}  // namespace fourdvt::render
