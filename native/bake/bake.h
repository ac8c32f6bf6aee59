// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. The stages in order of execution; each is one file of this folder:
//
//   validate      whole capture readable, output writable; the settings' hash for --resume
//   warp          motion classes: members on common time, root motion, corrections of the mesh blend (class_plan)
//   survey        first pass over the frames: which camera sees which face (visibility: depth maps and sample tests on
//                 the GPU), and the cameras' colours against each other (colour_calibration)
//   labelling     cameras per face for whole sequences (4DVT Eq. 1-5, ALGORITHMS 1)
//   resample      camera pictures → L texture layers in UV space on the GPU
//   fill          empty texels and gutters (ALGORITHMS 2.4)
//   tile          layers + barcode → one 4:2:0 picture
//   encode        H.264, one closed GOP at a time
//   align         classes: what the decoded members show, brought together on the surface (surface_alignment)
//   geometry      quantised positions, labels, corrections and alignment → chunks
//   graph         where every state enters every other one (transitions)
//   assemble      mp4 + bin + character.gltf + texture still + poster + report, renamed into place at the end
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets and meshes, whatever the
// length; besides, for classes, 12 bytes a vertex, phase and further member (alignment over the whole motion).
#pragma once

#include "bake/run/environment.h"
#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "base/result.h"

namespace fourdvt::bake {

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

}  // namespace fourdvt::bake
