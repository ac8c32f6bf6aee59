// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <cstring>

#include "bake/texels/picture_crop.h"
#include "capture/capture.h"
#include "edge/scene_file.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "platform/video_writer.h"
#include "render/cameras/fvvr.h"
#include "tools/commands.h"
#include "tools/render_arguments.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

Image besideEachOther(const std::vector<Image>& pictures) {
  const Image& first = pictures.front();
  Image out(first.width * static_cast<int>(pictures.size()), first.height, first.channels);
  for (size_t i = 0; i < pictures.size(); ++i)
    for (int y = 0; y < first.height; ++y)
      std::memcpy(out.at(static_cast<int>(i) * first.width, y), pictures[i].at(0, y),
                  static_cast<size_t>(first.width) * first.channels);
  return out;
}

// Renders a captured frame by free-viewpoint video rendering (algorithms/cameras.md).
Status renderFvvr(CharacterSession& session, const RenderArguments& arguments, const std::string& sequence) {
  FOURDVT_ASSIGN(auto view, chooseCamera(arguments, session.character()));
  // Takes all sequences, so that the mesh is refined as in a bake of all of them.
  const bool refines = arguments.fvvr.refine.any();
  const std::vector<std::string> only = refines ? std::vector<std::string>() : std::vector{sequence};
  auto capture = mattes::openCapture(arguments.fvvr.capture_folder, videoOpener(), only);
  if (!capture.ok()) return capture.error();
  const capture::CaptureSequence* found = capture.value().find(sequence);
  if (!found)
    return Error{ErrorId::InvalidArgument, arguments.fvvr.capture_folder + ": has no sequence \"" + sequence + "\""};
  const capture::CaptureSequence& filmed = *found;
  if (static_cast<uint32_t>(arguments.frame) >= filmed.frame_count)
    return Error{ErrorId::InvalidArgument, arguments.fvvr.capture_folder + ": " + sequence + " has frames 0 to " +
                                               std::to_string(filmed.frame_count - 1)};
  if (refines) {
    const bool tty = rewritesProgress();
    const std::atomic<bool>* stop = listenForStop();
    const auto refinement = refine::refineCapture(capture.value(), videoOpener(), arguments.fvvr.refine,
                                                  [&](const std::string& what, double) {
                                                    if (tty) std::fprintf(stderr, "\r\033[Krefine %s", what.c_str());
                                                    return !*stop;
                                                  });
    if (tty) std::fputs("\r\033[K", stderr);
    if (!refinement) return refinement.error();
    refine::applyRefinement(refinement.value(), capture.value());
  }
  FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture.value(), filmed, videoOpener(), arguments.frame));
  FOURDVT_ASSIGN(auto frame, reader->next());
  for (Image& picture : frame.pictures) bake::replaceEdgeColours(picture);
  std::vector<PinholeCamera> cameras;
  for (const auto& camera : capture.value().cameras) cameras.push_back(camera.pinhole);
  FOURDVT_ASSIGN(auto fvvr, render::Fvvr::create(*session.gpu.device, cameras, capture.value().topology,
                                                 {.visibility = arguments.method.visibility}));
  const render::FvvrOptions options{.closest = arguments.closest.value_or(0),
                                    .background = arguments.recipe.background};
  const render::View seen = render::viewFromCamera(view);
  FOURDVT_TRY(fvvr->setFrame(frame.positions, frame.pictures, fvvr->camerasOf(seen, options)));
  FOURDVT_ASSIGN(auto picture, fvvr->renderStill(seen, options));
  return platform::writeImage(arguments.output, picture, 95);
}

// Opens the character's room; nullopt unless requested.
Result<std::optional<render::Scene>> wantedRoom(CharacterSession& session, const RenderArguments& arguments) {
  if (!arguments.room) return std::optional<render::Scene>();
  FOURDVT_ASSIGN(auto room,
                 edge::openRoom(*session.gpu.device, manifestPath(arguments.character), session.character()));
  return std::optional(std::move(room));
}

render::LengthScales lengthScales(const CharacterSession& session) {
  const auto scale = static_cast<float>(session.character().length_scale);
  return {scale, scale};
}

