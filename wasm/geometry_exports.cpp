// SPDX-License-Identifier: Apache-2.0
// C ABI, geometry decoding: in slices, or in a worker. Ownership of records: exports.cpp.
#include <emscripten.h>

#include "instance.h"

using namespace fourdvt;

namespace {

template <class Value>
abi::Bytes bytesOf(const std::vector<Value>& values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), static_cast<uint32_t>(values.size() * sizeof(Value))};
}

}  // namespace

const abi::GeometryMesh* fdvt_geometry_mesh(Instance* h) {
  const package::BaseMesh* mesh = h->player->mesh();
  if (!mesh) return nullptr;
  h->records.mesh = {bytesOf(mesh->topology.face_vertices), bytesOf(h->player->chunkMesh()->base)};
  return &h->records.mesh;
}

int32_t fdvt_slice_decoding(Instance* h, double seconds) {
  h->player->sliceDecoding(
      {.steps = UINT32_MAX, .seconds = seconds, .now_s = [] { return emscripten_get_now() / 1000; }});
  return 1;
}
void fdvt_decode_elsewhere(Instance* h, int32_t on) { h->player->decodeElsewhere(on != 0); }

const abi::DecodeJob* fdvt_decode_job(Instance* h, uint32_t number) {
  const std::optional<DecodeJob> job = h->player->decodeJob(number);
  if (!job) return nullptr;
  const package::StreamIndex& index = *job->index;
  abi::DecodeJob& out = h->records.job;
  out.id = job->id;
  out.chunk = {job->chunk.data(), static_cast<uint32_t>(job->chunk.size())};
  out.wanted = job->frames;
  out.frames = index.chunks[job->gop].frame_count;
  out.layers = index.layer_count;
  out.members = index.member_count;
  out.references = index.reference_count;
  out.alignments = index.alignment_count;
  return &out;
}

void fdvt_frame_decoded(Instance* h, uint32_t job, uint32_t frame, const uint8_t* data, uint32_t size, double seconds) {
  h->player->takeDecoded(job, frame, {data, size}, seconds);
}
