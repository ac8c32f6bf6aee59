// SPDX-License-Identifier: Apache-2.0
#include "render/montage/layered_montage.h"

#include <algorithm>

#include "render/fields/surface_fields.h"
#include "render/table.h"

namespace fourdvt::render {

std::string_view montageShaderText(std::string_view name);  // embedded; see CMakeLists.txt

namespace {

// Tuned on the walk of the sample, held-out cameras: 24.41 dB / .8145 against 24.38 / .8110 of the plain blend; M4D's
// own aims, which know no surface, with (0, 2) and 5 cm: 24.33 / .8131.
constexpr float kClamp_m = 0.1f;
constexpr glm::vec2 kPowers(2, 4);     // of the aims: surface and ray, view and ray
constexpr size_t kMostStates = 16;     // looks that have fields at a time
constexpr int kVaryingsOfDevice = 15;  // WebGL2 promises no more

// Both tables of eight slots and what draws them.
struct SlotTables {
  gpu::Texture low, high;
  gpu::Target target;
  FieldTables tables() const { return {low.id(), high.id()}; }
};

Status makeTables(gpu::Device& device, gpu::PixelFormat format, uint32_t vertices, const char* label, SlotTables& out) {
  FOURDVT_ASSIGN(out.low, makeTable(device, format, vertices, label));
  FOURDVT_ASSIGN(out.high, makeTable(device, format, vertices, label));
  FOURDVT_ASSIGN(out.target, gpu::makeTarget(device, {.colors = {out.low.id(), out.high.id()}, .label = label}));
  return {};
}

// The fields of one member of a look.
struct LookFields {
  SurfaceFields fields;
  SlotTables serves, aims;
  gpu::TextureId mesh = 0;  // CharacterModel::corners of the mesh that the tables are for; 0: there are none
  FieldCameras cameras = kNoFieldCameras;
  uint64_t geometry_serial = 0;  // that the distances are of
  int member = -1;
  // Uniforms, which are read when the draw is made.
  glm::vec4 slot_cameras[2], slot_centres[kFieldSlots];
  int drawn_member = 0;
  float share = 0;
};

size_t heaviestOf(const Part& part) {
  size_t heaviest = 0;
  for (size_t i = 1; i < part.members.size(); ++i)
    if (part.members[i].weight > part.members[heaviest].weight) heaviest = i;
  return heaviest;
}

// The cameras nearest to the view in angle, seen from the middle of the surface.
std::vector<size_t> nearestCameras(const CharacterModel& model, const CharacterView& view) {
  const glm::vec3 middle = 0.5f * (model.frame_bounds.min + model.frame_bounds.max);
  const glm::vec3 to_eye = glm::normalize(view.eye_in_character - middle);
  std::vector<size_t> cameras(model.camera_centres.size());
  for (size_t i = 0; i < cameras.size(); ++i) cameras[i] = i;
  const auto nearness = [&](size_t i) {
    return glm::dot(glm::normalize(glm::vec3(model.camera_centres[i]) - middle), to_eye);
  };
  std::sort(cameras.begin(), cameras.end(), [&](size_t a, size_t b) { return nearness(a) > nearness(b); });
  cameras.resize(std::min<size_t>(cameras.size(), kFieldSlots));
  return cameras;
}

class LayeredMontage final : public LayeredPass {
 public:
  Status prepare(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView& view,
                 const DrawOptions& options) override {
    FOURDVT_TRY(LayeredPass::prepare(device, model, part, view, options));
    if (looks_.size() >= kMostStates && !looks_.contains(part.look)) looks_.clear();
    LookFields& look = looks_[part.look];
    const size_t drawn = heaviestOf(part);
    look.drawn_member = static_cast<int>(drawn);
    look.share = std::clamp(2 * part.members[drawn].weight - 1, 0.0f, 1.0f);
    if (look.mesh != model.corners.id()) {
      look = {.drawn_member = look.drawn_member, .share = look.share};
      FOURDVT_TRY(makeTables(device, gpu::PixelFormat::RGBA8, model.vertex_count, "cameras of vertices", look.serves));
      FOURDVT_TRY(makeTables(device, gpu::PixelFormat::RGBA16F, model.vertex_count, "aims of fields", look.aims));
      look.mesh = model.corners.id();
    }
    FOURDVT_TRY(updateFields(device, model, part, view, options, look));
    return {};
  }

 protected:
  Result<gpu::Program> makeProgram(gpu::Device& device, const LayeredVariant& variant,
                                   const std::string& defines) const override {
    const int members = variant.members, layers = variant.layers;
    const int varyings = 2 + 2 * members + (members * layers + 3) / 4 + (layers + 3) / 4;
    if (varyings > kVaryingsOfDevice) return LayeredPass::makeProgram(device, variant, defines);
    return makeOwn(device, "montage_layered.vert", "montage_layered.frag", defines);
  }

