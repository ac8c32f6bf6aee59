// SPDX-License-Identifier: Apache-2.0
#include "lab/study/tables/projective.h"

#include <algorithm>
#include <cmath>

#include "lab/study/run/projective_rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr std::pair<const char*, const char*> kProxyTitles[] = {
    {kProxyGiven, "given mesh"},     {"given-2000", "2,000 faces"}, {"given-500", "500 faces"},
    {kProxyRefined, "refined hull"}, {kProxyHull, "hull"},          {"hull-2px", "hull, 2 px"},
    {"hull-4px", "hull, 4 px"},      {kProxyPlane, "plane"}};
constexpr std::pair<const char*, const char*> kDecided[] = {
    {kProxyGiven, "tracked mesh"}, {kProxyRefined, "refined hull"}, {kProxyHull, "hull"}};

std::string onProxy(const std::string& proxy) { return "axis=proxy at=" + proxy; }

Cells proxyColumns(const StudyValues& v) {
  const auto measured = v.settings(kCondition, "", "at");
  Cells out;
  for (const auto& [name, title] : kProxyTitles)
    if (std::find(measured.begin(), measured.end(), name) != measured.end())
      out.push_back({{title}, "", onProxy(name)});
  return out;
}

std::string byAxis(const std::string& axis, const std::string& place) {
  if (axis == kAxisRotation) return "rotation " + place + "°";
  if (axis == kAxisTranslation) return "position " + place + " mm";
  if (axis == kAxisFocal) return "focal length " + place + " %";
  if (axis == kAxisGain) return "gain " + place + " %";
  if (axis == kAxisStandoff) return "surface off by up to " + place + " mm";
  if (axis == kAxisMixed) return "mixed";
  return axis + " " + place;
}

// Rows of the base and each condition of these axes.
Cells axisRows(const StudyValues& v, const std::vector<const char*>& axes) {
  Cells out{{{"none"}, "", onProxy(kProxyGiven)}};
  for (const char* axis : axes)
    for (const Row& row : v.rows()) {
      if (row.table != kCondition || settingText(row.setting, "axis") != axis) continue;
      const std::string place = settingText(row.setting, "at");
      const std::string filter = std::string("axis=") + axis + " at=" + place;
      bool known = false;
      for (const Cell& cell : out) known |= cell.filter == filter;
      if (!known) out.push_back({{byAxis(axis, place)}, "", filter});
    }
  return out;
}

Cells axisColumns(const StudyValues& v) {
  Cells out;
  for (const char* method : {kMethodLinear, kFvvr, kMethodFloating, kMethodMontage, kMethodSweep})
    for (const Cell& known : methodsOf(v, kCondition))
      if (known.method == method) out.push_back(known);
  return out;
}

const Cell kQuality{.quantity = kPsnrFgDb, .beside = kSsimFg};

void fillGoals(Section& section, const StudyValues& v) {
  for (const auto& [proxy, title] : kDecided)
    if (const std::string method = pickMethod(v, proxy).method; !method.empty())
      section.tiles.push_back({methodTitle(method), std::string("to take on a ") + title});
  addTable(section, judgementTable(judgeProjective(v), "What the papers promise"));
}

void fillChoice(Section& section, const StudyValues& v) {
  for (const auto& [proxy, title] : kDecided) {
    const MethodPick pick = pickMethod(v, proxy);
    const auto remark = [&](const StudyValues&, const Cell& cell) {
      for (const auto& [refused, why] : pick.refused)
        if (refused == cell.method) return why;
      return std::string(cell.method == pick.method ? "✓ take this" : "");
    };
    const auto newView = [](const StudyValues& values, const Cell& cell) {
      return values.mean(kCondition, cell.method, cell.filter, kViewS) /
             values.mean(kCondition, kFvvr, cell.filter, kViewS);
    };
    Cells columns = cellsOf({{"dB", kPsnrFgDb},
                             {"SSIM", kSsimFg},
                             {"flicker, levels", kFlickerLevels},
                             {"new frame against FVVR", kRatioToFvvr, times}});
    columns.push_back({.title = {"new view against FVVR"}, .text = times, .value = newView});
    columns.push_back({.title = {"bytes"}, .words = [](const StudyValues&, const Cell&) { return "0"; }});
    columns.push_back({.title = {""}, .words = remark});
    addGrid(section, v, {kCondition, std::string("On a ") + title, "", {"method"}, {.filter = onProxy(proxy)}},
            methodsOf(v, kCondition), columns);
  }
}

