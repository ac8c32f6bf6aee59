// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>

#include "bake/bake.h"
#include "bake/quality.h"
#include "bake/run/renditions.h"
#include "render/cameras/camera_method.h"
#include "tools/args.h"
#include "tools/bake_arguments.h"
#include "tools/choice.h"
#include "tools/commands.h"
#include "tools/log.h"
#include "tools/progress_line.h"
#include "tools/refine_arguments.h"
#include "tools/session.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

// Help texts live as long as the process.
const char* qualityHelp() {
  static const std::string text = [] {
    std::string t = "sets texture, layers, crf and preset; explicit options override it (default web):";
    for (const bake::Quality& q : bake::qualities()) t += std::string("\n") + q.name + ": " + q.meaning;
    return t;
  }();
  return text.c_str();
}

const char* presetHelp() {
  static const std::string text = [] {
    std::string t = "speed preset of the encoder, by its own name (default: of the quality):";
    for (const encode::CodecInfo& info : encode::kCodecInfos) t += std::string("\n") + info.name + ": " + info.presets;
    return t;
  }();
  return text.c_str();
}

const char* methodHelp() {
  static const std::string text = [] {
    std::string names;
    for (const std::string& name : render::cameraMethodNames(render::MethodGroup::Textured)) names += ", " + name;
    return "cameras: the method that players draw the character by: auto (default; measured on cameras that are left "
           "out), or one of" +
           names.substr(1);
  }();
  return text.c_str();
}

const CommandHelp& help() {
  static const CommandHelp text{
      "bake CAPTURE -o CHARACTER [options]",
      "Turns a capture folder into a character folder that any web server can host. A new folder appears when it is "
      "complete; in an old one, the earlier bake's files are replaced. After Ctrl-C, the same command with --resume "
      "continues.",
      {{"-o", "CHARACTER", "folder to write (required)"},
       {"--sequences", "A,B", "only these sequences (default: all)"},
       {"--cameras", "A,B",
        "only these cameras, by the names in images.txt, at most 31 (default: all, or of more than 31 the best in "
        "directions, share of the surface in the picture and pixels on it)"},
       {"--appearance", "KIND",
        "layers (texture layers on a mesh of constant topology) or cameras (camera pictures on surfaces of any "
        "topology); default: layers if the meshes allow it"},
       {"--quality", "NAME", qualityHelp()},
       {"--codec", "NAME", "h264 (plays everywhere, the default), vp9 or av1 (smaller, slower to bake)"},
       {"--layers", "N", "texture layers, 1 to 6 (default: of the quality)"},
       {"--texture", "N", "texels, side of layer 1 (default: of the quality)"},
       {"--equal-layers", nullptr, "all layers have the size of layer 1 (default: the others have half of it)"},
       {"--crf", "N",
        "rate factor, lower is better: 0 to 51 for h264, 0 to 63 for vp9 and av1 (default: of the quality)"},
       {"--preset", "NAME", presetHelp()},
       {"--renditions", "LIST",
        "smaller renditions beside the highest, which the options above describe: SIZE:CRF or SIZE:CRF:CODEC, "
        "separated "
        "by commas. SIZE: texels of layer 1, a multiple of 32 from 64; for characters from cameras the share of the "
        "highest's sides, a multiple of 0.125. highest: none but that (default: its size at half the bitrate, and 3/8 "
        "of it, from cameras half of it; 1024:36,384:34 for web)"},
       {"--penalty", "NAME",
        "penalty of a camera for a face, by its optical axis (axis; default, as in the papers), its ray to the face's "
        "centre (ray) or its number of pixels (resolution)"},
       kRefineOption,
       kRefineCamerasOption,
       kMatteBiasOption,
       {"--no-colour-calibration", nullptr, "do not match the cameras' colours"},
       {"--filter", "NAME", "filter for sampling camera pictures: bicubic (default), bilinear or mipmap"},
       {"--no-classes", nullptr, "leave out the capture's motion classes"},
       {"--align", "MODE", "classes: baked (align the members' textures on the surface; default) or none (faster)"},
       {"--blend-error", "MM",
        "classes: largest distance of the blended mesh from the non-linear blend, millimetres (default 1 for a person, "
        "and in proportion to the size of other surfaces)"},
       {"--tile-scale", "X", "cameras: texels per pixel of their pictures, 0.01 to 1 (default 1)"},
       {"--faces", "N",
        "cameras: simplify surfaces of changing topology to about N faces, 100 to 1000000; 0: keep all (default "
        "10000)"},
       {"--tile-texels", "N", "cameras: largest tiled picture, million texels (default 9.4, what phones decode)"},
       {"--method", "NAME", methodHelp()},
       {"--method-cost", "X",
        "cameras: methods that auto may choose take at most X times as long for a frame as fvvr, 1 to 100 (default "
        "2.5)"},
       {"--position-step", "MM",
        "quantisation step of vertices, millimetres (default for a person 0.25 from layers, 1 from cameras; half of it "
        "for surfaces of half the size, and so on)"},
       {"--coarse-step", "MM",
        "layers: likewise for renditions with fewer texels than the highest, 0.001 to 100, or 0: as for the others "
        "(default 2 for a person, as above); their alignment is coarser in proportion"},
       {"--gop", "N", "most frames of a group of pictures (default 20)"},
       {"--jobs", "N", "worker threads; 0: one per core (default 0)"},
       {"--resume", nullptr, "continue an interrupted run with the same settings"}}};
  return text;
}

