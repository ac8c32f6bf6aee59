// SPDX-License-Identifier: Apache-2.0
#include "lab/study/tables/report.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "lab/study/run/projective_rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

void addTile(Section& section, double value, const std::string& text, const std::string& meaning) {
  if (!std::isnan(value)) section.tiles.push_back({text, meaning});
}

void fillSummary(Section& section, const StudyValues& v) {
  const double ours = v.sum(kTable1, kJoint, "", kTotalBytes), masked = v.sum(kTable1, kFvvr, "", kTotalBytes),
               smaller = 100 * (1 - ours / masked);
  addTile(section, smaller, percentText(smaller), "less than the foreground-only multi-view, at L = 3, 512²");
  const double ssim = v.mean(kTable1, kJointDefault, "", kSsimFg);
  addTile(section, ssim, fixedText(ssim, 4), "SSIM-FG against FVVR, default settings");
  const double ratio = v.mean(kSpeed, kMethodLayered, "!pass !closest", kRatioToFvvr);
  addTile(section, ratio, fixedText(ratio, 2) + " ×", "FVVR's frame rate");
  const double gap = v.mean(kHeldOut, kJointDefault, "", kPsnrFgDb) - v.mean(kHeldOut, kFvvr, "", kPsnrFgDb);
  addTile(section, gap, (gap > 0 ? "+" : "") + fixedText(gap, 2) + " dB", "against FVVR at the held-out cameras");
  const double bake = v.mean(kBake, kJointDefault, "!stage", kSecondsFrame);
  addTile(section, bake, secondsText(bake), "a frame, whole bake");
  section.tables.push_back(judgementTable(judgeGoals(v), "Goals"));
}

void fillTrends(Section& section, const StudyValues& v) {
  section.tables.push_back(judgementTable(judgeTrends(v), ""));
}

// The report from top to bottom.
const SectionPlan kStudySections[] = {
    {"summary", "Summary", "", fillSummary, {}},
    {"table1",
     "4DVT Table 1",
     "Loading, storage and quality of FVVR, 4DVT's three labellings and ours, in the papers' protocol: the reference "
     "of SSIM and PSNR is FVVR's picture from the same ring views, not the truth. FVVR's storage is the "
     "foreground-only multi-view as PNG. Storage of the layers counts everything that is loaded; against the "
     "multi-view as video, at equal quality, it stands under “Storage and memory”.\n\nLoading, whole sequence: every "
     "picture is decoded and uploaded, as the papers measure it. To the first picture: what a viewer waits for, since "
     "both can show one before the rest has come.\n\n“Per texel” takes each texel's camera as LVDT does, but weights "
     "it at run time by the cameras of its face, for the streamed labels are per face. LVDT's camera maps are per "
     "texel: it is no measurement of LVDT's method.",
     fillTable1,
     {}},
    {"layers",
     "Quality against layers and size",
     "LVDT Fig. 5 and 4DVT Fig. 9: the layered render against FVVR's picture from the same viewpoint, one curve per "
     "layer size; all layers of one size, as in the papers. SSIM over the foreground of the ring views, on black. "
     "The difference maps are LVDT Fig. 6.",
     fillLayers,
     {kPictureErrorMap}},
    {"storage",
     "Storage and memory",
     "LVDT Table 1 and Fig. 7a–c. Reductions of the layers as images and as video are against the foreground-only "
     "multi-view as PNG; that of the GPU memory is against FVVR's pictures and depth maps.",
     fillStorage,
     {}},
    {"speed",
     "Speed",
     "LVDT 4.4: frame rate of the layered renderer and of FVVR, on the same machine in the same run (the paper: 20 "
     "against 11 frames a second). Times are of this machine; the ratio is what compares.",
     fillSpeed,
     {}},
    {"labels",
     "Labels",
     "Seams: share of mesh edges whose faces differ in this layer. Flips: share of faces that differ from the frame "
     "before. Penalty: 4DVT Eq. 1, mean over the filled ranks of faces that a camera sees. Energy: of the joint "
     "formulation with our weights, whatever the method. Means over the sequences.\n\nThe papers' methods leave a "
     "face empty that no camera sees, ours goes on with its neighbours' label, which alone makes fewer seams where "
     "nothing was filmed. What shows is the second table: edges between two faces, and faces in two frames, that at "
     "least one camera sees. The last table takes ours apart.",
     fillLabels,
     {}},
    {"held-out",
     "Held-out cameras",
     "Against pictures of cameras that no method uses: the truth. Foreground: the union of both silhouettes; "
     "“common”: where both are, without the outline's error.",
     fillHeldOut,
     {kPictureWorst}},
    {"rate",
     "Rate and quality",
     "The rendered view (not the atlas) against the truth of the held-out cameras, over the bitrate of the video: of "
     "the layers, or of all cameras for FVVR. One curve per codec, preset and layout; the quality setting varies along "
     "it. Up and to the left is better.",
     fillRate,
     {}},
    {"camera-maps",
     "Layers and camera maps",
     "LVDT Fig. 3–4, 4DVT Fig. 4–5. One column per layer: the texture in UV space, its camera map (one colour per "
     "camera), the same two on the body, and the share of the layer in the blend. Large patches of one colour "
     "compress better and have fewer seams.",
     nullptr,
     {kPictureLayers, kPictureChanges}},
    {"grazing",
     "Grazing views and seams",
     "Views from far above and below and midway between two cameras, where seams and green fringes would show.",
     fillGrazing,
     {kPictureGrazing}},
    {"motion",
     "Motion",
     "4DVT 5–6: a motion class, one character between its members. Methods of bringing the members' appearance "
     "together: none (plain blend), Farnebäck and DIS as GPU passes, OpenCV's own on read-back pictures, and the "
     "alignment baked into the stream.\n\nThe truth between the members exists for captures of the virtual studio "
     "only. To judge appearance and not the silhouette, pictures are compared where both show the character; the "
     "whole foreground is given as well.",
     fillMotion,
     {kPictureMotionColumns, kPictureMotionCrops, kPictureTransition}},
    {"trends",
     "The papers' trends",
     "What the papers report, and whether this capture shows it. Reasons that begin with “Likely” are an "
     "interpretation; the others are values of this run.",
     fillTrends,
     {}},
};

