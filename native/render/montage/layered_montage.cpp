// SPDX-License-Identifier: Apache-2.0
#include "render/montage/layered_montage.h"

#include <algorithm>
#include <utility>

#include "render/fields/surface_fields.h"
#include "render/table.h"

namespace fourdvt::render {

std::string_view montageShaderText(std::string_view name);  // embedded; see CMakeLists.txt

namespace {

// Tuned on held-out cameras of the sample capture's walk: 24.41 dB / .8145 against 24.38 / .8110 of the plain blend
// with powers 1 and 1, and 24.42 / .8148 of the plain blend with the same powers (algorithms/montage.md); M4D's own
// aims, independent of surface orientation, with (0, 2) and 5 cm: 24.33 / .8131.
constexpr glm::vec2 kPowers(2, 4);     // exponents of the aims: surface and ray, view and ray
constexpr int kVaryingsOfDevice = 15;  // maximum guaranteed by WebGL2
// Fields that the last kKept prepares did not use are dropped once there are more than kMaxFields. No picture has that
// many parts, all of which are prepared before the first is drawn.
constexpr size_t kMaxFields = 16;
constexpr uint64_t kKept = 256;

// Slot tables, low and high, and their programs.
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

// Fields of one member of an appearance.
struct MemberFields {
  SurfaceFields fields;
  SlotTables seen, aims;
  gpu::TextureId mesh = 0;  // CharacterModel::corners of the tables' mesh; 0: no tables
  FieldCameras cameras = kNoFieldCameras;
  uint64_t geometry_serial = 0;  // geometry of the distances
  uint64_t used = 0;             // last prepare that used the fields
  // Uniforms, borrowed until the draw.
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

// Key of a part's fields across pictures: looks are rebuilt for every picture, and with Align::Flow the members of one
// look are separate parts.
using FieldsKey = std::pair<const Appearance*, int>;  // appearance, member

FieldsKey fieldsKeyOf(const Part& part) { return {part.look->appearance, part.members[heaviestOf(part)].member}; }

// Returns the cameras nearest to the view in angle, seen from the middle of the surface.
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
    MemberFields& own = members_[fieldsKeyOf(part)];
    if (own.mesh != model.corners.id()) {
      own = {};
      FOURDVT_TRY(makeTables(device, gpu::PixelFormat::RGBA8, model.vertex_count, "cameras of vertices", own.seen));
      FOURDVT_TRY(makeTables(device, gpu::PixelFormat::RGBA16F, model.vertex_count, "aims of fields", own.aims));
      own.mesh = model.corners.id();
    }
    const size_t drawn = heaviestOf(part);
    own.drawn_member = static_cast<int>(drawn);
    own.share = std::clamp(2 * part.members[drawn].weight - 1, 0.0f, 1.0f);
    own.used = ++clock_;
    FOURDVT_TRY(updateFields(device, model, part, view, options, own));
    if (members_.size() > kMaxFields)
      std::erase_if(members_, [&](const auto& entry) { return entry.second.used + kKept < clock_; });
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
    const MemberFields& own = members_.at(fieldsKeyOf(part));
    const FieldTables fields = own.fields.fields();
    draw.textures.push_back({"u_fields_low", fields.low});
    draw.textures.push_back({"u_fields_high", fields.high});
    draw.uniforms.push_back(gpu::uniform("u_slot_cameras", std::span<const glm::vec4>(own.slot_cameras)));
    draw.uniforms.push_back(gpu::uniform("u_field_member", own.drawn_member));
    draw.uniforms.push_back(gpu::uniform("u_field_share", own.share));
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
                      const DrawOptions& options, MemberFields& own) {
    FOURDVT_TRY(makePass(device, "montage_seen.frag", seen_program_));
    FOURDVT_TRY(makePass(device, "montage_aims.frag", aims_program_));
    const int member = part.members[size_t(own.drawn_member)].member;
    const FieldCameras cameras = keepSlots(own.cameras, nearestCameras(model, view));
    for (size_t slot = 0; slot < kFieldSlots; ++slot) {
      const bool held = cameras[slot] != kNoCamera;
      own.slot_cameras[slot / 4][int(slot % 4)] = held ? float(cameras[slot]) : -1;
      own.slot_centres[slot] = held ? model.camera_centres[cameras[slot]] : glm::vec4(0);
    }
    const int vertices = static_cast<int>(model.vertex_count), first = member * vertices;
    const auto pass = [&](const SlotTables& to, const gpu::Program& program, FieldTables distances) {
      gpu::Draw draw{.program = program.id(),
                     .textures = {{"u_vertex_masks", part.look->appearance->vertex_masks.id()},
                                  {"u_positions_normals", model.positions_normals.id()}},
                     .uniforms = {gpu::uniform("u_first", first), gpu::uniform("u_vertex_count", vertices),
                                  gpu::uniform("u_slot_cameras", std::span<const glm::vec4>(own.slot_cameras)),
                                  gpu::uniform("u_slot_centres", std::span<const glm::vec4>(own.slot_centres)),
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
    // Labels of a frame arrive with its mesh, so geometry_serial covers both.
    if (own.geometry_serial != model.geometry_serial || own.cameras != cameras) {
      pass(own.seen, seen_program_, {});
      FOURDVT_TRY(own.fields.updateDistances(device, model, own.seen.tables(), model.length_scale * kLayeredClamp_m,
                                             kLayeredSteps));
      own.geometry_serial = model.geometry_serial;
      own.cameras = cameras;
    }
    pass(own.aims, aims_program_, own.fields.distances());
    return own.fields.follow(device, model, own.aims.tables(), own.cameras, options.method.elapsed_s,
                             options.method.montage.settling_s);
  }

  gpu::Program seen_program_, aims_program_;
  std::map<FieldsKey, MemberFields> members_;
  uint64_t clock_ = 0;  // counts prepares
};

}  // namespace

Result<std::shared_ptr<LayeredPass>> makeLayeredMontage(gpu::Device& device) {
  if (!device.caps().half_float_targets)
    return Error{ErrorId::Unsupported, "montage4d needs half-float render targets, which this GPU does not have"};
  return std::shared_ptr<LayeredPass>(std::make_shared<LayeredMontage>());
}

}  // namespace fourdvt::render
