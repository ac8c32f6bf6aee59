// SPDX-License-Identifier: Apache-2.0
#include "capture/folder/result_folder.h"

#include <algorithm>
#include <filesystem>

#include "base/hash.h"
#include "base/text.h"
#include "capture/folder/linked_capture.h"
#include "jobs/plan.h"
#include "platform/files.h"
#include "platform/process.h"
#include "store/folder.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

constexpr int kPlacedAtOnce = 5;  // retries, where processes finish the same job at once

// Names relative to `folder`, sizes and times of all files below it, except a sequence's meshes and held-out pictures.
std::vector<std::string> filesOf(const std::string& folder, bool of_sequence) {
  std::vector<std::string> files;
  std::error_code failed, ignored;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (fs::recursive_directory_iterator it(folder, kFollow, failed), end; !failed && it != end; it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (of_sequence && it.depth() == 0 && (name == kMeshFolder || name.starts_with("test"))) {
      it.disable_recursion_pending();
      continue;
    }
    if (!it->is_regular_file(ignored)) continue;
    files.push_back(it->path().lexically_relative(folder).string() + " " + std::to_string(it->file_size(ignored)) +
                    " " + std::to_string(it->last_write_time(ignored).time_since_epoch().count()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Returns true where `inner` is `outer` or lies below it; both without links.
bool within(const fs::path& inner, const fs::path& outer) {
  const auto [a, b] = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
  return a == outer.end();
}

}  // namespace

std::string inputsKey(const Capture& capture) {
  uint64_t hash = kFnv1aStart;
  const auto add = [&](const std::string& text) {
    hash = fnv1a(std::string_view(text.c_str(), text.size() + 1), hash);
  };
  const ColmapText cameras = colmapText(capture.cameras, capture.metres_per_unit);
  add(cameras.cameras);
  add(cameras.images);
  for (const CaptureCamera& camera : capture.cameras)  // skew is missing from the texts
    if (camera.distortion.skew != 0) add(camera.pinhole.name + " " + std::to_string(camera.distortion.skew));
  add(std::to_string(int(capture.background_kind)) + " " + std::to_string(capture.ground_y_m));
  for (const std::string& folder : {capture.background_folder, capture.folder + "/" + kHintsFolder})
    for (const std::string& file : filesOf(folder, false)) add(file);
  for (const CaptureSequence& sequence : capture.sequences) {
    add(sequence.name + " " + std::to_string(sequence.frame_count));
    if (sequence.first_frame > 0) add("first frame " + std::to_string(sequence.first_frame));
    for (const auto& [camera, frames] : sequence.offset_frames) add(camera + " is off by " + std::to_string(frames));
    for (const std::string& file : filesOf(sequence.folder, true)) add(file);
  }
  return hexDigits(hash);
}

Result<std::string> checkedTarget(const std::string& folder, const std::string& capture_folder,
                                  const FolderWriter& writer) {
  std::error_code failed;
  fs::path target = fs::weakly_canonical(fs::absolute(folder, failed), failed);
  if (!target.has_filename()) target = target.parent_path();
  const auto bad = [&](const std::string& what) { return Error{ErrorId::InvalidArgument, folder + ": " + what}; };
  if (const fs::path source = fs::canonical(capture_folder, failed); !failed) {
    if (within(target, source)) return bad("lies inside the capture that is read; choose a folder beside it");
    for (const char* ending : {"", ".part", ".work"})
      if (within(source, target.string() + ending))
        return bad("would replace the capture that is read; choose another output folder");
  }
  if (!fs::exists(target, failed)) return target.string();
  if (!fs::is_directory(target, failed)) return bad("exists and is not a folder; choose another output folder");
  if (fs::is_empty(target, failed)) return target.string();
  if (!writer.not_with.empty() && fs::exists(target / writer.not_with, failed))
    return bad("has a " + writer.not_with + ", another command's result; choose another output folder");
  if (fs::exists(target / writer.marker, failed)) return target.string();
  return bad("exists and was not written by " + writer.command + " (no " + writer.marker +
             " inside); choose another output folder");
}

std::string frameName(uint32_t frame) {
  const std::string digits = std::to_string(frame);
  return std::string(6 - std::min<size_t>(6, digits.size()), '0') + digits;
}

Status ResultFolder::open(const std::string& key, bool resume) const {
  std::error_code failed;
  const auto found = store::keyOf(workFolder());
  for (const std::string& folder : {workFolder(), partFolder()}) {
    if (fs::exists(folder, failed) && !found)
      return Error{ErrorId::InvalidArgument, folder + ": exists and was not left by " + writer_.command +
                                                 "; move it away or choose another output folder"};
  }
  if (found && !found->ends_with(signature()))
    return Error{ErrorId::InvalidArgument, workFolder() +
                                               ": is unfinished work of another command, or of an earlier "
                                               "version; finish that, or remove it and " +
                                               partFolder()};
  const bool same = holds(key);
  if (resume && found && !same) {
    return Error{
        ErrorId::InvalidArgument,
        workFolder() +
            ": was left by a run with other options or of another build, or the capture's pictures, plates or cameras "
            "have changed since; repeat that run's options, or leave out --resume to begin anew"};
  }
  if (!resume || !same) {
    platform::removeFolder(partFolder());
    store::removeFolder(workFolder());
  }
  FOURDVT_TRY(store::setKey(workFolder(), key + signature()));
  return platform::makeFolder(partFolder());
}

ResultFolder ResultFolder::ofThisProcess() const {
  ResultFolder out = *this;
  out.part_ending_ += "." + platform::ownSuffix();
  return out;
}

Result<std::string> ResultFolder::openFor(const std::string& settings, Earlier earlier,
                                          const std::function<void(const std::string&)>& note) const {
  const std::string work = workFolder();
  const std::string key =
      jobs::folderKey(settings, earlier == Earlier::KeptIfSame, [&](const std::string& k) { return holds(k); });
  const bool other_build = jobs::holdsPlanOfAnotherBuild(work);
  if (other_build && earlier == Earlier::Kept)
    return Error{ErrorId::InvalidArgument, work +
                                               ": holds work of another build of fourdvt, which does not fit together "
                                               "with this one's; leave out --resume to begin anew"};
  const bool same = holds(key) && !other_build;
  std::error_code none;
  if (earlier == Earlier::KeptIfSame && !same && note && fs::exists(work, none))
    note(work + ": holds work of other settings, of another capture or of another build; all begins again");
  FOURDVT_TRY(open(key, earlier == Earlier::Kept || (earlier == Earlier::KeptIfSame && same)));
  return key;
}

bool ResultFolder::holds(const std::string& key) const { return store::keyOf(workFolder()) == key + signature(); }

Status ResultFolder::place() const {
  const std::string previous = workFolder() + "/previous." + platform::ownSuffix();  // only this process removes it
  std::error_code none;
  Status placed = platform::replaceFolder(partFolder(), target_, previous);
  for (int again = 0; again < kPlacedAtOnce && !placed.ok() && fs::exists(partFolder(), none); ++again)
    placed = platform::replaceFolder(partFolder(), target_, previous);
  FOURDVT_TRY(placed);
  platform::removeFolder(previous);
  return {};
}

Status ResultFolder::finish() const {
  FOURDVT_TRY(place());
  store::removeFolder(workFolder());
  return {};
}

}  // namespace fourdvt::capture
