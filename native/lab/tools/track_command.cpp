// SPDX-License-Identifier: Apache-2.0
#include "lab/tools/commands.h"
#include "tools/commands.h"
#include "track/run/options.h"

namespace fourdvt::lab {
namespace {

tools::Options evidenceOptions(track::TrackOptions& o) {
  return {
      {"--flow-between MODE", tools::choice(o.fit.flow_from_parent, {{"on", true}, {"off", false}}),
       "optical flow from a similar frame: on (default) or off"},
      {"--flow-from-template MODE", tools::choice(o.fit.flow_from_anchor, {{"on", true}, {"off", false}}),
       "optical flow from the template's frame, by which vertices keep their colours: on (default) or off"},
      {"--order KIND", tools::choice(o.by_similarity, {{"similarity", true}, {"time", false}}),
       "similarity: along a tree of similar frames (default); time: each frame after its predecessor"},
      {"--nodes N", tools::number(o.nodes, 20, 5000), "nodes of the deformation graph, 20 to 5000 (default 400)"},
      {"--rigidity-mm X", tools::number(o.fit.rigidity_sigma_m, 0.01, 100, 1e-3),
       "deviation of a link between nodes from a rotation (default 16)"},
      {"--surface-mm X", tools::number(o.fit.surface_sigma_m, 0.01, 100, 1e-3),
       "noise of the surfaces along their normals (default 4)"},
      {"--smooth-mm X", tools::number(o.fit.smoothness_sigma_m, 0.01, 100, 1e-3),
       "difference of neighbours' offsets (default 2)"},
      {"--outline-px X", tools::number(o.fit.outline_sigma_px, 0, 100),
       "noise of the mattes' edges (default 0.5); 0: outlines do not count"},
  };
}

}  // namespace

Result<int> trackCommand(int argc, char** argv) { return tools::trackCommand(argc, argv, evidenceOptions); }

}  // namespace fourdvt::lab