// Applies quality and codec first, so that options that are given explicitly win.
void readEncoding(Args& args, bake::BakeOptions& o) {
  encode::Codec codec = o.codec;
  if (args.has("--codec") && !encode::parseCodec(args.text("--codec"), codec))
    args.complain("--codec must be one of " + encode::codecNames() + ", not \"" + args.text("--codec") + "\"");
  const std::string name = args.text("--quality", bake::kDefaultQuality);
  if (const bake::Quality* quality = bake::findQuality(name))
    bake::applyQuality(*quality, codec, o);
  else
    args.complain("--quality must be one of draft, web, high, not \"" + name + "\"");
  o.layers = args.integer("--layers", o.layers, 1, 6);
  o.texture = args.integer("--texture", o.texture, 64, 4096);
  o.crf = args.integer("--crf", o.crf, 0, encode::infoOf(codec).highest_crf);
  o.preset = args.text("--preset", o.preset);
  o.equal_layers = args.has("--equal-layers");
  if (!encode::knowsPreset(codec, o.preset))
    args.complain(std::string("--preset for ") + encode::infoOf(codec).name + " must be " +
                  encode::infoOf(codec).presets + ", not \"" + o.preset + "\"");
}

// After readEncoding: the other codecs' presets are the quality's.
void readRenditions(Args& args, bake::BakeOptions& o) {
  o.standard_renditions = !args.has("--renditions");
  if (o.standard_renditions || args.text("--renditions") == "highest") return;
  const std::string wrong = bake::parseRenditions(args.list("--renditions"), o, o.lower_renditions);
  if (!wrong.empty()) args.complain("--renditions: " + wrong);
  const bake::Quality* quality = bake::findQuality(args.text("--quality", bake::kDefaultQuality));
  for (bake::LowerRendition& r : o.lower_renditions)
    r.preset = r.codec == o.codec || !quality ? o.preset : quality->preset[static_cast<int>(r.codec)];
}

void readAppearance(Args& args, bake::BakeOptions& o) {
  using package::AppearanceKind;
  if (args.has("--appearance"))
    o.appearance = choice(args, "--appearance", AppearanceKind::Layers,
                          {{"layers", AppearanceKind::Layers}, {"cameras", AppearanceKind::Cameras}});
  o.cameras.faces = args.integer("--faces", o.cameras.faces, 0, 1'000'000);
  if (o.cameras.faces > 0 && o.cameras.faces < 100) args.complain("--faces must be 0, or 100 to 1000000");
  o.cameras.tile_scale = args.number("--tile-scale", o.cameras.tile_scale, 0.01, 1);
  o.cameras.max_texels = args.number("--tile-texels", o.cameras.max_texels / 1e6, 0.01, 16.8) * 1e6;
  const std::string method = args.text("--method", "auto");
  const auto methods = render::cameraMethodNames(render::MethodGroup::Textured);
  if (std::find(methods.begin(), methods.end(), method) != methods.end())
    o.cameras.method = method;
  else if (method != "auto")
    args.complain(std::string("--method: ") + methodHelp() + "; not \"" + method + "\"");
  o.cameras.choice.most_cost = args.number("--method-cost", o.cameras.choice.most_cost, 1, 100);
  if (args.has("--coarse-step")) o.coarse_step_m = args.number("--coarse-step", 2, 0, 100) / 1e3;
  if (o.coarse_step_m && *o.coarse_step_m != 0 && *o.coarse_step_m < 1e-6)
    args.complain("--coarse-step must be 0, or 0.001 to 100");
  if (!args.has("--position-step")) return;
  o.position_step_m = args.number("--position-step", 0.5, 0.001, 100) / 1e3;
}

