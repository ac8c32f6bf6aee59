// SPDX-License-Identifier: Apache-2.0
#include "base/result.h"

namespace fourdvt {

const char* errorName(ErrorId id) {
  switch (id) {
    case ErrorId::None:
      return "none";
    case ErrorId::InvalidArgument:
      return "invalid-argument";
    case ErrorId::FileMissing:
      return "file-missing";
    case ErrorId::FileUnreadable:
      return "file-unreadable";
    case ErrorId::WriteFailed:
      return "write-failed";
    case ErrorId::CaptureJson:
      return "capture-json";
    case ErrorId::CameraModel:
      return "camera-model";
    case ErrorId::CameraPose:
      return "camera-pose";
    case ErrorId::CameraMissingVideo:
      return "camera-missing-video";
    case ErrorId::VideoTooShort:
      return "video-too-short";
    case ErrorId::FrameSize:
      return "frame-size";
    case ErrorId::MeshTopology:
      return "mesh-topology";
    case ErrorId::MeshNoUvs:
      return "mesh-no-uvs";
    case ErrorId::MeshNotFinite:
      return "mesh-not-finite";
    case ErrorId::MeshIndex:
      return "mesh-index";
    case ErrorId::MeshUvRange:
      return "mesh-uv-range";
    case ErrorId::NothingVisible:
      return "nothing-visible";
    case ErrorId::ManifestInvalid:
      return "manifest-invalid";
    case ErrorId::StreamInvalid:
      return "stream-invalid";
    case ErrorId::MeshDataInvalid:
      return "mesh-data-invalid";
    case ErrorId::VideoInvalid:
      return "video-invalid";
    case ErrorId::FetchFailed:
      return "fetch-failed";
    case ErrorId::DecoderUnsupported:
      return "decoder-unsupported";
    case ErrorId::GpuFailure:
      return "gpu-failure";
    case ErrorId::Unsupported:
      return "unsupported";
    case ErrorId::Interrupted:
      return "interrupted";
    case ErrorId::DecoderLost:
      return "decoder-lost";
    case ErrorId::FilesDiffer:
      return "files-differ";
    case ErrorId::Internal:
      return "internal";
  }
  return "internal";
}

}  // namespace fourdvt
