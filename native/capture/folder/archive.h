// SPDX-License-Identifier: Apache-2.0
// Fields of an opened capture, for files that store it (store/archive.h).
#pragma once

#include "capture/capture.h"
#include "store/archive.h"

namespace fourdvt::store {

inline void fields(Archive& a, capture::CaptureCamera& c) { a(c.pinhole, c.distortion); }
inline void fields(Archive& a, capture::CaptureSound& s) { a(s.path, s.offset_s); }
inline void fields(Archive& a, GroundMotion& m) { a(m.turn_rad, m.shift_m); }
inline void fields(Archive& a, capture::CaptureTravel& t) { a(t.motion, t.place_m); }
inline void fields(Archive& a, capture::CaptureSequence& s) {
  a(s.name, s.frame_count, s.loop, s.root_velocity_mps, s.travel, s.folder, s.mesh_pattern, s.first_mesh,
    s.packed_positions, s.packed_units_per_metre, s.test_frames, s.first_frame, s.offset_frames, s.sound);
}
inline void fields(Archive& a, capture::CaptureClass::MemberOf& m) { a(m.sequence, m.parameter); }
inline void fields(Archive& a, capture::CaptureClass& c) { a(c.name, c.parameters, c.members, c.footstep); }
// Without the offsets, which are part of a refinement.
inline void fields(Archive& a, capture::Capture& c) {
  a(c.folder, c.name, c.credit, c.fps, c.metres_per_unit, c.ground_y_m, c.cameras, c.sequences, c.classes,
    c.cameras_folder, c.background_folder, c.background_kind, c.room, c.meshes, c.topology);
}

}  // namespace fourdvt::store
