// SPDX-License-Identifier: Apache-2.0
// The ladder: renditions below the highest, which BakeOptions' own fields describe. Their text, the standard one, what
// cannot be, and what a stream encodes.
#pragma once

#include <string>
#include <vector>

#include "bake/run/job.h"

namespace fourdvt::bake {

// Reads entries SIZE:CRF or SIZE:CRF:CODEC; without a codec that of `options`. Presets stay empty. Returns what is
// wrong, or nothing.
std::string parseRenditions(const std::vector<std::string>& entries, const BakeOptions& options,
                            std::vector<LowerRendition>& out);

// By the measurements of quality.cpp half the bitrate: the same picture with a coarser CRF; and less than a quarter:
// 3/8 of the texels a side, from cameras half of the pixels. Renditions that would not be below the highest are left
// out.
std::vector<LowerRendition> standardRenditions(const BakeOptions& options);

// Returns what is wrong with options.lower_renditions, or nothing. Before the appearance is known, sizes may be of
// either kind.
std::string checkRenditions(const BakeOptions& options);

// The last part of a lower rendition's file name: ".384-34", or ".384-34-av1" if the highest has another codec.
std::string fileSuffix(const LowerRendition& rendition, const BakeOptions& options);

// Adds the lower renditions to a stream that has its highest.
void addLowerRenditions(const BakeOptions& options, StreamPlan& stream);

// Returns true if a rendition below the highest goes with coarser geometry (BakeOptions::coarse_step_m).
bool hasCoarseGeometry(const BakeOptions& options);

// Texels of all renditions over those of the highest, about.
double ladderTexels(const BakeOptions& options);

// Work of one frame in the Encode stage; encoding is half of it with one rendition.
double encodeWork(const BakeOptions& options);

}  // namespace fourdvt::bake