// Table of constants, with the texts of the comments beside them.
Table constantsTable() {
  return {"What the constants were chosen on",
          "The values of a motion that constants were chosen on flatter them; those of the other motions do not. All "
          "motions are of one performer under one rig, so that no figure here shows another performer or another rig.",
          {"constants", "chosen on", "by"},
          {{"quality presets: CRF and encoder preset (bake/quality.cpp)",
            "all motions of the sample; of VP9 and AV1: its run", "rate and held-out quality of rendered views"},
           {"encoder parameters (encode/encoder.cpp)",
            "deblocking and qcomp: all motions of the sample; the others: not recorded",
            "bitrate and SSIM of rendered views"},
           {"resampling: filter (bake/texels/resample.h)", "all motions of the sample",
            "held-out SSIM and PSNR, and bitrate"},
           {"resampling: matte and contour distances (bake/texels/resample.h)", "walk and run of the sample",
            "held-out SSIM and PSNR, no codec"},
           {"powers of the blend (render/recipe.h)", "all motions of the sample",
            "held-out SSIM and PSNR, seams of a synthetic cylinder, change on an orbit"},
           {"root motion: how steady contacts are (bake/motion/root_track.cpp)", "walk and run of the sample",
            "feet sliding, and the declared speed"},
           {"weights of the joint labels (bake/labels/labelling.h)", "not recorded",
            "flips and seams of one sequence at a layer-1 penalty within 10 % of naive's"},
           {"detail put back in aligned blends (render/layered_pass.cpp)", "nothing: measured per class by the bake",
            "correlation of the members' detail"}}};
}

// Pictures of these caption keys, in the rows' order.
std::vector<Picture> picturesOf(const StudyValues& values, const std::vector<std::string>& keys) {
  std::vector<Picture> out;
  for (const Row& row : values.rows()) {
    if (row.table != kPictures || std::find(keys.begin(), keys.end(), row.quantity) == keys.end()) continue;
    const std::string file = settingText(row.setting, "file");
    if (file.empty()) continue;
    Picture picture{"pictures/" + file, ""};
    const double width = settingNumber(row.setting, "width"), height = settingNumber(row.setting, "height");
    if (width > 0 && height > 0) picture.width = static_cast<int>(width), picture.height = static_cast<int>(height);
    static const std::pair<const char*, const char*> kKinds[] = {
        {kPictureLayers, "Layers and their camera maps"},
        {kPictureChanges, "Layer 1's camera maps in three frames; faces that change are white"},
        {kPictureErrorMap, "Reference, ours, difference × 4"},
        {kPictureGrazing, "View with crops, FVVR above"},
        {kPictureWorst, "Worst held-out view: truth, ours, FVVR where kept, differences × 4"},
        {kPictureMotionColumns, "From one member (w = 0) to the other (w = 1)"},
        {kPictureMotionCrops, "Half way between the members"},
        {kPictureTransition, "A transition"},
        {kPictureMethods, "Methods on surfaces and calibrations that are more and more off"},
        {kPictureCloseUps, "The same, close up"},
        {kPictureCross, "An input camera's view without its own picture and with it, differences × 4"},
        {kPictureWorstViews, "Every method's worst held-out view by SSIM-FG: truth, drawn, difference × 4"}};
    for (const auto& [key, caption] : kKinds)
      if (row.quantity == key) picture.caption = caption;
    for (const std::string& part : {row.sequence, row.method.empty() ? "" : methodTitle(row.method)})
      if (!part.empty()) picture.caption += ", " + part;
    static const std::pair<const char*, const char*> kParts[] = {
        {"layers", "L = "}, {"size", "size "}, {"frame", "frame "},   {"view", ""},
        {"from", "from "},  {"to", "to "},     {"score", "SSIM-FG "}, {"at", "on "}};
    for (const auto& [key, prefix] : kParts)
      if (const std::string text = settingText(row.setting, key); !text.empty())
        picture.caption += std::string(", ") + prefix + text;
    out.push_back(std::move(picture));
  }
  return out;
}

}  // namespace

