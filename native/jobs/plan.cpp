// SPDX-License-Identifier: Apache-2.0
#include "jobs/plan.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/hash.h"
#include "base/text.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "platform/process.h"

namespace fourdvt::jobs {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;

uint64_t add(uint64_t hash, uint64_t value) {
  return fnv1a({reinterpret_cast<const uint8_t*>(&value), sizeof value}, hash);
}

Error unreadable(const std::string& path, const std::string& why) {
  return {ErrorId::FileUnreadable, path + ": " + why + "; run `fourdvt plan` again"};
}

Plan planFrom(const Json& json) {
  Plan plan;
  const Json& tool = json.at("tool");
  plan.tool = {tool.at("version"), tool.at("build"), tool.at("program")};
  plan.command = json.at("command");
  plan.arguments = json.at("arguments").get<std::vector<std::string>>();
  plan.capture = json.at("capture");
  plan.result = json.at("result");
  plan.frames = json.at("frames");
  plan.capture_s = json.at("capture_s");
  for (const Json& p : json.at("pieces")) {
    Piece piece;
    piece.id = p.at("id");
    piece.kind = p.at("kind");
    piece.needs = p.at("needs").get<std::vector<std::string>>();
    piece.seconds = p.at("seconds");
    piece.memory_mb = p.at("memory_mb");
    piece.inputs = std::stoull(p.at("inputs").get<std::string>(), nullptr, 16);
    piece.hash = std::stoull(p.at("hash").get<std::string>(), nullptr, 16);
    plan.pieces.push_back(std::move(piece));
  }
  if (plan.pieces.empty() || plan.pieces.back().kind != kFinish) throw std::invalid_argument("no last piece");
  return plan;
}

}  // namespace

std::string Piece::done() const { return "done/" + id + "." + hexDigits(hash) + ".json"; }

const Piece* Plan::find(const std::string& id) const {
  const auto found = std::find_if(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.id == id; });
  return found == pieces.end() ? nullptr : &*found;
}

void Piece::addInput(uint64_t digest) { inputs = add(inputs, digest); }

void Piece::setCost(double estimated_s, double max_mb) {
  seconds = std::round(10 * estimated_s) / 10;
  memory_mb = std::ceil(max_mb);
}

Status checkSequenceNames(const std::vector<std::string>& sequences, const std::string& capture_folder,
                          const std::string& command) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; };
  for (const std::string& name : sequences)
    if (!std::all_of(name.begin(), name.end(), fits))
      return Error{ErrorId::CaptureJson, capture_folder + "/capture.json: sequence name '" + name +
                                             "' cannot be part of the name of a piece; use letters, digits, '_', '-' " +
                                             "and '.', or run `fourdvt " + command + "`"};
  return {};
}

Status settleHashes(const std::string& settings_key, Plan& plan) {
  const uint64_t start = fnv1a(settings_key + plan.tool.build);
  std::map<std::string, uint64_t> settled;
  for (Piece& piece : plan.pieces) {
    piece.hash = add(fnv1a(piece.id, start), piece.inputs);
    for (const std::string& needed : piece.needs) {
      const auto known = settled.find(needed);
      if (known == settled.end())
        return Error{ErrorId::Internal, "piece " + piece.id + " comes before " + needed + ", which it needs"};
      piece.hash = add(piece.hash, known->second);
    }
    settled[piece.id] = piece.hash;
  }
  return {};
}

std::string planJson(const Plan& plan) {
  Json json;
  json["format"] = kFormat;
  json["tool"] = {{"version", plan.tool.version}, {"build", plan.tool.build}, {"program", plan.tool.program}};
  json["command"] = plan.command;
  json["arguments"] = plan.arguments;
  json["capture"] = plan.capture;
  json["result"] = plan.result;
  json["frames"] = plan.frames;
  json["capture_s"] = plan.capture_s;
  // One line per piece, so that plans of thousands of pieces remain readable and diffable.
  std::string text = json.dump(1);
  text.resize(text.size() - 2);
  text += ",\n \"pieces\": [";
  const char* separator = "\n  ";
  for (const Piece& p : plan.pieces) {
    const Json piece = {{"id", p.id},
                        {"kind", p.kind},
                        {"done", p.done()},
                        {"needs", p.needs},
                        {"seconds", p.seconds},
                        {"memory_mb", p.memory_mb},
                        {"threads", 2},
                        {"inputs", hexDigits(p.inputs)},
                        {"hash", hexDigits(p.hash)}};
    text += separator + piece.dump();
    separator = ",\n  ";
  }
  return text + "\n ]\n}\n";
}

Status writePlan(const std::string& job_folder, const Plan& plan) {
  for (const char* folder : {"done", "attempts", "logs"}) FOURDVT_TRY(platform::makeFolder(job_folder + "/" + folder));
  return platform::writeFileAtomic(job_folder + "/" + kPlanFile, planJson(plan));
}

void dropRecords(const std::string& job_folder, const Plan& plan, const std::function<bool(size_t piece)>& is_lost) {
  std::error_code ignored;
  for (size_t p = 0; p < plan.pieces.size(); ++p)
    if (plan.pieces[p].kind == kFinish || is_lost(p))
      std::filesystem::remove(job_folder + "/" + plan.pieces[p].done(), ignored);
}

std::string videoIndexFolder(const std::string& job_folder) { return job_folder + "/videos"; }

Status indexVideos(const std::string& job_folder, const std::vector<std::string>& paths,
                   const std::atomic<bool>* stop) {
  const std::string folder = videoIndexFolder(job_folder);
  FOURDVT_TRY(platform::makeFolder(folder));
  for (const std::string& path : paths) {
    if (stop && *stop) return Error{ErrorId::Interrupted, "stopped while listing the pictures of " + path};
    FOURDVT_TRY(platform::indexVideo(path, folder));
  }
  return {};
}

Error changedSincePlan(const std::string& what) {
  return {ErrorId::InvalidArgument,
          what + " have changed since the plan was made, or differ on this machine; run `fourdvt plan` again"};
}

Result<Plan> readPlan(const std::string& job_folder) {
  const std::string path = job_folder + "/" + kPlanFile;
  const auto bytes = platform::readFile(path);
  if (!bytes) return Error{ErrorId::FileMissing, path + ": there is none; make it with `fourdvt plan`"};
  const Json json = Json::parse(bytes.value().begin(), bytes.value().end(), nullptr, false);
  if (json.is_discarded() || !json.is_object() || json.value("format", 0) != kFormat)
    return unreadable(path, "not a plan of this version");
  try {
    return planFrom(json);
  } catch (const std::exception&) {
    return unreadable(path, "lacks a field, or has one of the wrong type");
  }
}

bool holdsPlanOfAnotherBuild(const std::string& job_folder) {
  const auto plan = readPlan(job_folder);
  return plan.ok() && plan.value().tool.build != thisTool().build;
}

Status checkTool(const std::string& job_folder, const Plan& plan) {
  const Tool& here = thisTool();
  if (plan.tool.build == here.build) return {};
  return Error{ErrorId::InvalidArgument,
               job_folder + "/" + kPlanFile + ": made by fourdvt " + plan.tool.version + " (build " + plan.tool.build +
                   ", " + plan.tool.program + "), but this is " + here.version + " (build " + here.build + ", on " +
                   platform::hostName() +
                   "): results of both would not fit together; run that program, with the same versions " +
                   "of the libraries that it uses, on every machine, or plan again with this one"};
}

}  // namespace fourdvt::jobs
