// SPDX-License-Identifier: Apache-2.0
#include "lab/study/run/run_steps.h"

#include <algorithm>
#include <filesystem>

#include "base/hash.h"
#include "base/text.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStems[] = {"evaluate", "projective"};  // StudyOptions::stem of each kind of study

std::string keyPath(const std::string& folder) { return folder + "/steps/key.txt"; }

std::string readText(const std::string& path) {
  auto text = platform::readText(path);
  return text ? text.take() : std::string();
}

// Lists path below the folder, size and time of each file, except for those in `except`.
void listFiles(const fs::path& folder, const fs::path& except, std::vector<std::string>& lines) {
  std::error_code error;
  fs::recursive_directory_iterator it(folder, error), end;
  for (; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (fs::equivalent(it->path(), except, ignored)) {
      it.disable_recursion_pending();
      continue;
    }
    if (!it->is_regular_file(ignored)) continue;
    lines.push_back(fs::relative(it->path(), folder, ignored).string() + " " + std::to_string(it->file_size(ignored)) +
                    " " + std::to_string(it->last_write_time(ignored).time_since_epoch().count()));
  }
}

std::string commandLine(const StudyOptions& options) {
  const auto listed = [](const char* option, const std::vector<std::string>& names) {
    return names.empty() ? "" : option + joined(names, ",");
  };
  return "fourdvt-lab " + std::string(options.command) + " '" + options.capture_folder + "' -o '" +
         options.report_folder + "'" + options.further + listed(" --sequences ", options.sequences) +
         listed(" --steps ", options.steps) + (options.quick ? " --quick" : "");
}

// Kept rows, or nullopt if there are none or the file is damaged.
std::optional<Rows> keptRows(const std::string& path) {
  const std::string text = readText(path);
  if (text.empty()) return std::nullopt;
  auto rows = parseRowsCsv(text, path);
  if (!rows) return std::nullopt;
  return rows.take();
}

// Context of a step: maps the step's progress to its share of the study.
StudyContext contextOfStep(const StudyContext& context, const StudyStep& step, double before, double weight) {
  StudyContext inner = context;
  inner.progress = [&context, name = std::string(step.name), before, weight](const StudyProgress& p) {
    if (!context.progress) return;
    context.progress({p.step.empty() ? name : p.step, p.detail, before + weight * std::clamp(p.share, 0.0, 1.0)});
  };
  return inner;
}

}  // namespace

std::string studyKey(const StudyOptions& options, const std::string& version) {
  std::vector<std::string> lines;
  listFiles(options.capture_folder, options.report_folder, lines);
  std::sort(lines.begin(), lines.end());
  std::string text = version + " " + options.command + (options.quick ? " quick" : " full") + options.further;
  for (const std::string& name : options.sequences) text += "\nsequence " + name;
  text += "\nrefine " + std::to_string(options.refine.outline) + std::to_string(options.refine.cameras) +
          (options.refine.matte_bias_pixels ? std::to_string(*options.refine.matte_bias_pixels) : "");
  for (const std::string& line : lines) text += "\n" + line;
  return hexDigits(fnv1a(text));
}

Status openReportFolder(const std::string& folder, const std::string& key) {
  std::error_code ignored;
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
    return Error{ErrorId::InvalidArgument, folder + ": exists and is not a folder; choose another report folder"};
  const std::string old = readText(keyPath(folder));
  if (old.empty() && fs::exists(folder, ignored) && !fs::is_empty(folder, ignored))
    return Error{ErrorId::InvalidArgument, folder +
                                               ": exists and is not a study's report (no steps/key.txt inside); "
                                               "choose another report folder"};
  const bool measured = std::any_of(std::begin(kStems), std::end(kStems), [&](const char* stem) {
    std::error_code unread;
    return fs::exists(folder + "/" + stem + ".csv", unread);
  });
  if (!old.empty() && old != key + "\n" && measured)
    return Error{ErrorId::InvalidArgument, folder +
                                               ": holds a study of other settings, or of a capture that has changed "
                                               "since; delete it or choose another report folder"};
  if (old != key + "\n") {
    for (const char* part : {"/steps", "/work", "/pictures"}) platform::removeFolder(folder + part);
    for (const std::string stem : kStems)
      for (const char* end : {".csv", ".json"}) fs::remove(folder + "/" + stem + end, ignored);
    fs::remove(folder + "/report.html", ignored);
  }
  for (const char* part : {"/steps", "/work", "/pictures"}) FOURDVT_TRY(platform::makeFolder(folder + part));
  return platform::writeFileAtomic(keyPath(folder), key + "\n");
}

void reportProgress(const StudyContext& context, const std::string& step, const std::string& detail, double share) {
  if (context.progress) context.progress({step, detail, share});
}

