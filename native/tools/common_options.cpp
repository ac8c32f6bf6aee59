// SPDX-License-Identifier: Apache-2.0
#include "package/character.h"
#include "refine/refine.h"
#include "tools/commands.h"

namespace fourdvt::tools {

Option sequencesOption(std::vector<std::string>& field) {
  return {"--sequences A,B", list(field), "only these sequences (default: all)"};
}

Option jobsOption(int& field, const std::string& what) {
  return {"--jobs N", number(field, 0, 1024), what + "; 0: one per core (default 0)"};
}

Option resumeOption(bool& field) {
  return {"--resume", flag(field), "continue an interrupted run with the same settings"};
}

Option renditionOption(std::optional<int>& field) {
  return {
      "--rendition N", number(field, 0, package::kMaxPictureSide),
      "rendition: 0 for the lowest, counted as `fourdvt inspect` lists them, or the texels of layer 1 (default: the "
      "highest)"};
}

Options refineOptions(refine::RefineOptions& o) {
  const auto readBias = [&o](Args& args, const std::string& name) {
    number(o.matte_bias_pixels, -8, 8)(args, name);
    if (o.matte_bias_pixels && !o.any())
      args.complain("--matte-bias-px has nothing to correct with --refine none and --refine-cameras off");
  };
  return {
      {"--refine MODE", choice(o.outline, {{"outline", true}, {"none", false}}, Wording::Or),
       "outline (default): move the mesh along its normals until its outlines match the mattes; none: as given"},
      {"--refine-cameras MODE", choice(o.cameras, {{"on", true}, {"off", false}}, Wording::Or),
       "on (default): correct cameras that the mattes clearly contradict; off: as given"},
      {"--matte-bias-px PX", readBias,
       "margin of the mattes beyond the performer's outline, pixels; negative if they are too small (default: "
       "measured)"},
  };
}

bool refinesExplicitly(const Args& args) {
  return args.has("--refine") || args.has("--refine-cameras") || args.has("--matte-bias-px");
}

}  // namespace fourdvt::tools