bake::BakeOptions readOptions(Args& args) {
  bake::BakeOptions o;
  o.capture_folder = args.positional();
  o.character_folder = args.required("-o");
  o.sequences = args.list("--sequences");
  o.camera_names = args.list("--cameras");
  readEncoding(args, o);
  readRenditions(args, o);
  o.gop = args.integer("--gop", o.gop, 1, 1000);
  o.jobs = args.integer("--jobs", o.jobs, 0, 1024);
  o.resume = args.has("--resume");
  o.penalty =
      choice(args, "--penalty", o.penalty,
             {{"axis", bake::Penalty::Axis}, {"ray", bake::Penalty::Ray}, {"resolution", bake::Penalty::Resolution}});
  o.resample.filter = choice(args, "--filter", o.resample.filter,
                             {{"bilinear", bake::ResampleFilter::Bilinear},
                              {"mipmap", bake::ResampleFilter::Mipmap},
                              {"bicubic", bake::ResampleFilter::Bicubic}});
  o.classes.bake = !args.has("--no-classes");
  o.classes.align = choice(args, "--align", o.classes.align, {{"baked", true}, {"none", false}});
  if (args.has("--blend-error")) o.classes.blend_error_m = args.number("--blend-error", 1, 0.01, 1000) / 1e3;
  readAppearance(args, o);
  o.refine = readRefineOptions(args);
  o.refine_asked = args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px");
  o.colour_calibration = !args.has("--no-colour-calibration");
  return o;
}

}  // namespace

void printBakeSummary(const std::string& character_folder, const bake::BakeReport& report, double seconds) {
  for (const auto& [stage, work_s] : report.seconds_by_stage) detail("%s: %.1f s of work", stage.c_str(), work_s);
  uint64_t bytes = 0;
  for (const auto& [part, size] : report.bytes_by_part) bytes += size;
  note("%s: %u frames, %.2f MB, %.1f s (%.2f s per frame), peak memory %.0f MB\nreport: %s/report.html",
       character_folder.c_str(), report.frames, bytes / 1e6, seconds, report.frames ? seconds / report.frames : 0.0,
       report.peak_rss_bytes / 1e6, bake::reportFolderOf(character_folder).c_str());
}

BakeCommandLine readBakeCommand(int argc, char** argv, const BakeExtension* extension) {
  CommandHelp known = help();
  if (extension) known.options.push_back(extension->option);
  Args args(known, argc, argv);
  BakeCommandLine line{readOptions(args), std::nullopt};
  if (extension) extension->read(args, line.options);
  if (args.problem().empty() && !args.wantsHelp()) {
    const std::string wrong = line.options.check();
    if (!wrong.empty()) args.complain(wrong);
  }
  line.exit_code = helpOrProblem(known, args);
  if (line.exit_code) return line;
  const Status found = encode::checkEncoder(line.options.codec, line.options.preset);
  if (!found.ok()) line.exit_code = fail(found.error());
  return line;
}

bake::BakeEnvironment bakeEnvironment(const GpuSession& gpu, ProgressLine& line) {
  bake::BakeEnvironment environment;
  environment.device = gpu.device.get();
  environment.open_video = videoOpener();
  environment.progress = [&line](const bake::Progress& p) {
    line.show({p.stage, p.done, p.total, p.frames_per_s, p.left_s});
  };
  environment.note = [](const std::string& text) { note("%s", text.c_str()); };
  environment.stop = listenForStop();
  return environment;
}

int bakeCommand(int argc, char** argv, const BakeExtension* extension) {
  const auto [options, exit_code] = readBakeCommand(argc, argv, extension);
  if (exit_code) return *exit_code;
  auto gpu = openGpu();
  if (!gpu.ok()) return fail(gpu.error());
  ProgressLine line;
  const auto start = std::chrono::steady_clock::now();
  auto report = bake::bake(options, bakeEnvironment(gpu.value(), line));
  line.end();
  if (!report.ok()) return fail(report.error());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  printBakeSummary(options.character_folder, report.value(), seconds.count());
  return kOk;
}

}  // namespace fourdvt::tools