Judgement judged(const std::string& claim, double decisive, bool holds, const std::string& measured,
                 const std::string& reason) {
  using Verdict = Judgement::Verdict;
  if (std::isnan(decisive)) return {claim, "", Verdict::NotMeasured, ""};
  return {claim, measured, holds ? Verdict::Holds : Verdict::Fails, holds ? "" : reason};
}

Table judgementTable(const std::vector<Judgement>& judgements, const std::string& title) {
  Table table{title, "", {"claim", "verdict", "measured", "why not"}, {}};
  for (const Judgement& j : judgements) {
    const char* verdict = j.verdict == Judgement::Verdict::Holds   ? "✓ holds"
                          : j.verdict == Judgement::Verdict::Fails ? "✗ does not hold"
                                                                   : "not measured";
    table.rows.push_back({j.claim, verdict, j.measured, j.reason});
  }
  return table;
}

std::string addSections(Document& document, const StudyValues& values, std::span<const SectionPlan> plans) {
  std::vector<std::string> missing;
  for (const SectionPlan& plan : plans) {
    Section section{plan.id, plan.title, plan.text, {}, {}, {}, {}};
    if (plan.fill) plan.fill(section, values);
    section.pictures = picturesOf(values, plan.pictures);
    if (section.tables.empty() && section.plots.empty() && section.pictures.empty() && section.tiles.empty())
      missing.push_back(plan.title);
    else
      document.sections.push_back(std::move(section));
  }
  return joined(missing);
}

Section settingsSection(const StudyValues& v, const std::string& title, const std::string& stem,
                        std::vector<std::vector<std::string>> settings) {
  Section section{"settings", title, "Every figure of this page, and more, is in `" + stem + ".csv` beside it."};
  for (const bool first : {true, false})
    for (const Row& row : v.rows()) {
      const bool is_first =
          row.quantity == kAboutCommand || row.quantity == kAboutDevice || row.quantity == kAboutEncoder;
      if (row.table != kAbout || is_first != first) continue;
      const std::string text = settingText(row.setting, "text");
      settings.push_back({row.quantity, text.empty() ? fixedText(row.value, 3) + " " + row.unit : text});
    }
  section.tables.push_back({"", "", {"", "value"}, std::move(settings)});
  return section;
}

Document makeStudyDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name) {
  const StudyValues values(rows);
  Document document{capture_name + ": evaluation", "", {}};
  document.subtitle = "Layered view-dependent texture of " + capture_name +
                      " against free-viewpoint video rendering and held-out cameras: the tables and figures of the two "
                      "papers on this capture. Made by `fourdvt-lab study" +
                      std::string(options.quick ? " --quick`." : "`.");
  const std::string missing = addSections(document, values, kStudySections);
  Section settings = settingsSection(values, "Settings and versions", "evaluate",
                                     {{"sequences", options.sequences.empty() ? "all" : joined(options.sequences)},
                                      {"mode", options.quick ? "quick" : "full"},
                                      {"jobs", options.jobs > 0 ? std::to_string(options.jobs) : "as many as cores"}});
  if (!missing.empty())
    settings.text += "\n\nNot measured in this run: " + missing + (options.quick ? " (quick run)." : ".");
  settings.tables.push_back(constantsTable());
  document.sections.push_back(std::move(settings));
  return document;
}

}  // namespace fourdvt::study
