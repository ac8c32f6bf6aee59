// SPDX-License-Identifier: Apache-2.0
// The look that figures are drawn in: what people call a style (render/styles/styles.h).
#pragma once

#include "render/styles/styles.h"
#include "tools/args.h"

namespace fourdvt::tools {

struct LookArguments {
  std::optional<render::StyleOptions> style;  // none: as filmed
  std::string light_picture;                  // equirectangular; empty: the light of StyleOptions
};

inline constexpr Option kLookOption{"--look", "WHAT", "sketch (grey dots) or relit (new light); default: as filmed"};
inline constexpr Option kLookStrengthOption{"--look-strength", "X", "strength of the look, 0 to 1 (default 1)"};
inline constexpr Option kLightOption{
    "--light", "PICTURE", "relit: equirectangular picture of the light; its centre is straight ahead of the view"};
inline constexpr Option kLightTurnOption{"--light-turn", "DEG",
                                         "relit: rotation of the light, clockwise seen from above (default 0)"};

LookArguments readLookArguments(Args& args);
// Errors: those of reading the picture, with its path; GpuFailure.
Status setLook(const LookArguments& look, gpu::Device& device, render::Recipe& recipe);

}  // namespace fourdvt::tools
