// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>

#include "edge/scene_file.h"
#include "motion/blend.h"
#include "platform/files.h"
#include "platform/video_writer.h"
#include "render/still_target.h"
#include "tools/render_arguments.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

constexpr double kSweep_s = 8, kAfterLastCue_s = 4, kScene_s = 6;
constexpr double kShapeTolerance_px = 2;  // movies have even sizes

// Several playing figures drawn into one picture. Time advances in the steps of advance().
class Ensemble {
 public:
  // `gpu` outlives the ensemble.
  static Result<std::unique_ptr<Ensemble>> create(GpuSession& gpu, edge::AlignMethod align);
  // Opens a character and shows its first frame. Errors: those of opening; InvalidArgument (unknown state or
  // parameter).
  Status add(const edge::ActorOptions& options);
  // Advances playback by this time, and starts the transitions whose cues are due.
  Status advance(double seconds);
  // `scene` may be null.
  Result<Image> draw(const PinholeCamera& camera, const render::Scene* scene, const render::RecipeOptions& recipe);
  render::Recipe& recipe() { return *recipe_; }
  Player& player(size_t actor) { return actors_[actor].character->player(); }

 private:
  struct Actor {
    std::unique_ptr<edge::CharacterPlayer> character;
    std::vector<edge::Cue> cues;  // sorted by time
    size_t next_cue = 0;
  };
  Ensemble(GpuSession& gpu, std::shared_ptr<render::Recipe> recipe, render::Align align)
      : gpu_(gpu), recipe_(std::move(recipe)), align_(align), still_(*gpu.device) {}
  Status followCues(Actor& actor);

  GpuSession& gpu_;
  std::shared_ptr<render::Recipe> recipe_;
  render::Align align_;
  render::StillTarget still_;
  std::vector<Actor> actors_;
  double now_s_ = 0;
};

Result<std::unique_ptr<Ensemble>> Ensemble::create(GpuSession& gpu, edge::AlignMethod align) {
  FOURDVT_ASSIGN(std::shared_ptr<render::Recipe> shared, render::Recipe::create(*gpu.device));
  FOURDVT_ASSIGN(auto prepared, edge::prepareAlign(align, *gpu.device, *shared));
  return std::unique_ptr<Ensemble>(new Ensemble(gpu, std::move(shared), prepared));
}

Status Ensemble::add(const edge::ActorOptions& options) {
  FOURDVT_ASSIGN(auto opened, openCharacterOn(gpu_, options.folder, recipe_, options.rendition));
  Actor actor{std::move(opened), options.cues};
  Player& player = actor.character->player();
  const package::Character& character = *player.character();
  const std::string state = options.state.empty() ? character.sequences.front().name : options.state;
  for (const edge::Cue& cue : options.cues)
    if (auto found = edge::findState(character, cue.state, options.folder); !found.ok()) return found.error();
  if (auto found = edge::findState(character, state, options.folder); !found.ok()) return found.error();
  std::stable_sort(actor.cues.begin(), actor.cues.end(),
                   [](const edge::Cue& a, const edge::Cue& b) { return a.at_s < b.at_s; });
  FOURDVT_TRY(edge::setParameters(player, options.parameters, options.folder));
  FOURDVT_TRY(actor.character->showFrame(state, 0));
  player.setPlacement(options.placement);
  player.setTravel(options.travel);
  player.setAlign(align_);
  player.play();
  actors_.push_back(std::move(actor));
  return {};
}

Status Ensemble::followCues(Actor& actor) {
  while (actor.next_cue < actor.cues.size() && actor.cues[actor.next_cue].at_s <= now_s_ + 1e-9)
    FOURDVT_TRY(actor.character->player().goTo(actor.cues[actor.next_cue++].state));
  return {};
}

Status Ensemble::advance(double seconds) {
  for (Actor& actor : actors_) {
    FOURDVT_TRY(followCues(actor));
    FOURDVT_TRY(actor.character->advance(seconds));
  }
  now_s_ += seconds;
  return {};
}

