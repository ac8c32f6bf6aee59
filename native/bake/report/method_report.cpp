// SPDX-License-Identifier: Apache-2.0
#include "bake/report/method_report.h"

#include "report/text.h"

namespace fourdvt::bake {
namespace {

using Json = nlohmann::ordered_json;
using report::fixedText;

std::string introduction(const ChosenMethod& chosen) {
  const std::string drawn = "Players draw the character by `" + chosen.method + "` unless they are told otherwise. ";
  if (chosen.choice.verdicts.empty()) return drawn;
  return drawn + "It was chosen on " + std::to_string(chosen.views) + " views of " + std::to_string(chosen.frames) +
         (chosen.frames == 1 ? " frame" : " frames") +
         ": cameras were left out in turn, drawn from the others, and compared with their pictures. What is drawn "
         "lies " +
         fixedText(chosen.shift_px, 1) +
         " pixels off on average, as a whole; from 2 on the calibration is too far off "
         "for `sweep`. Blended: where two cameras or more share a pixel, with the picture moved to where it fits best; "
         "the choice is made by these. Judged: corrected for what leaving out gets wrong, up to 1 dB more for the "
         "search of `sweep`, the farther the cameras stand apart, .3 dB less for `linear` per pixel off. Figure: all "
         "of it, as drawn. A method may cost " +
         fixedText(chosen.most_cost, 1) + " of FVVR's frames.";
}

}  // namespace

Json methodJson(const ChosenMethod& chosen) {
  Json json{{"name", chosen.method}, {"measured", !chosen.choice.verdicts.empty()}};
  if (chosen.sweep_band_m) json["sweep_band_m"] = *chosen.sweep_band_m;
  if (chosen.choice.verdicts.empty()) return json;
  json["frames"] = chosen.frames;
  json["views"] = chosen.views;
  json["shift_px"] = chosen.shift_px;
  json["gap_deg"] = chosen.gap_deg;
  json["most_cost"] = chosen.most_cost;
  json["scores"] = Json::array();
  for (const MethodVerdict& v : chosen.choice.verdicts)
    json["scores"].push_back({{"method", v.score.method},
                              {"cost", v.score.cost},
                              {"blended_psnr_db", v.score.psnr_db},
                              {"blended_ssim", v.score.ssim},
                              {"own_psnr_db", v.score.own_psnr_db},
                              {"figure_psnr_db", v.score.psnr_fg_db},
                              {"figure_ssim", v.score.ssim_fg},
                              {"judged_psnr_db", v.judged_db},
                              {"verdict", v.verdict}});
  return json;
}

report::Section methodSection(const ChosenMethod& chosen) {
  report::Section out{"method", "Method", introduction(chosen), {}, {}, {}, {}, {}};
  if (chosen.choice.verdicts.empty()) return out;
  report::Table table{
      "",
      "",
      {"method", "FVVR's frames", "blended, dB", "SSIM", "own view, dB", "judged, dB", "figure, dB", "SSIM", ""},
      {}};
  for (const MethodVerdict& v : chosen.choice.verdicts)
    table.rows.push_back({v.score.method, fixedText(v.score.cost, 1), fixedText(v.score.psnr_db, 2),
                          fixedText(v.score.ssim, 3), fixedText(v.score.own_psnr_db, 2), fixedText(v.judged_db, 2),
                          fixedText(v.score.psnr_fg_db, 2), fixedText(v.score.ssim_fg, 3), v.verdict});
  out.tables = {std::move(table)};
  return out;
}

}  // namespace fourdvt::bake
