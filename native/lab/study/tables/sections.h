// SPDX-License-Identifier: Apache-2.0
// Contents of the report's sections from its rows; the list of sections is in report.cpp. A section without tables,
// plots, pictures and tiles was not measured. Internal to tables/.
#pragma once

#include <limits>
#include <span>

#include "lab/study/tables/grid.h"

namespace fourdvt::study {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // not measured

// Entry in a report's list of sections.
struct SectionPlan {
  const char *id, *title, *text;
  void (*fill)(Section& section, const StudyValues& values);  // may be null: pictures only
  std::vector<std::string> pictures;                          // caption keys
};

// Adds the sections that were measured; returns the titles of the others, "Speed, Labels".
std::string addSections(Document& document, const StudyValues& values, std::span<const SectionPlan> plans);
// Last section: these settings and the facts of table "about". `stem`: of the CSV file.
Section settingsSection(const StudyValues& values, const std::string& title, const std::string& stem,
                        std::vector<std::vector<std::string>> settings);

void fillTable1(Section& section, const StudyValues& values);
void fillLayers(Section& section, const StudyValues& values);
void fillStorage(Section& section, const StudyValues& values);
void fillSpeed(Section& section, const StudyValues& values);
void fillLabels(Section& section, const StudyValues& values);
void fillHeldOut(Section& section, const StudyValues& values);
void fillRate(Section& section, const StudyValues& values);
void fillGrazing(Section& section, const StudyValues& values);
void fillMotion(Section& section, const StudyValues& values);

// Verdict on a claim. `decisive` is NaN if unmeasured; `reason` applies to failures.
Judgement judged(const std::string& claim, double decisive, bool holds, const std::string& measured,
                 const std::string& reason = {});
std::vector<Judgement> judgeMotion(const StudyValues& values);
Table judgementTable(const std::vector<Judgement>& judgements, const std::string& title);

}  // namespace fourdvt::study