void fillProxies(Section& section, const StudyValues& v) {
  const Cells methods = methodsOf(v, kCondition), proxies = proxyColumns(v);
  struct Shown {
    const char *title, *note;
    Cell cell;
  };
  const Shown shown[] = {
      {"PSNR-FG, dB / SSIM-FG at the held-out cameras", "", kQuality},
      {"Shift-tolerant PSNR, dB",
       "Blocks of 16 × 16 pixels may each lie up to 3 pixels off.",
       {.quantity = kShiftTolerantDb}},
      {"Gradient energy against the truth's",
       "Below 1: blurred. Above: ghosts, seams, noise.",
       {.quantity = kGradientRatio}},
      {"Flicker, levels",
       "What the error changes from frame to frame under a point of the surface, at an input camera that is left out.",
       {.quantity = kFlickerLevels}},
      {"Cost of a new frame against FVVR's in the same run", "", {.quantity = kRatioToFvvr, .text = times}}};
  for (const Shown& s : shown) addGrid(section, v, {kCondition, s.title, s.note, {"method"}, s.cell}, methods, proxies);
}

void addAxisPlots(Section& section, const StudyValues& v, const std::string& axis, const std::string& label,
                  int decimals, double base) {
  for (const auto& [quantity, title] : {std::pair{kSsimFg, std::string("SSIM-FG")}, {kPsnrFgDb, "PSNR-FG, dB"}})
    addCurves(section, v,
              {.table = kCondition,
               .quantity = quantity,
               .x_key = "at",
               .x_decimals = decimals,
               .title = title + " over " + label,
               .x_label = label,
               .y_label = title,
               .filter = "axis=" + axis,
               .base = std::pair{base, onProxy(kProxyGiven)}},
              axisColumns(v));
}

void fillCameras(Section& section, const StudyValues& v) {
  addAxisPlots(section, v, kAxisCameras, "cameras a picture is drawn from", 0, kClosest);
}

void fillCalibration(Section& section, const StudyValues& v) {
  addGrid(section, v,
          {kCondition,
           "PSNR-FG, dB / SSIM-FG",
           "Mixed: .1°, 2 mm, .2 % of focal length, 3 % of gain, 5 mm of surface.",
           {"error, σ"},
           kQuality},
          axisRows(v, {kAxisRotation, kAxisTranslation, kAxisFocal, kAxisGain, kAxisStandoff, kAxisMixed}),
          axisColumns(v));
  addAxisPlots(section, v, kAxisRotation, "rotation, σ in degrees", 2, 0);
}

// Frames per second of a run, for methods that were cross-validated.
double framesPerSecond(const StudyValues& v, const Cell& cell) {
  const double rmse = v.of(kCross, cell.sequence, cell.method, cell.filter, kRmse);
  return std::isnan(rmse)
             ? rmse
             : 1 / v.of(kCondition, cell.sequence, cell.method, onProxy(settingText(cell.filter, "proxy")), kFrameS);
}

void fillCross(Section& section, const StudyValues& v) {
  Cells measured;
  for (const std::string& sequence : v.sequences(kCross))
    for (const Cell& proxy : settingsOf(v, kCross, "", "proxy"))
      for (const Cell& method : methodsOf(v, kCross))
        measured.push_back({.title = {sequence + ", " + proxy.title[0], method.title[0]},
                            .method = method.method,
                            .filter = proxy.filter,
                            .sequence = sequence});
  Cells columns = cellsOf({{"RMSE", kRmse, [](double rmse) { return fixedText(100 * rmse, 2) + " %"; }},
                           {"dB", kPsnrFgDb},
                           {"SSIM", kSsimFg}});
  columns.push_back({.title = {"frames/s"}, .text = fixed<1>, .value = framesPerSecond});
  for (const auto& [own, title] : {std::pair{"0", "Each camera left out"}, {"1", "With the camera's own picture"}})
    addGrid(section, v, {kCross, title, "", {"motion, surface", "method"}, {.filter = std::string("own=") + own}},
            measured, columns);
}

