// SPDX-License-Identifier: Apache-2.0
// The study on a small capture: all tables are present, an interrupted study resumes, invalid input gives a one-line
// message.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "command.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

struct Csv {
  std::set<std::string> tables, methods;  // methods: "table method"
  std::map<std::string, double> values;   // "table,sequence,method,setting,quantity"
};

// Reads the CSV. Fields contain no quoted commas, except the "about" texts, which are skipped.
Csv readCsv(const std::string& path) {
  Csv out;
  std::istringstream lines(readText(path));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "table,sequence,method,setting,quantity,value,unit");
  while (std::getline(lines, line)) {
    std::vector<std::string> cells(1);
    for (char c : line)
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    out.tables.insert(cells[0]);
    if (cells[0] == "about" || cells.size() != 7) continue;
    out.methods.insert(cells[0] + " " + cells[2]);
    out.values[cells[0] + "," + cells[1] + "," + cells[2] + "," + cells[3] + "," + cells[4]] = std::stod(cells[5]);
  }
  return out;
}

double first(const Csv& csv, const std::string& table, const std::string& method, const std::string& quantity) {
  for (const auto& [key, value] : csv.values)
    if (key.rfind(table + ",turn," + method + ",", 0) == 0 && key.size() > quantity.size() &&
        key.substr(key.size() - quantity.size() - 1) == "," + quantity)
      return value;
  ADD_FAILURE() << "no " << table << " " << method << " " << quantity;
  return -1;
}

bool has(const Csv& csv, const std::string& table, const std::string& method, const std::string& quantity) {
  for (const auto& [key, value] : csv.values)
    if (key.rfind(table + ",turn," + method + ",", 0) == 0 && key.size() > quantity.size() &&
        key.substr(key.size() - quantity.size() - 1) == "," + quantity)
      return true;
  return false;
}

const std::string& capture() {
  static const std::string path = smallCapture("study_capture");
  return path;
}

// Study shared by the tests below: stopped by Ctrl-C once the first step's rows are written, then run to its end.
struct Study {
  std::string report = scratch("study") + "/report", reference;  // reference: the first step's rows when it stopped
  Outcome stopped, rest;
  bool wrote_rows = false, wrote_report = false, drew = false;  // when it stopped
};
const Study& study() {
  static const Study made = [] {
    Study out;
    const std::string command = std::string(FOURDVT_LAB_BIN) + " study " + capture() + " -o " + out.report + " --quick";
    out.stopped = shell(command + " & pid=$!; until [ -e " + out.report +
                        "/steps/reference.csv ] || ! kill -0 $pid; do sleep 0.05; done; kill -INT $pid; wait $pid");
    out.wrote_rows = exists(out.report + "/evaluate.csv");
    out.wrote_report = exists(out.report + "/report.html");
    out.drew = exists(out.report + "/steps/pictures.csv");
    out.reference = readText(out.report + "/steps/reference.csv");
    out.rest = shell(command);
    return out;
  }();
  return made;
}

