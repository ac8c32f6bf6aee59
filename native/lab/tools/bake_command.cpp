// SPDX-License-Identifier: Apache-2.0
#include "lab/labels/paper_labellings.h"
#include "lab/tools/commands.h"
#include "tools/commands.h"

namespace fourdvt::lab {
namespace {

void readLabels(tools::Args& args, bake::BakeOptions& options) {
  if (!args.has("--labels")) return;
  const std::string name = args.text("--labels");
  if (const bake::Labelling* rule = findLabelling(name)) return useLabelling(*rule, options);
  std::string names;
  for (const bake::Labelling* rule : allLabellings()) names += (names.empty() ? "" : ", ") + std::string(rule->name);
  args.complain("--labels must be one of " + names + ", not \"" + name + "\"");
}

}  // namespace

int bakeCommand(int argc, char** argv) {
  const tools::BakeExtension labels{
      {"--labels", "RULE",
       "labelling: joint (default), or one of the papers': naive, spatial, temporal-paper, per-texel"},
      readLabels};
  return tools::bakeCommand(argc, argv, &labels);
}

}  // namespace fourdvt::lab
