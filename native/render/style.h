// SPDX-License-Identifier: Apache-2.0
// A style restyles the finished picture of any figure (M4D 6; the page's attribute `look`). The recipe draws the
// unstyled figure into a picture of the target's size, then the style draws the mesh from it. Implementation:
// render/styles/, which a player may leave out.
#pragma once

#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

class FigureStyle {
 public:
  virtual ~FigureStyle() = default;
  // Makes one draw of the mesh inside the caller's pass. picture: premultiplied, of the target's size, y up; alpha is
  // the mesh's coverage.
  virtual void draw(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
                    const CharacterView& view) const = 0;
};

}  // namespace fourdvt::render