Result<Image> Ensemble::draw(const PinholeCamera& camera, const render::Scene* scene,
                             const render::RecipeOptions& recipe) {
  std::vector<render::Figure> figures;
  for (const Actor& actor : actors_) {
    FOURDVT_ASSIGN(auto figure, actor.character->player().figure());
    figures.push_back(figure);
  }
  const render::View view = render::viewFromCamera(camera, render::lengthScalesOf(figures));
  return still_.render(view, [&](gpu::TargetId target) {
    return recipe_->draw(figures, scene, view, {recipe, align_}, target);
  });
}

// Camera of frame i; called in order, after the ensemble has advanced to it.
using CameraOf = std::function<PinholeCamera(int frame)>;

// Orbits round the character's first position, or follows the character on request.
CameraOf orbitCamera(const RenderArguments& arguments, Player& player, int width, int height) {
  const OrbitView orbit = chooseOrbit(arguments, *player.character(), width, height);
  const motion::Placement start = player.placement();
  const bool follow = arguments.follow;
  return [=, &player](int) {
    OrbitView view = orbit;
    const glm::vec2 at = (follow ? player.placement() : start).ground_m;
    view.target_in_world += glm::dvec3(at.x, 0, at.y);
    return cameraFromOrbit(view, width, height);
  };
}

struct Show {
  Ensemble& ensemble;
  CameraOf camera;
  double fps;
  int frames;
  std::function<Status(int frame)> prepare;  // called before frame i is drawn
  const render::Scene* scene = nullptr;
};

Result<Image> drawFrame(const Show& show, int frame, const render::RecipeOptions& recipe) {
  if (frame > 0) FOURDVT_TRY(show.ensemble.advance(1 / show.fps));
  FOURDVT_TRY(show.prepare(frame));
  return show.ensemble.draw(show.camera(frame), show.scene, recipe);
}

Status writeMovie(const Show& show, const RenderArguments& arguments) {
  std::unique_ptr<platform::VideoWriter> writer;
  for (int i = 0; i < show.frames; ++i) {
    FOURDVT_ASSIGN(auto picture, drawFrame(show, i, arguments.recipe));
    if (!writer) {
      FOURDVT_ASSIGN(
          writer, platform::VideoWriter::create(arguments.output,
                                                {.width = picture.width, .height = picture.height, .fps = show.fps}));
    }
    FOURDVT_TRY(writer->write(picture));
    if (rewritesProgress()) std::fprintf(stderr, "\r\033[K%d of %d frames", i + 1, show.frames);
  }
  if (rewritesProgress()) std::fputs("\r\033[K", stderr);
  return writer->finish();
}

// Writes frame `arguments.frame` of the show.
Status writePicture(const Show& show, const RenderArguments& arguments) {
  for (int i = 0; i < arguments.frame; ++i) {
    if (i > 0) FOURDVT_TRY(show.ensemble.advance(1 / show.fps));
    FOURDVT_TRY(show.prepare(i));
  }
  FOURDVT_ASSIGN(const Image picture, drawFrame(show, arguments.frame, arguments.recipe));
  return platform::writeImage(arguments.output, picture, 95);
}

int frameCount(double seconds, double fps) { return std::max(1, static_cast<int>(std::lround(seconds * fps))); }

