// SPDX-License-Identifier: Apache-2.0
// Figures and report of a tracking run.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "track/cycle.h"
#include "track/order.h"
#include "track/run/prepare.h"
#include "track/run/track.h"

namespace fourdvt::track {

// Cycle of a sequence that becomes a loop.
struct CycleOfSequence {
  Cycle cycle;
  Loop loop;
  Travel travel;
};

struct TrackedSequence {
  std::string name;
  std::vector<Positions> positions;          // [frame] smoothed
  std::optional<CycleOfSequence> cycle;      // the new capture has its frames alone
  std::vector<FitFigures> figures;           // [frame] of the fits
  std::vector<double> seconds;               // [frame]
  std::map<uint32_t, std::string> failures;  // frame → why its fit failed; it is interpolated
};

// Sets figures and warnings of the summary.
void summarise(std::span<const TrackedSequence> sequences, TrackSummary& summary);

// Writes track.html, its pictures and track.json. Errors: WriteFailed; those of stored pictures.
Status writeTrackReport(const std::string& folder, const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                        std::span<const TrackingStep> steps, std::span<const TrackedSequence> sequences,
                        const TrackSummary& summary);

}  // namespace fourdvt::track
