// SPDX-License-Identifier: Apache-2.0
// Movies and pictures of characters that play: a parameter swept, transitions, composited scenes.
#pragma once

#include "tools/render_arguments.h"

namespace fourdvt::tools {

// --sweep and --play: one character, camera from the arguments.
Status renderMotion(const RenderArguments& arguments);
// --scene.
Status renderScene(const RenderArguments& arguments);

}  // namespace fourdvt::tools
