// SPDX-License-Identifier: Apache-2.0
#include "render/styles/styles.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace fourdvt::render {

std::string_view styleShaderText(std::string_view name);  // embedded; see CMakeLists.txt

namespace {

constexpr float kGrainsPerHeight = 900;   // stipples per height of the view, limited by pixels
constexpr float kReachOfHeight = 0.006f;  // radius of the noise, in heights of the view

// Returns the rotation from the character's frame to the viewer's (M4D Eq. 6): x right, y up, z towards the viewer.
glm::mat4 viewerFromCharacter(const CharacterView& view) {
  const glm::mat4& m = view.clip_from_character;
  const glm::vec3 ahead = viewAxis(m);
  const glm::vec3 upwards(m[0][1], m[1][1],
                          m[2][1]);  // up, plus a part along `ahead` where the picture's middle is off the axis
  const glm::vec3 up = glm::normalize(upwards - glm::dot(upwards, ahead) * ahead);
  return glm::mat4(glm::transpose(glm::mat3(glm::cross(ahead, up), up, -ahead)));
}

glm::mat4 turnBack(float turn_rad) {
  const float c = std::cos(turn_rad), s = std::sin(turn_rad);
  glm::mat4 m(1);
  m[0] = {c, 0, -s, 0};
  m[2] = {s, 0, c, 0};
  return m;
}

class Style final : public FigureStyle {
 public:
  Status set(gpu::Device& device, const StyleOptions& options) {
    for (int surface = 0; surface < 2; ++surface) {
      gpu::Program& program = programs_[int(options.kind)][surface];
      if (program) continue;
      const char* fragment = options.kind == StyleKind::Sketch ? "style_sketch.frag" : "style_relit.frag";
      const std::string defines =
          "TABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + (surface ? "\nINDEXED\n" : "\n");
      FOURDVT_ASSIGN(program, gpu::makeProgram(device, std::string("style_mesh.vert + ") + fragment,
                                               styleShaderText("style_mesh.vert"), styleShaderText(fragment), defines));
    }
    options_ = options;
    return {};
  }

  void draw(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
            const CharacterView& view) const override {
    const bool surface = !model.corners;
    const glm::mat4 light_from_character = turnBack(options_.light_turn_rad) * viewerFromCharacter(view);
    glm::vec4 light[9];
    for (size_t i = 0; i < 9; ++i) light[i] = glm::vec4(options_.light[i], 0);
    const int grain = std::max(1, int(std::lround(float(view.height) / kGrainsPerHeight)));
    const float reach = std::max(1.5f, kReachOfHeight * float(view.height));
    gpu::Draw draw{.program = programs_[int(options_.kind)][surface].id(),
                   .textures = {{"u_positions_normals", model.positions_normals.id()}, {"u_shown", picture}},
                   .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                                gpu::uniform("u_light_from_character", light_from_character),
                                gpu::uniform("u_light", std::span<const glm::vec4>(light)),
                                gpu::uniform("u_strength", options_.strength), gpu::uniform("u_grain", grain),
                                gpu::uniform("u_reach", reach), gpu::uniform("u_origin", view.origin)},
                   .vertex_count = static_cast<int>(3 * model.face_count),
                   .depth_test = true,
                   .depth_write = true,
                   .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None};
    if (surface)
      draw.textures.push_back({"u_corner_vertices", model.corner_vertices.id()});
    else
      draw.textures.push_back({"u_corners", model.corners.id()});
    device.draw(draw);
  }

 private:
  StyleOptions options_;
  gpu::Program programs_[2][2];  // [kind]; layered characters, surfaces
};

}  // namespace

Status setStyle(gpu::Device& device, Recipe& recipe, const StyleOptions& options) {
  if (!(options.strength >= 0 && options.strength <= 1))
    return Error{ErrorId::InvalidArgument, "a look's strength must be between 0 and 1"};
  if (FigureStyle* style = recipe.style())
    return static_cast<Style*>(style)->set(device, options);  // FigureStyle has no other subclass
  auto style = std::make_unique<Style>();
  FOURDVT_TRY(style->set(device, options));
  recipe.setStyle(std::move(style));
  return {};
}

}  // namespace fourdvt::render
