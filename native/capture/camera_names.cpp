// SPDX-License-Identifier: Apache-2.0
#include "capture/camera_names.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr double kSameAngle = 2e-3;  // tolerance of a rotation matrix's elements: a tenth of a degree
constexpr double kSamePlace = 2e-3;  // share of the distance between the cameras that are farthest apart
constexpr double kSameLens = 1e-6;   // share of the focal length

using Parts = std::vector<std::string>;

struct Group {
  Parts folder;
  std::string stem;             // stem of its only picture, or the common part of the stems of several
  std::vector<size_t> members;  // indices of pictures
  bool by_folder = false;       // the folder contains this group alone
};

Parts partsOf(const std::string& path) {
  Parts out;
  std::string part;
  for (const char c : path + "/") {
    if (c != '/' && c != '\\') {
      part += c;
    } else {
      if (!part.empty() && part != ".") out.push_back(part);
      part.clear();
    }
  }
  return out;
}

std::string pathOf(const std::string& given, const Parts& parts) {
  return (given.starts_with('/') ? "/" : "") + joined(parts, "/");
}

bool hasLetter(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) || c >= 0x80; });
}

// "cam00_0017" without its last number; the whole stem without one.
std::string withoutLastNumber(const std::string& stem) {
  size_t end = stem.size();
  while (end > 0 && !isDigit(stem[end - 1])) --end;
  size_t begin = end;
  while (begin > 0 && isDigit(stem[begin - 1])) --begin;
  return begin == end ? stem : stem.substr(0, begin) + "#" + stem.substr(end);
}

double widest(const std::vector<ListedPicture>& pictures) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const ListedPicture& picture : pictures) {
    low = glm::min(low, picture.camera.pinhole.centreInWorld());
    high = glm::max(high, picture.camera.pinhole.centreInWorld());
  }
  return glm::length(high - low);
}

bool sameCamera(const CaptureCamera& a, const CaptureCamera& b, double extent) {
  const PinholeCamera &p = a.pinhole, &q = b.pinhole;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(p.cam_from_world[i][j] - q.cam_from_world[i][j]) <= kSameAngle)) return false;
  const double lens =
      std::max({std::abs(p.fx - q.fx), std::abs(p.fy - q.fy), std::abs(p.cx - q.cx), std::abs(p.cy - q.cy)});
  return glm::length(p.centreInWorld() - q.centreInWorld()) <= kSamePlace * extent && lens <= kSameLens * p.fx;
}

// Returns true if files name cameras and folders do not: "top/cam1.png", "top/cam2.png", "below/cam1.png" ….
bool namesCameras(const std::string& file) { return lowerCase(file).find("cam") != std::string::npos; }

// Error for moving cameras: pictures of at least two equal names, each with another pose.
Status refuseMotion(const std::map<Parts, std::vector<size_t>>& folders, const std::vector<ListedPicture>& pictures,
                    const std::vector<Parts>& parts, double extent) {
  std::map<std::string, size_t> named;  // file name → number of folders
  for (const Parts& path : parts) ++named[path.back()];
  for (const auto& [folder, members] : folders) {
    if (folder.empty() || namesCameras(parts[members[0]].back())) continue;
    for (size_t i = 1; i < members.size(); ++i) {
      const size_t a = members[0], b = members[i];
      const bool elsewhere = named[parts[a].back()] > 1 && named[parts[b].back()] > 1;
      if (!elsewhere || sameCamera(pictures[a].camera, pictures[b].camera, extent)) continue;
      return Error{ErrorId::CameraPose, pictures[b].where + "camera \"" + joined(folder, "/") +
                                            "\" has another pose or lens in " + parts[b].back() + " than in " +
                                            parts[a].back() +
                                            "; export the calibration of one instant, or calibrate cameras that stand "
                                            "still as a rig"};
    }
  }
  return {};
}

// Name without the number of a picture in a series: "cam00" of "cam00_0001"; the whole name without a separator.
std::string seriesName(const std::string& stem) {
  std::string name = withoutLastNumber(stem);
  const size_t number = name.find('#');
  if (number == std::string::npos || number + 1 != name.size()) return stem;
  name.resize(number);
  const size_t length = name.size();
  while (!name.empty() && !std::isalnum(static_cast<unsigned char>(name.back()))) name.pop_back();
  return name.empty() || name.size() == length ? stem : name;
}

