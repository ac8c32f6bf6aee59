// SPDX-License-Identifier: Apache-2.0
#include "tools/render_arguments.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "base/text.h"
#include "capture/capture.h"
#include "platform/files.h"
#include "render/cameras/camera_method.h"
#include "tools/commands.h"

namespace fourdvt::tools {
namespace {

using render::MethodGroup;

bool isMethod(const std::string& name, MethodGroup group) {
  const std::vector<std::string> names = render::cameraMethodNames(group);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(MethodGroup group) { return joined(render::cameraMethodNames(group)); }

std::string methodMeaning() {
  return "for characters from cameras: " + listed(MethodGroup::Textured) + " (default: the character's own, else " +
         render::cameraMethodNames(MethodGroup::Textured).front() +
         "); to inspect them: " + listed(MethodGroup::Inspection) + "; for characters from layers: layered, montage4d";
}

constexpr int kMaxSide = 8192;

// Reads a premultiplied background from RRGGBB, "room" or "none"; the room is drawn over a background of none.
void readBackground(Args& args, const std::string& name, RenderArguments& a) {
  const std::string text = args.text(name, "none");
  a.room = text == "room";
  if (text == "none" || a.room) return;
  const auto isHexadecimal = [](unsigned char c) { return std::isxdigit(c) != 0; };
  if (text.size() != 6 || !std::all_of(text.begin(), text.end(), isHexadecimal))
    return args.refuse(name, "RRGGBB, room or none");
  const unsigned long value = std::stoul(text, nullptr, 16);
  a.recipe.background = glm::vec4(value >> 16 & 255, value >> 8 & 255, value & 255, 255) / 255.0f;
}

bool texturesFromCameras(const RenderArguments& a) {
  return a.method_name.empty() || isMethod(a.method_name, MethodGroup::Textured);
}

void readMethod(Args& args, const std::string& name, RenderArguments& a) {
  a.method_name = args.text(name);
  if (!texturesFromCameras(a) && a.method_name != "layered" && !isMethod(a.method_name, MethodGroup::Inspection))
    args.refuse(name, listed(MethodGroup::Textured) + ", " + listed(MethodGroup::Inspection) + " or layered");
}

Options motionOptions(RenderArguments& a) {
  return {
      {"-o PICTURE", text(a.output), ".png (with transparency), .jpg or .webp"},
      {"--turntable MOVIE", text(a.turntable), "H.264 .mp4 instead of a picture"},
      {"--seconds S", number(a.seconds, 0.1, 3600), "length of a movie (default: whole loops, at least 8 s)"},
      {"--sequence NAME", text(a.sequence), "sequence (default: the first)"},
      {"--frame N", number(a.frame, 0, 100'000'000), "frame, from 0 (default 0)"},
      renditionOption(a.rendition),
      {"--class NAME", text(a.motion_class), "motion class instead of a sequence"},
      {"--phase U", number(a.phase, 0, 1), "position in the motion, 0 to 1, instead of a frame"},
      {"--parameter NAME=VALUE", parsedList(a.parameters, edge::parseParameter, "NAME=NUMBER"),
       "parameter of the class, e.g. speed_mps=2.1; separate several by commas"},
      {"--align HOW",
       choice(a.align,
              {{"none", edge::AlignMethod::None},
               {"baked", edge::AlignMethod::Baked},
               {"flow-gpu", edge::AlignMethod::FlowGpu},
               {"flow-dis", edge::AlignMethod::FlowDis},
               {"flow-opencv", edge::AlignMethod::FlowOpencv},
               {"flow-opencv-dis", edge::AlignMethod::FlowOpencvDis}},
              Wording::Or),
       "alignment of a class's motions: none, baked (default), flow-gpu, flow-dis, flow-opencv, flow-opencv-dis"},
      {"--sweep NAME=A:B", parsed(a.sweep, edge::parseSweep, "NAME=FROM:TO"),
       "movie in which the parameter goes from A to B (default 8 s)"},
      {"--play STATE@S,...", parsedList(a.cues, edge::parseCue, "STATE@SECONDS"),
       "movie that goes to STATE of the motion graph at S seconds; STATE without @S: at the start"},
      {"--travel", flag(a.travel), "with --sweep, --play: the character moves over the ground"},
      {"--follow", flag(a.follow), "the camera follows the (first) character"},
      {"--fps N", number(a.fps, 1, 240), "frames per second of --sweep and --play (default 25)"},
      {"--scene SCENE", text(a.scene), "scene.json: characters with a background, camera track and occluders"},
  };
}

Options viewOptions(ViewArguments& view) {
  return {
      {"--azimuth DEG", number(view.azimuth_deg, -3600, 3600),
       "0 is in front of the performer, positive towards +X (default 25)"},
      {"--elevation DEG", number(view.elevation_deg, -90, 90), "positive is from above (default 8)"},
      {"--distance M", number(view.distance_m, 0.01, 1e4),
       "metres from the centre of the bounds (default: the whole character fits)"},
      {"--fov DEG", number(view.vertical_fov_deg, 1, 150), "vertical field of view (default 30)"},
      {"--camera NAME", text(view.camera), "a capture camera instead of an orbit position"},
      {"--cameras FOLDER", text(view.cameras_folder),
       "folder of cameras.txt and images.txt with the camera of --camera"},
      {"--size WxH", size(view.size, kMaxSide), "pixels (default 720x960, or the camera's)"},
  };
}

Options lookOptions(RenderArguments& a) {
  using render::DebugView, render::StyleKind;
  return {
      {"--background RRGGBB", [&a](Args& args, const std::string& name) { readBackground(args, name, a); },
       "colour, or room (the character's own), or none (default; black in movies)"},
      {"--debug WHAT",
       choice(a.recipe.debug,
              {{"labels", DebugView::Labels},
               {"layers", DebugView::Layer},
               {"weights", DebugView::Weights},
               {"normals", DebugView::Normals}},
              Wording::Or),
       "labels, layers (side by side), weights or normals"},
      {"--no-shadow", flag(a.recipe.ground_shadow, false), "draw no ground shadow"},
      {"--look WHAT", choice(a.look.kind, {{"sketch", StyleKind::Sketch}, {"relit", StyleKind::Relit}}, Wording::Or),
       "sketch (grey dots) or relit (new light); default: as filmed"},
      {"--look-strength X", number(a.look.strength, 0, 1), "strength of the look, 0 to 1 (default 1)"},
      {"--light PICTURE", text(a.look.light_picture),
       "relit: equirectangular picture of the light; its centre is straight ahead of the view"},
      {"--light-turn DEG", number(a.look.light_turn_deg, -3600, 3600),
       "relit: rotation of the light, clockwise seen from above (default 0)"},
  };
}

Options methodOptions(RenderArguments& a) {
  using render::Visibility;
  return {
      {"--method WHAT", [&a](Args& args, const std::string& name) { readMethod(args, name, a); }, methodMeaning()},
      {"--capture CAPTURE", text(a.fvvr.capture_folder),
       "with --method fvvr: texture a captured frame from all camera videos of the folder that CHARACTER was baked "
       "from, without a shadow"},
      {"--closest M", number(a.closest, 1, package::kMaxCameras),
       "use the M cameras closest to the view (default 4; with --capture: all)"},
      {"--visibility WHAT",
       choice(a.method.visibility,
              {{"none", Visibility::None},
               {"plain", Visibility::Plain},
               {"offset", Visibility::Offset},
               {"fattened", Visibility::Fattened}},
              Wording::Or),
       "visibility test: offset (default) and fattened leave a margin around occluders, plain uses depth maps without "
       "a margin, none textures through occluders"},
  };
}

void checkLook(Args& args, const LookArguments& look) {
  if (look.kind != render::StyleKind::Relit && (args.has("--light") || args.has("--light-turn")))
    args.complain("--light and --light-turn belong to --look relit");
  if (!look.kind && args.has("--look-strength")) args.complain("--look-strength belongs to --look");
}

void checkMethod(Args& args, const RenderArguments& a) {
  if (!texturesFromCameras(a) && (args.has("--closest") || args.has("--visibility")))
    args.complain("--closest and --visibility belong to methods that use camera pictures: " +
                  listed(MethodGroup::Textured));
  if (a.fromCapture() && a.method_name != "fvvr") args.complain("--capture belongs to --method fvvr");
  if (!a.fromCapture() && refinesExplicitly(args))
    args.complain("--refine, --refine-cameras and --matte-bias-px belong to --method fvvr --capture");
  if (a.fromCapture() && (!a.turntable.empty() || args.has("--debug")))
    args.complain("--method fvvr --capture is for stills and takes no --debug");
}

void checkMotion(Args& args, const RenderArguments& a) {
  const bool is_scene = !a.scene.empty();
  if (!a.motion_class.empty() && args.has("--sequence")) args.complain("--class and --sequence exclude each other");
  if (a.phase && args.has("--frame")) args.complain("--phase and --frame exclude each other");
  if (a.sweep.has_value() + !a.cues.empty() + is_scene + !a.turntable.empty() + a.fromCapture() > 1)
    args.complain("--sweep, --play, --scene, --turntable and --capture exclude each other");
  if (a.movie() && !a.playing() && !is_scene) args.complain("a movie needs --sweep, --play, --scene or --turntable");
  if (a.playing() && !a.movie() && !a.output.empty())
    args.complain("--sweep and --play make a movie: -o must end in .mp4");
  if (!a.playing() && a.travel) args.complain("--travel belongs to --sweep and --play");
  if (!a.playing() && args.has("--fps")) args.complain("--fps belongs to --sweep and --play");
  if (!a.playing() && !is_scene && a.follow) args.complain("--follow belongs to --sweep, --play and --scene");
  if ((a.playing() || is_scene) && (!a.view.camera.empty() || args.has("--debug")))
    args.complain("--camera and --debug are for stills of one character");
  if (a.playing() && (args.has("--frame") || a.phase))
    args.complain("--sweep and --play take neither --frame nor --phase");
  if (is_scene && (!a.sequence.empty() || !a.parameters.empty() || a.phase))
    args.complain("the scene's file says which state and parameter; give them there");
  if (a.rendition && (is_scene || a.fromCapture()))
    args.complain("--rendition goes with neither --scene nor --capture");
  if (a.fromCapture() && (!a.motion_class.empty() || !a.parameters.empty() || a.phase))
    args.complain("--method fvvr --capture renders captured frames: neither --class nor --parameter nor --phase");
}

void checkOutput(Args& args, const RenderArguments& a) {
  if (a.output.empty() && a.turntable.empty()) args.complain("-o PICTURE or --turntable MOVIE is required");
  if (!a.output.empty() && !a.turntable.empty()) args.complain("-o and --turntable exclude each other");
  const bool orbit = a.view.azimuth_deg || a.view.elevation_deg || a.view.distance_m || a.view.vertical_fov_deg;
  if (orbit && !a.view.camera.empty())
    args.complain("--camera and --azimuth, --elevation, --distance, --fov exclude each other");
  if (!a.view.cameras_folder.empty() && a.view.camera.empty()) args.complain("--cameras needs --camera NAME as well");
  if (!a.turntable.empty() && (!a.view.camera.empty() || args.has("--frame") || a.phase))
    args.complain("--turntable takes neither --camera nor --frame nor --phase");
  const bool movie = a.movie() || !a.turntable.empty();
  if (!movie && args.has("--seconds")) args.complain("--seconds belongs to movies");
  if (!a.turntable.empty() && a.drawsLayersApart()) args.complain("--debug " + args.text("--debug") + " is for stills");
  if (movie && a.view.size && (a.view.size->first % 2 || a.view.size->second % 2))
    args.complain("--size of a movie must be even");
  if (a.room && (!a.scene.empty() || a.fromCapture()))
    args.complain("--background room belongs neither to --scene nor to --method fvvr");
  if (a.look.kind && (a.fromCapture() || args.has("--debug")))
    args.complain("--look goes with neither --capture nor --debug");
  if (a.output.empty()) return;
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (!a.movie() && extension != ".png" && extension != ".jpg" && extension != ".webp")
    args.complain("-o must end in .png, .jpg or .webp, or .mp4 for a movie");
}

}  // namespace

bool RenderArguments::movie() const { return std::filesystem::path(output).extension() == ".mp4"; }

std::optional<int> readRenderCommand(int argc, char** argv, RenderArguments& a) {
  Args args(
      {"render (CHARACTER | --scene SCENE.json) (-o PICTURE | -o MOVIE.mp4 | --turntable MOVIE.mp4) [options]",
       "Draws one frame of a character, seen from an orbit position, a capture camera or a camera of a COLMAP "
       "text model. With --turntable, --sweep, --play or --scene it writes a movie: the camera orbits the "
       "character, a parameter changes, transitions play, or characters are composited with a background, its "
       "camera track and occluders.",
       {&a.character},
       join({motionOptions(a), viewOptions(a.view), lookOptions(a), methodOptions(a), refineOptions(a.fvvr.refine)}),
       "--scene"},
      argc, argv);
  if (!a.motion_class.empty()) a.sequence = a.motion_class;
  if (a.closest) a.method.closest = *a.closest;
  a.chooses_cameras = a.closest || args.has("--visibility");
  checkLook(args, a.look);
  checkMethod(args, a);
  checkMotion(args, a);
  checkOutput(args, a);
  return args.helpOrProblem();
}

Status setLook(const LookArguments& look, gpu::Device& device, render::Recipe& recipe) {
  if (!look.kind) return {};
  render::StyleOptions style{.kind = *look.kind,
                             .strength = look.strength,
                             .light_turn_rad = static_cast<float>(glm::radians(look.light_turn_deg))};
  if (!look.light_picture.empty()) {
    FOURDVT_ASSIGN(const Image picture, platform::readImage(look.light_picture));
    auto light = render::lightFromPicture(picture.pixels, picture.width, picture.height, picture.channels);
    if (!light) return Error{light.error().id, look.light_picture + ": " + light.error().message};
    style.light = light.value();
  }
  return render::setStyle(device, recipe, style);
}

Status checkMethod(const RenderArguments& a, const package::Character& character) {
  const auto invalid = [&](const std::string& what) {
    return Error{ErrorId::InvalidArgument, a.character + ": " + what};
  };
  if (character.appearance == package::AppearanceKind::Layers) {
    const bool fits = a.method_name.empty() || a.method_name == "layered" || a.method_name == "montage4d";
    if (!a.fromCapture() && (!fits || a.chooses_cameras))
      return invalid(
          "is a layered character; --method montage4d goes with it, or fvvr with --capture CAPTURE, which has the "
          "videos");
    return {};
  }
  if (a.method_name == "layered") return invalid("is a character from cameras and has no layers; leave --method out");
  if (a.recipe.debug != render::DebugView::None)
    return invalid("is a character from cameras; --debug belongs to layered ones");
  return {};
}

OrbitView chooseOrbit(const RenderArguments& a, const package::Character& character, int width, int height) {
  OrbitView view = defaultOrbit(character.bounds, double(width) / height);
  if (a.view.azimuth_deg) view.azimuth_deg = *a.view.azimuth_deg;
  if (a.view.elevation_deg) view.elevation_deg = *a.view.elevation_deg;
  if (a.view.distance_m) view.distance_m = *a.view.distance_m;
  if (a.view.vertical_fov_deg) view.vertical_fov_deg = *a.view.vertical_fov_deg;
  return view;
}

Result<PinholeCamera> chooseCamera(const RenderArguments& a, const package::Character& character) {
  if (a.view.camera.empty()) {
    const auto [width, height] = a.view.size.value_or(std::pair{720, 960});
    return cameraFromOrbit(chooseOrbit(a, character, width, height), width, height);
  }
  std::vector<PinholeCamera> cameras = character.cameras;
  if (!a.view.cameras_folder.empty()) {
    FOURDVT_ASSIGN(auto read, capture::readColmapCameras(a.view.cameras_folder));
    cameras.clear();
    for (const auto& camera : read) cameras.push_back(camera.pinhole);
  }
  std::string known;
  for (const PinholeCamera& camera : cameras) {
    if (camera.name == a.view.camera)
      return a.view.size ? scaledCamera(camera, a.view.size->first, a.view.size->second) : camera;
    known += (known.empty() ? "" : ", ") + camera.name;
  }
  return Error{ErrorId::InvalidArgument, (a.view.cameras_folder.empty() ? a.character : a.view.cameras_folder) +
                                             ": has no camera \"" + a.view.camera + "\"; it has " + known};
}

}  // namespace fourdvt::tools
