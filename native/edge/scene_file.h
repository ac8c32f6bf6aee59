// SPDX-License-Identifier: Apache-2.0
// scene.json: characters composited with a background and its camera track (Casas et al. 2014, step 6). Reads and
// checks only. Paths in it are relative to the file. World: metres, y up, ground at ground_y.
//
// clang-format off
//   {"background": "street.jpg",     picture or video (.mp4) that the camera took, undistorted; optional
//    "camera": "street",             COLMAP text model with one image per frame, sorted by name, or one image; else the orbit options
//    "camera_name": "0007",          that image only (without extension), for every frame; optional
//    "metres_per_unit": 1,           of the COLMAP model
//    "occluders": ["car.obj"],       hide characters and show the background; OBJ in metres
//    "meshes": ["floor.obj"],        are drawn: colours "v x y z r g b", else grey
//    "ground_y": 0, "fps": 25, "seconds": 6,
//    "size": [1280, 720],            with a background, of the shape of the camera's picture
//    "characters": [{"src": "../character", "state": "locomotion", "parameter": {"speed_mps": 2}, "position": [x, z],
//                    "heading_deg": 90, "travel": true, "play": ["pickup@1.5"]}]}
// clang-format on
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "edge/motion.h"
#include "gpu/device.h"
#include "package/character.h"
#include "render/scene.h"

namespace fourdvt::edge {

struct ActorOptions {
  std::string folder;  // character folder
  std::string state;   // initial state; empty: the character's first
  Parameters parameters;
  motion::Placement placement;
  bool travel = false;
  std::vector<Cue> cues;
  std::optional<int> rendition;  // see fourdvt render --rendition
};

struct SceneFile {
  std::string path;
  std::string background;              // empty: none
  std::vector<PinholeCamera> cameras;  // one camera: for all frames; empty: an orbit
  std::vector<std::string> occluders, meshes;
  double ground_y_m = 0, fps = 25, seconds = 0;  // seconds 0: the camera track's length, one frame or more
  std::optional<std::pair<int, int>> size;
  std::vector<ActorOptions> characters;
};

// Errors: FileMissing, InvalidArgument (file, key and remedy named), those of readColmapCameras.
Result<SceneFile> readSceneFile(const std::string& path);
// Reads the triangles of an OBJ file: "v x y z [r g b]" and "f"; skips all other lines. Errors: FileMissing, MeshIndex.
Result<std::vector<render::SceneCorner>> readSceneMesh(const std::string& path);

// Reads the room picture of a character that has a room, RGBA. `folder`: the character's. Errors: FileMissing,
// FileUnreadable, FilesDiffer.
Result<Image> readRoomPicture(const std::string& folder, const package::Room& room);
// Scene of the character's room. `manifest`: its character.gltf. Errors: those of readRoomPicture, GpuFailure,
// InvalidArgument if the character has no room.
Result<render::Scene> openRoom(gpu::Device& device, const std::string& manifest, const package::Character& character);

}  // namespace fourdvt::edge
