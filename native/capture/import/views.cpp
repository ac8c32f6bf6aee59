// SPDX-License-Identifier: Apache-2.0
#include "capture/import/views.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <set>

#include "capture/pictures.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> kVideoEndings{".mp4", ".mkv", ".mov", ".avi", ".webm"};
const std::set<std::string> kPictureEndings{".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"};
const std::set<std::string> kPlateNames{"background", "backgrounds", "bg", "plate", "plates", "empty", "clean"};
const std::set<std::string> kMatteNames{"masks", "mask", "mattes", "matte"};
constexpr const char* kViewFolders[] = {"", "videos", "images", "video", "rgbs", "frames"};

std::string stemOf(const fs::path& path) { return lowerCase(path.stem().string()); }
bool isVideo(const fs::path& path) { return kVideoEndings.count(lowerExtension(path)) > 0; }
bool isPicture(const fs::path& path) { return kPictureEndings.count(lowerExtension(path)) > 0; }
bool isAside(const std::string& stem) { return kPlateNames.count(stem) > 0 || kMatteNames.count(stem) > 0; }

// Name without extension, and without the second one of COLMAP's mattes (000000.jpg.png).
std::string pictureStem(const fs::path& path) {
  return (isPicture(path.stem()) ? path.stem().stem() : path.stem()).string();
}

// Pictures in the order of the numbers in their names.
View numberedView(const std::vector<std::string>& pictures) {
  std::vector<std::string> names;
  for (const std::string& path : pictures) names.push_back(pictureStem(path));
  const std::vector<int64_t> numbers = pictureNumbers(names);
  std::vector<size_t> order(pictures.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return numbers[a] < numbers[b]; });
  View view;
  for (const size_t i : order) view.pictures.push_back(pictures[i]), view.numbers.push_back(numbers[i]);
  return view;
}

// Pictures or video in a camera's folder; plates and mattes beside its pictures are left out unless `all`.
std::optional<View> viewInFolder(const fs::path& folder, bool all) {
  std::vector<std::string> numbered, videos, others;
  for (const fs::path& path : sortedEntries(folder)) {
    if ((!all && isAside(stemOf(path))) || isFolder(path)) continue;
    const bool has_number = pictureStem(path).find_first_of("0123456789") != std::string::npos;
    if (isVideo(path))
      videos.push_back(path.string());
    else if (isPicture(path) && has_number)
      numbered.push_back(path.string());
    else if (isPicture(path))
      others.push_back(path.string());
  }
  if (!numbered.empty()) return numberedView(numbered);
  if (videos.size() == 1) return View{videos[0], {}, {}};
  if (others.size() == 1) return View{{}, others, {}};
  return std::nullopt;
}

// Matches "cam00.jpg.png", COLMAP's name of the matte of cam00.jpg.
bool isMatteOf(const fs::path& path, const std::string& name) {
  const fs::path inner = path.stem();
  return isPicture(path) && isPicture(inner) && inner.stem().string() == name;
}

std::optional<View> viewNamed(const fs::path& folder, const std::string& name, bool all) {
  std::optional<View> picture, video;
  for (const fs::path& path : sortedEntries(folder)) {
    if (isFolder(path) || !(path.stem().string() == name || isMatteOf(path, name))) continue;
    if (isVideo(path) && (!video || lowerExtension(path) == ".mp4")) video = View{path.string(), {}, {}};
    if (isPicture(path) && !picture) picture = View{{}, {path.string()}, {}};
  }
  if (video) return video;
  if (isFolder(folder / name))
    if (auto inside = viewInFolder(folder / name, all)) return inside;
  return picture;
}

// Matches names between separators: "cam1" in "take_cam1-b".
bool standsAlone(const std::string& stem, const std::string& name) {
  const auto other = [&](size_t at) {
    return at >= stem.size() || !std::isalnum(static_cast<unsigned char>(stem[at]));
  };
  for (size_t at = stem.find(name); at != std::string::npos; at = stem.find(name, at + 1))
    if ((at == 0 || other(at - 1)) && other(at + name.size())) return true;
  return false;
}

std::vector<fs::path> videosWith(const fs::path& folder, const std::string& name) {
  std::vector<fs::path> out;
  for (const fs::path& path : sortedEntries(folder))
    if (isVideo(path) && standsAlone(path.stem().string(), name)) out.push_back(path);
  return out;
}

