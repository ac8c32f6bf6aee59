// SPDX-License-Identifier: Apache-2.0
// Geometry decoding: on demand, ahead of time in slices of a tick, or elsewhere.
#include <algorithm>

#include "base/later.h"
#include "package/chunk_decoder.h"
#include "player/parts/loading.h"

namespace fourdvt {

namespace {

constexpr uint32_t kRowsAhead = 12;  // beyond the shown or sought frame
constexpr size_t kMaxJobs = 4;       // two tracks, present and next GOP each
// Limits, in slices, of a tick's decoding time while seeking, which is nominally half the tick: nothing moves until the
// frame is decoded.
constexpr double kMinSlices = 3, kMaxSlices = 8;

}  // namespace

// Switches to fine geometry, only at the start of a pass: later, all earlier rows would have to be decoded at once.
void Loading::takeFine(Gop& gop) {
  if (gop.fine_state != PartState::Present) return;
  gop.dropDecoded();
  gop.chunk = std::move(gop.fine);
  gop.fine.clear();
  gop.fine_state = PartState::Absent;
  gop.coarse = false;
}

// Opens the decoder on first use.
Status Loading::open(GopKey key, Gop& gop) {
  if (gop.decoded()) return {};
  const package::StreamIndex& coded = indexOf(key, gop);
  if (fromCameras()) {
    FOURDVT_ASSIGN(gop.surfaces,
                   later<&package::SurfaceChunk::open>(gop.chunk, coded, key.gop, *character_, sequence(key.sequence)));
  } else {
    FOURDVT_ASSIGN(gop.geometry, package::ChunkDecoder::open(gop.chunk, coded, key.gop, chunk_mesh_));
  }
  return {};
}

// Decodes up to a row, or by one step: kStep. Opening the decoder is one of the steps.
Status Loading::decode(GopKey key, Gop& gop, uint32_t row) {
  const bool timed = slice_ && slice_->now_s, opens = !gop.decoded();
  const double start_s = timed ? slice_->now_s() : 0;
  const uint32_t rows = gop.decodedRows();
  Status status = open(key, gop);
  if (status.ok() && !(opens && row == kStep))
    status = gop.surfaces   ? later<&package::SurfaceChunk::decodeTo>(*gop.surfaces, row == kStep ? rows : row)
             : row == kStep ? gop.geometry->step()
                            : gop.geometry->decodeTo(row);
  gop.damaged = !status.ok();
  const uint32_t more = gop.decodedRows() - rows;
  decoded_.rows += more;
  if (timed) {
    const double spent_s = slice_->now_s() - start_s;
    decoded_.timed_rows += more;
    decoded_.seconds += spent_s;
    tick_decode_s_ += spent_s;
    decoded_.longest_tick_s = std::max(decoded_.longest_tick_s, tick_decode_s_);
  }
  return status;
}

// Begins or continues a pass over the GOP at a requested row.
void Loading::enter(Gop& gop, uint32_t row) {
  if (row < gop.row || !gop.decoded()) takeFine(gop);
  gop.row = row;
}

Status Loading::geometry(int sequence_index, uint32_t frame, bool due, FrameGeometry& out) {
  if (mesh_state_ != PartState::Present || !playable(sequence_index)) return {};
  const package::StreamIndex& streamed = index(sequence_index);
  const GopKey key{sequence_index, streamed.chunkOfFrame(frame)};
  Gop* gop = cache_.find(key);
  if (!gop || gop->chunk_state != PartState::Present) return {};
  const uint32_t row = frame - streamed.chunks[key.gop].first_frame;
  enter(*gop, row);
  if (slice_ && !gop->damaged && row >= gop->decodedRows() + due) return {};
  const Status status = decode(key, *gop, row);
  if (!status.ok())
    return Error{status.error().id, sequence(sequence_index).stream_uri + ": " + status.error().message};
  if (row >= gop->decodedRows()) return {};  // decoded elsewhere
  out = {gop->geometry ? &gop->geometry->frames() : nullptr, &indexOf(key, *gop), row, gop->surfaces.get()};
  return {};
}

// ---- ahead of time, here in slices of a tick or elsewhere ----

// Remaining decode budget of a tick.
struct Loading::SliceLeft {
  const DecodeSlice& slice;
  uint32_t steps = slice.steps;
  double end_s = 0;
  // Grants the first step however short the time, so that a seek always progresses.
  bool takeStep() {
    const bool late = slice.now_s && slice.now_s() >= end_s;
    if (steps == 0 || (late && steps < slice.steps)) return false;
    --steps;
    return true;
  }
};

void Loading::decodeAhead(std::span<const Need> needs, bool seeking) {
  if (!slice_ || mesh_state_ != PartState::Present) return;
  jobs_.clear();
  SliceLeft left{*slice_};
  const double min_s = slice_->seconds * kMinSlices, max_s = slice_->seconds * kMaxSlices;
  if (slice_->now_s) left.end_s = slice_->now_s() + (seeking ? std::clamp(tick_s_ / 2, min_s, max_s) : slice_->seconds);
  for (uint32_t ahead = 0; ahead <= kRowsAhead; ++ahead)
    for (const Need& need : needs)
      if (const Ahead at = reach(need, ahead); at.gop) {
        if (elsewhere_ && index(need.sequence).chunkOfFrame(need.frame) != at.key.gop) handOver(at);
        giveAway(at, ahead == 0);
      }
  for (uint32_t ahead = 0; ahead <= kRowsAhead; ++ahead)
    for (const Need& need : needs)
      if (const Ahead at = reach(need, ahead); at.gop && !decodeAhead(at, ahead == 0, left)) return;
}

// GOP and row of the frame `ahead` frames after the needed one. gop: null beyond the end, or without its chunk.
Loading::Ahead Loading::reach(const Need& need, uint32_t ahead) {
  if (!playable(need.sequence)) return {};
  const package::StreamIndex& streamed = index(need.sequence);
  uint32_t frame = need.frame + ahead;
  if (frame >= streamed.frame_count && !need.loops) return {};
  frame %= streamed.frame_count;
  const GopKey key{need.sequence, streamed.chunkOfFrame(frame)};
  Gop* gop = cache_.find(key);
  if (!gop || gop->chunk_state != PartState::Present) return {};
  const package::ChunkEntry& chunk = streamed.chunks[key.gop];
  const uint32_t row = frame - chunk.first_frame;
  if (ahead == 0)
    enter(*gop, row);
  else if (!gop->decoded())
    takeFine(*gop);
  return {key, gop, row, chunk.frame_count};
}

// False: the tick's budget is used up. A chunk that does not decode is left to `geometry`, which reports it.
bool Loading::decodeAhead(const Ahead& at, bool urgent, SliceLeft& left) {
  while (!at.gop->job && at.gop->decodedRows() <= at.row) {
    if (!urgent && !cache_.hasRoomForDecoded()) return true;
    if (!left.takeStep()) return false;
    if (!decode(at.key, *at.gop, kStep).ok()) return true;
  }
  return true;
}

// Turns a GOP that was begun here and is not due into a job: its rows are kept, and decoded again elsewhere before the
// following ones.
void Loading::handOver(const Ahead& at) {
  Gop& gop = *at.gop;
  if (!gop.geometry || gop.job || gop.here || gop.damaged || gop.decodedRows() == at.row_count) return;
  const uint32_t rows = gop.decodedRows();
  gop.geometry = package::receivedChunk(gop.geometry->take(), rows);
  gop.job = ++last_job_;
}

// Turns a GOP that is not begun into a job, and lists each job until it is done: for all rows while memory allows it,
// else up to the required rows.
void Loading::giveAway(const Ahead& at, bool urgent) {
  Gop& gop = *at.gop;
  if (!elsewhere_ && gop.job && gop.decodedRows() < at.row_count) gop.dropDecoded();
  const bool room = cache_.hasRoomForDecoded();
  if (!gop.decoded() && elsewhere_ && !gop.here && !fromCameras() && (urgent || room)) {
    gop.geometry = package::receivedChunk(indexOf(at.key, gop), at.key.gop);
    gop.job = ++last_job_;
  }
  if (!gop.job || gop.decodedRows() == at.row_count) return;
  const auto known = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& job) { return job.id == gop.job; });
  if (known == jobs_.end()) {
    if (jobs_.size() < kMaxJobs) jobs_.push_back({gop.job, at.key, room ? at.row_count : urgent ? at.row + 1 : 0});
  } else if (room || urgent) {
    known->frames = std::max(known->frames, at.row + 1);
  }
}

std::optional<DecodeJob> Loading::decodeJob(size_t number) {
  for (const Job& job : jobs_) {
    const Gop* gop = cache_.find(job.key);
    if (!gop || gop->job != job.id || number-- > 0) continue;
    return DecodeJob{job.id, gop->chunk, &indexOf(job.key, *gop), job.key.gop, job.frames};
  }
  return {};
}

bool Loading::takeDecoded(uint32_t id, uint32_t row, std::span<const uint8_t> bytes, double seconds) {
  const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) { return j.id == id; });
  Gop* gop = job == jobs_.end() ? nullptr : cache_.find(job->key);
  if (!gop || gop->job != id) return false;
  if (row != gop->decodedRows()) return true;
  if (gop->geometry->append(bytes)) {
    ++decoded_.elsewhere;
    ++decoded_.rows;
    ++decoded_.timed_rows;
    decoded_.seconds += seconds;
    return true;
  }
  gop->dropDecoded();
  gop->here = true;
  return false;
}

}  // namespace fourdvt
