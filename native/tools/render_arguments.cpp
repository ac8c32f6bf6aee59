// SPDX-License-Identifier: Apache-2.0
#include "tools/render_arguments.h"

#include <cctype>
#include <filesystem>

#include "capture/capture.h"

namespace fourdvt::tools {
namespace {

constexpr int kMaxSide = 8192;

// Premultiplied background from RRGGBB or "none".
glm::vec4 background(Args& args) {
  const std::string text = args.text("--background", "none");
  if (text == "none") return glm::vec4(0);
  unsigned value = 0;
  bool hexadecimal = text.size() == 6;
  for (char c : text) hexadecimal = hexadecimal && std::isxdigit(static_cast<unsigned char>(c));
  if (hexadecimal)
    value = static_cast<unsigned>(std::stoul(text, nullptr, 16));
  else
    args.complain("--background must be RRGGBB or none, not \"" + text + "\"");
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
  const std::string method = args.text("--method", "layered");
  a.fvvr = method == "fvvr";
  if (!a.fvvr && method != "layered") args.complain("--method must be layered or fvvr, not \"" + method + "\"");
  a.capture_folder = args.text("--capture");
  a.fvvr_options.closest = args.integer("--closest", 0, 1, package::kMaxCameras);
  a.fvvr_options.background = a.recipe.background;
  if (a.fvvr && a.capture_folder.empty()) args.complain("--method fvvr needs --capture CAPTURE with the videos");
  if (!a.fvvr && (args.has("--capture") || args.has("--closest")))
    args.complain("--capture and --closest belong to --method fvvr");
  if (a.fvvr && (!a.turntable.empty() || !a.debug.empty()))
    args.complain("--method fvvr is for stills and takes no --debug");
}

void checkCombination(Args& args, const RenderArguments& a) {
  if (a.output.empty() && a.turntable.empty()) args.complain("-o PICTURE or --turntable MOVIE is required");
  if (!a.output.empty() && !a.turntable.empty()) args.complain("-o and --turntable exclude each other");
  const bool orbit = a.azimuth_deg || a.elevation_deg || a.distance_m || a.vertical_fov_deg;
  if (orbit && !a.camera.empty())
    args.complain("--camera and --azimuth, --elevation, --distance, --fov exclude each other");
  if (!a.cameras_folder.empty() && a.camera.empty()) args.complain("--cameras needs --camera NAME as well");
  if (!a.turntable.empty() && (!a.camera.empty() || args.has("--frame")))
    args.complain("--turntable takes neither --camera nor --frame");
  if (a.turntable.empty() && args.has("--seconds")) args.complain("--seconds belongs to --turntable");
  if (!a.turntable.empty() && (a.debug == "layers" || a.debug == "labels"))
    args.complain("--debug " + a.debug + " is for stills");
  if (!a.turntable.empty() && a.size && (a.size->first % 2 || a.size->second % 2))
    args.complain("--size of a movie must be even");
  if (a.output.empty()) return;
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (extension != ".png" && extension != ".jpg" && extension != ".webp")
    args.complain("-o must end in .png, .jpg or .webp");
}

}  // namespace

const CommandHelp& renderHelp() {
  static const CommandHelp text{
      "render CHARACTER (-o PICTURE | --turntable MOVIE.mp4) [options]",
      "Draws one frame of a character from an orbit position, from one of its capture cameras, or from a camera of a\n"
      "COLMAP text model; or a movie of the playing sequence while the camera turns once round it.",
      {{"-o", "PICTURE", ".png (with transparency), .jpg or .webp"},
       {"--turntable", "MOVIE", "H.264 .mp4 instead of a picture"},
       {"--seconds", "S", "length of the turntable (default: whole loops, at least 8 s)"},
       {"--sequence", "NAME", "sequence (default: the first)"},
       {"--frame", "N", "frame, from 0 (default 0)"},
       {"--azimuth", "DEG", "0: in front of the performer, positive: towards +X (default 25)"},
       {"--elevation", "DEG", "positive: from above (default 8)"},
       {"--distance", "M", "metres from the centre of the bounds (default: all in view)"},
       {"--fov", "DEG", "vertical field of view (default 30)"},
       {"--camera", "NAME", "a capture camera instead of an orbit position"},
       {"--cameras", "FOLDER", "cameras.txt and images.txt that --camera is looked up in"},
       {"--size", "WxH", "pixels (default 720x960, or the camera's)"},
       {"--background", "RRGGBB", "or none (default; black in movies)"},
       {"--debug", "WHAT", "labels, layers (side by side), weights or normals"},
       {"--no-shadow", nullptr, "without the ground shadow"},
       {"--method", "WHAT", "layered (default), or fvvr: projective texturing from all camera videos, no shadow"},
       {"--capture", "CAPTURE", "fvvr: the capture folder that CHARACTER was baked from"},
       {"--closest", "M", "fvvr: only the M cameras closest to the view (default: all)"}}};
  return text;
}

RenderArguments readRenderArguments(Args& args) {
  RenderArguments a;
  a.character = args.positional();
  a.output = args.text("-o");
  a.turntable = args.text("--turntable");
  a.sequence = args.text("--sequence");
  a.frame = args.integer("--frame", 0, 0, 100'000'000);
  a.size = args.size("--size", kMaxSide);
  a.camera = args.text("--camera");
  a.cameras_folder = args.text("--cameras");
  a.azimuth_deg = optionalNumber(args, "--azimuth", -3600, 3600);
  a.elevation_deg = optionalNumber(args, "--elevation", -90, 90);
  a.distance_m = optionalNumber(args, "--distance", 0.01, 1e4);
  a.vertical_fov_deg = optionalNumber(args, "--fov", 1, 150);
  a.seconds = args.number("--seconds", 0, 0.1, 3600);
  a.recipe.background = background(args);
  a.recipe.ground_shadow = !args.has("--no-shadow");
  a.debug = debugView(args, a.recipe);
  readMethod(args, a);
  checkCombination(args, a);
  return a;
}

OrbitView chooseOrbit(const RenderArguments& a, const package::Character& character, int width, int height) {
  OrbitView view = defaultOrbit(character.bounds, double(width) / height);
  if (a.azimuth_deg) view.azimuth_deg = *a.azimuth_deg;
  if (a.elevation_deg) view.elevation_deg = *a.elevation_deg;
  if (a.distance_m) view.distance_m = *a.distance_m;
  if (a.vertical_fov_deg) view.vertical_fov_deg = *a.vertical_fov_deg;
  return view;
}

Result<PinholeCamera> chooseCamera(const RenderArguments& a, const package::Character& character) {
  if (a.camera.empty()) {
    const auto [width, height] = a.size.value_or(std::pair{720, 960});
    return cameraFromOrbit(chooseOrbit(a, character, width, height), width, height);
  }
  std::vector<PinholeCamera> cameras = character.cameras;
  if (!a.cameras_folder.empty()) {
    auto read = capture::readColmapCameras(a.cameras_folder);
    if (!read.ok()) return read.error();
    cameras.clear();
    for (const auto& camera : read.value()) cameras.push_back(camera.pinhole);
  }
  std::string known;
  for (const PinholeCamera& camera : cameras) {
    if (camera.name == a.camera) return a.size ? scaledCamera(camera, a.size->first, a.size->second) : camera;
    known += (known.empty() ? "" : ", ") + camera.name;
  }
  return Error{ErrorId::InvalidArgument, (a.cameras_folder.empty() ? a.character : a.cameras_folder) +
                                             ": has no camera \"" + a.camera + "\"; it has " + known};
}

}  // namespace fourdvt::tools