Status renderStill(CharacterSession& session, const RenderArguments& arguments, const package::Sequence& sequence) {
  FOURDVT_ASSIGN(auto camera, chooseCamera(arguments, session.character()));
  const auto phase = static_cast<uint32_t>(std::lround(arguments.phase.value_or(0) * sequence.frame_count));
  const uint32_t frame = arguments.phase ? phase % sequence.frame_count : static_cast<uint32_t>(arguments.frame);
  FOURDVT_TRY(session.player->showFrame(sequence.name, frame));
  FOURDVT_ASSIGN(const auto room, wantedRoom(session, arguments));
  const render::LengthScales scales = lengthScales(session);
  render::RecipeOptions recipe = arguments.recipe;
  std::vector<Image> pictures;
  const int count = arguments.drawsLayersApart() ? session.character().layer_count : 1;
  for (int layer = 0; layer < count; ++layer) {
    recipe.debug_layer = layer;
    FOURDVT_ASSIGN(auto picture, session.player->renderStill(render::viewFromCamera(camera, scales), recipe,
                                                             room ? &*room : nullptr));
    pictures.push_back(std::move(picture));
  }
  return platform::writeImage(arguments.output, besideEachOther(pictures), 95);
}

// Loops the sequence during one camera orbit, starting and ending at the still's azimuth.
Status renderTurntable(CharacterSession& session, const RenderArguments& arguments, const package::Sequence& sequence) {
  const auto [width, height] = arguments.view.size.value_or(std::pair{720, 960});
  const double loops = std::ceil(8.0 / sequence.duration_s());
  const double seconds = arguments.seconds > 0 ? arguments.seconds : loops * sequence.duration_s();
  const int frames = std::max(1, static_cast<int>(std::lround(seconds * sequence.fps)));
  FOURDVT_ASSIGN(auto writer, platform::VideoWriter::create(arguments.turntable,
                                                            {.width = width, .height = height, .fps = sequence.fps}));
  FOURDVT_ASSIGN(const auto room, wantedRoom(session, arguments));
  OrbitView view = chooseOrbit(arguments, session.character(), width, height);
  const render::LengthScales scales = lengthScales(session);
  const double start_deg = view.azimuth_deg;
  for (int i = 0; i < frames; ++i) {
    FOURDVT_TRY(session.player->showFrame(sequence.name, static_cast<uint32_t>(i) % sequence.frame_count));
    view.azimuth_deg = start_deg + 360.0 * i / frames;
    FOURDVT_ASSIGN(auto picture,
                   session.player->renderStill(render::viewFromCamera(cameraFromOrbit(view, width, height), scales),
                                               arguments.recipe, room ? &*room : nullptr));
    FOURDVT_TRY(writer->write(picture));
    if (rewritesProgress()) std::fprintf(stderr, "\r\033[K%d of %d frames", i + 1, frames);
  }
  if (rewritesProgress()) std::fputs("\r\033[K", stderr);
  return writer->finish();
}

Status prepareMotion(CharacterSession& session, const RenderArguments& arguments) {
  Player& player = session.player->player();
  FOURDVT_TRY(edge::setParameters(player, arguments.parameters, arguments.character));
  FOURDVT_ASSIGN(auto align, edge::prepareAlign(arguments.align, *session.gpu.device, session.player->recipe()));
  player.setAlign(align);
  player.setMethod(arguments.method);
  if (!arguments.method_name.empty() && arguments.method_name != "layered" && !arguments.fromCapture())
    FOURDVT_TRY(useMethod(session, arguments.method_name));
  return setLook(arguments.look, *session.gpu.device, session.player->recipe());
}

}  // namespace

Result<int> renderCommand(int argc, char** argv) {
  RenderArguments arguments;
  if (const auto code = readRenderCommand(argc, argv, arguments)) return *code;
  if (!arguments.scene.empty() || arguments.playing()) {
    FOURDVT_TRY(arguments.scene.empty() ? renderMotion(arguments) : renderScene(arguments));
    return kOk;
  }
  const auto invalid = [&](const std::string& what) {
    return Error{ErrorId::InvalidArgument, arguments.character + ": " + what};
  };
  FOURDVT_ASSIGN(auto session, openCharacter(arguments.character, arguments.rendition));
  const package::Character& character = session.character();
  FOURDVT_TRY(checkMethod(arguments, character));
  const std::string name = arguments.sequence.empty() ? character.sequences.front().name : arguments.sequence;
  FOURDVT_ASSIGN(const package::Sequence* sequence, edge::findState(character, name, arguments.character));
  if (!arguments.motion_class.empty() && !sequence->isClass())
    return invalid(name + " is a sequence, not a class; use --sequence");
  if (static_cast<uint32_t>(arguments.frame) >= sequence->frame_count)
    return invalid(name + " has frames 0 to " + std::to_string(sequence->frame_count - 1));
  FOURDVT_TRY(prepareMotion(session, arguments));
  FOURDVT_TRY(arguments.fromCapture()       ? renderFvvr(session, arguments, name)
              : arguments.turntable.empty() ? renderStill(session, arguments, *sequence)
                                            : renderTurntable(session, arguments, *sequence));
  detail("wrote %s", (arguments.turntable.empty() ? arguments.output : arguments.turntable).c_str());
  return kOk;
}

}  // namespace fourdvt::tools
