// SPDX-License-Identifier: Apache-2.0
#include "lab/labels/paper_labellings.h"
#include "lab/tools/commands.h"
#include "tools/commands.h"

namespace fourdvt::lab {
namespace {

tools::Options labelsOption(bake::BakeOptions& options) {
  const auto read = [&options](tools::Args& args, const std::string& name) {
    if (!args.has(name)) return;
    if (const bake::Labelling* rule = findLabelling(args.text(name))) return useLabelling(*rule, options);
    std::string names;
    for (const bake::Labelling* rule : allLabellings()) names += (names.empty() ? "" : ", ") + std::string(rule->name);
    args.refuse(name, "one of " + names);
  };
  return {{"--labels RULE", read,
           "labelling: joint (default), or one of the papers': naive, spatial, temporal-paper, per-texel"}};
}

}  // namespace

Result<int> bakeCommand(int argc, char** argv) { return tools::bakeCommand(argc, argv, labelsOption); }

}  // namespace fourdvt::lab
