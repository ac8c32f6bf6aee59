// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bake/bake.h"
#include "bake/quality.h"
#include "bake/run/renditions.h"
#include "base/watch.h"
#include "render/cameras/camera_method.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/planned_commands.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

std::string qualityMeaning() {
  std::string out = "sets texture, layers, crf and preset; explicit options override it (default web):";
  for (const bake::Quality& q : bake::qualities()) out += std::string("\n") + q.name + ": " + q.meaning;
  return out;
}

std::string presetMeaning() {
  std::string out = "speed preset of the encoder, by its own name (default: of the quality):";
  for (const encode::CodecInfo& info : encode::kCodecInfos) out += std::string("\n") + info.name + ": " + info.presets;
  return out;
}

std::string methodMeaning() {
  std::string names;
  for (const std::string& name : render::cameraMethodNames(render::MethodGroup::Textured)) names += ", " + name;
  return "cameras: the method that players draw the character by: auto (default; measured on cameras that are left "
         "out), or one of" +
         names.substr(1);
}

const bake::Quality* qualityOf(const Args& args) {
  return bake::findQuality(args.text("--quality", bake::kDefaultQuality));
}

void readQuality(Args& args, const std::string& name) {
  if (!qualityOf(args)) args.refuse(name, "one of draft, web, high");
}

// Applies quality and codec, so that later explicit options override them.
void readCodec(Args& args, const std::string& name, bake::BakeOptions& o) {
  encode::Codec codec = o.codec;
  if (args.has(name) && !encode::parseCodec(args.text(name), codec))
    args.refuse(name, "one of " + encode::codecNames());
  if (const bake::Quality* quality = qualityOf(args)) bake::applyQuality(*quality, codec, o);
}

void readPreset(Args& args, const std::string& name, bake::BakeOptions& o) {
  o.preset = args.text(name, o.preset);
  if (!encode::knowsPreset(o.codec, o.preset))
    args.complain(name + " for " + encode::infoOf(o.codec).name + " must be " + encode::infoOf(o.codec).presets +
                  ", not \"" + o.preset + "\"");
}

// Codecs other than the quality's have presets of their own.
void readRenditions(Args& args, const std::string& name, bake::BakeOptions& o) {
  o.standard_renditions = !args.has(name);
  if (o.standard_renditions || args.text(name) == "highest") return;
  const std::string wrong = bake::parseRenditions(args.list(name), o, o.lower_renditions);
  if (!wrong.empty()) args.complain(name + ": " + wrong);
  const bake::Quality* quality = qualityOf(args);
  for (bake::LowerRendition& r : o.lower_renditions)
    r.preset = r.codec == o.codec || !quality ? o.preset : quality->preset[static_cast<int>(r.codec)];
}

void readMethod(Args& args, const std::string& name, bake::BakeOptions& o) {
  const std::string method = args.text(name, "auto");
  const auto methods = render::cameraMethodNames(render::MethodGroup::Textured);
  if (std::find(methods.begin(), methods.end(), method) != methods.end())
    o.cameras.method = method;
  else if (method != "auto")
    args.complain(name + ": " + methodMeaning() + "; not \"" + method + "\"");
}

// Passes the options, as set so far, on to a reader.
Reader with(bake::BakeOptions& o, void (*read)(Args&, const std::string&, bake::BakeOptions&)) {
  return [&o, read](Args& args, const std::string& name) { read(args, name, o); };
}

Options sourceOptions(bake::BakeOptions& o) {
  using package::AppearanceKind;
  return {
      {"-o CHARACTER", required(o.character_folder), "folder to write (required)"},
      sequencesOption(o.sequences),
      {"--cameras A,B", list(o.camera_names),
       "only these cameras, by the names in images.txt, at most 31 (default: all, or of more than 31 the best in "
       "directions, share of the surface in the picture and pixels on it)"},
      {"--appearance KIND",
       choice(o.appearance, {{"layers", AppearanceKind::Layers}, {"cameras", AppearanceKind::Cameras}}),
       "layers (texture layers on a mesh of constant topology) or cameras (camera pictures on surfaces of any "
       "topology); default: layers if the meshes allow it"},
  };
}

Options encodingOptions(bake::BakeOptions& o) {
  const auto readCrf = [&o](Args& args, const std::string& name) {
    number(o.crf, 0, encode::infoOf(o.codec).highest_crf)(args, name);
  };
  return {
      {"--quality NAME", readQuality, qualityMeaning()},
      {"--codec NAME", with(o, readCodec),
       "h264 (plays everywhere, the default), vp9 or av1 (smaller, slower to bake)"},
      {"--layers N", number(o.layers, 1, package::kMaxLayers), "texture layers, 1 to 6 (default: of the quality)"},
      {"--texture N", number(o.texture, 64, 4096), "texels, side of layer 1 (default: of the quality)"},
      {"--equal-layers", flag(o.equal_layers),
       "all layers have the size of layer 1 (default: the others have half of it)"},
      {"--crf N", readCrf,
       "rate factor, lower is better: 0 to 51 for h264, 0 to 63 for vp9 and av1 (default: of the quality)"},
      {"--preset NAME", with(o, readPreset), presetMeaning()},
      {"--renditions LIST", with(o, readRenditions),
       "smaller renditions beside the highest, which the options above describe: SIZE:CRF or SIZE:CRF:CODEC, separated "
       "by commas. SIZE: texels of layer 1, a multiple of 32 from 64; for characters from cameras the share of the "
       "highest's sides, a multiple of 0.125. highest: none but that (default: its size at half the bitrate, and 3/8 "
       "of it, from cameras half of it; 1024:36,384:34 for web)"},
  };
}

