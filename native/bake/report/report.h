// SPDX-License-Identifier: Apache-2.0
// The bake's report: report.json (every value) and report.html (self-contained: inline CSS and SVG, pictures by
// relative file name). The caller writes the pictures.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "report/document.h"

namespace fourdvt::bake {

// Additional values of a sequence from cameras.
struct ReportTiles {
  int width = 0, height = 0;  // texels of the layout
  double kept_share = 0;      // pixels shown by tiles over those of the cameras' whole pictures, mean over the GOPs
  double used_share = 0;      // texels of tiles over those of the layout, mean over the GOPs
  uint32_t runs = 0;          // runs of frames with one topology
  uint32_t vertices = 0, faces = 0;  // maximum over all frames
};

struct ReportRendition {
  std::string file, codec;
  int width = 0, height = 0;    // tiled picture
  uint64_t bytes = 0;           // size of the video
  uint64_t geometry_bytes = 0;  // rest of the stream that is played with it, with its header
};

struct ReportSequence {
  std::string name;
  uint32_t frames = 0, gops = 0;
  double fps = 0;
  bool loop = false;
  uint32_t members = 1;
  std::vector<ReportRendition> renditions;         // in the manifest's order, the lowest first
  uint64_t video_bytes = 0;                        // .mp4 of the highest rendition
  uint64_t geometry_bytes = 0, label_bytes = 0;    // in the chunks of the .bin: positions, labels
  uint64_t offset_bytes = 0, alignment_bytes = 0;  // in a class's chunks: corrections of the mesh blend, alignment
  uint64_t index_bytes = 0;                        // rest of the .bin: header, index, sample tables, root motion
  std::optional<ReportTiles> tiles;                // from cameras; geometry_bytes are then those of the surfaces
};

// `file`: written by the caller, relative to the report's folder; `caption`: one sentence.
using ReportPicture = report::Picture;

struct ReportInput {
  BakeOptions options;  // resolved: jobs > 0, sequences listed
  BakeReport figures;
  std::string capture_name, credit, generator;  // generator: "fourdvt X.Y.Z"
  std::string codec;                            // RFC 6381
  uint32_t cameras = 0, vertices = 0, faces = 0;
  int picture_width = 0, picture_height = 0;  // tiled picture, texels
  double wall_s = 0;                          // duration of the whole bake
  bool resumed = false;                       // seconds cover this run only, which continued an earlier one
  std::vector<ReportSequence> sequences;
  std::vector<std::pair<std::string, std::string>> versions;  // library → version, e.g. libavcodec → 59.37.100
  std::vector<ReportPicture> pictures;                        // the first is shown large (the poster)
  std::vector<ReportPicture> outlines;                        // views whose outlines were far off, before and after
  std::string refined_cameras;                                // folder of the COLMAP text model; empty: none changed
};

// Errors: WriteFailed.
Status writeReport(const std::string& folder, const ReportInput& input);

}  // namespace fourdvt::bake
