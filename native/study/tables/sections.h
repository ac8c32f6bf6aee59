// SPDX-License-Identifier: Apache-2.0
// The sections of the study's report, each from its rows. Internal to tables/. A section without tables,
// plots, pictures and tiles was not measured.
#pragma once

#include "report/document.h"
#include "study/tables/report.h"

namespace fourdvt::study {

Section layersSection(const StudyValues& values);   // LVDT Fig. 5-6, 4DVT Fig. 9
Section storageSection(const StudyValues& values);  // LVDT Table 1, Fig. 7
Section rateSection(const StudyValues& values);     // rate-distortion
Section speedSection(const StudyValues& values);    // LVDT 4.4, bake stages
Section motionSection(const StudyValues& values);   // 4DVT 5-6: blend, alignment, transitions

std::vector<Judgement> judgeMotion(const StudyValues& values);
Table judgementTable(const std::vector<Judgement>& judgements, const std::string& title);

// Pictures of these caption keys, in the rows' order.
std::vector<Picture> picturesOf(const StudyValues& values, const std::vector<std::string>& keys);

}  // namespace fourdvt::study
