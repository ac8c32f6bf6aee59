// SPDX-License-Identifier: Apache-2.0
// State shared by the files of the C ABI: a page's handle and its records. abi.txt lists the ABI's functions and
// records; abi.h is generated from it.
#pragma once

#include <emscripten/html5.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "abi.h"
#include "base/camera.h"
#include "player/player.h"

namespace fourdvt {

class LivePlayer;

// State shared by the characters of one picture. Several canvases may share a context and its device.
struct Canvas {
  EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = 0;
  std::shared_ptr<gpu::Device> device;
  std::shared_ptr<render::Recipe> recipe;
  render::Scene scene;
  std::string method;  // the recipe's method for characters from cameras; empty: none
};

// Records last returned to the page; each function overwrites its own.
struct Records {
  abi::Error error;
  abi::Request request;
  abi::Event event;
  abi::State state;
  abi::Character character;
  abi::Sequence sequence;
  abi::Parameter parameter;
  abi::Text member;
  abi::GeometryMesh mesh;
  abi::DecodeJob job;
  abi::TimeRange range;
  abi::SurfacePoint point;
};

// Requested method and its fallback.
struct Fallback {
  std::string wanted, drawn, message;
  bool is_new = false;  // event still to be sent
};

struct Instance {
  std::shared_ptr<Canvas> canvas;
  std::unique_ptr<Player> player;  // destroyed before the canvas
  LivePlayer* live = nullptr;      // alias of `player` for a live stream; else null
  FlatJson manifest;               // collected value by value until fdvt_load
  render::RecipeOptions options;
  // Owners of the memory behind the records' texts and bytes.
  Request request;
  Event event;
  Error error;
  std::string goal;
  Fallback fallback;
  Records records;
};

inline abi::Text text(const std::string& s) { return {s.data(), static_cast<uint32_t>(s.size())}; }
inline abi::Text text(const char* s) { return {s, static_cast<uint32_t>(std::char_traits<char>::length(s))}; }
inline abi::Error recordOf(const Error& error) { return {text(errorName(error.id)), text(error.message)}; }

// Converts to the ABI's `ok`: 1, or 0 after storing the handle's error.
inline int32_t keep(Instance* h, const Status& status) {
  if (!status.ok()) h->error = status.error();
  return status.ok() ? 1 : 0;
}

inline int32_t fail(Instance* h, ErrorId id, const char* message) {
  h->error = {id, message};
  return 0;
}

inline PinholeCamera cameraOf(const abi::View& view) {
  const double* t = view.target;
  const OrbitView orbit{view.azimuth, view.elevation, view.distance, {t[0], t[1], t[2]}, view.fov};
  return cameraFromOrbit(orbit, view.width, view.height);
}

// Equivalent of fdvt_set_align for one of the flows (appearance_exports.cpp).
int32_t useFlow(Instance* h, abi::AlignMode mode);
// Equivalent of fdvt_set_method with an empty name, unless the canvas has a method (appearance_exports.cpp).
int32_t useMethodOfCharacter(Instance* h);

inline void makeCurrent(Instance* h) { emscripten_webgl_make_context_current(h->canvas->context); }

}  // namespace fourdvt
