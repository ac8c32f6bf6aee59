// SPDX-License-Identifier: Apache-2.0
// Finds a camera's videos, pictures, mattes and plates by its name. Does NOT open them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fourdvt::capture {

// A video, or pictures in the order of the numbers in their names.
struct View {
  std::string video;
  std::vector<std::string> pictures;
  std::vector<int64_t> numbers;  // of the pictures (pictureNumbers); empty: their names have none
  uint32_t first_number = 0;     // of the links to the pictures
  const std::string& first() const { return video.empty() ? pictures.front() : video; }
};

// NAME.mp4 (.mkv, .mov, .avi, .webm), a folder NAME with numbered pictures, one picture or one video, or NAME.png
// (.jpg …), in `folder` or in its folder videos, images, video, rgbs or frames; else the only video there in whose name
// NAME stands between other signs than letters and digits.
std::optional<View> findView(const std::string& folder, const std::string& name);
// A file or folder that a calibration names.
std::optional<View> viewAt(const std::string& path);
// The same, where the extension may be left out.
std::optional<View> viewNear(const std::string& path);
// A picture that a calibration lists, with or without its extension, in `folder` or its folders as above.
std::optional<View> findListed(const std::string& folder, const std::string& listed);

// maskNN for camNN, as captures call them; or NAME, or what the calibration lists, in `folder`'s folder masks, mask or
// mattes, where pictures may be called NAME.jpg.png as COLMAP does; or mask.mp4, mask/ … in the camera's own folder.
std::optional<View> findMattes(const std::string& folder, const std::string& name, const std::string& listed = {});
// Pictures of the empty studio: called background, bg, plate, empty or clean, in the camera's folder, or folders of
// that name with NAME.png …, or NAME_background.png ….
std::optional<View> findPlates(const std::string& folder, const std::string& name);

// Videos that lie beside a camera's file, or the folder of its pictures, and have its name, too.
std::vector<std::string> videosBeside(const std::string& first);

// Videos, and folders with numbered pictures, which lie where findView looks, but none of `names` fits them.
std::vector<std::string> viewsWithoutCamera(const std::string& folder, const std::vector<std::string>& names);

}  // namespace fourdvt::capture
