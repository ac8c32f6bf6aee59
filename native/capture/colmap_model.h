// SPDX-License-Identifier: Apache-2.0
// Common parts of COLMAP's text and binary models: camera models, cameras from numbers, poses of
// rigs, lists of pictures.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "capture/camera_names.h"
#include "capture/capture.h"
#include "capture/text.h"

namespace fourdvt::capture {

inline constexpr int kMaxColmapParameters = 12;

struct ColmapIntrinsics {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;
};

struct ColmapModel {
  int number;  // number in binary models
  std::string_view name;
  int parameters;
  ColmapIntrinsics (*make)(const double* parameters);
};

// Looks up a model by name. `where`: prefix of messages, file and place. Errors: CameraModel.
Result<const ColmapModel*> colmapModel(std::string_view name, const std::string& where);
Result<const ColmapModel*> colmapModel(int number, const std::string& where);

Error colmapPoseError(const std::string& where, const std::string& what);

// Errors: CameraPose (an implausible size, numbers that are not finite, focal lengths that are not positive).
Result<ColmapIntrinsics> makeIntrinsics(const ColmapModel& model, int width, int height, const double* parameters,
                                        const std::string& where);

// Error for a file that is truncated or of another kind.
Error colmapCutOff(const std::string& file);

// `pose`: QW QX QY QZ TX TY TZ. The camera's name is empty. Errors: CameraPose.
Result<CaptureCamera> makeColmapCamera(const ColmapIntrinsics& intrinsics, const std::array<double, 7>& pose,
                                       const std::string& where);

// Refuses paths that lead out of the image folder. Errors: CameraPose.
Status checkListedPath(std::string_view path, const std::string& where);

// Rigs and frames of COLMAP 3.12 and later (colmap_rigs.cpp): poses of images by their rig, which override those in
// images.txt or images.bin. Image number → QW QX QY QZ TX TY TZ, world to camera. Contains no images of cameras without
// a pose in their rig.
using RigPoses = std::map<uint64_t, std::array<double, 7>>;

// Parses texts of rigs.txt and frames.txt; messages name `path` as their folder. Errors: CameraPose.
Result<RigPoses> parseRigsText(std::string_view rigs, std::string_view frames, const std::string& path);
// Parses rigs.bin and frames.bin in the same way.
Result<RigPoses> parseRigsBinary(std::string_view rigs, std::string_view frames, const std::string& path);

// Images of a model, in file order. Poses in `rigs` override the images' own. Errors: CameraModel, CameraPose.
Result<std::vector<ListedPicture>> colmapTextPictures(std::string_view cameras_text, std::string_view images_text,
                                                      const RigPoses& rigs, const std::string& path);
Result<std::vector<ListedPicture>> colmapBinaryPictures(std::string_view cameras_bytes, std::string_view images_bytes,
                                                        const RigPoses& rigs, const std::string& path);

// Cameras of readColmapCameras with the pictures that the model lists. Errors: those of readColmapCameras.
Result<std::vector<ListedCamera>> readColmapListed(const std::string& folder);

}  // namespace fourdvt::capture
