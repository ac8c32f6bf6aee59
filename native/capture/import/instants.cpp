// SPDX-License-Identifier: Apache-2.0
#include "capture/import/instants.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "capture/picture_clock.h"

namespace fourdvt::capture {
namespace {

constexpr double kDay_s = 24 * 3600;
constexpr double kNotedOff = 0.1;  // steps: deviation of a picture from its instant that is noted

std::string fileName(const std::string& path) { return std::filesystem::path(path).filename().string(); }

void showInOrder(Clip& clip) {
  clip.shown.clear();
  for (size_t i = 0; i < clip.pictures(); ++i) clip.shown.push_back({int64_t(i), i});
}

Error variableRate(const Clip& clip, double fps) {
  double least = 1e300, most = 0;
  const std::vector<double>& t = clip.listing.times_s;
  for (size_t i = 1; i < t.size(); ++i)
    least = std::min(least, t[i] - t[i - 1]), most = std::max(most, t[i] - t[i - 1]);
  return {ErrorId::FileUnreadable, clip.view.video + ": its frame rate varies (its pictures are " +
                                       printed("%.3g", 1000 * least) + " to " + printed("%.3g", 1000 * most) +
                                       " ms apart); make it constant: " + constantRateCommand(clip.view.video, fps)};
}

// Sets the instants of one video relative to its first picture.
Status setVideoInstants(Clip& clip, double fps, ClipNotes& notes) {
  if (clip.listing.times_s.empty()) {
    showInOrder(clip);
    return {};
  }
  const auto clock = clockOf(clip.listing.times_s);
  if (!clock) return variableRate(clip, fps);
  clip.step_s = clock->step_s;
  for (size_t i = 0; i < clock->instants.size(); ++i) clip.shown.push_back({clock->instants[i], i});
  if (clock->max_off > std::max(kNotedOff, 2 * clip.listing.tick_s / std::max(clock->step_s, 1e-9)))
    notes.done.push_back(clip.view.video + ": its pictures lie up to " + printed("%.2f", clock->max_off) +
                         " frames off a constant rate; the nearest ones are paired");
  return {};
}

// Checks that all videos run at the rate of the first one: within half a frame at the end.
Status checkRates(const std::vector<Clip*>& videos) {
  const Clip* first = nullptr;
  for (const Clip* clip : videos) {
    if (clip->step_s == 0) continue;
    if (!first) first = clip;
    const double drift = (clip->step_s / first->step_s - 1) * double(clip->shown.back().instant);
    if (std::abs(drift) <= 0.5) continue;
    return Error{ErrorId::FileUnreadable,
                 clip->view.video + ": " + printed("%.5g", clip->fps) + " frames a second, but " + first->view.video +
                     " has " + printed("%.5g", first->fps) + ", so that they are " + printed("%.3g", std::abs(drift)) +
                     " frames out of step at the end; give all clips one rate: " +
                     constantRateCommand(clip->view.video, first->fps)};
  }
  return {};
}

// Start of each video relative to the first one, in frames; empty if their time codes have no common instant.
std::vector<int64_t> timecodeStarts(const std::vector<Clip*>& videos) {
  std::vector<int64_t> starts;
  for (const Clip* clip : videos) {
    double later_s = *clip->listing.timecode_s - *videos[0]->listing.timecode_s;
    later_s -= kDay_s * std::round(later_s / kDay_s);  // across midnight
    starts.push_back(std::llround(later_s / clip->step_s));
  }
  int64_t begin = INT64_MIN, end = INT64_MAX;
  for (size_t i = 0; i < videos.size(); ++i) {
    begin = std::max(begin, starts[i]);
    end = std::min(end, starts[i] + videos[i]->shown.back().instant);
  }
  if (begin > end) return {};
  return starts;
}

void offsetByTimecodes(const std::vector<Clip*>& videos, ClipNotes& notes) {
  std::string with, without;
  for (const Clip* clip : videos) {
    std::string& list = clip->listing.timecode_s && clip->step_s > 0 ? with : without;
    list += (list.empty() ? "" : ", ") + clip->camera;
  }
  if (with.empty() || videos.size() < 2) return;
  if (!without.empty()) {
    notes.warnings.push_back("time codes are not used: " + without + " has none; clips are taken to begin together");
    return;
  }
  const std::vector<int64_t> starts = timecodeStarts(videos);
  if (starts.empty()) {
    notes.warnings.push_back(
        "time codes are not used: by them no instant is in all clips; they are taken to begin "
        "together");
    return;
  }
  const int64_t earliest = *std::min_element(starts.begin(), starts.end());
  std::string list;
  for (size_t i = 0; i < videos.size(); ++i) {
    for (Shown& shown : videos[i]->shown) shown.instant += starts[i] - earliest;
    if (starts[i] == earliest) continue;
    list += (list.empty() ? "" : ", ") + videos[i]->camera + " by " + std::to_string(starts[i] - earliest);
  }
  if (!list.empty())
    notes.done.push_back("by their time codes clips begin later than the first one, in frames: " + list +
                         " (--ignore-time-codes: they begin together)");
}

// Notes creation times that differ.
void noteCreationTimes(const std::vector<Clip*>& videos, ClipNotes& notes) {
  std::string earliest, latest, first, last;
  for (const Clip* clip : videos) {
    const std::string& created = clip->listing.created;
    if (created.empty()) return;
    if (earliest.empty() || created < earliest) earliest = created, first = clip->camera;
    if (created > latest) latest = created, last = clip->camera;
  }
  if (earliest == latest) return;
  notes.done.push_back("creation_time, a hint that is not used, differs: " + earliest + " (" + first + ") to " +
                       latest + " (" + last + "); clips are taken to begin together");
}

bool ascending(const std::vector<int64_t>& numbers) {
  return !numbers.empty() &&
         std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<int64_t>()) == numbers.end();
}

// Pairs by numbers common to all folders; an instant is a number's rank among those of all.
bool pairByNumber(const std::vector<Clip*>& folders) {
  std::map<int64_t, size_t> counts;
  size_t fewest = SIZE_MAX;
  for (const Clip* clip : folders) {
    for (const int64_t number : clip->view.numbers) ++counts[number];
    fewest = std::min(fewest, clip->view.numbers.size());
  }
  size_t common = 0;
  std::map<int64_t, int64_t> instants;
  for (const auto& [number, clips] : counts) {
    common += clips == folders.size();
    instants.emplace(number, int64_t(instants.size()));
  }
  if (2 * common < fewest) return false;
  for (Clip* clip : folders) {
    clip->shown.clear();
    for (size_t i = 0; i < clip->view.numbers.size(); ++i) clip->shown.push_back({instants[clip->view.numbers[i]], i});
  }
  return true;
}

// Pairs time stamps that differ a little: each picture belongs to the nearest one of the folder with the maximum count.
bool pairByNearest(const std::vector<Clip*>& folders) {
  const Clip& longest = **std::max_element(folders.begin(), folders.end(), [](const Clip* a, const Clip* b) {
    return a->view.numbers.size() < b->view.numbers.size();
  });
  const std::vector<int64_t> clock = longest.view.numbers;
  std::vector<int64_t> steps;
  for (size_t i = 1; i < clock.size(); ++i) steps.push_back(clock[i] - clock[i - 1]);
  if (steps.empty()) return false;
  std::nth_element(steps.begin(), steps.begin() + ptrdiff_t(steps.size() / 2), steps.end());
  const int64_t most = steps[steps.size() / 2] / 2;
  for (Clip* clip : folders) {
    clip->shown.clear();
    for (size_t i = 0; i < clip->view.numbers.size(); ++i) {
      const int64_t number = clip->view.numbers[i];
      auto nearest = std::lower_bound(clock.begin(), clock.end(), number);
      if (nearest == clock.end() || (nearest != clock.begin() && number - nearest[-1] < *nearest - number)) --nearest;
      const int64_t instant = nearest - clock.begin();
      const bool free = clip->shown.empty() || clip->shown.back().instant < instant;
      if (free && std::abs(*nearest - number) <= most) clip->shown.push_back({instant, i});
    }
    if (2 * clip->shown.size() < clip->view.numbers.size()) return false;
  }
  return true;
}

void setFolderInstants(const std::vector<Clip*>& folders, ClipNotes& notes) {
  const bool single = std::all_of(folders.begin(), folders.end(), [](const Clip* c) { return c->pictures() == 1; });
  const bool numbered =
      std::all_of(folders.begin(), folders.end(), [](const Clip* c) { return ascending(c->view.numbers); });
  if (!single && numbered && (pairByNumber(folders) || pairByNearest(folders))) return;
  for (Clip* clip : folders) showInOrder(*clip);
  if (single || folders.size() < 2) return;
  notes.warnings.push_back("the numbers in the names of pictures, such as " + folders[0]->nameOf(0) + " and " +
                           folders[1]->nameOf(0) +
                           ", have too little in common; pictures are paired in their order: name those of an instant "
                           "alike if that is wrong");
}

// Numbers of the pictures of a folder's mattes, by the numbers in their names.
std::vector<int64_t> picturesOfMattes(const Clip& pictures, const Clip& mattes) {
  const std::vector<int64_t>&numbers = mattes.view.numbers, &own = pictures.view.numbers;
  std::vector<int64_t> out;
  if (!ascending(numbers)) return out;
  if (own.empty()) {  // videos number pictures from 0 or from 1
    const int64_t last = int64_t(pictures.pictures()) - 1;
    const int64_t start = numbers.size() == pictures.pictures() ? numbers.front()
                          : numbers.back() == last              ? 0
                          : numbers.back() == last + 1          ? 1
                                                                : numbers.front();
    for (const int64_t number : numbers) out.push_back(number - start);
    return out;
  }
  for (const int64_t number : numbers) {
    const auto at = std::lower_bound(own.begin(), own.end(), number);
    out.push_back(at != own.end() && *at == number ? at - own.begin() : -1);
  }
  if (std::all_of(out.begin(), out.end(), [](int64_t i) { return i < 0; })) out.clear();
  return out;
}

// Returns true if the lists differ by a constant.
bool differByAConstant(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i] - b[i] != a[0] - b[0]) return false;
  return true;
}

}  // namespace

