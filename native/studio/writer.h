// SPDX-License-Identifier: Apache-2.0
// Writing a studio capture: progress and stop, packed meshes, and the folder that appears only when it is complete.
#pragma once

#include <string>

#include "studio/actors/actor.h"
#include "studio/studio.h"

namespace fourdvt::studio {

// FOLDER.work until keep(); removed with what is in it otherwise.
class OutputFolder {
 public:
  // Errors: InvalidArgument (FOLDER is there and no studio capture, FOLDER.work is there and not ours), WriteFailed.
  static Result<OutputFolder> open(const std::string& folder);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();
  const std::string& path() const { return work_; }
  Status makeFolder(const std::string& name) const;
  Status keep();

 private:
  OutputFolder(std::string folder, std::string work) : folder_(std::move(folder)), work_(std::move(work)) {}
  std::string folder_, work_;
};

class Ticker {
 public:
  Ticker(const StudioEnvironment& environment, uint32_t total) : environment_(environment) { progress_.total = total; }
  void begin(const std::string& step) { progress_.step = step; }
  Status tick();  // one picture done; Interrupted
  uint32_t done() const { return progress_.done; }

 private:
  const StudioEnvironment& environment_;
  StudioProgress progress_;
};

// mesh_topology.obj: faces, wedge UVs (origin bottom left), positions. 1-based "v/vt".
std::string objText(const MeshTopology& topology, const Positions& positions);
// Little-endian int16 [vertex][xyz], appended.
void appendPacked(const Positions& positions, double units_per_metre, std::vector<uint8_t>& out);
std::string numberedName(const char* format, uint32_t number);  // format: one %u

}  // namespace fourdvt::studio
