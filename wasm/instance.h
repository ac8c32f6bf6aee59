// SPDX-License-Identifier: Apache-2.0
// State shared by the files of the C ABI: the handle that a page holds and the records that it reads. The ABI itself,
// its functions and records, is listed in abi.txt, from which abi.h is made.
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

// State shared by the characters of one picture. Several canvases may share a context, and its device.
struct Canvas {
  EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = 0;
  std::shared_ptr<gpu::Device> device;
  std::shared_ptr<render::Recipe> recipe;
  render::Scene scene;
  std::string method;  // by which the recipe draws characters from cameras; empty: none
};

// The records that the page was given last; each function overwrites its own.
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

// A method that was asked for, and the one that serves in its place.
struct Fallback {
  std::string wanted, drawn, message;
  bool is_new = false;  // the page has not had the event
};

struct Instance {
  std::shared_ptr<Canvas> canvas;
  std::unique_ptr<Player> player;  // destroyed before the canvas
  LivePlayer* live = nullptr;      // the player, if it plays a live stream
  FlatJson manifest;               // filled value by value until fdvt_load
  render::RecipeOptions options;
  // Owners of what the texts and bytes of the records point to.
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

// The ABI's `ok`: 1, or 0 with the handle's error set.
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

// As fdvt_set_align, for one of the flows (appearance_exports.cpp).
int32_t useFlow(Instance* h, abi::AlignMode mode);
// As fdvt_set_method without a name, unless the canvas has a method (appearance_exports.cpp).
int32_t useMethodOfCharacter(Instance* h);

inline void makeCurrent(Instance* h) { emscripten_webgl_make_context_current(h->canvas->context); }

}  // namespace fourdvt