std::string Clip::nameOf(size_t picture) const {
  if (!view.video.empty()) return "picture " + std::to_string(picture) + " of " + fileName(view.video);
  const std::filesystem::path path(view.pictures[picture]);
  return path.parent_path().filename().string() + "/" + path.filename().string();
}

double commonRate(const std::vector<Clip>& clips) {
  for (const Clip& clip : clips)
    if (clip.fps > 0) return clip.fps;
  return 0;
}

Status setInstants(std::vector<Clip>& clips, bool time_codes, ClipNotes& notes) {
  std::vector<Clip*> videos, folders;
  for (Clip& clip : clips) (clip.view.video.empty() ? folders : videos).push_back(&clip);
  for (Clip* clip : videos) FOURDVT_TRY(setVideoInstants(*clip, commonRate(clips), notes));
  FOURDVT_TRY(checkRates(videos));
  if (time_codes) offsetByTimecodes(videos, notes);
  const bool coded =
      std::any_of(videos.begin(), videos.end(), [](const Clip* c) { return !c->listing.timecode.empty(); });
  if (!coded) noteCreationTimes(videos, notes);
  if (!folders.empty()) setFolderInstants(folders, notes);
  return {};
}

bool numberMattesAlike(const std::vector<Clip>& clips, const std::vector<Clip>& mattes) {
  std::set<int64_t> shifts;
  for (const Clip& matte : mattes)
    for (const Clip& clip : clips)
      if (clip.camera == matte.camera && !clip.view.numbers.empty() && !matte.view.numbers.empty())
        shifts.insert(matte.view.numbers[0] - clip.view.numbers[0]);
  return shifts.size() < 2;
}

