// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "capture/import/takes.h"
#include "capture/picture_clock.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kNamedGaps = 3;

using Pictures = std::map<int64_t, size_t>;  // instant → picture

Pictures picturesOf(const Clip& clip) {
  Pictures out;
  for (const Shown& shown : clip.shown) out.emplace(shown.instant, shown.picture);
  return out;
}

struct Camera {
  const Clip *colour = nullptr, *mattes = nullptr;  // mattes: may be null
  Pictures pictures, matte_pictures;
  // Returns true if picture and matte exist; two videos share one picture number.
  bool has(int64_t instant) const {
    const auto picture = pictures.find(instant);
    if (picture == pictures.end() || !mattes) return picture != pictures.end();
    const auto matte = matte_pictures.find(instant);
    const bool videos = !colour->view.video.empty() && !mattes->view.video.empty();
    return matte != matte_pictures.end() && (!videos || matte->second == picture->second);
  }
};

std::vector<Camera> camerasOf(const std::vector<Clip>& clips, const std::vector<Clip>& mattes) {
  std::vector<Camera> out;
  for (const Clip& clip : clips) {
    Camera camera{&clip, nullptr, picturesOf(clip), {}};
    for (const Clip& matte : mattes)
      if (matte.camera == clip.camera) camera.mattes = &matte, camera.matte_pictures = picturesOf(matte);
    out.push_back(std::move(camera));
  }
  return out;
}

// Instants at which at least one camera has a picture; frames are consecutive there.
std::vector<int64_t> instantsOf(const std::vector<Camera>& cameras) {
  std::set<int64_t> out;
  for (const Camera& camera : cameras)
    for (const auto& entry : camera.pictures) out.insert(entry.first);
  return {out.begin(), out.end()};
}

// Longest run of instants without a missing camera.
std::vector<int64_t> longestStretch(const std::vector<Camera>& cameras, const std::vector<int64_t>& instants) {
  size_t begin = 0, best = 0, most = 0;
  for (size_t i = 0; i < instants.size(); ++i) {
    if (!std::all_of(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.has(instants[i]); }))
      begin = i + 1;
    if (i + 1 - begin > most) most = i + 1 - begin, best = begin;
  }
  const auto first = instants.begin() + ptrdiff_t(best);
  return {first, first + ptrdiff_t(most)};
}

std::string seconds(double value) { return printed("%.3f s", value); }

// Instants between the latest beginning and the earliest end of all cameras.
std::vector<int64_t> commonSpan(const std::vector<Camera>& cameras, std::vector<int64_t> instants) {
  int64_t begin = INT64_MIN, end = INT64_MAX;
  for (const Camera& camera : cameras) {
    if (camera.pictures.empty()) return {};
    begin = std::max(begin, camera.pictures.begin()->first);
    end = std::min(end, camera.pictures.rbegin()->first);
  }
  std::erase_if(instants, [&](int64_t i) { return i < begin || i > end; });
  return instants;
}

class Report {
 public:
  // `instants`: common span of all cameras.
  Report(const std::vector<Camera>& cameras, const std::vector<int64_t>& instants, double fps, ClipNotes& notes)
      : cameras_(cameras), instants_(instants), fps_(fps), notes_(notes) {}

  // Warns of missing pictures and mattes within the common span.
  void lacking() const {
    for (const Camera& camera : cameras_) {
      std::vector<std::string> lost, without;
      for (const int64_t i : instants_) {
        const auto picture = camera.pictures.find(i);
        if (picture == camera.pictures.end())
          lost.push_back(nameLost(camera, i));
        else if (picture != camera.pictures.end() && camera.mattes && !camera.matte_pictures.count(i))
          without.push_back(camera.colour->nameOf(picture->second));
      }
      if (!lost.empty()) notes_.warnings.push_back(placeOf(*camera.colour) + ": lacks " + list(lost) + remedy(camera));
      if (!without.empty())
        notes_.warnings.push_back(placeOf(*camera.mattes) + ": lacks the matte of " + list(without));
      if (!lost.empty() || !without.empty()) continue;
      if (camera.mattes && camera.matte_pictures.empty())
        notes_.warnings.push_back(placeOf(*camera.mattes) + ": none of its mattes belongs to a picture");
    }
  }

  void ends() const {
    const Camera *late = &cameras_[0], *early = &cameras_[0], *first = &cameras_[0];
    for (const Camera& camera : cameras_) {
      if (camera.pictures.begin()->first > late->pictures.begin()->first) late = &camera;
      if (camera.pictures.begin()->first < first->pictures.begin()->first) first = &camera;
      if (camera.pictures.rbegin()->first < early->pictures.rbegin()->first) early = &camera;
    }
    if (late->colour->view.video.empty() && late->pictures.begin()->first > first->pictures.begin()->first)
      notes_.warnings.push_back(placeOf(*late->colour) + ": begins with " + nameFirst(*late) + ", others with " +
                                nameFirst(*first) + "; pictures are paired by their numbers");
    size_t most = 0;
    for (const Camera& camera : cameras_) most = std::max(most, camera.colour->pictures());
    const size_t fewest = early->colour->pictures();
    if (fewest < most && early->pictures.rbegin()->first < lastInstant())
      notes_.warnings.push_back(early->colour->view.first() + ": the shortest, with " + std::to_string(fewest) +
                                " frames; others have up to " + std::to_string(most));
  }

 private:
  int64_t lastInstant() const {
    int64_t last = INT64_MIN;
    for (const Camera& camera : cameras_) last = std::max(last, camera.pictures.rbegin()->first);
    return last;
  }

