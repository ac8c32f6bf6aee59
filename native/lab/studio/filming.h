// SPDX-License-Identifier: Apache-2.0
// Recordings of the ring's cameras in memory: plates, and pictures with their mattes. Poses the set.
#pragma once

#include <memory>
#include <vector>

#include "lab/studio/room.h"
#include "lab/studio/sensor.h"
#include "lab/studio/set.h"

namespace fourdvt::studio {

// Frame of one motion.
struct Moment {
  size_t motion = 0;
  uint32_t frame = 0, count = 1;  // count: the whole motion's frames
  uint64_t shot = 0;              // see Sensor::expose
};

// [ring camera] time offset of its pictures after their frame, in frames.
std::vector<double> timeOffsets(const StudioOptions& options);

class Filming {
 public:
  struct Recorded {
    Image colour, matte;  // RGB; one channel
  };

  // Borrows `options` and `set`.
  Filming(const StudioOptions& options, StudioSet& set);
  const Room* room() const { return room_.get(); }  // null: the green studio
  // Picture of the empty studio; `take` counts a camera's plates.
  Image plate(size_t camera, uint32_t take) const;
  // Sets the frame for record() and poses the set at it.
  void begin(const Moment& moment);
  // Records a camera's picture; leaves the set posed at the camera's own time.
  Result<Recorded> record(size_t camera);

 private:
  void pose(double frame);
  Result<Image> behind(size_t camera);

  const StudioOptions& options_;
  StudioSet& set_;
  std::unique_ptr<Room> room_;
  std::vector<Sensor> sensors_;        // [ring camera]
  const std::vector<double> offsets_;  // [ring camera]
  Moment moment_;
};

}  // namespace fourdvt::studio
