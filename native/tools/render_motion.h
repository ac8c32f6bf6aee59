// SPDX-License-Identifier: Apache-2.0
// Movies and pictures of characters that play: a parameter swept, transitions, composited scenes.
#pragma once

#include "tools/render_arguments.h"

namespace fourdvt::tools {

// Renders --sweep and --play: one character, with the camera from the arguments.
Status renderMotion(const RenderArguments& arguments);
// Renders --scene.
Status renderScene(const RenderArguments& arguments);

}  // namespace fourdvt::tools