// Background by frame; holds the last picture after a video's end.
class Background {
 public:
  static Result<Background> open(gpu::Device& device, const std::string& path) {
    Background out(device, path);
    if (path.empty()) return out;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      return Error{ErrorId::FileMissing, path + ": there is no such file; correct \"background\" in the scene"};
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension == ".jpg" || extension == ".jpeg" || extension == ".png" || extension == ".webp") {
      FOURDVT_ASSIGN(auto picture, platform::readImage(path));
      FOURDVT_TRY(out.upload(picture));
    } else {
      FOURDVT_ASSIGN(out.video_, videoOpener()(path, 3));
      FOURDVT_TRY(out.step());
      if (!out.texture_) return Error{ErrorId::VideoInvalid, path + ": has no pictures; choose another background"};
    }
    return out;
  }
  Status step() {
    if (!video_) return {};
    FOURDVT_ASSIGN(auto picture, video_->next());
    return picture ? upload(*picture) : Status();
  }
  gpu::TextureId texture() const { return texture_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Background(gpu::Device& device, std::string path) : device_(&device), path_(std::move(path)) {}

  Status upload(const Image& picture) {
    Image rgba(picture.width, picture.height, 4, 255);
    for (size_t i = 0; i < rgba.pixels.size() / 4; ++i)
      for (size_t c = 0; c < 3; ++c) rgba.pixels[4 * i + c] = picture.pixels[picture.channels * i + c];
    if (!texture_ || picture.width != width_ || picture.height != height_) {
      const int largest = device_->caps().max_texture_size;
      if (picture.width > largest || picture.height > largest)
        return Error{ErrorId::InvalidArgument,
                     path_ + ": is larger than " + std::to_string(largest) + " pixels; scale it down"};
      FOURDVT_ASSIGN(texture_, gpu::makeTexture(*device_, {.width = picture.width,
                                                           .height = picture.height,
                                                           .filter = gpu::Filter::Linear,
                                                           .label = "background"}));
      width_ = picture.width;
      height_ = picture.height;
    }
    device_->updateTexture(texture_.id(), {.width = width_, .height = height_}, rgba.pixels.data());
    return {};
  }

  gpu::Device* device_;
  std::string path_;
  std::unique_ptr<VideoSource> video_;
  gpu::Texture texture_;
  int width_ = 0, height_ = 0;
};

Status addMeshes(gpu::Device& device, const std::vector<std::string>& paths, bool occluder_only, render::Scene& scene) {
  for (const std::string& path : paths) {
    FOURDVT_ASSIGN(auto corners, edge::readSceneMesh(path));
    auto mesh = render::makeSceneMesh(device, corners, occluder_only);
    if (!mesh.ok()) return Error{mesh.error().id, path + ": " + mesh.error().message};
    scene.meshes.push_back(mesh.take());
  }
  return {};
}

// Output size: --size, else the scene's, the camera's or the background's; even for movies.
std::pair<int, int> sceneSize(const RenderArguments& arguments, const edge::SceneFile& file,
                              const Background& background) {
  std::pair<int, int> size{720, 960};
  if (background.texture()) size = {background.width(), background.height()};
  if (!file.cameras.empty()) size = {file.cameras[0].width, file.cameras[0].height};
  if (file.size) size = *file.size;
  if (arguments.view.size) size = *arguments.view.size;
  if (!arguments.movie()) return size;
  return {std::max(2, size.first & ~1), std::max(2, size.second & ~1)};
}

// Requires equal aspect ratios: the background is stretched over the output, the character is not.
Status checkShape(const edge::SceneFile& file, int width, int height) {
  for (const PinholeCamera& camera : file.cameras) {
    if (std::abs(double(width) * camera.height / camera.width - height) <= kShapeTolerance_px) continue;
    const auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
    return Error{ErrorId::InvalidArgument, file.path + ": an output of " + size(width, height) +
                                               " pixels has another shape than the camera's picture of " +
                                               size(camera.width, camera.height) +
                                               ", so that the background would not fit; choose a size of that shape"};
  }
  return {};
}

}  // namespace