TEST(CliStudy, QuickStudyHasEveryTable) {
  const std::string report = study().report;
  ASSERT_EQ(study().rest.code, 0) << study().rest.output;
  EXPECT_TRUE(exists(report + "/report.html"));
  const Csv csv = readCsv(report + "/evaluate.csv");
  const auto lines = [&](const char* name) {
    const std::string text = readText(report + name);
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_EQ(lines("/evaluate.json"), lines("/evaluate.csv") + 1);  // one row per line
  for (const std::string table :
       {"table1", "multiview", "layers", "labels", "held-out", "tuning", "bake", "rate", "speed", "pictures", "about"})
    EXPECT_TRUE(csv.tables.count(table)) << table;
  for (const std::string method : {"fvvr", "naive", "spatial", "temporal-paper", "joint", "joint-default"}) {
    EXPECT_TRUE(csv.methods.count("table1 " + method)) << method;
    EXPECT_TRUE(csv.methods.count("held-out " + method)) << method;
    EXPECT_GT(first(csv, "held-out", method, "psnr_fg_db"), 18) << method;  // a checkered box, ray-traced
    EXPECT_GT(first(csv, "held-out", method, "psnr_seen_db"), 18) << method;
    EXPECT_GT(first(csv, "table1", method, "total_bytes"), 1000) << method;
    if (method == "fvvr") continue;
    EXPECT_GT(first(csv, "labels", method, "seen_flip_percent"), -1) << method;
    EXPECT_GT(first(csv, "table1", method, "ssim_fg"), 0.7) << method;
    EXPECT_LE(first(csv, "table1", method, "ssim_fg"), 1) << method;
    EXPECT_GT(first(csv, "table1", method, "percent_of_masked"), 0) << method;
    // A percentage, or a row that no rate reaches this quality.
    for (const std::string quality : {"held_out_psnr", "held_out_ssim", "tuned_psnr", "tuned_ssim"})
      EXPECT_NE(has(csv, "table1", method, "percent_at_equal_" + quality),
                has(csv, "table1", method, "beyond_range_at_" + quality))
          << method << " " << quality;
  }
  // Expected results of this one bake, so that no change of labels, texels, codec or renderer loses quality unnoticed.
  for (const auto& [method, psnr_db, ssim] :
       {std::tuple{"fvvr", 29.06, 0.950}, std::tuple{"naive", 30.21, 0.973}, std::tuple{"joint", 30.74, 0.975},
        std::tuple{"joint-default", 31.05, 0.977}}) {
    EXPECT_NEAR(first(csv, "held-out", method, "psnr_fg_db"), psnr_db, 0.15) << method;
    EXPECT_NEAR(first(csv, "held-out", method, "ssim_fg"), ssim, 0.003) << method;
  }
  const auto label = [&](const std::string& method, const char* quantity) {
    return csv.values.at("label-parts,turn," + method + ",layer=1," + quantity);
  };
  for (const auto& [method, seams, flips] :
       {std::tuple{"naive", 1.32, 0.39}, std::tuple{"spatial", 1.04, 1.00}, std::tuple{"joint", 0.0, 0.0},
        std::tuple{"joint-no-partial", 1.25, 0.0}}) {
    EXPECT_NEAR(label(method, "seen_seam_percent"), seams, 0.1) << method;
    EXPECT_NEAR(label(method, "seen_flip_percent"), flips, 0.1) << method;
  }
  const double layered = first(csv, "table1", "joint", "video_bytes");
  EXPECT_EQ(first(csv, "table1", "joint", "total_bytes"), layered + first(csv, "table1", "joint", "geometry_bytes") +
                                                              first(csv, "table1", "joint", "label_bytes") +
                                                              first(csv, "table1", "joint", "other_bytes"));
  EXPECT_EQ(first(csv, "multiview", "multiview", "raw_bytes"), 4 * 6 * 160 * 160 * 3);
  EXPECT_LT(first(csv, "multiview", "multiview", "masked_bytes"), first(csv, "multiview", "multiview", "raw_bytes"));
  // FVVR from decoded videos: the higher rate scores better, and neither exceeds the capture's own pictures.
  const auto videos = [&](int crf, const char* quantity) {
    return csv.values.at("multiview-codec,turn,h264,crf=" + std::to_string(crf) + "," + quantity);
  };
  EXPECT_GT(videos(20, "video_bytes"), videos(36, "video_bytes"));
  EXPECT_GT(videos(20, "held_out_psnr_fg_db"), videos(36, "held_out_psnr_fg_db"));
  EXPECT_GT(videos(20, "held_out_ssim_fg"), videos(36, "held_out_ssim_fg"));
  EXPECT_GT(videos(20, "tuned_psnr_fg_db"), videos(36, "tuned_psnr_fg_db"));
  EXPECT_GT(videos(20, "tuned_ssim_fg"), videos(36, "tuned_ssim_fg"));
  EXPECT_LT(videos(20, "held_out_psnr_fg_db"), first(csv, "held-out", "fvvr", "psnr_fg_db") + 0.1);
  EXPECT_LT(videos(20, "tuned_psnr_fg_db"), first(csv, "held-out", "fvvr-tuned", "psnr_fg_db") + 0.1);
  // Savings of FVVR with fewer cameras, and its quality then.
  EXPECT_GT(first(csv, "held-out", "fvvr-closest", "psnr_fg_db"), 18);
  EXPECT_TRUE(csv.methods.count("speed fvvr"));
  for (const std::string method : {"spatial", "joint", "joint-no-unseen", "joint-no-partial", "joint-neither"})
    EXPECT_TRUE(csv.methods.count("label-parts " + method)) << method;
  EXPECT_TRUE(exists(report + "/pictures/error-map-512.jpg"));
  EXPECT_TRUE(exists(report + "/pictures/worst-held-out-turn.jpg"));
  EXPECT_TRUE(exists(report + "/work/methods/joint-default/character.gltf"));
  EXPECT_FALSE(exists(report + "/work/methods/naive-512"));

  // A second run takes all rows from the first run's files.
  const std::string before = readText(report + "/evaluate.csv");
  fs::remove(report + "/report.html");
  const Outcome again = lab("study " + capture() + " -o " + report + " --quick");
  ASSERT_EQ(again.code, 0) << again.output;
  EXPECT_EQ(readText(report + "/evaluate.csv"), before);
  EXPECT_TRUE(exists(report + "/report.html"));
}

TEST(CliStudy, StoppedStudyGoesOn) {
  const Study& s = study();
  EXPECT_EQ(s.stopped.code, 130) << s.stopped.output;
  EXPECT_NE(s.stopped.output.find("again to go on"), std::string::npos) << s.stopped.output;
  EXPECT_TRUE(s.wrote_rows) << "those that were measured";
  EXPECT_TRUE(s.wrote_report);
  EXPECT_FALSE(s.drew);
  ASSERT_FALSE(s.reference.empty());
  EXPECT_EQ(s.rest.code, 0) << s.rest.output;
  EXPECT_EQ(readText(s.report + "/steps/reference.csv"), s.reference);
  EXPECT_TRUE(exists(s.report + "/steps/pictures.csv"));
}

TEST(CliStudy, WrongInputIsOneClearLine) {
  const std::string folder = scratch("wrong");
  const Outcome nothing = lab("study " + folder + "/none -o " + folder + "/r");
  EXPECT_EQ(nothing.code, 1);
  EXPECT_TRUE(isOneLineWith(nothing, folder + "/none")) << nothing.output;
  EXPECT_FALSE(exists(folder + "/r"));

  fs::create_directories(folder + "/thesis");
  writeText(folder + "/thesis/chapter.txt", "mine");
  const Outcome foreign = lab("study " + capture() + " -o " + folder + "/thesis --quick");
  EXPECT_EQ(foreign.code, 1);
  EXPECT_TRUE(isOneLineWith(foreign, "not a study's report")) << foreign.output;
  EXPECT_EQ(readText(folder + "/thesis/chapter.txt"), "mine");

  const std::string broken = copyOf(capture(), "study_broken");
  fs::remove_all(broken + "/turn/cam02");
  const Outcome missing = lab("study " + broken + " -o " + folder + "/r --quick");
  EXPECT_EQ(missing.code, 1);
  EXPECT_TRUE(isOneLineWith(missing, "cam02")) << missing.output;
  EXPECT_FALSE(exists(folder + "/r"));

  const Outcome sequence = lab("study " + capture() + " -o " + folder + "/r --sequences fly");
  EXPECT_EQ(sequence.code, 1);
  EXPECT_TRUE(isOneLineWith(sequence, "fly")) << sequence.output;

  const Outcome unwritable = lab("study " + capture() + " -o /proc/report --quick");
  EXPECT_EQ(unwritable.code, 1);
  EXPECT_TRUE(isOneLineWith(unwritable, "/proc/report")) << unwritable.output;
}

TEST(CliStudy, MethodsFromCamerasAreComparedAndGoOn) {
  const std::string report = scratch("methods") + "/report";
  const std::string command = "methods " + capture() + " -o " + report + " --quick";
  const Outcome stopped =
      interrupted(FOURDVT_LAB_BIN, command, report + "/steps/proxies.csv", scratch("methods_log") + "/log");
  EXPECT_EQ(stopped.code, 130) << stopped.output;
  EXPECT_NE(stopped.output.find("fourdvt-lab methods"), std::string::npos)
      << stopped.output;  // the command to resume with
  EXPECT_FALSE(exists(report + "/steps/pictures.csv"));
  const std::string proxies = readText(report + "/steps/proxies.csv");
  ASSERT_FALSE(proxies.empty());

  const Outcome run = lab(command);
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_EQ(readText(report + "/steps/proxies.csv"), proxies);
  for (const char* file :
       {"/report.html", "/projective.json", "/pictures/methods-turn.jpg", "/pictures/close-ups-turn.jpg",
        "/pictures/worst-given-turn.jpg", "/pictures/cross-turn.jpg", "/work/surfaces/hull/turn/000000.ply"})
    EXPECT_TRUE(exists(report + file)) << file;
  const Csv csv = readCsv(report + "/projective.csv");
  for (const std::string table : {"condition", "view", "cross", "stage", "pictures", "about"})
    EXPECT_TRUE(csv.tables.count(table)) << table;
  const auto value = [&](const std::string& condition, const std::string& quantity) {
    for (const auto& [key, value] : csv.values)
      if (key.rfind("condition,turn,fvvr," + condition + " ", 0) == 0 &&
          key.substr(key.size() - quantity.size() - 1) == "," + quantity)
        return value;
    ADD_FAILURE() << condition << " " << quantity;
    return -1.0;
  };
  // On a checkered box the true surface scores best, and displaced cameras cost sharpness and quality.
  EXPECT_GT(value("axis=proxy at=given", "psnr_fg_db"), 24);
  EXPECT_GT(value("axis=proxy at=given", "ssim_fg"), 0.9);
  EXPECT_GT(value("axis=proxy at=given", "psnr_fg_db"), value("axis=proxy at=hull", "psnr_fg_db") + 1);
  EXPECT_GT(value("axis=proxy at=given", "ssim_fg"), value("axis=rotation at=0.1", "ssim_fg"));
  EXPECT_GE(value("axis=proxy at=hull", "shift_tolerant_db"), value("axis=proxy at=hull", "psnr_fg_db"));
  EXPECT_LT(value("axis=proxy at=given", "flicker_levels"), value("axis=proxy at=hull", "flicker_levels"));
  EXPECT_EQ(value("axis=proxy at=given", "ratio_to_fvvr"), 1);
  EXPECT_GT(csv.values.at("cross,turn,fvvr,proxy=given own=1,psnr_fg_db"),
            csv.values.at("cross,turn,fvvr,proxy=given own=0,psnr_fg_db"));

  // A report of another kind is not overwritten; unknown methods are refused.
  const Outcome other = lab("study " + capture() + " -o " + report + " --quick");
  EXPECT_EQ(other.code, 1);
  EXPECT_TRUE(isOneLineWith(other, "study of other settings")) << other.output;
  const Outcome unknown = lab("methods " + capture() + " -o " + report + "2 --methods fvvr,holography");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_TRUE(isOneLineWith(unknown, "holography")) << unknown.output;
  EXPECT_FALSE(exists(report + "2"));
}

}  // namespace
}  // namespace fourdvt::test
