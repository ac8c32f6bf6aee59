// SPDX-License-Identifier: Apache-2.0
// Template for tracking: the surface of one frame as a mesh of even triangles with texture coordinates.
#pragma once

#include <cmath>
#include <span>
#include <string>
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
  double limbs_m = 0;      // length of all limbs, see limbs.h; one that touches the trunk does not count
  // Larger is better: limbs apart, surface in sight.
  double score() const { return area_m2 > 0 ? limbs_m / std::sqrt(area_m2) + seen_m2 / area_m2 - 20 * cut_share : 0; }
};

// `surface`: closed; `views`: pictures of its frame, one per camera.
TemplateFitness fitnessOf(const TriangleMesh& surface, double cut_m3, double other_m3, const std::vector<View>& views);

// Reason why a frame's surface is no template, with a remedy; empty: it is one. `overlap`: of the surface with the
// mattes of its frame. `given`: the user chose the frame, and may choose another.
std::string templateProblem(const TemplateFitness& fitness, double overlap, bool given);

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
