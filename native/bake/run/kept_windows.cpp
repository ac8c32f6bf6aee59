// SPDX-License-Identifier: Apache-2.0
#include "bake/run/kept_windows.h"

#include <filesystem>

#include "store/checked_file.h"

namespace fourdvt::bake {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInfix = ".window-";

}  // namespace

std::string KeptWindows::pathOf(uint32_t first, uint32_t end) const {
  return path_ + kInfix + std::to_string(first) + "-" + std::to_string(end - 1);
}

LabelKeeper KeptWindows::keeper() const {
  return {[this](uint32_t first, uint32_t end) {
            auto bytes = store::loadChecked(pathOf(first, end));
            return bytes ? bytes.take() : std::vector<uint8_t>();
          },
          [this](uint32_t first, uint32_t end, const std::vector<uint8_t>& bytes) {
            return store::saveChecked(pathOf(first, end), bytes);
          }};
}

void KeptWindows::remove() const {
  const fs::path labels(path_);
  std::error_code ignored;
  std::vector<fs::path> found;
  for (fs::directory_iterator file(labels.parent_path(), ignored), end; file != end; file.increment(ignored))
    if (file->path().filename().string().starts_with(labels.filename().string() + kInfix))
      found.push_back(file->path());
  for (const fs::path& file : found) fs::remove(file, ignored);
}

}  // namespace fourdvt::bake
