// SPDX-License-Identifier: Apache-2.0
#include "lab/study/tables/report.h"

#include <algorithm>
#include <cmath>

#include "lab/study/run/projective_rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

void addTile(Section& section, double value, const std::string& text, const std::string& meaning) {
  if (!std::isnan(value)) section.tiles.push_back({text, meaning});
}

void fillSummary(Section& section, const StudyValues& v) {
  const double ours = v.sum(rows::kTable1, rows::kJoint, "", rows::kTotalBytes),
               masked = v.sum(rows::kTable1, rows::kFvvr, "", rows::kTotalBytes), smaller = 100 * (1 - ours / masked);
  addTile(section, smaller, percentText(smaller), "less than the foreground-only multi-view, at L = 3, 512²");
  const double ssim = v.mean(rows::kTable1, rows::kJointDefault, "", rows::kSsimFg);
  addTile(section, ssim, fixedText(ssim, 4), "SSIM-FG against FVVR, default settings");
  const double ratio = v.mean(rows::kSpeed, rows::kMethodLayered, "!pass !closest", rows::kRatioToFvvr);
  addTile(section, ratio, fixedText(ratio, 2) + " ×", "FVVR's frame rate");
  const double gap = v.mean(rows::kHeldOut, rows::kJointDefault, "", rows::kPsnrFgDb) -
                     v.mean(rows::kHeldOut, rows::kFvvr, "", rows::kPsnrFgDb);
  addTile(section, gap, (gap > 0 ? "+" : "") + fixedText(gap, 2) + " dB", "against FVVR at the held-out cameras");
  const double bake = v.mean(rows::kBake, rows::kJointDefault, "!stage", rows::kSecondsFrame);
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
     {rows::kPictureErrorMap}},
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
     {rows::kPictureWorst}},
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
     {rows::kPictureLayers, rows::kPictureChanges}},
    {"grazing",
     "Grazing views and seams",
     "Views from far above and below and midway between two cameras, where seams and green fringes would show.",
     fillGrazing,
     {rows::kPictureGrazing}},
    {"motion",
     "Motion",
     "4DVT 5–6: a motion class, one character between its members. Methods of bringing the members' appearance "
     "together: none (plain blend), Farnebäck and DIS as GPU passes, OpenCV's own on read-back pictures, and the "
     "alignment baked into the stream.\n\nThe truth between the members exists for captures of the virtual studio "
     "only. To judge appearance and not the silhouette, pictures are compared where both show the character; the "
     "whole foreground is given as well.",
     fillMotion,
     {rows::kPictureMotionColumns, rows::kPictureMotionCrops, rows::kPictureTransition}},
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

Section settingsSection(const StudyValues& v, const StudyOptions& options, const std::vector<std::string>& missing) {
  Section section{"settings", "Settings and versions", "", {}, {}, {}, {}};
  section.text = "Every figure of this page, and more, is in `evaluate.csv` beside it.";
  if (!missing.empty()) {
    section.text += "\n\nNot measured in this run: ";
    for (size_t i = 0; i < missing.size(); ++i) section.text += (i ? ", " : "") + missing[i];
    section.text += options.quick ? " (quick run)." : ".";
  }
  Table table{"", "", {"", "value"}, {}};
  std::string sequences;
  for (const std::string& name : options.sequences) sequences += (sequences.empty() ? "" : ", ") + name;
  table.rows.push_back({"sequences", sequences.empty() ? "all" : sequences});
  table.rows.push_back({"mode", options.quick ? "quick" : "full"});
  table.rows.push_back({"jobs", options.jobs > 0 ? std::to_string(options.jobs) : "as many as cores"});
  auto add = [&](bool first) {
    for (const Row& row : v.rows()) {
      const bool is_first = row.quantity == rows::kAboutCommand || row.quantity == rows::kAboutDevice ||
                            row.quantity == rows::kAboutEncoder;
      if (row.table != rows::kAbout || is_first != first) continue;
      const std::string text = rows::settingText(row.setting, "text");
      table.rows.push_back({row.quantity, text.empty() ? fixedText(row.value, 3) + " " + row.unit : text});
    }
  };
  add(true), add(false);
  section.tables.push_back(std::move(table));
  section.tables.push_back(constantsTable());
  return section;
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

std::vector<Picture> picturesOf(const StudyValues& values, const std::vector<std::string>& keys) {
  std::vector<Picture> out;
  for (const Row& row : values.rows()) {
    if (row.table != rows::kPictures || std::find(keys.begin(), keys.end(), row.quantity) == keys.end()) continue;
    Picture picture;
    const std::string file = rows::settingText(row.setting, "file");
    if (file.empty()) continue;
    picture.file = "pictures/" + file;
    const double width = rows::settingNumber(row.setting, "width"), height = rows::settingNumber(row.setting, "height");
    if (width > 0 && height > 0) picture.width = static_cast<int>(width), picture.height = static_cast<int>(height);
    static const std::pair<const char*, const char*> kKinds[] = {
        {rows::kPictureLayers, "Layers and their camera maps"},
        {rows::kPictureChanges, "Layer 1's camera maps in three frames; faces that change are white"},
        {rows::kPictureErrorMap, "Reference, ours, difference × 4"},
        {rows::kPictureGrazing, "View with crops, FVVR above"},
        {rows::kPictureWorst, "Worst held-out view: truth, ours, FVVR where kept, differences × 4"},
        {rows::kPictureMotionColumns, "From one member (w = 0) to the other (w = 1)"},
        {rows::kPictureMotionCrops, "Half way between the members"},
        {rows::kPictureTransition, "A transition"},
        {rows::kPictureMethods, "Methods on surfaces and calibrations that are more and more off"},
        {rows::kPictureCloseUps, "The same, close up"},
        {rows::kPictureCross, "An input camera's view without its own picture and with it, differences × 4"},
        {rows::kPictureWorstViews, "Every method's worst held-out view by SSIM-FG: truth, drawn, difference × 4"}};
    for (const auto& [key, caption] : kKinds)
      if (row.quantity == key) picture.caption = caption;
    for (const std::string& part : {row.sequence, row.method.empty() ? "" : methodTitle(row.method)})
      if (!part.empty()) picture.caption += ", " + part;
    static const std::pair<const char*, const char*> kParts[] = {
        {"layers", "L = "}, {"size", "size "}, {"frame", "frame "},   {"view", ""},
        {"from", "from "},  {"to", "to "},     {"score", "SSIM-FG "}, {"at", "on "}};
    for (const auto& [key, prefix] : kParts)
      if (const std::string text = rows::settingText(row.setting, key); !text.empty())
        picture.caption += std::string(", ") + prefix + text;
    out.push_back(std::move(picture));
  }
  return out;
}

Document makeStudyDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name) {
  const StudyValues values(rows);
  Document document{capture_name + ": evaluation", "", {}};
  document.subtitle = "Layered view-dependent texture of " + capture_name +
                      " against free-viewpoint video rendering and held-out cameras: the tables and figures of the two "
                      "papers on this capture. Made by `fourdvt-lab study" +
                      std::string(options.quick ? " --quick`." : "`.");
  std::vector<std::string> missing;
  for (const SectionPlan& plan : kStudySections) {
    Section section{plan.id, plan.title, plan.text, {}, {}, {}, {}};
    if (plan.fill) plan.fill(section, values);
    section.pictures = picturesOf(values, plan.pictures);
    if (measured(section))
      document.sections.push_back(std::move(section));
    else
      missing.push_back(plan.title);
  }
  document.sections.push_back(settingsSection(values, options, missing));
  return document;
}

}  // namespace fourdvt::study
