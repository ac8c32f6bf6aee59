// SPDX-License-Identifier: Apache-2.0
// Report of a study from its rows alone (rows.h): tables, curves, goals and trends. Unmeasured parts are left out and
// listed in the last section. Needs neither files, OpenCV nor a GPU.
#pragma once

#include <string>
#include <vector>

#include "lab/study/run/context.h"
#include "report/document.h"

namespace fourdvt::study {

using report::Curve, report::Document, report::Picture, report::Plot, report::Section, report::Table;
using report::fixedText, report::percentText, report::bytesText, report::secondsText, report::bitrateText;

Document makeStudyDocument(const Rows& rows, const StudyOptions& options, const std::string& capture_name);

// Rows by name. A filter is "key=value !key": each pair must be in the setting (numbers compare as numbers), and a key
// with a "!" must be absent; empty: any setting.
class StudyValues {
 public:
  explicit StudyValues(const Rows& rows) : rows_(rows) {}
  // Value of the first matching row of this sequence; NaN if there is none.
  double of(const std::string& table, const std::string& sequence, const std::string& method, const std::string& filter,
            const std::string& quantity) const;
  // Value of the row over all sequences (empty name) if present, else mean or sum of the sequences' rows; NaN: none.
  double mean(const std::string& table, const std::string& method, const std::string& filter,
              const std::string& quantity) const;
  double sum(const std::string& table, const std::string& method, const std::string& filter,
             const std::string& quantity) const;
  // Distinct values in order of appearance. methods: the known ones first, in the report's order.
  std::vector<std::string> sequences(const std::string& table) const;
  std::vector<std::string> methods(const std::string& table) const;
  std::vector<std::string> settings(const std::string& table, const std::string& method, const std::string& key) const;
  // Distinct values as ascending numbers; no method: all.
  std::vector<double> numbers(const std::string& table, const std::string& method, const std::string& key) const;
  const Rows& rows() const { return rows_; }

 private:
  // Values over which mean and sum are taken.
  std::vector<double> each(const std::string& table, const std::string& method, const std::string& filter,
                           const std::string& quantity) const;

  const Rows& rows_;
};

bool matchesFilter(const std::string& setting, const std::string& filter);

// "ours (joint)", "FVVR", "NO: naive" …
std::string methodTitle(const std::string& method);

// Verdict on a goal of the project or a trend of the papers.
struct Judgement {
  std::string claim, measured;
  enum class Verdict { Holds, Fails, NotMeasured } verdict = Verdict::NotMeasured;
  std::string reason;  // cause of a failure by the rows
};
std::vector<Judgement> judgeGoals(const StudyValues& values);
std::vector<Judgement> judgeTrends(const StudyValues& values);

}  // namespace fourdvt::study
