// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/job_file.h"

#include "store/folder.h"

namespace fourdvt::store {

// Options that frames and their report depend on.
void fields(Archive& a, reconstruct::ReconstructOptions& o) {
  a(o.capture_folder, o.folder, o.sequences, o.leave_out, o.mattes_alone, o.any_silhouettes, o.synchronise,
    o.refine_cameras, o.hull, o.contour_tolerance_px, o.voxel_m, o.faces, o.adaptivity, o.stereo, o.planes, o.fairing);
}
void fields(Archive& a, reconstruct::JobFile& f) {
  a(f.job.options, f.job.settings_key, f.job.warnings, f.job.name, f.common_input_digest);
}

}  // namespace fourdvt::store

namespace fourdvt::reconstruct {
namespace {

constexpr const char* kFile = "/job.bin";

}  // namespace

Status writeJobFile(const std::string& job_folder, const JobFile& file) {
  return store::save(job_folder + kFile, file);
}

Result<JobFile> readJobFile(const std::string& job_folder) {
  const std::string path = job_folder + kFile;
  auto file = store::load<JobFile>(path);
  if (file) return file;
  if (file.error().id == ErrorId::FileMissing)
    return Error{ErrorId::FileMissing, path + ": there is none; run `fourdvt plan` again"};
  return Error{ErrorId::FileUnreadable,
               path + ": damaged, or of another version; delete it and run `fourdvt plan` again"};
}

}  // namespace fourdvt::reconstruct