Options textureOptions(bake::BakeOptions& o) {
  using bake::ResampleFilter;
  return {
      {"--no-colour-calibration", flag(o.colour_calibration, false), "do not match the cameras' colours"},
      {"--filter NAME",
       choice(o.resample.filter, {{"bilinear", ResampleFilter::Bilinear},
                                  {"mipmap", ResampleFilter::Mipmap},
                                  {"bicubic", ResampleFilter::Bicubic}}),
       "filter for sampling camera pictures: bicubic (default), bilinear or mipmap"},
      {"--detail MODE", choice(o.common_detail, {{"common", true}, {"own", false}}),
       "layers: fine detail is the mean of neighbouring frames, sharpened, where they agree (common; default), or each "
       "frame's own"},
      {"--no-classes", flag(o.classes.bake, false), "leave out the capture's motion classes"},
      {"--align MODE", choice(o.classes.align, {{"baked", true}, {"none", false}}),
       "classes: baked (align the members' textures on the surface; default) or none (faster)"},
      {"--blend-error MM", number(o.classes.blend_error_m, 0.01, 1000, 1e-3),
       "classes: largest distance of the blended mesh from the non-linear blend, millimetres (default 1 for a person, "
       "and in proportion to the size of other surfaces)"},
      {"--tile-scale X", number(o.cameras.tile_scale, 0.01, 1),
       "cameras: texels per pixel of their pictures, 0.01 to 1 (default 1)"},
      {"--faces N", number(o.cameras.faces, 0, 1'000'000),
       "cameras: simplify surfaces of changing topology to about N faces, 100 to 1000000; 0: keep all (default "
       "10000)"},
      {"--tile-texels N", number(o.cameras.max_texels, 0.01, 16.8, 1e6),
       "cameras: largest tiled picture, million texels (default 9.4, what phones decode)"},
      {"--method NAME", with(o, readMethod), methodMeaning()},
      {"--method-cost X", number(o.cameras.choice.most_cost, 1, 100),
       "cameras: methods that auto may choose take at most X times as long for a frame as fvvr, 1 to 100 (default "
       "2.5)"},
  };
}

Options bakeOptions(bake::BakeOptions& o) {
  using bake::Penalty;
  return join({
      sourceOptions(o),
      encodingOptions(o),
      {{"--penalty NAME",
        choice(o.penalty, {{"axis", Penalty::Axis}, {"ray", Penalty::Ray}, {"resolution", Penalty::Resolution}}),
        "penalty of a camera for a face, by its optical axis (axis; default, as in the papers), its ray to the face's "
        "centre (ray) or its number of pixels (resolution)"}},
      refineOptions(o.refine),
      textureOptions(o),
      {{"--position-step MM", number(o.position_step_m, 0.001, 100, 1e-3),
        "quantisation step of vertices, millimetres (default for a person 0.5 from layers, 1 from cameras; half of it "
        "for surfaces of half the size, and so on)"},
       {"--coarse-step MM", number(o.coarse_step_m, 0, 100, 1e-3),
        "layers: likewise for renditions with fewer texels than the highest, 0.001 to 100, or 0: as for the others "
        "(default 3.5 for a person, as above); their alignment is coarser in proportion"},
       {"--gop N", number(o.gop, 1, 1000), "most frames of a group of pictures (default 20)"},
       jobsOption(o.jobs),
       resumeOption(o.resume)},
  });
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

Result<std::optional<int>> readBakeCommand(int argc, char** argv, bake::BakeOptions& o, BakeExtension extension) {
  Args args({"bake CAPTURE -o CHARACTER [options]",
             "Turns a capture folder into a character folder that any web server can host. A new folder appears when "
             "it is complete; in an old one, the earlier bake's files are replaced. After Ctrl-C, the same command "
             "with --resume continues.",
             {&o.capture_folder},
             join({bakeOptions(o), extension ? extension(o) : Options()})},
            argc, argv);
  if (o.cameras.faces > 0 && o.cameras.faces < 100) args.complain("--faces must be 0, or 100 to 1000000");
  if (o.coarse_step_m && *o.coarse_step_m != 0 && *o.coarse_step_m < 1e-6)
    args.complain("--coarse-step must be 0, or 0.001 to 100");
  o.refine_asked = refinesExplicitly(args);
  args.complain(o.check());
  if (const auto code = args.helpOrProblem()) return code;
  FOURDVT_TRY(encode::checkEncoder(o.codec, o.preset));
  return std::optional<int>();
}

bake::BakeEnvironment bakeEnvironment(const GpuSession& gpu, ProgressLine& line) {
  bake::BakeEnvironment environment;
  environment.device = gpu.device.get();
  environment.open_video = videoOpener();
  environment.progress = [&line](const FrameProgress& p) { line.show(p); };
  environment.note = [](const std::string& text) { note("%s", text.c_str()); };
  environment.stop = listenForStop();
  return environment;
}

Result<int> bakeCommand(int argc, char** argv, BakeExtension extension) {
  bake::BakeOptions options;
  FOURDVT_ASSIGN(const auto code, readBakeCommand(argc, argv, options, extension));
  if (code) return *code;
  FOURDVT_ASSIGN(const auto gpu, openGpu());
  ProgressLine line;
  const Watch watch;
  FOURDVT_ASSIGN(const auto report, bake::bake(options, bakeEnvironment(gpu, line)));
  line.end();
  const double seconds = watch.seconds();
  printBakeSummary(options.character_folder, report, seconds);
  return kOk;
}

}  // namespace fourdvt::tools