void setMatteInstants(const Clip& pictures, Clip& mattes, bool alike, ClipNotes& notes) {
  mattes.shown.clear();
  const bool as_many = pictures.pictures() == mattes.pictures();
  const bool both_numbered = !pictures.view.numbers.empty() && !mattes.view.numbers.empty();
  const bool same = both_numbered && pictures.view.numbers == mattes.view.numbers;
  const bool shifted =
      both_numbered && (same || alike) && differByAConstant(pictures.view.numbers, mattes.view.numbers);
  if (shifted && pictures.view.numbers[0] != mattes.view.numbers[0])
    notes.done.push_back("mattes of " + pictures.camera + " are numbered otherwise (" + mattes.nameOf(0) + " for " +
                         pictures.nameOf(0) + ") and paired in order");
  if (as_many && (shifted || !both_numbered)) {
    for (const Shown& shown : pictures.shown) mattes.shown.push_back({shown.instant, shown.picture});
    return;
  }
  const auto clock = clockOf(mattes.listing.times_s);
  if (!mattes.view.video.empty() && pictures.step_s > 0 && clock && clock->step_s > 0) {
    for (size_t i = 0; i < clock->instants.size(); ++i)
      mattes.shown.push_back({pictures.shown.front().instant + clock->instants[i], i});
    return;
  }
  std::vector<int64_t> of = picturesOfMattes(pictures, mattes);
  if (of.empty())  // pairs in order
    for (size_t i = 0; i < mattes.pictures(); ++i) of.push_back(int64_t(i));
  std::map<int64_t, int64_t> instants;  // picture → instant
  for (const Shown& shown : pictures.shown) instants[int64_t(shown.picture)] = shown.instant;
  for (size_t i = 0; i < of.size(); ++i)
    if (const auto at = instants.find(of[i]); at != instants.end()) mattes.shown.push_back({at->second, i});
}

}  // namespace fourdvt::capture
