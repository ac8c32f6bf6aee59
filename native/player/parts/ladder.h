// SPDX-License-Identifier: Apache-2.0
// Rendition choice for a sequence's next GOPs: the lowest at first, then the highest within the measured throughput and
// decoding speed. Pure logic on steps of player time; fetching and switching: loading.h, pictures.h.
#pragma once

#include <cstdint>
#include <vector>

#include "package/character.h"

namespace fourdvt {

// Special rendition numbers: highest available; automatic by throughput.
constexpr uint32_t kHighestRendition = UINT32_MAX, kAutomaticRendition = UINT32_MAX - 1;

class Ladder {
 public:
  explicit Ladder(uint32_t quality);

  // quality: a rendition number (clamped to the sequence's highest), or one of the constants above. max_texels:
  // maximum width of layer 1, or of the layout, in the automatic choice; 0: unlimited.
  void setQuality(uint32_t quality, uint32_t max_texels);
  // Excludes a rendition that cannot be decoded here. False: none of the sequence is left.
  bool leaveOut(const package::Sequence& sequence, uint32_t rendition);
  // Excludes a rendition whose video file cannot be fetched or differs from the manifest. The sequence keeps its
  // position.
  void miss(const package::Rendition& rendition) { missing_.push_back(&rendition); }
  void seekAgain(const package::Sequence& sequence);   // re-admits missed renditions
  void forget() { missing_.clear(), rough_.clear(); }  // reset for another manifest
  // Excludes a rendition that the edge cannot decode, unless it is the last one left; plays: decodable but not smooth,
  // the automatic choice stays below it.
  void judge(const package::Sequence& sequence, uint32_t rendition, bool plays);
  bool isOut(const package::Sequence& sequence, uint32_t rendition) const;
  bool allOut(const package::Sequence& sequence) const;
  // Initial throughput measured by the edge; `measure` gradually replaces it.
  void expect(double throughput_bps);
  // Adds the time since the last call: bytes received, and whether a fetch was under way.
  void measure(uint64_t bytes, double step_s, bool fetching);
  // Adds a step of playing pictures of this rendition; late: a picture is due and only the decoder is missing. Too much
  // late time keeps the automatic choice below the rendition for a while, doubled each time.
  void measureDecoding(uint32_t rendition, double step_s, bool late);

  bool tooSlow(const package::Sequence& sequence, uint32_t rendition) const;

  // Chooses a rendition. present: previous choice, kept while the throughput fluctuates around a limit. ahead_s: time
  // buffered or under way before the GOP to choose for; if long enough, the present rendition is kept whatever was
  // measured, and the next one is tried: small responses measure latency more than throughput.
  uint32_t choose(const package::Sequence& sequence, uint32_t present, double ahead_s = 0) const;
  void rest() { rest_left_s_ = kTryAgain_s; }  // after a step down: no trial for a while
  bool automatic() const { return quality_ == kAutomaticRendition; }
  uint32_t lowest(const package::Sequence& sequence) const { return allowed(sequence, 0); }
  // Highest rendition that choose can return: target for a loop that is held whole.
  uint32_t highest(const package::Sequence& sequence) const;
  double throughput_bps() const { return seconds_ > 0 ? 8 * bytes_ / seconds_ : 0; }  // 0: no measurement yet

 private:
  static constexpr double kTryAgain_s = 20;
  // Nearest allowed rendition to `r`, lower ones first.
  uint32_t allowed(const package::Sequence& sequence, uint32_t r) const;

  uint32_t quality_, max_texels_ = 0;
  uint32_t left_out_ = 0;  // bit mask of renditions
  std::vector<const package::Rendition*> missing_, rough_;
  double bytes_ = 0, seconds_ = 0;   // decayed sums
  double late_s_ = 0;                // decayed sum
  uint32_t too_slow_ = 0;            // lowest rendition not decoded in time; 0: none
  double slow_left_s_ = 0, slow_s_;  // time to its next trial; length of the next pause
  double rest_left_s_ = 0;
};

}  // namespace fourdvt