Status renderMotion(const RenderArguments& arguments) {
  FOURDVT_ASSIGN(auto gpu, openGpu());
  FOURDVT_ASSIGN(auto ensemble, Ensemble::create(gpu, arguments.align));
  FOURDVT_TRY(setLook(arguments.look, *gpu.device, ensemble->recipe()));
  edge::ActorOptions actor{arguments.character, arguments.sequence, arguments.parameters, {}, arguments.travel, {},
                           arguments.rendition};
  actor.cues = arguments.cues;
  if (actor.state.empty() && !actor.cues.empty() && actor.cues[0].at_s == 0) actor.state = actor.cues[0].state;
  const std::optional<edge::Sweep> sweep = arguments.sweep;
  if (sweep) actor.parameters.emplace_back(sweep->parameter, sweep->from);
  FOURDVT_TRY(ensemble->add(actor));
  Player& player = ensemble->player(0);
  if (sweep && motion::findParameter(*player.sequence(), sweep->parameter) < 0)
    return Error{ErrorId::InvalidArgument, arguments.character + ": " + player.sequence()->name + " is no class by " +
                                               sweep->parameter + "; choose one with --class"};
  const double last_cue_s =
      actor.cues.empty()
          ? 0
          : std::max_element(actor.cues.begin(), actor.cues.end(), [](const edge::Cue& a, const edge::Cue& b) {
              return a.at_s < b.at_s;
            })->at_s;
  const double seconds = arguments.seconds > 0 ? arguments.seconds : sweep ? kSweep_s : last_cue_s + kAfterLastCue_s;
  const auto [width, height] = arguments.view.size.value_or(std::pair{720, 960});
  const int frames = frameCount(seconds, arguments.fps);
  const auto sweepTo = [&](int frame) -> Status {
    if (!sweep) return {};
    const double share = frames > 1 ? double(frame) / (frames - 1) : 0;
    return player.setParameter(sweep->parameter, sweep->from + share * (sweep->to - sweep->from), true);
  };
  render::Scene room;
  if (arguments.room) {
    FOURDVT_ASSIGN(room, edge::openRoom(*gpu.device, manifestPath(arguments.character), *player.character()));
  }
  const Show show{*ensemble,     orbitCamera(arguments, player, width, height),
                  arguments.fps, frames,
                  sweepTo,       arguments.room ? &room : nullptr};
  return writeMovie(show, arguments);
}

Status renderScene(const RenderArguments& arguments) {
  FOURDVT_ASSIGN(const edge::SceneFile file, edge::readSceneFile(arguments.scene));
  auto gpu = openGpu();
  if (!gpu.ok()) return gpu.error();
  gpu::Device& device = *gpu.value().device;
  FOURDVT_ASSIGN(auto ensemble, Ensemble::create(gpu.value(), arguments.align));
  FOURDVT_TRY(setLook(arguments.look, device, ensemble->recipe()));
  for (const edge::ActorOptions& actor : file.characters) FOURDVT_TRY(ensemble->add(actor));
  FOURDVT_ASSIGN(auto background, Background::open(device, file.background));
  render::Scene scene;
  scene.background = background.texture();
  scene.ground_y_m = static_cast<float>(file.ground_y_m);
  FOURDVT_TRY(addMeshes(device, file.occluders, true, scene));
  FOURDVT_TRY(addMeshes(device, file.meshes, false, scene));
  const auto [width, height] = sceneSize(arguments, file, background);
  if (background.texture()) FOURDVT_TRY(checkShape(file, width, height));
  const double track_s = file.cameras.size() > 1 ? static_cast<double>(file.cameras.size()) / file.fps : kScene_s;
  const double seconds = arguments.seconds > 0 ? arguments.seconds : file.seconds > 0 ? file.seconds : track_s;
  const int frames = arguments.movie() ? frameCount(seconds, file.fps) : arguments.frame + 1;
  if (file.cameras.size() > 1 && file.cameras.size() < static_cast<size_t>(frames))
    return Error{ErrorId::InvalidArgument, file.path + ": " + std::to_string(frames) + " frames, but only " +
                                               std::to_string(file.cameras.size()) +
                                               " cameras; shorten \"seconds\" or choose one \"camera_name\""};
  CameraOf camera = orbitCamera(arguments, ensemble->player(0), width, height);
  if (!file.cameras.empty())
    camera = [&, w = width, h = height](int frame) {
      return scaledCamera(file.cameras[file.cameras.size() > 1 ? static_cast<size_t>(frame) : 0], w, h);
    };
  const auto next = [&](int frame) -> Status {
    if (frame > 0) FOURDVT_TRY(background.step());
    scene.background = background.texture();
    return {};
  };
  const Show show{*ensemble, camera, file.fps, frames, next, &scene};
  return arguments.movie() ? writeMovie(show, arguments) : writePicture(show, arguments);
}

}  // namespace fourdvt::tools
