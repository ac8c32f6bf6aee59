// SPDX-License-Identifier: Apache-2.0
// Result<T>: a value or an Error, the only report of failure: portable code throws no exceptions. An error has no stack
// trace or nested cause; its message is complete in one line.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>

namespace fourdvt {

// Stable identifiers. Tests and page scripts compare these, never the wording. Append only. Comment per entry:
// "meaning; remedy", the source of the documents' table (site/docs/errors.mjs).
enum class ErrorId : int {
  None = 0,
  InvalidArgument,  // an option or argument is unknown or out of range; read the command's --help
  FileMissing,      // a named file or folder does not exist or cannot be opened; check the path and its permissions
  FileUnreadable,   // a file's bytes cannot be read, or are not what its name says; export or download it again
  WriteFailed,      // the output cannot be written; free space on the disk, or choose a folder that you may write to
  CaptureJson,  // capture.json cannot be parsed, lacks a field or has one of the wrong type; correct the key that is
                // named
  CameraModel,  // cameras.txt uses a COLMAP model that is not read; convert it to one that CAPTURE.md lists
  CameraPose,   // a pose or the intrinsics are singular or not finite; check that camera's lines of cameras.txt and
                // images.txt
  CameraMissingVideo,  // a camera has no video and no pictures in a sequence; add them, or remove the camera from
                       // images.txt
  VideoTooShort,       // a video or an animated mesh has fewer frames than its sequence declares; lower "frames" in
                       // capture.json or export it again
  FrameSize,        // a picture's size differs from the calibration's, or it is open whether a mark turns it; use the
                    // pictures that were calibrated, neither cropped nor scaled, or import with --orientation
  MeshTopology,     // faces or UVs differ from those of the first frame; export one mesh that moves, or set "topology":
                    // "per-frame"
  MeshNoUvs,        // a mesh has no UVs, which layers need; unwrap it, or bake with --appearance cameras
  MeshNotFinite,    // a vertex is not a finite number; export that frame again
  MeshIndex,        // a face names a vertex that does not exist, or has fewer than three; export that frame again
  MeshUvRange,      // UVs lie outside 0 to 1; pack the atlas into one tile
  NothingVisible,   // no camera sees the surface; check axes, units and poses
  ManifestInvalid,  // character.gltf lacks a field or has one out of range; bake again, and check that src names a
                    // character.gltf
  StreamInvalid,    // a .bin stream is damaged or cut off; upload the character again
  MeshDataInvalid,  // the base mesh is damaged or does not match the manifest; upload the character again
  VideoInvalid,     // video samples do not decode, or have another size; upload the character again
  FetchFailed,      // a file could not be fetched; check its address, and the server's headers for other origins
  DecoderUnsupported,  // there is no decoder for this codec; open the page in a newer browser, or bake H.264
  GpuFailure,          // a context, a shader or a GPU resource could not be made; update the browser or its GPU driver
  Unsupported,         // the data is valid, but newer than this reader; update the player
  Interrupted,         // the command was stopped; run it again, with --resume to keep what is finished
  Internal,            // the program met a state that it does not expect; report it with the message
  DecoderLost,  // the browser took the video decoder away several times in a row; close other players, then retry
  FilesDiffer,  // the files of a character come from different bakes; upload all files of one bake, and clear caches
};

// Short stable name, e.g. "capture-json"; carried by the element's error event.
const char* errorName(ErrorId id);

struct Error {
  ErrorId id = ErrorId::Internal;
  std::string message;  // one line: what is wrong, with which file, and the remedy
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Error error) : error_(std::move(error)) {}
  bool ok() const { return value_.has_value(); }
  explicit operator bool() const { return ok(); }
  T& value() {
    assert(ok());
    return *value_;
  }
  const T& value() const {
    assert(ok());
    return *value_;
  }
  T take() {
    assert(ok());
    return std::move(*value_);
  }
  const Error& error() const {
    assert(!ok());
    return error_;
  }

 private:
  std::optional<T> value_;
  Error error_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}
  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const {
    assert(!ok_);
    return error_;
  }

 private:
  Error error_;
  bool ok_ = true;
};

using Status = Result<void>;

}  // namespace fourdvt

// Returns the error of a Status/Result from the enclosing function.
#define FOURDVT_TRY(expression)                              \
  do {                                                       \
    auto fourdvt_status = (expression);                      \
    if (!fourdvt_status.ok()) return fourdvt_status.error(); \
  } while (0)

// FOURDVT_ASSIGN(target, expression): assigns a Result's value, or returns its error from the enclosing function. The
// target is a declaration ("auto picture", "const Image still") or an existing object.
#define FOURDVT_ASSIGN(target, ...) \
  FOURDVT_ASSIGN_FROM(FOURDVT_NAME_WITH(fourdvt_result_, __COUNTER__), target, __VA_ARGS__)
#define FOURDVT_ASSIGN_FROM(result, target, ...) \
  auto result = (__VA_ARGS__);                   \
  if (!result.ok()) return result.error();       \
  target = result.take()
#define FOURDVT_NAME_WITH(name, number) FOURDVT_NAME_JOINED(name, number)
#define FOURDVT_NAME_JOINED(name, number) name##number
