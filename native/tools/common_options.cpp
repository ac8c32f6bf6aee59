// SPDX-License-Identifier: Apache-2.0
#include "tools/refine_arguments.h"

namespace fourdvt::tools {
namespace {

bool readMode(Args& args, const char* name, const char* on, const char* off) {
  const std::string mode = args.text(name, on);
  if (mode != on && mode != off)
    args.complain(std::string(name) + " must be " + on + " or " + off + ", not \"" + mode + "\"");
  return mode == on;
}

}  // namespace

refine::RefineOptions readRefineOptions(Args& args) {
  refine::RefineOptions options;
  options.outline = readMode(args, "--refine", "outline", "none");
  options.cameras = readMode(args, "--refine-cameras", "on", "off");
  if (args.has("--matte-bias-px")) options.matte_bias_pixels = args.number("--matte-bias-px", 0, -8, 8);
  if (options.matte_bias_pixels && !options.any())
    args.complain("--matte-bias-px has nothing to correct with --refine none and --refine-cameras off");
  return options;
}

}  // namespace fourdvt::tools
