// SPDX-License-Identifier: Apache-2.0
#include "jobs/records.h"

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "platform/files.h"
#include "platform/process.h"

namespace fourdvt::jobs {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Record, id, kind, host, seconds, cpu_s, peak_mb, read_mb, written_mb, attempt)

namespace {

namespace fs = std::filesystem;

// "done/gop-walk-3.0123456789abcdef.json" → "gop-walk-3.0123456789abcdef".
std::string stemOf(const Piece& piece) { return fs::path(piece.done()).stem().string(); }

std::optional<Record> recordIn(const std::string& path) {
  const auto bytes = platform::readFile(path);
  if (!bytes) return std::nullopt;
  const auto json = nlohmann::json::parse(bytes.value().begin(), bytes.value().end(), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    return json.get<Record>();
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

// Number of starts by piece, counted from file names STEM~NUMBER.HOST.PID.
std::map<std::string, uint32_t> startsIn(const std::string& job_folder) {
  std::map<std::string, uint32_t> out;
  std::error_code failed;
  for (fs::directory_iterator file(job_folder + "/attempts", failed), end; !failed && file != end;
       file.increment(failed)) {
    const std::string name = file->path().filename().string();
    ++out[name.substr(0, name.find('~'))];
  }
  return out;
}

}  // namespace

Result<Attempt> Attempt::begin(const std::string& job_folder, const Piece& piece) {
  Attempt out;
  out.folder_ = job_folder;
  out.piece_ = piece;
  const std::string stem = stemOf(piece);
  const auto starts = startsIn(job_folder);
  if (const auto before = starts.find(stem); before != starts.end()) out.number_ = before->second + 1;
  FOURDVT_TRY(platform::writeFileAtomic(
      job_folder + "/attempts/" + stem + "~" + std::to_string(out.number_) + "." + platform::ownSuffix(),
      std::string()));
  return out;
}

Result<Record> Attempt::finish() {
  const std::string path = folder_ + "/" + piece_.done();
  if (const auto earlier = recordIn(path)) return *earlier;
  Record r;
  r.id = piece_.id, r.kind = piece_.kind, r.host = platform::hostName(), r.attempt = number_;
  r.seconds = watch_.seconds();
  const platform::ProcessUsage usage = platform::processUsage();
  r.cpu_s = usage.cpu_s, r.peak_mb = double(usage.peak_bytes) / 1e6;
  r.read_mb = double(usage.read_bytes) / 1e6, r.written_mb = double(usage.written_bytes) / 1e6;
  FOURDVT_TRY(platform::writeFileAtomic(path, nlohmann::json(r).dump() + "\n"));
  return r;
}

bool isDone(const std::string& job_folder, const Piece& piece) {
  return recordIn(job_folder + "/" + piece.done()).has_value();
}

Progress readProgress(const std::string& job_folder, const Plan& plan) {
  Progress out;
  const auto starts = startsIn(job_folder);
  for (const Piece& piece : plan.pieces) {
    if (auto record = recordIn(job_folder + "/" + piece.done())) out.done[piece.id] = *record;
    if (const auto start = starts.find(stemOf(piece)); start != starts.end()) out.attempts[piece.id] = start->second;
  }
  return out;
}

Status checkNeeds(const std::string& job_folder, const Plan& plan, const Piece& piece) {
  std::string missing;
  size_t count = 0;
  for (const std::string& id : piece.needs) {
    const Piece* needed = plan.find(id);
    if (needed && isDone(job_folder, *needed)) continue;
    if (++count <= 3) missing += (missing.empty() ? "" : ", ") + id;
  }
  if (count == 0) return {};
  if (count > 3) missing += " and " + std::to_string(count - 3) + " more";
  return Error{ErrorId::InvalidArgument, job_folder + ": piece " + piece.id + " needs " + missing +
                                             ", which are not done; run those first, or all by Snakemake"};
}

}  // namespace fourdvt::jobs
