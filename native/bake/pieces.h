// SPDX-License-Identifier: Apache-2.0
// A bake cut into pieces that any machine with the same files can compute (jobs/plan.h). A piece makes the same call
// of a stage, on the same files of the work folder, as the bake of a whole character; a job folder is therefore a
// work folder, and `fourdvt bake --resume` continues from finished pieces.
// layers    survey (a window of frames) → labels (windows: even, then odd) → label (a sequence) → gop →
//           align (a GOP of a class) → chunks (a class); colours, graph, room, finish
// cameras   colours → method (a tried frame), gop (with its surfaces), room → finish
#pragma once

#include "bake/bake.h"
#include "bake/run/bake_run.h"
#include "jobs/plan.h"

namespace fourdvt::bake {

enum class PieceKind { Survey, Colours, Labels, Label, Gop, Align, Chunks, Graph, Room, Method, Finish };

struct BakePiece {
  jobs::Piece piece;
  PieceKind kind = PieceKind::Finish;
  size_t number = 0;                               // index of the sequence or stream
  uint32_t index = 0;                              // first frame of the window, GOP or trial
  std::vector<size_t> windows;                     // label windows
  std::vector<std::pair<size_t, uint32_t>> reads;  // sequence index and window of input files (kInputWindow)
  std::vector<size_t> reads_meshes;                // sequences all of whose meshes are read
};

// Pieces in topological order, Finish last. Requires the job's keys (settleKeys).
std::vector<BakePiece> bakePieces(const Job& job);

// [piece] True if a result of the piece is missing or damaged. Errors: WriteFailed.
Result<std::vector<bool>> lostPieces(BakeRun& run, const std::vector<BakePiece>& pieces);

// Errors: InvalidArgument if files that the piece reads have changed since the plan.
Status checkPieceInputs(const BakeRun& run, const BakePiece& piece);

// Computes one piece other than the last; finished pieces are skipped. Errors: those of its stage; InvalidArgument if
// files that it reads have changed.
Status runPiece(BakeRun& run, const BakePiece& piece);

}  // namespace fourdvt::bake
