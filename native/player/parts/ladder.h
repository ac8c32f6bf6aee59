// SPDX-License-Identifier: Apache-2.0
// Chooses the rendition that a sequence's next GOPs are fetched in: the lowest at first, then the highest that the
// network's measured throughput carries and that is decoded in time. Pure logic on steps of the player's time. Does NOT
// fetch and does NOT switch anything (loading.h, pictures.h).
#pragma once

#include <cstdint>
#include <vector>

#include "package/character.h"

namespace fourdvt {

// In place of a rendition's number: the highest there is; as the network allows.
constexpr uint32_t kHighestRendition = UINT32_MAX, kAutomaticRendition = UINT32_MAX - 1;

class Ladder {
 public:
  explicit Ladder(uint32_t quality);

  // quality: a rendition's number (the highest of a sequence that has fewer), or one of the constants above.
  // most_texels: the automatic choice takes no layer 1, or layout, that is wider; 0: any.
  void setQuality(uint32_t quality, uint32_t most_texels);
  // This rendition cannot be decoded here. False: then none of the sequence's can.
  bool leaveOut(const package::Sequence& sequence, uint32_t rendition);
  // Its video file cannot be fetched, or is another than the manifest describes. The sequence stays where it is.
  void miss(const package::Rendition& rendition) { missing_.push_back(&rendition); }
  void seekAgain(const package::Sequence& sequence);   // what was missed
  void forget() { missing_.clear(), rough_.clear(); }  // another manifest's renditions follow
  // The edge expects that this rendition cannot be decoded here, or that it plays, but not smoothly: the automatic
  // choice then stays below it. Ignored where no other would be left.
  void judge(const package::Sequence& sequence, uint32_t rendition, bool plays);
  bool isOut(const package::Sequence& sequence, uint32_t rendition) const;
  bool allOut(const package::Sequence& sequence) const;
  // Begins with a throughput that the edge has measured elsewhere; what `measure` adds takes its place.
  void expect(double throughput_bps);
  // Adds the time since the last call: the bytes that came in it, and whether any were on their way.
  void measure(uint64_t bytes, double step_s, bool fetching);
  // Adds a step of playing pictures of this rendition; late: one is due, and only the decoder has yet to give it.
  // Too much of that takes the automatic choice below the rendition for a while, each time for twice as long.
  void measureDecoding(uint32_t rendition, double step_s, bool late);

  bool tooSlow(const package::Sequence& sequence, uint32_t rendition) const;

  // present: the rendition that was chosen before; it is kept while the throughput wavers round a limit. ahead_s: what
  // is held or on its way before that which is chosen for. With enough of it the present rendition is kept whatever was
  // measured, and the next one is tried: small answers measure the latency more than the throughput.
  uint32_t choose(const package::Sequence& sequence, uint32_t present, double ahead_s = 0) const;
  void rest() { rest_left_s_ = kTryAgain_s; }  // a lower one was chosen: none is tried for a while
  bool automatic() const { return quality_ == kAutomaticRendition; }
  uint32_t lowest(const package::Sequence& sequence) const { return allowed(sequence, 0); }
  // The highest that choose can ever give: what a loop that is held whole may be raised to.
  uint32_t highest(const package::Sequence& sequence) const;
  double throughput_bps() const { return seconds_ > 0 ? 8 * bytes_ / seconds_ : 0; }  // 0: nothing measured yet

 private:
  static constexpr double kTryAgain_s = 20;
  // The nearest to `r` that is not left out, below it before above it.
  uint32_t allowed(const package::Sequence& sequence, uint32_t r) const;

  uint32_t quality_, most_texels_ = 0;
  uint32_t left_out_ = 0;  // a bit for each rendition
  std::vector<const package::Rendition*> missing_, rough_;
  double bytes_ = 0, seconds_ = 0;   // recent ones, older ones count less
  double late_s_ = 0;                // likewise
  uint32_t too_slow_ = 0;            // the lowest rendition that is not decoded in time; 0: none
  double slow_left_s_ = 0, slow_s_;  // until it may be tried again; the whole wait the next time
  double rest_left_s_ = 0;
};

}  // namespace fourdvt
