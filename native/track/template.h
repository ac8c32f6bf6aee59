// SPDX-License-Identifier: Apache-2.0
// Template for tracking: the surface of one frame as a mesh of even triangles with texture coordinates.
#pragma once

#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "track/views.h"

namespace fourdvt::track {

// Suitability of a frame's surface for a template.
struct TemplateFitness {
  double seen_m2 = 0;      // surface that at least one camera sees at 60 degrees or less
  double area_m2 = 0;      // whole surface
  double cut_share = 0;    // share of the volume that is left out for genus 0, see genus_zero.h
  double other_share = 0;  // share of the volume in other parts, e.g. a second person
  // Parts in contact hide surface, handles cost volume. Larger is better.
  double score() const { return seen_m2 * (1 - 20 * cut_share); }
};

// `surface`: closed; `views`: pictures of its frame, one per camera.
TemplateFitness fitnessOf(const TriangleMesh& surface, double cut_m3, double other_m3, const std::vector<View>& views);

struct TemplateOptions {
  uint32_t faces = 8000;
  int texels = 1024;       // side of the texture that charts are packed for
  int gutter_texels = 20;  // distance of charts
};

struct TemplateMesh {
  MeshTopology topology;
  Positions positions;  // world, metres
};

// Remeshes a closed surface of genus 0, with smaller triangles where it is curved and where cameras resolve it well,
// and makes a texture atlas with resolution by what cameras see and seams where they see least. Errors: those of
// remeshed (mesh/remesh.h) and unwrapped (mesh/atlas.h).
Result<TemplateMesh> templateMesh(const TriangleMesh& surface, const std::vector<View>& views,
                                  const TemplateOptions& options);

}  // namespace fourdvt::track
