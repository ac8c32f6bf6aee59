// SPDX-License-Identifier: Apache-2.0
// Writes the parts of an imported capture folder. Errors: WriteFailed, and those of pictures.
#pragma once

#include "capture/import/meshes.h"
#include "capture/import/takes.h"

namespace fourdvt::capture {

// Links pictures and mattes of the take's cameras, and its meshes, into `folder`/NAME.
Status linkTake(const ImportedCalibration& calibration, const Take& take, const std::string& folder);
// Writes background/CAMERA/000000.png …: links to the plates, or up to 25 pictures of the clip.
Status writePlates(const View& plates, const CaptureCamera& camera, const OpenVideo& open_video,
                   const std::string& folder);
// Writes cameras/cameras.txt, cameras/images.txt and capture.json; cameras are in metres, Y up.
Status writeDescription(const ImportedCalibration& calibration, const std::vector<Take>& takes, ImportedMeshes meshes,
                        const std::vector<CaptureClass>& classes, double fps, const std::string& folder);

}  // namespace fourdvt::capture