// Entries of `folder` with one of these names, ignoring case: folders, or files by their stem.
std::vector<fs::path> entriesNamed(const fs::path& folder, const std::set<std::string>& names) {
  std::vector<fs::path> out;
  for (const fs::path& path : sortedEntries(folder))
    if (names.count(isFolder(path) ? lowerCase(path.filename().string()) : stemOf(path))) out.push_back(path);
  return out;
}

std::optional<View> findAside(const std::string& folder, const std::string& name, const std::set<std::string>& names) {
  for (const fs::path& path : entriesNamed(fs::path(folder) / name, names))
    if (auto view = viewAt(path.string())) return view;
  for (const fs::path& path : entriesNamed(folder, names))
    if (auto view = viewNamed(path, name, true)) return view;
  for (const std::string& aside : names)
    for (const std::string& joined : {name + "_" + aside, name + "-" + aside, aside + "_" + name})
      if (auto view = viewNamed(folder, joined, true)) return view;
  return std::nullopt;
}

}  // namespace

std::optional<View> viewAt(const std::string& path) {
  if (isFolder(path)) return viewInFolder(path, true);
  if (!isFile(path)) return std::nullopt;
  if (isVideo(path)) return View{path, {}, {}};
  if (isPicture(path)) return View{{}, {path}, {}};
  return std::nullopt;
}

std::optional<View> findView(const std::string& folder, const std::string& name) {
  for (const char* inner : kViewFolders)
    if (auto view = viewNamed(fs::path(folder) / inner, name, false)) return view;
  for (const char* inner : kViewFolders) {
    const auto videos = videosWith(fs::path(folder) / inner, name);
    if (videos.size() == 1) return View{videos[0].string(), {}, {}};
  }
  return std::nullopt;
}

std::optional<View> viewNear(const std::string& path) {
  if (auto view = viewAt(path)) return view;
  return viewNamed(fs::path(path).parent_path(), fs::path(path).filename().string(), false);
}

std::optional<View> findListed(const std::string& folder, const std::string& listed) {
  if (listed.empty()) return std::nullopt;
  for (const char* inner : kViewFolders) {
    if (auto view = viewNear((fs::path(folder) / inner / listed).string())) return view;
  }
  return std::nullopt;
}

std::optional<View> findMattes(const std::string& folder, const std::string& name, const std::string& listed) {
  if (auto named = viewNamed(folder, matteStem(name), true)) return named;
  if (!listed.empty()) {
    for (const fs::path& path : entriesNamed(folder, kMatteNames))
      for (const std::string& own : {listed + ".png", listed})
        if (auto view = viewAt((path / own).string())) return view;
  }
  return findAside(folder, name, kMatteNames);
}

std::optional<View> findPlates(const std::string& folder, const std::string& name) {
  return findAside(folder, name, kPlateNames);
}

std::vector<std::string> videosBeside(const std::string& first) {
  const fs::path used = isVideo(first) ? fs::path(first) : fs::path(first).parent_path();
  const std::string name = isVideo(first) ? used.stem().string() : used.filename().string();
  std::vector<std::string> out;
  for (const fs::path& path : sortedEntries(used.parent_path()))
    if (path != used && isVideo(path) && !isFolder(path) && path.stem().string() == name) out.push_back(path.string());
  return out;
}

std::vector<std::string> viewsWithoutCamera(const std::string& folder, const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const char* inner : kViewFolders) {
    for (const fs::path& path : sortedEntries(fs::path(folder) / inner)) {
      const bool is_folder = isFolder(path);
      const std::string stem = is_folder ? path.filename().string() : path.stem().string();
      const bool known =
          std::any_of(names.begin(), names.end(), [&](const std::string& name) { return standsAlone(stem, name); });
      const bool view = is_folder ? viewInFolder(path, false).has_value() : isVideo(path);
      const bool searched = is_folder && std::any_of(std::begin(kViewFolders), std::end(kViewFolders),
                                                     [&](const char* searched_too) { return stem == searched_too; });
      if (view && !known && !searched && !isAside(lowerCase(stem))) out.push_back(path.string());
    }
  }
  return out;
}

}  // namespace fourdvt::capture
