// SPDX-License-Identifier: Apache-2.0
// Work beyond what a first picture takes: prefetching, judgements of renditions, decoding of geometry in slices,
// programs; and decoders that keep time themselves.
#include "player/player_impl.h"

namespace fourdvt {

namespace {
constexpr size_t kMostLandings = 3;
constexpr double kLead_s = 0.12;  // what a transition takes to prepare its target, about
}  // namespace

void PlayerImpl::judgeRendition(uint32_t sequence, uint32_t rendition, bool plays) {
  if (!character() || sequence >= character()->sequences.size()) return;
  const package::Sequence& s = character()->sequences[sequence];
  if (rendition < s.renditions.size()) loading_.ladder().judge(s, rendition, plays);
}

void PlayerImpl::lookAhead(bool at_once) {
  looks_ahead_ = true;
  commanded_ = commanded_ || at_once;
  loading_.lookAhead();
}

void PlayerImpl::sliceDecoding(const DecodeSlice& slice) { loading_.sliceDecoding(slice); }

void PlayerImpl::decodeAhead() {
  std::array<Need, kDecoders> needs;
  size_t count = 0;
  for (const Track* t : {&main(), &other()})
    if (isReady(*t)) needs[count++] = {t->head.sequence(), frameOf(*t, t->head.position()), loops(*t), {}};
  loading_.decodeAhead({needs.data(), count}, seeking());
}

void PlayerImpl::decodeElsewhere(bool on) { loading_.decodeElsewhere(on); }
std::optional<DecodeJob> PlayerImpl::decodeJob(size_t number) { return loading_.decodeJob(number); }
bool PlayerImpl::takeDecoded(uint32_t job, uint32_t row, std::span<const uint8_t> bytes, double seconds) {
  return loading_.takeDecoded(job, row, bytes, seconds);
}
const package::BaseMesh* PlayerImpl::mesh() const { return loading_.hasMesh() ? &loading_.mesh() : nullptr; }
const package::ChunkMesh* PlayerImpl::chunkMesh() const { return loading_.hasMesh() ? &loading_.chunkMesh() : nullptr; }

// Prefetches for the sequences that follow the current one in the manifest.
void PlayerImpl::fetchAhead() {
  if (seeking() || transitions_.phase() != Transitions::Phase::None) return;
  std::array<Loading::Landing, kMostLandings> landings;
  const int count = loading_.sequenceCount(), source = main().head.sequence();
  size_t found = 0;
  for (int i = 1; i < count && found < kMostLandings; ++i) {
    const int target = (source + i) % count;
    if (!loading_.broken(target)) landings[found++] = {target, landingOn(target)};
  }
  loading_.fetchAhead({landings.data(), found});
}

// Returns the frame at which a transition that starts now enters the target; without a motion graph, the first frame.
uint32_t PlayerImpl::landingOn(int target) const {
  const TransitionView view = transitionView();
  if (view.held || !view.graph) return 0;
  const auto way = view.graph->plan({view.source, view.frame(), view.weights, view.sequence->fps * view.clock_rate},
                                    target, {.min_wait_s = kLead_s});
  return way ? way->entry.frame : 0;
}

std::optional<TimeRange> PlayerImpl::buffered(size_t number) const {
  const int sequence = main().head.sequence();
  if (sequence < 0 || starting() || !loading_.playable(sequence)) return {};
  const auto& chunks = loading_.index(sequence).chunks;
  const double fps = wantedOf(main()).fps;
  for (size_t first = 0; first < chunks.size(); ++first) {
    size_t end = first;
    while (end < chunks.size() && loading_.holds(sequence, static_cast<uint32_t>(end))) ++end;
    if (end == first) continue;
    if (number-- == 0) {
      const package::ChunkEntry& last = chunks[end - 1];
      return TimeRange{chunks[first].first_frame / fps, (last.first_frame + last.frame_count) / fps};
    }
    first = end;
  }
  return {};
}

// Keeps a picture or two ready: a decoder that runs ahead of the clock is slowed down, one that lags is sped up.
double PlayerImpl::pace(int decoder) const {
  const Track& t = tracks_[static_cast<size_t>(decoder != 0)];
  if (!t.head.used() || !runs(t)) return 0;
  constexpr double kPaces[] = {1.15, 1, 0.9};
  const int ready = std::min(t.slots.readyCount(), 2);
  return wantedOf(t).fps * clockRate(t) * kPaces[ready];
}

// The picture is another presentation's than it was named for: of what the element had when it was copied. It counts as
// that one's where that is a neighbour and yet to be shown, and goes unused where that has passed. One that is sought
// must be that one: it is awaited again.
bool PlayerImpl::takeAs(Track& t, int slot, std::optional<uint32_t> seen) {
  const int64_t named = t.slots.k(slot);
  if (t.head.seeking()) {
    t.slots.reject(slot);
    t.feeding.awaitAgain(named);
    return false;
  }
  // A late page copies a later picture, a time that runs ahead names one that is yet to come. Within less than a loop
  // the frame tells which.
  constexpr int64_t kBack = 8, kOn = 17;
  const int64_t first = std::max<int64_t>(0, named - kBack);
  const int64_t end = std::min(named + kOn, first + wantedOf(t).frame_count);
  for (int64_t k = first; seen && k < end; ++k) {
    if (frameOf(t, k) % 4096 != *seen) continue;
    if (k > t.head.shown().k)
      t.slots.renumber(slot, k);
    else
      t.slots.reject(slot);
    return k > t.head.shown().k;
  }
  ++stats_.barcode_mismatches;
  t.slots.reject(slot);
  return false;
}

// A blend has at most one member more than the space has parameters, and is aligned as far as is known. An error comes
// up again in the picture's draw.
bool PlayerImpl::makeNextProgram(const render::RecipeOptions& options) {
  if (!hasFrame() || fromCameras()) return false;
  size_t most_members = 1;
  bool aligned = true;
  for (int i = 0; i < loading_.sequenceCount(); ++i) {
    const package::Sequence& s = loading_.sequence(i);
    most_members = std::max(most_members, std::min(s.members.size(), s.space.names.size() + 1));
    if (s.isClass() && loading_.hasHeader(i)) aligned = loading_.index(i).alignment_count > 0;
  }
  auto made = recipe_->makeNextProgram(character()->layer_count, static_cast<int>(most_members), aligned,
                                       options_.picture_kind, {options, align_});
  return made.ok() && made.value();
}

}  // namespace fourdvt