Status checkStop(const StudyContext& context) {
  if (!context.stop || !*context.stop) return {};
  return Error{ErrorId::Interrupted, "stopped"};
}

Status addPart(const StudyContext& context, const std::string& name, const std::function<Result<Rows>()>& measure,
               Rows& out) {
  const std::string folder = context.work() + "/rows", path = folder + "/" + name + ".csv";
  auto rows = keptRows(path);
  if (!rows) {
    FOURDVT_TRY(checkStop(context));
    FOURDVT_ASSIGN(rows, measure());
    FOURDVT_TRY(platform::makeFolder(folder));
    FOURDVT_TRY(platform::writeFileAtomic(path, rowsCsv(*rows)));
  }
  out.insert(out.end(), rows->begin(), rows->end());
  return {};
}

Status addPicture(const StudyContext& context, const std::string& file, const Image& picture, Row shown, Rows& out,
                  int quality) {
  FOURDVT_TRY(platform::writeImage(context.pictures() + "/" + file, picture, quality));
  shown.table = rows::kPictures;
  shown.setting = "file=" + file + " " + shown.setting;
  out.push_back(std::move(shown));
  return {};
}

std::string sizeSetting(const Image& picture) {
  return "width=" + std::to_string(picture.width) + " height=" + std::to_string(picture.height);
}

Result<Rows> rowsOfStep(const StudyContext& context, const std::string& step) {
  const std::string path = context.options.report_folder + "/steps/" + step + ".csv";
  if (auto kept = keptRows(path)) return std::move(*kept);
  return Error{ErrorId::Internal, path + ": not there; run the step \"" + step + "\" first"};
}

Result<std::vector<StudyStep>> askedSteps(std::span<const StudyStep> all, const std::vector<std::string>& names) {
  const auto isAsked = [&](const StudyStep& step) {
    return names.empty() || std::find(names.begin(), names.end(), step.name) != names.end();
  };
  for (const std::string& name : names) {
    if (std::any_of(all.begin(), all.end(), [&](const StudyStep& step) { return name == step.name; })) continue;
    return Error{ErrorId::InvalidArgument,
                 "no step is named \"" + name + "\"; the steps are " + joined(all, ", ", &StudyStep::name)};
  }
  std::vector<StudyStep> out;
  std::copy_if(all.begin(), all.end(), std::back_inserter(out), isAsked);
  return out;
}

Result<Rows> runSteps(const StudyContext& context, std::span<const StudyStep> steps,
                      const std::function<Status(const Rows&)>& publish) {
  const std::string& folder = context.options.report_folder;
  double total = 0, before = 0;
  for (const StudyStep& step : steps) total += step.weight;
  Rows all;
  for (const StudyStep& step : steps) {
    const std::string path = folder + "/steps/" + step.name + ".csv";
    const double weight = step.weight / total;
    auto rows = keptRows(path);
    if (!rows) {
      const StudyContext inner = contextOfStep(context, step, before, weight);
      if (inner.progress) inner.progress({step.name, "", 0});
      auto measured = checkStop(context) ? step.run(inner) : Result<Rows>(checkStop(context).error());
      if (!measured && measured.error().id == ErrorId::Interrupted)
        return Error{ErrorId::Interrupted, "stopped; what was measured is kept in " + folder + "; run `" +
                                               commandLine(context.options) + "` again to go on"};
      if (!measured) return measured.error();
      rows = measured.take();
      FOURDVT_TRY(platform::writeFileAtomic(path, rowsCsv(*rows)));
    }
    all.insert(all.end(), rows->begin(), rows->end());
    before += weight;
    FOURDVT_TRY(publish(all));
    if (context.progress) context.progress({step.name, "finished", std::min(before, 1.0)});
  }
  return all;
}

Result<Rows> publishSteps(const StudyContext& context, std::span<const StudyStep> steps,
                          const std::function<report::Document(const Rows&)>& makeDocument,
                          Rows (*conclude)(const Rows&)) {
  const std::string folder = context.options.report_folder + "/", stem = folder + context.options.stem;
  Rows published;
  FOURDVT_ASSIGN([[maybe_unused]] const auto measured, runSteps(context, steps, [&](const Rows& rows) -> Status {
                   published = rows;
                   const Rows conclusions = conclude ? conclude(rows) : Rows();
                   published.insert(published.end(), conclusions.begin(), conclusions.end());
                   FOURDVT_TRY(platform::writeFileAtomic(stem + ".csv", rowsCsv(published)));
                   FOURDVT_TRY(platform::writeFileAtomic(stem + ".json",
                                                         rowsJson(published, context.options, context.capture->name)));
                   return platform::writeFileAtomic(folder + "report.html", report::documentHtml(makeDocument(rows)));
                 }));
  return published;
}

}  // namespace fourdvt::study