void fillTried(Section& section, const StudyValues& v) {
  const std::vector<std::string> methods = v.methods(kTried);
  Table table{"", "", {"condition", "pixels off", "taken"}, {}};
  for (const std::string& method : methods)
    if (!method.empty()) table.columns.push_back(methodTitle(method) + ", dB / SSIM");
  std::vector<std::string> settings;
  for (const Row& row : v.rows())
    if (row.table == kTried && std::find(settings.begin(), settings.end(), row.setting) == settings.end())
      settings.push_back(row.setting);
  for (const std::string& setting : settings) {
    std::vector<std::string> cells{settingText(setting, "axis") + " " + settingText(setting, "at"), "–", ""};
    for (const Row& row : v.rows()) {
      if (row.table != kTried || row.setting != setting) continue;
      if (row.quantity == kShiftPx) cells[1] = fixedText(row.value, 1);
      if (row.quantity == kTaken) cells[2] = methodTitle(row.method);
    }
    for (const std::string& method : methods) {
      if (method.empty()) continue;
      const double db = v.of(kTried, "", method, setting, kBlendedDb);
      cells.push_back(std::isnan(db)
                          ? "–"
                          : fixedText(db, 2) + " / " + fixedText(v.of(kTried, "", method, setting, kBlendedSsim), 3));
    }
    table.rows.push_back(std::move(cells));
  }
  addTable(section, std::move(table));
}

void fillStages(Section& section, const StudyValues& v) {
  addGrid(section, v, {kStage, "Milliseconds of a new frame, by pass", "", {"pass"}, {.quantity = kFrameMs}},
          settingsOf(v, kStage, "", "pass"), methodsOf(v, kStage));
}

const SectionPlan kMethodsSections[] = {
    {"summary", "Summary", "", fillGoals, {}},
    {"choice",
     "Which method to take",
     "A method may not be below linear blending by more than .05 dB, not cost more than twice FVVR's frame, and not "
     "flicker by more than a tenth more than FVVR. Of those left, the one with the best SSIM-FG is to be taken; of "
     "those within .002 of it, the one that costs least. All methods draw from the same files: none costs a byte. A "
     "new view: of a frame that stands.",
     fillChoice,
     {}},
    {"side-by-side",
     "Side by side",
     "FT Fig. 8: the held-out camera that is farthest in angle from the input cameras. Down: surfaces and calibrations "
     "that are more and more off.",
     nullptr,
     {kPictureMethods, kPictureCloseUps}},
    {"surfaces",
     "Methods and surfaces",
     "Drawn from the raw videos of the 4 cameras nearest to the view, before any codec, against held-out cameras; over "
     "the union of both silhouettes, on black. Hulls are polyhedral, from outlines that are true to 1, 2 and 4 pixels; "
     "the refined "
     "hull is what `fourdvt reconstruct` makes by default. The plane stands through the body's middle and faces the "
     "view, as for light fields; it is cut by the true outline, having none of its own.",
     fillProxies,
     {}},
    {"cameras",
     "Number of cameras",
     "On the given mesh; the cameras nearest to the view. Linear and floating draw from four at most, Montage4D from "
     "eight.",
     fillCameras,
     {}},
    {"calibration",
     "Calibration, gain and surface",
     "One error at a time, on the given mesh, drawn once from a fixed seed: the cameras are thought to be elsewhere, "
     "their colours have other gains, or the surface is displaced smoothly along its normals. The truth is unchanged.",
     fillCalibration,
     {}},
    {"cross-validation",
     "Montage4D Table 2",
     "The picture of every input camera against what is drawn for it: without its own picture, and, as the paper can "
     "be read, with it. Hulls are made from all mattes, the left-out one's included. Frames a second: of a run of new "
     "frames on this machine, with reading back.",
     fillCross,
     {kPictureCross}},
    {"tried",
     "What the bake chooses",
     "Input cameras that are left out, where the others share the surface, with the drawn picture moved to where it "
     "fits "
     "best; and how far that is. Methods that cost more than 2.5 of FVVR's frames are not tried.",
     fillTried,
     {}},
    {"stages",
     "Montage4D Table 3",
     "Passes timed apart, with the GPU drained after each, so that they add up to more than an undisturbed frame. "
     "“upload”: updates of textures, the new pictures and surface included.",
     fillStages,
     {}},
    {"worst", "Worst views", "", nullptr, {kPictureWorstViews}}};

}  // namespace

Document makeProjectiveDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name) {
  const StudyValues values(rows);
  Document document{capture_name + ": methods of texturing from cameras", "", {}};
  document.subtitle = "Floating Textures, Montage4D and the blends that they are measured against, on " + capture_name +
                      ". Made by `fourdvt-lab methods" + std::string(options.quick ? " --quick`." : "`.");
  addSections(document, values, kMethodsSections);
  document.sections.push_back(
      settingsSection(values, "Settings", "projective", {{"mode", options.quick ? "quick" : "full"}}));
  return document;
}

}  // namespace fourdvt::study
