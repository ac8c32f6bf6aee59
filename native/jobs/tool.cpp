// SPDX-License-Identifier: Apache-2.0
#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/hash.h"
#include "base/text.h"
#include "jobs/plan.h"
#include "platform/files.h"

namespace fourdvt::jobs {
namespace {

bool isLoaded(const dl_phdr_info& object, const ElfW(Phdr) & part) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type == PT_LOAD && segment.p_vaddr <= part.p_vaddr &&
        part.p_vaddr + part.p_memsz <= segment.p_vaddr + segment.p_memsz)
      return true;
  }
  return false;
}

// Build-id of a loaded object; empty if it has none.
std::string buildIdOf(const dl_phdr_info& object) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = object.dlpi_phdr[i];
    if (header.p_type != PT_NOTE || !isLoaded(object, header)) continue;
    const char* note = reinterpret_cast<const char*>(object.dlpi_addr + header.p_vaddr);
    const char* const end = note + header.p_memsz;
    const auto padded = [](size_t n) { return (n + 3) & ~size_t(3); };
    while (note + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) head;
      std::memcpy(&head, note, sizeof head);
      const char* const name = note + sizeof head;
      const char* const content = name + padded(head.n_namesz);
      note = content + padded(head.n_descsz);
      if (note > end) break;
      if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0)
        return std::string(content, head.n_descsz);
    }
  }
  return {};
}

// Build-id, or name and size of the file of an object without one.
std::string nameOf(const dl_phdr_info& object) {
  std::string id = buildIdOf(object);
  if (!id.empty()) return id;
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::canonical(object.dlpi_name, failed);
  return path.filename().string() + " " + std::to_string(std::filesystem::file_size(path, failed));
}

// Names of the shared libraries that are loaded now, in an order independent of their load addresses.
std::string loadedLibraries() {
  std::vector<std::string> ids;
  ::dl_iterate_phdr(
      [](dl_phdr_info* object, size_t, void* out) {
        if (std::strchr(object->dlpi_name, '/'))  // skips the program itself and the kernel's vDSO
          static_cast<std::vector<std::string>*>(out)->push_back(nameOf(*object));
        return 0;
      },
      &ids);
  std::sort(ids.begin(), ids.end());
  std::string all;
  for (const std::string& id : ids) all += id + "\n";
  return all;
}

const std::string kLibraries = loadedLibraries();  // initialised before any other library is loaded

}  // namespace

const Tool& thisTool() {
  static const Tool tool = [] {
    Tool out{FOURDVT_VERSION, "", ""};
    std::error_code ignored;
    out.program = std::filesystem::read_symlink("/proc/self/exe", ignored).string();
    if (const auto bytes = platform::readFile("/proc/self/exe"))
      out.build = hexDigits(fnv1a(kLibraries, fnv1a(bytes.value())));
    return out;
  }();
  return tool;
}

std::string folderKey(const std::string& settings, bool in_pieces,
                      const std::function<bool(const std::string& key)>& holds) {
  const std::string of_build = settings + "build " + thisTool().build + "\n";
  return holds(of_build) || (in_pieces && !holds(settings)) ? of_build : settings;
}

}  // namespace fourdvt::jobs
