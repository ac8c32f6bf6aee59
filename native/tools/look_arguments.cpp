// SPDX-License-Identifier: Apache-2.0
#include "tools/look_arguments.h"

#include "platform/files.h"

namespace fourdvt::tools {

LookArguments readLookArguments(Args& args) {
  LookArguments look;
  const std::string name = args.text("--look");
  const bool relit = name == "relit";
  if (name == "sketch" || relit)
    look.style = render::StyleOptions{.kind = relit ? render::StyleKind::Relit : render::StyleKind::Sketch};
  else if (!name.empty())
    args.complain("--look must be sketch or relit, not \"" + name + "\"");
  if (!relit && (args.has("--light") || args.has("--light-turn")))
    args.complain("--light and --light-turn belong to --look relit");
  if (!look.style && args.has("--look-strength")) args.complain("--look-strength belongs to --look");
  const double strength = args.number("--look-strength", 1, 0, 1),
               turn_deg = args.number("--light-turn", 0, -3600, 3600);
  look.light_picture = args.text("--light");
  if (!look.style) return look;
  look.style->strength = static_cast<float>(strength);
  look.style->light_turn_rad = static_cast<float>(glm::radians(turn_deg));
  return look;
}

Status setLook(const LookArguments& look, gpu::Device& device, render::Recipe& recipe) {
  if (!look.style) return {};
  render::StyleOptions style = *look.style;
  if (!look.light_picture.empty()) {
    FOURDVT_ASSIGN(const Image picture, platform::readImage(look.light_picture));
    auto light = render::lightFromPicture(picture.pixels, picture.width, picture.height, picture.channels);
    if (!light) return Error{light.error().id, look.light_picture + ": " + light.error().message};
    style.light = light.value();
  }
  return render::setStyle(device, recipe, style);
}

}  // namespace fourdvt::tools
