// SPDX-License-Identifier: Apache-2.0
// Calibrations of other programs: readCalibration (calibration_files.cpp) finds the calibration in a file or folder and
// reads it by the reader of its format. The readers' `path` is for messages and names; conventions are in CAPTURE.md,
// section "Calibration". Common errors: FileUnreadable (another format), CameraModel, CameraPose.
#pragma once

#include "capture/import/imported.h"

namespace fourdvt::capture {

// Supported formats, one per line, for messages and help: "Qualisys (NAME.qca.txt)".
std::string knownCalibrations();

// Finds and reads the calibration of a supported format in a file or folder; at most 64 MB of any file. Errors:
// FileMissing, FileUnreadable (no supported format: the message lists them; truncated or too large), CameraModel,
// CameraPose (also two cameras of one name).
Result<ImportedCalibration> readCalibration(const std::string& source);

// XML of Qualisys Track Manager. Z up, millimetres, 1/64 pixel.
Result<ImportedCalibration> parseQualisys(const std::string& text, const std::string& path);

// One camera of OpenCV's FileStorage (XML, YAML or JSON) with one of the usual node names.
Result<ImportedCamera> parseOpenCvCamera(const std::string& text, const std::string& name, const std::string& path);

// transforms.json of nerfstudio, instant-ngp and Blender: camera to world, x right, y up, z back; Z up; no unit. One
// camera per frame, named by its picture or the picture's folder (camerasOfPictures).
Result<ImportedCalibration> parseNerfstudio(const std::string& text, const std::string& path);

// EasyMocap's intri.yml and extri.yml. Z up, metres.
Result<ImportedCalibration> parseEasyMocap(const std::string& intri, const std::string& extri, const std::string& path);

// calibration.csv of ActorsHQ: rotation vector and position of the camera in the world, in metres; focal lengths and
// principal point as fractions of width and height. The up axis is undefined.
Result<ImportedCalibration> parseActorsHq(const std::string& text, const std::string& path);

// .toml of Pose2Sim and Caliscope: one table per camera, in Caliscope's [cameras.N]; world to camera, metres, Z up.
Result<ImportedCalibration> parseToml(const std::string& text, const std::string& path);

// Twelve numbers, a projection matrix row by row, or 21: K, R row by row, and t; optionally preceded by "CONTOUR". Unit
// and up axis are undefined.
Result<ImportedCamera> parseProjection(const std::string& text, const std::string& name, const std::string& path);
// Returns true for inputs of parseProjection.
bool looksLikeProjection(const std::string& text);

// Middlebury's NAME_par.txt: a count, then lines of a picture's name, K, R (row by row) and t. Unit and up axis are
// undefined.
Result<ImportedCalibration> parseMiddlebury(const std::string& text, const std::string& path);

// Camera export of Agisoft Metashape (File, Export, Export Cameras): camera to world, x right, y down, z forward. The
// chunk's transform gives the unit and, in a local system, the world.
Result<ImportedCalibration> parseMetashape(const std::string& text, const std::string& path);
// Returns true for inputs of parseMetashape.
bool looksLikeMetashape(const std::string& text);

// RealityCapture's "Internal/External camera parameters" (.csv, first column #name). Z up, no unit.
Result<ImportedCalibration> parseRealityCaptureCsv(const std::string& text, const std::string& path);
// One camera of RealityCapture's XMP files, which lie beside the pictures.
Result<ImportedCamera> parseRealityCaptureXmp(const std::string& text, const std::string& name,
                                              const std::string& path);
// Returns true for inputs of parseRealityCaptureXmp: an XMP file with a pose.
bool looksLikeRealityCaptureXmp(const std::string& text);

}  // namespace fourdvt::capture
