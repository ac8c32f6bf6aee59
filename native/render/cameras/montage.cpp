// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/montage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "render/cameras/figure_cameras.h"
#include "render/fields/surface_fields.h"
#include "render/table.h"

namespace fourdvt::render {
namespace {

enum class Kind { Blend, Holoportation, Seams, Weights };
struct KindOf {
  std::string_view name;
  Kind kind;
  const char* fragment;
};
constexpr KindOf kKinds[] = {{"montage4d", Kind::Blend, "camera_montage.frag"},
                             {"holoportation", Kind::Holoportation, "camera_holoportation.frag"},
                             {"montage4d-seams", Kind::Seams, "camera_montage_look.frag"},
                             {"montage4d-weights", Kind::Weights, "camera_montage_look.frag"}};

constexpr float kEverywhere = -1;  // vote reach without a limit
constexpr float kLeaving = 5;      // settling times for which a camera is still blended after the view has left it

// Inspection colours, one per slot.
constexpr glm::vec3 kSlotColors[kFieldSlots] = {{0.90f, 0.15f, 0.15f}, {0.15f, 0.65f, 0.20f}, {0.15f, 0.30f, 0.95f},
                                                {0.95f, 0.75f, 0.10f}, {0.75f, 0.20f, 0.85f}, {0.10f, 0.75f, 0.80f},
                                                {0.95f, 0.50f, 0.10f}, {0.45f, 0.45f, 0.50f}};

// Two textures with a texel per vertex, or smaller, filled by a pass.
struct TablePair {
  gpu::Texture low, high;
  gpu::Target target;
  int rows = 0;
  FieldTables tables() const { return {low.id(), high.id()}; }
};

Status makePair(gpu::Device& device, gpu::PixelFormat format, int width, int rows, TablePair& out) {
  if (rows <= out.rows) return {};
  out = {};
  const gpu::TextureDesc desc{.format = format, .width = width, .height = rows, .label = "montage"};
  FOURDVT_ASSIGN(out.low, gpu::makeTexture(device, desc));
  FOURDVT_ASSIGN(out.high, gpu::makeTexture(device, desc));
  FOURDVT_ASSIGN(out.target, gpu::makeTarget(device, {.colors = {out.low.id(), out.high.id()}, .label = "montage"}));
  out.rows = rows;
  return {};
}

void runPass(gpu::Device& device, const TablePair& to, int width, int rows, const gpu::Draw& draw) {
  device.beginPass({.target = to.target.id(), .width = width, .height = rows, .label = "montage"});
  device.draw(draw);
  device.endPass();
}

// Flags per slot, 1 for slots of the given cameras; low and high half.
struct SlotFlags {
  glm::vec4 low{0}, high{0};
};
SlotFlags flagsOf(const FieldCameras& slots, std::span<const size_t> cameras) {
  SlotFlags flags;
  for (int slot = 0; slot < kFieldSlots; ++slot)
    if (std::find(cameras.begin(), cameras.end(), slots[size_t(slot)]) != cameras.end())
      (slot < 4 ? flags.low : flags.high)[slot % 4] = 1;
  return flags;
}

struct Figure4D {
  FigureCameras cameras;
  SurfaceFields fields;
  FieldCameras slots = kNoFieldCameras;
  std::array<float, kFieldSlots> left_s{};  // time since the view left the slot's camera
  std::vector<size_t> chosen;               // cameras chosen for the view
  std::vector<size_t> in_slots;             // up to the last slot in use; kNoCamera: empty slot
  TablePair seen, row_sums, sums, aims;
  // Cache key of the visibility tables.
  uint64_t geometry = 0, picture = 0;
  FieldCameras seen_slots = kNoFieldCameras;
  MethodOptions seen_options;
};

bool sameVisibility(const MethodOptions& a, const MethodOptions& b) {
  return a.visibility == b.visibility && a.min_cosine == b.min_cosine &&
         a.montage.discontinuity_px == b.montage.discontinuity_px &&
         a.montage.vote_threshold == b.montage.vote_threshold && a.montage.vote_reach_px == b.montage.vote_reach_px &&
         a.montage.clamp_m == b.montage.clamp_m;
}

class Montage final : public Method {
 public:
  explicit Montage(const KindOf& kind) : kind_(kind.kind), fragment_(kind.fragment) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.push_back(std::make_unique<Figure4D>());
    Figure4D& figure = *figures_[number];
    FOURDVT_TRY(chooseCameras(device, model, look, view, options, figure));
    FOURDVT_TRY(updateSeen(device, model, look, options, figure));
    if (kind_ == Kind::Blend || kind_ == Kind::Weights)
      FOURDVT_TRY(makeFields(device, model, look, view, options, figure));
    FOURDVT_ASSIGN(const gpu::ProgramId made,
                   program(device, "camera_surface.vert", fragment_, drawDefines(figure, look, options)));
    static_cast<void>(made);
    return {};
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    const Figure4D& figure = *figures_[number];
    gpu::Draw draw = surfaceDraw(model, programs_.at(std::string(fragment_) + drawDefines(figure, look, options)).id());
    const FieldTables tables = kind_ == Kind::Seams           ? figure.fields.distances()
                               : kind_ == Kind::Holoportation ? figure.seen.tables()
                                                              : figure.fields.fields();
    draw.textures.push_back({"u_field_low", tables.low});
    draw.textures.push_back({"u_field_high", tables.high});
    draw.uniforms.push_back(gpu::uniform("u_exponent", options.montage.exponent));
    draw.uniforms.push_back(gpu::uniform("u_discontinuity", options.montage.discontinuity_px));
    glm::vec4 colors[kFieldSlots];
    const SlotFlags shown = flagsOf(figure.slots, figure.cameras.chosen());
    for (int slot = 0; slot < kFieldSlots; ++slot)
      colors[slot] = glm::vec4(kSlotColors[slot], (slot < 4 ? shown.low : shown.high)[slot % 4]);
    draw.uniforms.push_back(gpu::uniform("u_slot_colors", std::span<const glm::vec4>(colors)));
    const CameraUniforms cameras = uniforms(figure, look, options);
    cameras.addTo(draw);
    figure.cameras.addTo(draw, view, options);
    device.draw(draw);
  }

