// SPDX-License-Identifier: Apache-2.0
// Cameras of a calibration that lists pictures: names cameras by the pictures' paths, and merges several pictures of
// one static camera. Uses paths only, no files.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

struct ListedPicture {
  CaptureCamera camera;  // name unused
  std::string path;      // path in the list: "rig1/cam00/image0001.jpg"; '/' or '\'
  std::string where;     // prefix of messages: "images.txt:3: "
};

struct ListedCamera {
  CaptureCamera camera;
  std::string pictures;  // listed path of the camera's picture, or the folder of its pictures if that names the camera
  bool folder = false;   // `pictures` is a folder
  size_t first = 0;      // index of its first picture in the list
};

// Merges pictures and names cameras. Pictures in one folder with one pose and lens are one camera at several instants
// if their names differ in a number alone. If each camera has a folder of its own, it is named by the parts of the path
// that differ between cameras ("cam00/000000.png", "rig1/cam00/image0001.jpg": cam00); otherwise by the file's name
// without extension, unless that is a number alone. Errors: CameraPose (two cameras of one name, names that are invalid
// file names, folders in which a camera moves between pictures).
Result<std::vector<ListedCamera>> camerasOfPictures(const std::vector<ListedPicture>& pictures);

}  // namespace fourdvt::capture
