// SPDX-License-Identifier: Apache-2.0
#include "tools/render_arguments.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "capture/capture.h"
#include "render/cameras/camera_method.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

constexpr std::string_view kVisibility[] = {"none", "plain", "offset", "fattened"};  // as render::Visibility

using render::MethodGroup;

bool isMethod(const std::string& name, MethodGroup group) {
  const std::vector<std::string> names = render::cameraMethodNames(group);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(MethodGroup group) {
  std::string out;
  for (const std::string& name : render::cameraMethodNames(group)) out += (out.empty() ? "" : ", ") + name;
  return out;
}

const std::string& methodMeaning() {
  static const std::string text =
      "for characters from cameras: " + listed(MethodGroup::Textured) + " (default: the character's own, else " +
      render::cameraMethodNames(MethodGroup::Textured).front() +
      "); to inspect them: " + listed(MethodGroup::Inspection) + "; for characters from layers: layered, montage4d";
  return text;
}

constexpr int kMaxSide = 8192;

// Premultiplied background from RRGGBB, "room" or "none"; the room is drawn over a background of none.
glm::vec4 background(Args& args) {
  const std::string text = args.text("--background", "none");
  if (text == "none" || text == "room") return glm::vec4(0);
  unsigned value = 0;
  bool hexadecimal = text.size() == 6;
  for (char c : text) hexadecimal = hexadecimal && std::isxdigit(static_cast<unsigned char>(c));
  if (hexadecimal)
    value = static_cast<unsigned>(std::stoul(text, nullptr, 16));
  else
    args.complain("--background must be RRGGBB, room or none, not \"" + text + "\"");
  return glm::vec4(value >> 16 & 255, value >> 8 & 255, value & 255, 255) / 255.0f;
}

std::string debugView(Args& args, render::RecipeOptions& recipe) {
  const std::string name = args.text("--debug");
  if (name == "labels")
    recipe.debug = render::DebugView::Labels;
  else if (name == "layers")
    recipe.debug = render::DebugView::Layer;
  else if (name == "weights")
    recipe.debug = render::DebugView::Weights;
  else if (name == "normals")
    recipe.debug = render::DebugView::Normals;
  else if (!name.empty())
    args.complain("--debug must be labels, layers, weights or normals, not \"" + name + "\"");
  return name;
}

std::optional<double> optionalNumber(Args& args, const char* name, double low, double high) {
  if (!args.has(name)) return std::nullopt;
  return args.number(name, 0, low, high);
}

void readMethod(Args& args, RenderArguments& a) {
  a.method_name = args.text("--method");
  const bool textured = a.method_name.empty() || isMethod(a.method_name, MethodGroup::Textured);
  if (!textured && a.method_name != "layered" && !isMethod(a.method_name, MethodGroup::Inspection))
    args.complain("--method must be " + listed(MethodGroup::Textured) + ", " + listed(MethodGroup::Inspection) +
                  " or layered, not \"" + a.method_name + "\"");
  a.fvvr.capture_folder = args.text("--capture");
  a.fvvr.wanted = !a.fvvr.capture_folder.empty();
  a.method.closest = a.fvvr.options.closest = args.integer("--closest", 0, 1, package::kMaxCameras);
  if (!args.has("--closest")) a.method.closest = render::MethodOptions().closest;
  const std::string visibility = args.text("--visibility", "offset");
  const auto kind = std::find(std::begin(kVisibility), std::end(kVisibility), visibility);
  if (kind == std::end(kVisibility))
    args.complain("--visibility must be none, plain, offset or fattened, not \"" + visibility + "\"");
  else
    a.method.visibility = a.fvvr.depth_maps.visibility = render::Visibility(kind - std::begin(kVisibility));
  a.fvvr.refine = readRefineOptions(args);
  a.fvvr.options.background = a.recipe.background;
  a.chooses_cameras = args.has("--closest") || args.has("--visibility");
  if (!textured && a.chooses_cameras)
    args.complain("--closest and --visibility belong to methods that use camera pictures: " +
                  listed(MethodGroup::Textured));
  if (a.fvvr.wanted && a.method_name != "fvvr") args.complain("--capture belongs to --method fvvr");
  if (!a.fvvr.wanted && (args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px")))
    args.complain("--refine, --refine-cameras and --matte-bias-px belong to --method fvvr --capture");
  if (a.fvvr.wanted && (!a.turntable.empty() || !a.debug.empty()))
    args.complain("--method fvvr --capture is for stills and takes no --debug");
}

void readMotion(Args& args, RenderArguments& a) {
  if (args.has("--class")) {
    if (args.has("--sequence")) args.complain("--class and --sequence exclude each other");
    a.sequence = args.text("--class");
    a.wants_class = true;
  }
  if (args.has("--phase")) a.phase = args.number("--phase", 0, 0, 1);
  if (a.phase && args.has("--frame")) args.complain("--phase and --frame exclude each other");
  for (const std::string& entry : args.list("--parameter")) {
    const auto parameter = parseParameter(entry);
    if (!parameter) args.complain("--parameter must be NAME=NUMBER, not \"" + entry + "\"");
    if (parameter) a.parameters.push_back(*parameter);
  }
  const std::string align = args.text("--align", "baked");
  if (const auto method = alignMethod(align))
    a.align = *method;
  else
    args.complain(std::string("--align must be ") + kAlignNames + ", not \"" + align + "\"");
  if (args.has("--sweep")) {
    a.sweep = parseSweep(args.text("--sweep"));
    if (!a.sweep) args.complain("--sweep must be NAME=FROM:TO, not \"" + args.text("--sweep") + "\"");
  }
  for (const std::string& entry : args.list("--play")) {
    const auto cue = parseCue(entry);
    if (!cue) args.complain("--play must be STATE@SECONDS, not \"" + entry + "\"");
    if (cue) a.cues.push_back(*cue);
  }
  a.travel = args.has("--travel");
  a.follow = args.has("--follow");
  a.scene = args.text("--scene");
  a.fps = args.number("--fps", 25, 1, 240);
}

void checkMotion(Args& args, const RenderArguments& a) {
  const bool playing = a.sweep || !a.cues.empty();
  if (int(a.sweep.has_value()) + int(!a.cues.empty()) + int(!a.scene.empty()) + int(!a.turntable.empty()) +
          int(a.fvvr.wanted) >
      1)
    args.complain("--sweep, --play, --scene, --turntable and --capture exclude each other");
  if (a.movie() && !playing && a.scene.empty()) args.complain("a movie needs --sweep, --play, --scene or --turntable");
  if (playing && !a.movie() && !a.output.empty()) args.complain("--sweep and --play make a movie: -o must end in .mp4");
  if (!playing && args.has("--travel")) args.complain("--travel belongs to --sweep and --play");
  if (!playing && args.has("--fps")) args.complain("--fps belongs to --sweep and --play");
  if (!playing && a.scene.empty() && a.follow) args.complain("--follow belongs to --sweep, --play and --scene");
  if ((playing || !a.scene.empty()) && (!a.view.camera.empty() || !a.debug.empty()))
    args.complain("--camera and --debug are for stills of one character");
  if (playing && (args.has("--frame") || a.phase)) args.complain("--sweep and --play take neither --frame nor --phase");
  if (!a.scene.empty() && (!a.sequence.empty() || !a.parameters.empty() || a.phase))
    args.complain("the scene's file says which state and parameter; give them there");
  if (a.rendition && (!a.scene.empty() || a.fvvr.wanted))
    args.complain("--rendition goes with neither --scene nor --capture");
  if (a.fvvr.wanted && (a.wants_class || !a.parameters.empty() || a.phase))
    args.complain("--method fvvr --capture renders captured frames: neither --class nor --parameter nor --phase");
}

void checkCombination(Args& args, const RenderArguments& a) {
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
  if (!a.turntable.empty() && (a.debug == "layers" || a.debug == "labels"))
    args.complain("--debug " + a.debug + " is for stills");
  if (movie && a.view.size && (a.view.size->first % 2 || a.view.size->second % 2))
    args.complain("--size of a movie must be even");
  if (a.room && (!a.scene.empty() || a.fvvr.wanted))
    args.complain("--background room belongs neither to --scene nor to --method fvvr");
  if (a.look.style && (a.fvvr.wanted || !a.debug.empty()))
    args.complain("--look goes with neither --capture nor --debug");
  if (a.output.empty()) return;
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (!a.movie() && extension != ".png" && extension != ".jpg" && extension != ".webp")
    args.complain("-o must end in .png, .jpg or .webp, or .mp4 for a movie");
}

}  // namespace

const CommandHelp& renderHelp() {
  static const CommandHelp text{
      "render (CHARACTER | --scene SCENE.json) (-o PICTURE | -o MOVIE.mp4 | --turntable MOVIE.mp4) [options]",
      "Draws one frame of a character, seen from an orbit position, a capture camera or a camera of a COLMAP text "
      "model. With --turntable, --sweep, --play or --scene it writes a movie: the camera orbits the character, a "
      "parameter changes, transitions play, or characters are composited with a background, its camera track and "
      "occluders.",
      {{"-o", "PICTURE", ".png (with transparency), .jpg or .webp"},
       {"--turntable", "MOVIE", "H.264 .mp4 instead of a picture"},
       {"--seconds", "S", "length of a movie (default: whole loops, at least 8 s)"},
       {"--sequence", "NAME", "sequence (default: the first)"},
       {"--frame", "N", "frame, from 0 (default 0)"},
       kRenditionOption,
       {"--class", "NAME", "motion class instead of a sequence"},
       {"--phase", "U", "position in the motion, 0 to 1, instead of a frame"},
       {"--parameter", "NAME=VALUE", "parameter of the class, e.g. speed_mps=2.1; separate several by commas"},
       {"--align", "HOW",
        "alignment of a class's motions: none, baked (default), flow-gpu, flow-dis, flow-opencv, flow-opencv-dis"},
       {"--sweep", "NAME=A:B", "movie in which the parameter goes from A to B (default 8 s)"},
       {"--play", "STATE@S,...",
        "movie that goes to STATE of the motion graph at S seconds; STATE without @S: at the start"},
       {"--travel", nullptr, "with --sweep, --play: the character moves over the ground"},
       {"--follow", nullptr, "the camera follows the (first) character"},
       {"--fps", "N", "frames per second of --sweep and --play (default 25)"},
       {"--scene", "SCENE", "scene.json: characters with a background, camera track and occluders"},
       {"--azimuth", "DEG", "0 is in front of the performer, positive towards +X (default 25)"},
       {"--elevation", "DEG", "positive is from above (default 8)"},
       {"--distance", "M", "metres from the centre of the bounds (default: the whole character fits)"},
       {"--fov", "DEG", "vertical field of view (default 30)"},
       {"--camera", "NAME", "a capture camera instead of an orbit position"},
       {"--cameras", "FOLDER", "folder of cameras.txt and images.txt with the camera of --camera"},
       {"--size", "WxH", "pixels (default 720x960, or the camera's)"},
       {"--background", "RRGGBB", "colour, or room (the character's own), or none (default; black in movies)"},
       {"--debug", "WHAT", "labels, layers (side by side), weights or normals"},
       {"--no-shadow", nullptr, "draw no ground shadow"},
       kLookOption,
       kLookStrengthOption,
       kLightOption,
       kLightTurnOption,
       {"--method", "WHAT", methodMeaning().c_str()},
       {"--capture", "CAPTURE",
        "with --method fvvr: texture a captured frame from all camera videos of the folder that CHARACTER was baked "
        "from, without a shadow"},
       {"--closest", "M", "use the M cameras closest to the view (default 4; with --capture: all)"},
       {"--visibility", "WHAT",
        "visibility test: offset (default) and fattened leave a margin around occluders, plain uses depth maps without "
        "a margin, none textures through occluders"},
       kRefineOption,
       kRefineCamerasOption,
       kMatteBiasOption},
      "--scene"};
  return text;
}

bool RenderArguments::movie() const { return std::filesystem::path(output).extension() == ".mp4"; }

RenderArguments readRenderArguments(Args& args) {
  RenderArguments a;
  a.character = args.positional();
  a.output = args.text("-o");
  a.turntable = args.text("--turntable");
  a.sequence = args.text("--sequence");
  a.rendition = readRendition(args);
  a.frame = args.integer("--frame", 0, 0, 100'000'000);
  a.view.size = args.size("--size", kMaxSide);
  a.view.camera = args.text("--camera");
  a.view.cameras_folder = args.text("--cameras");
  a.view.azimuth_deg = optionalNumber(args, "--azimuth", -3600, 3600);
  a.view.elevation_deg = optionalNumber(args, "--elevation", -90, 90);
  a.view.distance_m = optionalNumber(args, "--distance", 0.01, 1e4);
  a.view.vertical_fov_deg = optionalNumber(args, "--fov", 1, 150);
  a.seconds = args.number("--seconds", 0, 0.1, 3600);
  a.recipe.background = background(args);
  a.room = args.text("--background") == "room";
  a.recipe.ground_shadow = !args.has("--no-shadow");
  a.debug = debugView(args, a.recipe);
  a.look = readLookArguments(args);
  readMethod(args, a);
  readMotion(args, a);
  checkMotion(args, a);
  checkCombination(args, a);
  return a;
}

Status checkMethod(const RenderArguments& a, const package::Character& character) {
  const auto invalid = [&](const std::string& what) {
    return Error{ErrorId::InvalidArgument, a.character + ": " + what};
  };
  if (character.appearance == package::AppearanceKind::Layers) {
    const bool fits = a.method_name.empty() || a.method_name == "layered" || a.method_name == "montage4d";
    if (!a.fvvr.wanted && (!fits || a.chooses_cameras))
      return invalid(
          "is a layered character; --method montage4d goes with it, or fvvr with --capture CAPTURE, which has the "
          "videos");
    return {};
  }
  if (a.method_name == "layered") return invalid("is a character from cameras and has no layers; leave --method out");
  if (!a.debug.empty()) return invalid("is a character from cameras; --debug belongs to layered ones");
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
