// SPDX-License-Identifier: Apache-2.0
// Chooses the method that a character from cameras is drawn by: a few frames of the capture, every camera (of many a
// few, far from each other) left out in turn and drawn from the others (method_trial.h). What a frame gave is kept in
// the survey folder, so that a stopped bake goes on after it. Memory: one frame.
#pragma once

#include "bake/run/bake_run.h"
#include "bake/run/figures.h"
#include "bake/texels/colour_calibration.h"

namespace fourdvt::bake {

constexpr uint32_t kTrialFrames = 3;  // of the whole capture, spread over its sequences

// The method of the options where they name one. maps: one per camera, or none. Errors: those of capture, tryMethods,
// WriteFailed, Interrupted.
Result<ChosenMethod> chooseBakedMethod(BakeRun& run, const std::vector<ColourMap>& maps);

// Number of frames that chooseBakedMethod tries; 0: it measures nothing.
uint32_t triedFrames(const Job& job);
// One of them: its sequence's number, and the frame.
std::pair<size_t, uint32_t> triedFrame(const Job& job, uint32_t number);
// Tries the methods on one of these frames, and keeps what they gave.
Status tryMethodsOn(BakeRun& run, const std::vector<ColourMap>& maps, uint32_t number);

}  // namespace fourdvt::bake
