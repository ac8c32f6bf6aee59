// SPDX-License-Identifier: Apache-2.0
// A style changes how figures of any kind look once they are drawn (M4D 6; the page's attribute `look`).
// The recipe draws a figure into a picture of the target's size as it would be seen, and lets the style draw its mesh
// from that. Implementation: render/styles/, which not every player has.
#pragma once

#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

class FigureStyle {
 public:
  virtual ~FigureStyle() = default;
  // One draw of the mesh inside the caller's pass. picture: premultiplied, of the target's size, drawn y up; its alpha
  // is the mesh's coverage.
  virtual void draw(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
                    const CharacterView& view) const = 0;
};

}  // namespace fourdvt::render
