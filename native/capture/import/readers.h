// SPDX-License-Identifier: Apache-2.0
// One reader a format. `path` is for messages and names; conventions are in CAPTURE.md, section "Calibration".
// Errors of all: FileUnreadable (not that format), CameraModel, CameraPose.
#pragma once

#include "capture/import/imported.h"

namespace fourdvt::capture {

// Qualisys Track Manager's XML. Z up, millimetres, 1/64 pixel.
Result<ImportedCalibration> parseQualisys(const std::string& text, const std::string& path);

// One camera of OpenCV's FileStorage (XML, YAML or JSON), whose nodes have one of the usual names.
Result<ImportedCamera> parseOpenCvCamera(const std::string& text, const std::string& name, const std::string& path);

// nerfstudio's, instant-ngp's and Blender's transforms.json: camera to world, x right, y up, z back; Z up; no unit. One
// camera a frame, named by its picture or that one's folder (camerasOfPictures).
Result<ImportedCalibration> parseNerfstudio(const std::string& text, const std::string& path);

// EasyMocap's intri.yml and extri.yml. Z up, metres.
Result<ImportedCalibration> parseEasyMocap(const std::string& intri, const std::string& extri, const std::string& path);

// The calibration.csv of ActorsHQ: rotation vector and position of the camera in the world, in metres; focal lengths
// and principal point as fractions of width and height. No axis is defined as up.
Result<ImportedCalibration> parseActorsHq(const std::string& text, const std::string& path);

// The .toml of Pose2Sim and Caliscope: a table a camera, of Caliscope's own [cameras.N]; world to camera, metres, Z up.
Result<ImportedCalibration> parseToml(const std::string& text, const std::string& path);

// Twelve numbers, a projection matrix row by row, or 21: K, R row by row, and t. "CONTOUR" may stand before them. No
// unit, no axis.
Result<ImportedCamera> parseProjection(const std::string& text, const std::string& name, const std::string& path);
// Returns true for what parseProjection can be given.
bool looksLikeProjection(const std::string& text);

// Middlebury's NAME_par.txt: a count, then lines of a picture's name, K, R (row by row) and t. No unit, no axis.
Result<ImportedCalibration> parseMiddlebury(const std::string& text, const std::string& path);

// Agisoft Metashape's cameras (File, Export, Export Cameras): camera to world, x right, y down, z forward. The
// transform of the chunk gives the unit and, in a local system, the world.
Result<ImportedCalibration> parseMetashape(const std::string& text, const std::string& path);
// Returns true for what parseMetashape can be given.
bool looksLikeMetashape(const std::string& text);

// RealityCapture's "Internal/External camera parameters" (.csv, first column #name). Z up, no unit.
Result<ImportedCalibration> parseRealityCaptureCsv(const std::string& text, const std::string& path);
// One camera of RealityCapture's XMP files, which lie beside the pictures.
Result<ImportedCamera> parseRealityCaptureXmp(const std::string& text, const std::string& name,
                                              const std::string& path);
// Returns true for what parseRealityCaptureXmp can be given: an XMP file with a pose.
bool looksLikeRealityCaptureXmp(const std::string& text);

}  // namespace fourdvt::capture
