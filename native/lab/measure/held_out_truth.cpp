// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/held_out_truth.h"

#include "base/text.h"
#include "platform/files.h"

namespace fourdvt::measure {

Result<Image> heldOutTruth(const capture::CaptureSequence& sequence, const PinholeCamera& camera, uint32_t frame) {
  const std::string name = printed("/%04u.png", sequence.first_frame + frame);
  const std::string path = sequence.folder + "/" + camera.name + name;
  FOURDVT_ASSIGN(auto truth, platform::readImage(path));
  if (truth.channels != 4 || truth.width != camera.width || truth.height != camera.height)
    return Error{ErrorId::FrameSize, path + ": must be RGBA of " + std::to_string(camera.width) + "x" +
                                         std::to_string(camera.height) + " pixels as in cameras_test/cameras.txt"};
  return truth;
}

}  // namespace fourdvt::measure
