// SPDX-License-Identifier: Apache-2.0
// Labels: the cameras from which each face takes its layers, for a whole sequence (algorithms/labels.md; 4DVT 4.1, Eq.
// 1-5: D. Casas, M. Volino, J. Collomosse, A. Hilton: 4D Video Textures for Interactive Character Appearance, Computer
// Graphics Forum 33(2) (Eurographics), 2014). face_costs.h measures the penalties. Memory: a window of frames, whatever
// the sequence's length. Deterministic: the same input gives the same labels for every job count.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "bake/labels/face_costs.h"
#include "base/result.h"

namespace fourdvt::bake {

struct FaceLinks;
struct LabelOptions;
struct WindowFrame;

// Rule that assigns cameras to faces, a constant with static lifetime.
struct Labelling {
  const char* name;  // part of the key under which labels and GOPs are stored
  bool windowed;     // neighbouring frames are solved together; false: each by itself
  // Solves the frames of one window (expansion.h). Called from several threads.
  void (*solve)(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames);
};
// Ordered tuples of distinct cameras, over space and time. The papers' rules, for comparison: lab/labels.
extern const Labelling kJoint;

struct LabelOptions {
  const Labelling* rule = &kJoint;
  int layers = 3;
  // Joint: weights of algorithms/labels.md. θ: penalty by rank, ω: rank term by rank (the last entry repeats), η: set
  // term, τ: time (label flips), empty: penalty of an empty rank. Tuned with bench_labels for few flips and seams at
  // a layer-1 penalty within 10 % of the cheapest cameras'. Stored labels and GOPs of other weights are not reused
  // (labelKey in stages/validate.cpp).
  std::vector<float> theta{1.4f, 0.2f, 0.1f}, omega{1.2f, 0.3f, 0.25f};
  float eta = 0.1f, tau = 0.75f, empty_penalty = 2.0f;
  // Joint: allows cameras that see a face in part (FaceCosts::partial); labels unseen faces, so that the neighbours'
  // label continues across them. Both are set in a bake; the study switches them off to measure the effect of each.
  bool use_partial = true, label_unseen = true;
  int window_frames = 12, hop_frames = 8, sweeps = 4;
  int jobs = 1;
};
// Entry `rank` of theta or omega: the last entry repeats; 0 if there is none.
float weightOfRank(const std::vector<float>& weights, int rank);

// Pairs of faces that share an edge, each once, f < g.
struct FaceGraph {
  uint32_t face_count = 0;
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  std::vector<uint8_t> neighbour_count;  // per face
};
FaceGraph makeFaceGraph(const MeshTopology& topology);

struct LabelStatistics {
  uint32_t frames = 0;
  std::vector<double> seam_percent;  // per layer: share of edges whose faces differ in this rank
  std::vector<double> flip_percent;  // per layer: share of faces that differ from the previous frame
  std::vector<double> camera_seam_percent, camera_flip_percent;  // the part of these where neither rank is empty
  // Seams and flips over faces that a camera sees, which excludes labels that no camera can show: edges between two
  // such faces, and faces that are seen in both frames.
  std::vector<double> seen_seam_percent, seen_flip_percent;
  std::vector<double> mean_penalty;  // per layer, over filled ranks of faces that a camera sees
  double energy = 0;                 // in the joint formulation with the options' weights, for every rule
  double empty_percent = 0;          // share of all ranks
  double seconds = 0;                // wall clock of the solve
};

using FaceCostSource = std::function<Result<FaceCosts>(uint32_t frame)>;  // called from one thread, in any order
// labels: [layer][face], camera index or package::kNoCamera. Called once per frame, in ascending order.
using LabelSink = std::function<Status(uint32_t frame, const std::vector<uint8_t>& labels)>;

// Stores the labels of solved windows, so that an interrupted solve skips them. Both functions are called from any
// thread.
struct LabelKeeper {
  // Bytes passed to keep() for these frames; empty: none.
  std::function<std::vector<uint8_t>(uint32_t first, uint32_t end)> find;
  std::function<Status(uint32_t first, uint32_t end, const std::vector<uint8_t>& bytes)> keep;
};

// Input and callbacks of solveLabels.
struct LabelExchange {
  FaceCostSource costs;
  LabelSink sink;
  std::function<void(uint32_t frames)> on_frame;  // receives the number of finished frames; may be empty
  const std::atomic<bool>* stop = nullptr;        // may be null
  const LabelKeeper* keeper = nullptr;            // may be null; windows of one frame are not stored
};

// Errors: those of costs, sink and keeper; Interrupted once *stop.
Result<LabelStatistics> solveLabels(const LabelOptions& options, const FaceGraph& graph, uint32_t frame_count,
                                    const LabelExchange& exchange);

// Solves some windows (indices into planWindows' list) and passes their labels to the keeper, which is required. Also
// solves the even windows that an odd one depends on, unless the keeper has them. Does not call the sink. Errors: those
// of costs and keeper; Interrupted once *stop.
Status solveLabelWindows(const LabelOptions& options, const FaceGraph& graph, uint32_t frame_count,
                         const std::vector<size_t>& windows, const LabelExchange& exchange);

// Seams, flips, penalties and energy of finished labels, accumulated frame by frame.
class LabelMeter {
 public:
  LabelMeter(const LabelOptions& options, const FaceGraph& graph);
  // Frames in ascending order; labels [layer][face].
  void add(const FaceCosts& costs, const std::vector<uint8_t>& labels);
  LabelStatistics statistics() const;  // without `seconds`

 private:
  // Faces, edges or steps of one layer.
  struct Counts {
    uint64_t seams = 0, flips = 0;                // pairs whose two labels differ
    uint64_t camera_seams = 0, camera_flips = 0;  // the part of these where both are cameras
    uint64_t seen_seams = 0, seen_flips = 0;      // the part of these where both faces are seen
    uint64_t filled = 0, filled_seen = 0;
    double penalty = 0;  // sum over filled_seen
  };
  void addLayer(const FaceCosts& costs, const uint8_t* layer, int l, const std::vector<uint8_t>& seen);
  double distance(const std::vector<uint8_t>& a, size_t f, const std::vector<uint8_t>& b, size_t g) const;

  LabelOptions options_;
  const FaceGraph& graph_;
  std::vector<uint8_t> previous_, previous_seen_;  // previous frame: labels, and 1 for a face that a camera sees
  std::vector<Counts> layers_;
  uint64_t seen_edges_ = 0, seen_steps_ = 0;
  uint32_t frames_ = 0;
  double energy_ = 0;
};

}  // namespace fourdvt::bake
