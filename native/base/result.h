// SPDX-License-Identifier: Apache-2.0
// Result<T>: a value or an Error. The only way a fallible boundary reports failure; there are no exceptions in
// portable code. Does NOT carry stack traces or nested causes: the message is complete in one line.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>

namespace fourdvt {

// Stable identifiers. Tests and page scripts compare these, never the wording. Append only.
enum class ErrorId : int {
  None = 0,
  InvalidArgument,     // a caller's option or command-line argument
  FileMissing,         // a named file or folder does not exist or cannot be opened
  FileUnreadable,      // exists, but its bytes cannot be read or are not what the name says
  WriteFailed,         // output not writable, disk full
  CaptureJson,         // capture.json missing a field, unparsable, wrong type
  CameraModel,         // COLMAP model we do not know
  CameraPose,          // non-finite or singular pose or intrinsics
  CameraMissingVideo,  // a camera has no video or images in a sequence
  VideoTooShort,       // fewer frames than the sequence declares
  FrameSize,           // picture size differs from the calibration's or between frames
  MeshTopology,        // faces or UVs differ from the first frame's
  MeshNoUvs,
  MeshNotFinite,
  MeshIndex,           // an index out of range, or a face that is not a triangle/polygon
  MeshUvRange,         // UVs outside [0,1]
  NothingVisible,      // no face seen by any camera: wrong axes or units
  ManifestInvalid,     // character.gltf: missing or out-of-range field
  StreamInvalid,       // .bin stream: bad magic, version, counts, truncation
  MeshDataInvalid,     // base mesh (Draco) corrupt or not matching the manifest
  VideoInvalid,        // video samples do not decode or have another size
  FetchFailed,         // transport: the byte range could not be had
  DecoderUnsupported,  // no decoder for the stream's codec
  GpuFailure,          // context, shader or resource creation failed
  Unsupported,         // valid, but newer than this reader or not supported here
  Interrupted,         // the user asked to stop
  Internal,
  DecoderLost,  // the decoder was taken away again and again
  FilesDiffer,  // a character's files are not of one bake: a part has another content hash than it should
};

// Short stable name, e.g. "capture-json"; what the element's error event carries.
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
// target is a declaration ("auto picture", "const Image still") or something that exists already.
#define FOURDVT_ASSIGN(target, ...) \
  FOURDVT_ASSIGN_FROM(FOURDVT_NAME_WITH(fourdvt_result_, __COUNTER__), target, __VA_ARGS__)
#define FOURDVT_ASSIGN_FROM(result, target, ...) \
  auto result = (__VA_ARGS__);                   \
  if (!result.ok()) return result.error();       \
  target = result.take()
#define FOURDVT_NAME_WITH(name, number) FOURDVT_NAME_JOINED(name, number)
#define FOURDVT_NAME_JOINED(name, number) name##number