 private:
  // Keeps a camera that left the view until its fields have faded, while there is room.
  Status chooseCameras(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                       const CharacterView& view, const MethodOptions& options, Figure4D& figure) const {
    std::vector<size_t> leaving;
    if (kind_ == Kind::Blend || kind_ == Kind::Weights)
      for (size_t slot = 0; slot < figure.slots.size(); ++slot)
        if (figure.slots[slot] != kNoCamera && figure.slots[slot] < look.cameras.size() &&
            figure.left_s[slot] + options.elapsed_s < kLeaving * options.montage.settling_s)
          leaving.push_back(figure.slots[slot]);
    FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options, kFieldSlots, leaving));
    const std::vector<size_t>& active = figure.cameras.chosen();
    const size_t nearest = figure.cameras.nearestCount();
    figure.chosen.assign(active.begin(), active.begin() + nearest);
    figure.slots = keepSlots(figure.slots, active);
    figure.in_slots.clear();
    for (size_t slot = 0; slot < figure.slots.size(); ++slot) {
      const size_t camera = figure.slots[slot];
      const bool is_chosen = std::find(figure.chosen.begin(), figure.chosen.end(), camera) != figure.chosen.end();
      figure.left_s[slot] = is_chosen ? 0 : figure.left_s[slot] + options.elapsed_s;
      if (camera == kNoCamera) continue;
      figure.in_slots.resize(slot, kNoCamera);
      figure.in_slots.push_back(camera);
    }
    return {};
  }

  Status updateSeen(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                    const MethodOptions& options, Figure4D& figure) {
    if (figure.geometry == model.geometry_serial && figure.picture == look.serial &&
        figure.seen_slots == figure.slots && sameVisibility(figure.seen_options, options))
      return {};
    const bool only_votes = kind_ == Kind::Holoportation;
    const int rows = static_cast<int>(tableRows(model.vertex_count)), vertex_count = int(model.vertex_count);
    const int room = static_cast<int>(tableRows(model.maxVertices()));
    FOURDVT_TRY(
        makePair(device, gpu::PixelFormat::RGBA8, CharacterModel::kTableWidth, std::max(room, rows), figure.seen));
    FOURDVT_ASSIGN(const gpu::ProgramId seen,
                   program(device, "camera_fullscreen.vert", "camera_montage_seen.frag",
                           CameraUniforms::defines(figure.in_slots.size(), picturesOf(look)) +
                               (only_votes ? "VOTES_ONLY\n" : "")));
    const SlotFlags used = flagsOf(figure.slots, figure.cameras.chosen());
    const float vote_reach = only_votes ? kEverywhere : options.montage.vote_reach_px;
    gpu::Draw draw{.program = seen,
                   .textures = {{"u_positions_normals", model.positions_normals.id()}},
                   .uniforms = {gpu::uniform("u_vertex_count", vertex_count), gpu::uniform("u_used_low", used.low),
                                gpu::uniform("u_used_high", used.high),
                                gpu::uniform("u_discontinuity", options.montage.discontinuity_px),
                                gpu::uniform("u_vote_threshold", options.montage.vote_threshold),
                                gpu::uniform("u_vote_reach", vote_reach)},
                   .vertex_count = 3};
    const CameraUniforms cameras = uniforms(figure, look, options);
    cameras.addTo(draw);
    runPass(device, figure.seen, CharacterModel::kTableWidth, rows, draw);
    if (!only_votes) {
      FOURDVT_TRY(countSeen(device, rows, figure));
      FOURDVT_TRY(figure.fields.updateDistances(device, model, figure.seen.tables(),
                                                model.length_scale * options.montage.clamp_m));
    }
    figure.geometry = model.geometry_serial;
    figure.picture = look.serial;
    figure.seen_slots = figure.slots;
    figure.seen_options = options;
    return {};
  }

  Status countSeen(gpu::Device& device, int rows, Figure4D& figure) {
    FOURDVT_TRY(makePair(device, gpu::PixelFormat::RGBA16F, 1, figure.seen.rows, figure.row_sums));
    FOURDVT_TRY(makePair(device, gpu::PixelFormat::RGBA16F, 1, 1, figure.sums));
    FOURDVT_ASSIGN(const gpu::ProgramId count,
                   program(device, "camera_fullscreen.vert", "camera_montage_count.frag", ""));
    const auto sum = [&](const TablePair& from, const TablePair& to, int to_rows) {
      runPass(device, to, 1, to_rows,
              {.program = count,
               .textures = {{"u_before_low", from.low.id()}, {"u_before_high", from.high.id()}},
               .uniforms = {gpu::uniform("u_rows", rows)},
               .vertex_count = 3});
    };
    sum(figure.seen, figure.row_sums, rows);
    sum(figure.row_sums, figure.sums, 1);
    return {};
  }

  Status makeFields(gpu::Device& device, const CharacterModel& model, const CameraLook& look, const CharacterView& view,
                    const MethodOptions& options, Figure4D& figure) {
    FOURDVT_TRY(
        makePair(device, gpu::PixelFormat::RGBA16F, CharacterModel::kTableWidth, figure.seen.rows, figure.aims));
    FOURDVT_ASSIGN(const gpu::ProgramId aims, program(device, "camera_fullscreen.vert", "camera_montage_aims.frag",
                                                      "CAMERAS " + std::to_string(figure.in_slots.size()) + "\n"));
    const int vertex_count = static_cast<int>(model.vertex_count);
    const SlotFlags chosen = flagsOf(figure.slots, figure.chosen);
    std::vector<glm::vec4> centres;
    for (size_t c : figure.in_slots)
      centres.push_back(c == kNoCamera ? glm::vec4(0) : glm::vec4(glm::vec3(look.cameras[c].centreInWorld()), 0));
    const FieldTables seen = figure.seen.tables(), distances = figure.fields.distances(), counts = figure.sums.tables();
    runPass(device, figure.aims, CharacterModel::kTableWidth, static_cast<int>(tableRows(model.vertex_count)),
            {.program = aims,
             .textures = {{"u_positions_normals", model.positions_normals.id()},
                          {"u_seen_low", seen.low},
                          {"u_seen_high", seen.high},
                          {"u_distances_low", distances.low},
                          {"u_distances_high", distances.high},
                          {"u_counts_low", counts.low},
                          {"u_counts_high", counts.high}},
             .uniforms = {gpu::uniform("u_vertex_count", vertex_count),
                          gpu::uniform("u_centres", std::span<const glm::vec4>(centres)),
                          gpu::uniform("u_eye", view.eye_in_character),
                          gpu::uniform("u_exponent", options.montage.exponent),
                          gpu::uniform("u_view_exponent", options.montage.view_exponent),
                          gpu::uniform("u_chosen_low", chosen.low), gpu::uniform("u_chosen_high", chosen.high)},
             .vertex_count = 3});
    return figure.fields.follow(device, model, figure.aims.tables(), figure.slots, options.elapsed_s,
                                options.montage.settling_s);
  }

  CameraUniforms uniforms(const Figure4D& figure, const CameraLook& look, const MethodOptions& options) const {
    return CameraUniforms(look.cameras, figure.in_slots, figure.cameras.maps(), picturesOf(look), options.min_cosine,
                          figure.cameras.lengthScale());
  }

  std::string drawDefines(const Figure4D& figure, const CameraLook& look, const MethodOptions& options) const {
    return CameraUniforms::defines(figure.in_slots.size(), picturesOf(look)) + "FIELDS\n" +
           (options.unseen == Unseen::Neighbourhood ? "FILLED\n" : "") + (kind_ == Kind::Seams ? "SEAMS\n" : "");
  }

  Result<gpu::ProgramId> program(gpu::Device& device, const char* vertex, const char* fragment,
                                 const std::string& defines) {
    gpu::Program& made = programs_[std::string(fragment) + defines];
    if (!made) {
      FOURDVT_ASSIGN(made, makeCameraProgram(device, vertex, fragment, defines));
    }
    return made.id();
  }

  const Kind kind_;
  const char* const fragment_;
  std::vector<std::unique_ptr<Figure4D>> figures_;  // indexed by figure
  std::map<std::string, gpu::Program> programs_;    // keyed by fragment shader and defines
};

}  // namespace

Result<std::unique_ptr<Method>> makeMontage(gpu::Device& device, std::string_view name) {
  for (const KindOf& kind : kKinds) {
    if (kind.name != name) continue;
    if (kind.kind != Kind::Holoportation && !device.caps().half_float_targets)
      return Error{ErrorId::Unsupported,
                   std::string(name) + " draws into half-float textures, which this GPU cannot; use holoportation"};
    return std::unique_ptr<Method>(std::make_unique<Montage>(kind));
  }
  return std::unique_ptr<Method>();
}

}  // namespace fourdvt::render
