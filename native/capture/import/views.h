// SPDX-License-Identifier: Apache-2.0
// Finds a camera's videos, pictures, mattes and plates by its name, without opening them, and reads the numbers and
// time stamps in the names of pictures (picture_names.cpp).
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
  std::vector<int64_t> numbers;  // numbers of the pictures (pictureNumbers); empty: names without numbers
  uint32_t first_number = 0;     // first number of the links to the pictures
  const std::string& first() const { return video.empty() ? pictures.front() : video; }
};

// Finds NAME.mp4 (.mkv, .mov, .avi, .webm), a folder NAME with numbered pictures, one picture or one video, or NAME.png
// (.jpg …), in `folder` or in its folder videos, images, video, rgbs or frames; else the only video there whose name
// contains NAME between characters other than letters and digits.
std::optional<View> findView(const std::string& folder, const std::string& name);
// Opens a file or folder that a calibration names.
std::optional<View> viewAt(const std::string& path);
// viewAt with an optional extension.
std::optional<View> viewNear(const std::string& path);
// Finds a picture listed by a calibration, with or without its extension, in `folder` or the folders of findView.
std::optional<View> findListed(const std::string& folder, const std::string& listed);

// Finds maskNN for camNN, as in captures; or NAME, or the calibration's listed name, in `folder`'s folder masks, mask
// or mattes, where pictures may be called NAME.jpg.png as in COLMAP; or mask.mp4, mask/ … in the camera's own folder.
std::optional<View> findMattes(const std::string& folder, const std::string& name, const std::string& listed = {});
// Finds pictures of the empty studio: called background, bg, plate, empty or clean, in the camera's folder, or folders
// of that name with NAME.png …, or NAME_background.png ….
std::optional<View> findPlates(const std::string& folder, const std::string& name);

// Videos beside a camera's file, or beside the folder of its pictures, that also have its name.
std::vector<std::string> videosBeside(const std::string& first);

// Videos, and folders with numbered pictures, in the folders of findView that match none of `names`.
std::vector<std::string> viewsWithoutCamera(const std::string& folder, const std::vector<std::string>& names);

// Sort keys of a folder's pictures by name, without extension: the only number that differs between the names; seconds
// with a fraction ("1700000000.88", "1700000000_880000000") as nanoseconds; all digits of a date and time. Otherwise
// the last number in the name; -1 without a number.
std::vector<int64_t> pictureNumbers(const std::vector<std::string>& names);

}  // namespace fourdvt::capture