  void addTo(gpu::Draw& draw, const Part& part) const override {
    const LookFields& look = looks_.at(part.look);
    const FieldTables fields = look.fields.fields();
    draw.textures.push_back({"u_fields_low", fields.low});
    draw.textures.push_back({"u_fields_high", fields.high});
    draw.uniforms.push_back(gpu::uniform("u_slot_cameras", std::span<const glm::vec4>(look.slot_cameras)));
    draw.uniforms.push_back(gpu::uniform("u_field_member", look.drawn_member));
    draw.uniforms.push_back(gpu::uniform("u_field_share", look.share));
  }

 private:
  static Result<gpu::Program> makeOwn(gpu::Device& device, const char* vertex, const char* fragment,
                                      const std::string& defines) {
    return gpu::makeProgram(device, std::string(vertex) + " + " + fragment, montageShaderText(vertex),
                            montageShaderText(fragment),
                            "TABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + "\n" + defines);
  }
  static Status makePass(gpu::Device& device, const char* fragment, gpu::Program& out) {
    if (out) return {};
    FOURDVT_ASSIGN(out, makeOwn(device, "montage_fullscreen.vert", fragment, ""));
    return {};
  }

  Status updateFields(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView& view,
                      const DrawOptions& options, LookFields& look) {
    FOURDVT_TRY(makePass(device, "montage_serves.frag", serves_program_));
    FOURDVT_TRY(makePass(device, "montage_aims.frag", aims_program_));
    const int member = part.members[size_t(look.drawn_member)].member;
    const FieldCameras cameras = keepSlots(look.cameras, nearestCameras(model, view));
    for (size_t slot = 0; slot < kFieldSlots; ++slot) {
      const bool held = cameras[slot] != kNoCamera;
      look.slot_cameras[slot / 4][int(slot % 4)] = held ? float(cameras[slot]) : -1;
      look.slot_centres[slot] = held ? model.camera_centres[cameras[slot]] : glm::vec4(0);
    }
    const int vertices = static_cast<int>(model.vertex_count), first = member * vertices;
    const auto pass = [&](const SlotTables& to, const gpu::Program& program, FieldTables distances) {
      gpu::Draw draw{.program = program.id(),
                     .textures = {{"u_vertex_masks", part.look->appearance->vertex_masks.id()},
                                  {"u_positions_normals", model.positions_normals.id()}},
                     .uniforms = {gpu::uniform("u_first", first), gpu::uniform("u_vertex_count", vertices),
                                  gpu::uniform("u_slot_cameras", std::span<const glm::vec4>(look.slot_cameras)),
                                  gpu::uniform("u_slot_centres", std::span<const glm::vec4>(look.slot_centres)),
                                  gpu::uniform("u_eye", view.eye_in_character), gpu::uniform("u_powers", kPowers)},
                     .vertex_count = 3};
      if (distances.low) {
        draw.textures.push_back({"u_distances_low", distances.low});
        draw.textures.push_back({"u_distances_high", distances.high});
      }
      device.beginPass({.target = to.target.id(),
                        .width = CharacterModel::kTableWidth,
                        .height = static_cast<int>(tableRows(model.vertex_count)),
                        .label = "layered fields"});
      device.draw(draw);
      device.endPass();
    };
    // A frame's labels come with its mesh.
    if (look.geometry_serial != model.geometry_serial || look.member != member || look.cameras != cameras) {
      pass(look.serves, serves_program_, {});
      FOURDVT_TRY(look.fields.updateDistances(device, model, look.serves.tables(), kClamp_m));
      look.geometry_serial = model.geometry_serial;
      look.member = member;
      look.cameras = cameras;
    }
    pass(look.aims, aims_program_, look.fields.distances());
    return look.fields.follow(device, model, look.aims.tables(), look.cameras, options.method.elapsed_s,
                              options.method.montage.settling_s);
  }

  gpu::Program serves_program_, aims_program_;
  std::map<const Look*, LookFields> looks_;  // callers keep their looks where they are from picture to picture
};

}  // namespace

Result<std::shared_ptr<LayeredPass>> makeLayeredMontage(gpu::Device& device) {
  if (!device.caps().half_float_targets)
    return Error{ErrorId::Unsupported, "montage4d needs half-float render targets, which this GPU does not have"};
  return std::shared_ptr<LayeredPass>(std::make_shared<LayeredMontage>());
}

}  // namespace fourdvt::render
