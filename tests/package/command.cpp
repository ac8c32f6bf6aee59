// SPDX-License-Identifier: Apache-2.0
#include "command.h"

#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "../unit/character_files.h"

namespace fourdvt::test {

namespace fs = std::filesystem;

namespace {

// Path in a folder of this test program: ctest runs several programs at once, and some use the same names.
fs::path scratchPath(const std::string& name) {
  return fs::path(SCRATCH_FOLDER) / program_invocation_short_name / name;
}

}  // namespace

Outcome shell(const std::string& command) {
  Outcome out;
  std::FILE* pipe = popen(("exec 2>&1; " + command).c_str(), "r");
  if (!pipe) return out;
  char buffer[4096];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.output.append(buffer, n);
  const int status = pclose(pipe);
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return out;
}

Outcome fourdvt(const std::string& arguments) { return shell(std::string(FOURDVT_BIN) + " " + arguments); }

Outcome lab(const std::string& arguments) { return shell(std::string(FOURDVT_LAB_BIN) + " " + arguments); }

bool isOneLineWith(const Outcome& outcome, const std::string& part) {
  const std::string& text = outcome.output;
  return std::count(text.begin(), text.end(), '\n') == 1 && text.back() == '\n' && text.find(part) != std::string::npos;
}

std::string scratch(const std::string& name) {
  const fs::path path = scratchPath(name);
  fs::remove_all(path);
  fs::create_directories(path);
  return path.string();
}

std::string smallCapture(const std::string& name, int frames, const std::string& rig) {
  const std::string path = scratch(name);
  const Outcome made = shell(std::string(MAKE_SMALL_CAPTURE) + " " + path + " " + std::to_string(frames) + " " + rig);
  if (made.code != 0) std::fprintf(stderr, "%s", made.output.c_str());
  return path;
}

std::string copyOf(const std::string& folder, const std::string& name) {
  const fs::path path = scratchPath(name);
  fs::remove_all(path);
  fs::copy(folder, path, fs::copy_options::recursive);
  return path.string();
}

std::string onlyFile(const std::string& folder, const std::string& extension) {
  std::string found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == extension) found = found.empty() ? entry.path().string() : "(several)";
  return found;
}

std::string readText(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

void writeText(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

void truncateTo(const std::string& path, double share) {
  fs::resize_file(path, static_cast<uint64_t>(static_cast<double>(fs::file_size(path)) * share));
}

void damage(const std::string& path, uint64_t offset, uint64_t count) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(offset));
  file << std::string(count, '\xA5');
}

bool exists(const std::string& path) { return fs::exists(path); }

Outcome interrupted(const std::string& program, const std::string& arguments, const std::string& once_there,
                    const std::string& log) {
  const pid_t child = fork();
  if (child == 0) {
    const std::string command = "exec " + program + " " + arguments + " >" + log + " 2>&1";
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  // A busy machine may need minutes until then; ctest's timeout ends a program that never gets there.
  int status = 0;
  while (workFile(fs::path(once_there).parent_path(), fs::path(once_there).filename()).empty() &&
         waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  if (kill(child, SIGINT) == 0) waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), readText(log)};
}

std::vector<std::string> differences(const std::string& a, const std::string& b) {
  std::set<std::string> names;
  for (const std::string& folder : {a, b})
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && entry.path().stem() != "report")
        names.insert(fs::relative(entry.path(), folder).string());
  std::vector<std::string> out;
  for (const std::string& name : names) {
    const std::string in_a = a + "/" + name, in_b = b + "/" + name;
    if (!exists(in_a) || !exists(in_b) || readText(in_a) != readText(in_b)) out.push_back(name);
  }
  return out;
}

}  // namespace fourdvt::test
