// SPDX-License-Identifier: Apache-2.0
// A bake cut into pieces that any machine with the same files can compute (jobs/plan.h). A piece is the same call of a
// stage, on the same files of the work folder, that the bake of a whole character makes; so that a job folder is a work
// folder, and what some pieces have finished, `fourdvt bake --resume` goes on with.
//   layers    survey (a window of frames) → labels (windows: even, then odd) → label (a sequence) → gop → align (a GOP
//   of
//             a class) → chunks (a class)            colours, graph, room, finish
//   cameras   colours → method (a tried frame), gop (with its surfaces), room → finish
#pragma once

#include "bake/bake.h"
#include "bake/run/bake_run.h"
#include "jobs/plan.h"

namespace fourdvt::bake {

enum class PieceKind { Survey, Colours, Labels, Label, Gop, Align, Chunks, Graph, Room, Method, Finish };

struct BakePiece {
  jobs::Piece piece;
  PieceKind kind = PieceKind::Finish;
  size_t number = 0;                               // of its sequence, or of its stream
  uint32_t index = 0;                              // first frame of the window, GOP, tried frame
  std::vector<size_t> windows;                     // of labels
  std::vector<std::pair<size_t, uint32_t>> reads;  // of sequences: number, and window of input files (kInputWindow)
  std::vector<size_t> reads_meshes;                // numbers of sequences of which it reads every mesh
};

// In an order in which each comes after those that it needs; the last is Finish. The job's keys are settled.
std::vector<BakePiece> bakePieces(const Job& job);

// [piece] whether a result that its record would stand for is missing or damaged. Errors: WriteFailed.
Result<std::vector<bool>> lostPieces(BakeRun& run, const std::vector<BakePiece>& pieces);

// Errors: InvalidArgument if files that the piece reads have changed since the plan.
Status checkPieceInputs(const BakeRun& run, const BakePiece& piece);

// Computes one piece but the last. Does nothing if it is done already. Errors: those of its stage; InvalidArgument if
// files that it reads have changed.
Status runPiece(BakeRun& run, const BakePiece& piece);

}  // namespace fourdvt::bake