  static std::string nameFirst(const Camera& camera) { return camera.colour->nameOf(camera.pictures.begin()->second); }

  static std::string placeOf(const Clip& clip) {
    if (!clip.view.video.empty()) return clip.view.video;
    return std::filesystem::path(clip.view.first()).parent_path().string();
  }

  // Names a lost picture by time and the previous picture; in a folder by its name in another folder.
  std::string nameLost(const Camera& camera, int64_t instant) const {
    const auto after = std::prev(camera.pictures.upper_bound(instant));
    if (camera.colour->step_s > 0)
      return "a picture at " + seconds(double(instant - camera.pictures.begin()->first) * camera.colour->step_s) +
             " (after picture " + std::to_string(after->second) + ")";
    for (const Camera& other : cameras_)
      if (const auto at = other.pictures.find(instant); at != other.pictures.end() && other.colour->view.video.empty())
        return "the picture that " + other.colour->camera + " has as " + other.colour->nameOf(at->second);
    return "the picture after " + camera.colour->nameOf(after->second);
  }

  std::string remedy(const Camera& camera) const {
    const View& view = camera.colour->view;
    return view.video.empty() ? "" : "; to repeat the one before it: " + constantRateCommand(view.video, fps_);
  }

  static std::string list(const std::vector<std::string>& names) {
    std::string out;
    for (size_t i = 0; i < std::min(names.size(), kNamedGaps); ++i) out += (i == 0 ? "" : ", ") + names[i];
    return out + (names.size() > kNamedGaps ? " and " + std::to_string(names.size() - kNamedGaps) + " more" : "");
  }

  const std::vector<Camera>& cameras_;
  const std::vector<int64_t>& instants_;
  const double fps_;
  ClipNotes& notes_;
};

// Number that readers of the take give to the stretch's first picture: the video's own, else 0.
size_t baseOf(const Camera& camera, int64_t begin) {
  if (!camera.colour->view.video.empty()) return camera.pictures.at(begin);
  if (camera.mattes && !camera.mattes->view.video.empty()) return camera.matte_pictures.at(begin);
  return 0;
}

// Keeps the stretch's pictures in a folder's view, numbered from `base`.
void keepStretch(const Pictures& pictures, const std::vector<int64_t>& stretch, size_t base, View& view) {
  if (!view.video.empty()) return;
  View kept;
  for (const int64_t instant : stretch) kept.pictures.push_back(view.pictures[pictures.at(instant)]);
  kept.first_number = static_cast<uint32_t>(base);
  view = std::move(kept);
}

void setTake(const std::vector<Camera>& cameras, const std::vector<int64_t>& stretch, Take& take) {
  size_t most = 0;
  for (const Camera& camera : cameras) most = std::max(most, baseOf(camera, stretch[0]));
  take.frames = static_cast<uint32_t>(stretch.size());
  take.first_frame = static_cast<uint32_t>(most);
  for (const Camera& camera : cameras) {
    const size_t base = baseOf(camera, stretch[0]);
    const std::string& name = camera.colour->camera;
    if (base != most) take.offset_frames[name] = int64_t(base) - int64_t(most);
    keepStretch(camera.pictures, stretch, base, take.views.at(name));
    if (camera.mattes) keepStretch(camera.matte_pictures, stretch, base, take.mattes.at(name));
  }
}

// Notes intervals above one frame within which no camera has a picture; the pairs stay correct.
void noteJumps(const Camera& camera, const std::vector<int64_t>& stretch, const std::string& take, ClipNotes& notes) {
  std::string first;
  size_t more = 0;
  for (size_t i = 1; i < stretch.size(); ++i) {
    if (stretch[i] == stretch[i - 1] + 1) continue;
    more += !first.empty();
    if (first.empty())
      first = camera.colour->nameOf(camera.pictures.at(stretch[i - 1])) + " and " +
              camera.colour->nameOf(camera.pictures.at(stretch[i]));
  }
  if (first.empty()) return;
  notes.warnings.push_back("sequence " + take + ": no camera has a picture between " + first +
                           (more > 0 ? " and at " + std::to_string(more) + " more places" : "") +
                           "; the motion jumps there");
}

}  // namespace

Status pairPictures(const std::vector<Clip>& clips, const std::vector<Clip>& mattes, Take& take, ClipNotes& notes) {
  const std::vector<Camera> cameras = camerasOf(clips, mattes);
  const std::vector<int64_t> instants = instantsOf(cameras), stretch = longestStretch(cameras, instants);
  const std::vector<int64_t> common = commonSpan(cameras, instants);
  if (!common.empty()) {
    const Report report(cameras, common, commonRate(clips), notes);
    report.lacking();
    report.ends();
  }
  if (stretch.empty()) {
    const std::string why = notes.warnings.empty() ? "" : " (" + notes.warnings.back() + ")";
    return Error{ErrorId::VideoTooShort, take.folder + ": no instant is in the clips of all cameras" + why +
                                             "; cut them to begin together, or name pictures of an instant alike"};
  }
  setTake(cameras, stretch, take);
  take.skipped = static_cast<uint32_t>(stretch[0] - instants.front());
  noteJumps(cameras[0], stretch, take.name, notes);
  if (stretch.size() < common.size())
    notes.warnings.push_back("sequence " + take.name + ": " + std::to_string(stretch.size()) + " of " +
                             std::to_string(common.size()) + " frames are kept, from " +
                             clips[0].nameOf(cameras[0].pictures.at(stretch[0])) +
                             " on: the longest stretch that no camera lacks a picture or a matte of");
  return {};
}

}  // namespace fourdvt::capture