// Groups the pictures of one folder by camera, in list order.
void groupFolder(const Parts& folder, const std::vector<size_t>& members, const std::vector<ListedPicture>& pictures,
                 const std::vector<Parts>& parts, double extent, std::vector<Group>& out) {
  const bool one_camera = !folder.empty() && std::all_of(members.begin(), members.end(), [&](size_t i) {
    return sameCamera(pictures[members[0]].camera, pictures[i].camera, extent);
  });
  std::map<std::string, std::vector<size_t>> series;  // name without its last number → groups in `out`
  for (const size_t i : members) {
    const std::string& file = parts[i].back();
    const std::string stem = file.substr(0, file.rfind('.'));
    std::vector<size_t>& groups = series[withoutLastNumber(stem)];
    const auto same = std::find_if(groups.begin(), groups.end(), [&](size_t g) {
      return (one_camera || seriesName(stem) != stem) &&
             sameCamera(pictures[out[g].members[0]].camera, pictures[i].camera, extent) &&
             parts[out[g].members[0]].back() != file;
    });
    if (same != groups.end()) {
      out[*same].members.push_back(i);
      continue;
    }
    groups.push_back(out.size());
    out.push_back({folder, stem, {i}});
  }
}

Parts withoutCommonEnds(const Parts& folder, const std::vector<Group>& groups) {
  size_t front = 0, back = 0;
  const auto all = [&](auto part) {
    return std::all_of(groups.begin(), groups.end(), [&](const Group& g) { return part(g.folder) == part(folder); });
  };
  const auto fromFront = [&](const Parts& f) { return front < f.size() ? f[front] : std::string(); };
  const auto fromBack = [&](const Parts& f) { return back < f.size() ? f[f.size() - 1 - back] : std::string(); };
  while (front < folder.size() && all(fromFront)) ++front;
  while (front + back < folder.size() && all(fromBack)) ++back;
  return {folder.begin() + static_cast<long>(front), folder.end() - static_cast<long>(back)};
}

bool distinct(const Parts& names) { return std::set<std::string>(names.begin(), names.end()).size() == names.size(); }

// Sets the groups' names, and by_folder of those named by their folder.
Parts namesOf(std::vector<Group>& groups) {
  std::map<Parts, std::pair<size_t, bool>> in_folder;  // number of groups; true if one of them has several pictures
  for (const Group& group : groups) {
    auto& [count, series] = in_folder[group.folder];
    ++count;
    series |= group.members.size() > 1;
  }
  Parts own, whole, folders;
  for (Group& group : groups) {
    const auto& [count, series] = in_folder[group.folder];
    const std::string stem = series ? seriesName(group.stem) : group.stem;
    group.by_folder = !group.folder.empty() && ((series && count == 1) || !hasLetter(group.stem));
    own.push_back(group.by_folder ? group.folder.back() : stem);
    const std::string folder = joined(withoutCommonEnds(group.folder, groups), "_");
    folders.push_back(folder);
    whole.push_back(folder + (folder.empty() ? "" : "_") + stem);
  }
  const bool named = std::none_of(folders.begin(), folders.end(), [](const auto& name) { return name.empty(); });
  if (groups.size() > 1 && named && distinct(folders)) {
    for (Group& group : groups) group.by_folder = true;
    return folders;
  }
  if (distinct(own)) return own;
  for (Group& group : groups) group.by_folder = false;
  return whole;
}

Status checkName(const std::string& name, const std::string& where) {
  if (name.empty()) return Error{ErrorId::CameraPose, where + "the image has no name; export the calibration again"};
  if (name != "." && name != "..") return {};
  return Error{ErrorId::CameraPose,
               where + "an image called " + name + " cannot name a camera's files; export the calibration again"};
}

}  // namespace

Result<std::vector<ListedCamera>> camerasOfPictures(const std::vector<ListedPicture>& pictures) {
  std::vector<Parts> parts;
  std::map<Parts, std::vector<size_t>> folders;
  std::vector<Parts> order;
  for (size_t i = 0; i < pictures.size(); ++i) {
    parts.push_back(partsOf(pictures[i].path));
    if (parts[i].empty()) FOURDVT_TRY(checkName({}, pictures[i].where));
    const Parts folder(parts[i].begin(), parts[i].end() - 1);
    if (folders[folder].empty()) order.push_back(folder);
    folders[folder].push_back(i);
  }
  const double extent = widest(pictures);
  FOURDVT_TRY(refuseMotion(folders, pictures, parts, extent));
  std::vector<Group> groups;
  for (const Parts& folder : order) groupFolder(folder, folders[folder], pictures, parts, extent, groups);
  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.members[0] < b.members[0]; });
  const Parts names = namesOf(groups);
  std::vector<ListedCamera> out;
  std::set<std::string> seen;
  for (size_t g = 0; g < groups.size(); ++g) {
    const size_t first = groups[g].members[0];
    const std::string& where = pictures[first].where;
    FOURDVT_TRY(checkName(names[g], where));
    if (!seen.insert(names[g]).second)
      return Error{ErrorId::CameraPose,
                   where + "camera \"" + names[g] + "\" is listed twice; export the calibration again"};
    const bool folder = groups[g].by_folder;
    out.push_back({pictures[first].camera, pathOf(pictures[first].path, folder ? groups[g].folder : parts[first]),
                   folder, first});
    out.back().camera.pinhole.name = names[g];
  }
  return out;
}

}  // namespace fourdvt::capture
