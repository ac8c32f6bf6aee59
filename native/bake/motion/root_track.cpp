// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/root_track.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/robust.h"

namespace fourdvt::bake {
namespace {

constexpr float kLow = 0.05f;          // metres above the ground below which vertices are examined
constexpr float kStanding = 0.015f;    // metres above the ground at which a vertex's weight has fallen considerably
constexpr double kSoleRise_mps = 0.2;  // vertical speed at which a vertex's weight has fallen considerably
constexpr double kSlow_mps =
    0.2;  // sliding speed at which a vertex's weight has fallen considerably, at the end of the search
constexpr double kSlowAtFirst_mps = 0.8;
constexpr double kStandingSlide_mps = 0.5;  // limit for standing vertices; faster ones belong to a swinging foot
constexpr int kSearches = 10;
constexpr double kFewStand = 0.3;    // share of the maximum standing weight at which a contact is half certain
constexpr double kSmoothness = 0.1;  // weight of smooth steps against contacts of certainty 1
constexpr double kDeclared = 0.05;   // certainty of the declared velocity, which prevails without contacts
constexpr double kAgreement = 0.2;   // share of the declared speed within which the measured one agrees
constexpr double kMinStand = 0.1;    // weight below which a vertex does not stand
// footfalls: the shortest time without landing vertices between two, and the minimum share of the heaviest footfall's
// vertices.
constexpr double kRest_s = 0.1, kFootShare = 0.2;
constexpr int kLongestStand = 32;  // steps after which a contact is split
// steadySteps: rounds, and the weight of fixed contacts, at the frame of maximum standing weight, in the first and
// the last.
constexpr int kSteadyingRounds = 8;
constexpr double kMinSteadiness = 1, kMaxSteadiness = 10;

struct ContactCandidate {  // a vertex near the ground, from one frame to the next
  uint32_t vertex = 0;
  float height = 0;
  glm::vec3 moved{0};
};

struct GroundStep {  // travel over the ground between two frames
  glm::dvec2 metres{0};
  double weight = 0;
};

// Height of the ground under the feet: four fifths of the frames have their lowest vertex at it or above.
float groundLevel(std::vector<float> lowest) {
  const auto fifth = lowest.begin() + long(lowest.size() / 5);
  std::nth_element(lowest.begin(), fifth, lowest.end());
  return *fifth;
}

Result<float> findGround(const capture::CaptureSequence& sequence, const ReadPositions& read) {
  std::vector<float> lowest;
  for (uint32_t t = 0; t < sequence.frame_count; ++t) {
    FOURDVT_ASSIGN(auto frame, read(sequence, t));
    float low = 1e30f;
    for (const glm::vec3& p : frame) low = std::min(low, p.y);
    lowest.push_back(low);
  }
  return groundLevel(std::move(lowest));
}

// [frame] vertices near the ground and their movement until the next frame; a loop's last frame leads to its first.
Result<std::vector<std::vector<ContactCandidate>>> findCandidates(const capture::CaptureSequence& sequence,
                                                                  float ground, const ReadPositions& read) {
  std::vector<std::vector<ContactCandidate>> candidates(sequence.frame_count);
  auto first = read(sequence, 0);
  if (!first) return first.error();
  Positions before = first.value();
  for (uint32_t t = 0; t < sequence.frame_count; ++t) {
    const bool last = t + 1 == sequence.frame_count;
    if (last && !sequence.loop) break;
    FOURDVT_ASSIGN(auto next, last ? std::move(first) : read(sequence, t + 1));
    const Positions& after = next;
    for (size_t v = 0; v < before.size(); ++v) {
      const float height = 0.5f * (before[v].y + after[v].y) - ground;
      if (height < kLow) candidates[t].push_back({uint32_t(v), std::max(height, 0.f), after[v] - before[v]});
    }
    before = std::move(next);
  }
  return candidates;
}

double square(double x) { return x * x; }

// Weight of a standing vertex: low, without vertical motion.
double standing(const ContactCandidate& c, double fps) {
  return std::exp(-square(c.height / kStanding) - square(c.moved.y * fps / kSoleRise_mps));
}

// Default step over the ground if none is declared: the median over the standing vertices.
glm::dvec2 usualStep(const std::vector<std::vector<ContactCandidate>>& candidates, double fps) {
  std::vector<double> x, z;
  for (const auto& frame : candidates) {
    for (const ContactCandidate& c : frame) {
      if (standing(c, fps) < 0.3) continue;
      x.push_back(-c.moved.x);
      z.push_back(-c.moved.z);
    }
  }
  return {median(x), median(z)};
}

// Finds the step that minimises the sliding of standing vertices, with decreasing weight of fast-sliding ones.
GroundStep solveStep(const std::vector<ContactCandidate>& candidates, double fps, const glm::dvec2& usual) {
  GroundStep step{usual, 0};
  for (int search = 0; search < kSearches; ++search) {
    const double share = double(search) / (kSearches - 1);
    const double slow = kSlowAtFirst_mps * std::pow(kSlow_mps / kSlowAtFirst_mps, share) / fps;
    glm::dvec2 sum(0);
    double weight = 0;
    for (const ContactCandidate& c : candidates) {
      const glm::dvec2 wanted(-c.moved.x, -c.moved.z);
      const glm::dvec2 slide = wanted - step.metres;
      const double w = standing(c, fps) * std::exp(-glm::dot(slide, slide) / square(slow));
      sum += w * wanted;
      weight += w;
    }
    step.weight = weight;
    if (weight > 1e-3) step.metres = sum / weight;
  }
  return step;
}

// Keeps certain steps and interpolates the others from their neighbours' velocity. `declared` may be null.
void smoothSteps(std::vector<GroundStep>& steps, bool loop, const glm::dvec2* declared) {
  double max_weight = 0;
  for (const GroundStep& step : steps) max_weight = std::max(max_weight, step.weight);
  const int count = int(steps.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right(count, 2);
  for (int t = 0; t < count; ++t) {
    const double stand = square(steps[t].weight);
    const double certainty = stand / (stand + square(kFewStand * max_weight) + 1e-12) + 1e-9;
    entries.emplace_back(t, t, certainty + (declared ? kDeclared : 0));
    const glm::dvec2 wanted = certainty * steps[t].metres + (declared ? kDeclared * *declared : glm::dvec2(0));
    right.row(t) << wanted.x, wanted.y;
    const int next = t + 1 < count ? t + 1 : 0;
    if ((next == 0 && !loop) || next == t) continue;
    entries.insert(entries.end(),
                   {{t, t, kSmoothness}, {next, next, kSmoothness}, {t, next, -kSmoothness}, {next, t, -kSmoothness}});
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixX2d solved = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  for (int t = 0; t < count; ++t) steps[t].metres = {solved(t, 0), solved(t, 1)};
}

// Travel between frames at which the vertices that stand in all of them do not slide.
class Contacts {
 public:
  Contacts(const std::vector<std::vector<ContactCandidate>>& candidates, const std::vector<GroundStep>& steps,
           bool loop, double fps)
      : count_(int(candidates.size())), pairs_(candidates.size() * kLongestStand), weight_at_(candidates.size()) {
    const auto standingAt = [&](int t) {
      std::vector<Stand> stands;
      for (const ContactCandidate& c : candidates[size_t(t)]) {
        const glm::dvec2 moved(c.moved.x, c.moved.z), slide = moved + steps[size_t(t)].metres;
        const double weight = standing(c, fps) * std::exp(-glm::dot(slide, slide) / square(kSlow_mps / fps));
        if (weight > kMinStand) stands.push_back({c.vertex, weight, moved});
      }
      return stands;
    };
    std::map<uint32_t, int> steps_of;  // [vertex] number of steps in which it stands
    std::set<uint32_t> at_end;         // vertices that stand in the last step
    for (int t = 0; loop && t < count_; ++t)
      for (const Stand& stand : standingAt(t)) {
        ++steps_of[stand.vertex];
        if (t + 1 == count_) at_end.insert(stand.vertex);
      }
    const auto alwaysStands = [&](uint32_t vertex) { return steps_of[vertex] == count_; };
    // A loop is traversed twice: a contact across its end is complete where it begins in the first pass, and a
    // permanent contact is as long as the loop.
    std::map<uint32_t, Contact> open;
    for (int t = 0; t < (loop ? 2 : 1) * count_; ++t) {
      std::map<uint32_t, Contact> still;
      for (const Stand& now : standingAt(t % count_)) {
        if (t >= count_ && (!open.contains(now.vertex) || alwaysStands(now.vertex))) continue;
        const bool began_before = loop && t == 0 && at_end.contains(now.vertex) && !alwaysStands(now.vertex);
        Contact contact{t, began_before, {glm::dvec2(0)}, {now.weight}};
        if (auto known = open.extract(now.vertex); !known.empty()) contact = std::move(known.mapped());
        contact.weight.back() = (contact.weight.back() + now.weight) / 2;
        contact.moved.push_back(contact.moved.back() + now.moved);
        contact.weight.push_back(now.weight);
        if (contact.moved.size() > kLongestStand) {
          add(contact);
          contact = {t + 1, contact.began_before, {glm::dvec2(0)}, {now.weight}};
        }
        still.emplace(now.vertex, std::move(contact));
      }
      for (const auto& [vertex, contact] : open) add(contact);
      open = std::move(still);
    }
    for (const auto& [vertex, contact] : open) add(contact);
  }

  // Calls use(frame, later frame, metres to travel, weight); at the frame of maximum standing weight the vertices'
  // weights sum to 1.
  template <typename Use>
  void forEachPair(const Use& use) const {
    const double most = std::max(1e-9, *std::max_element(weight_at_.begin(), weight_at_.end()));
    for (int t = 0; t < count_; ++t)
      for (int later = 1; later <= kLongestStand; ++later) {
        const Pair& pair = pairs_[size_t(t * kLongestStand + later - 1)];
        if (pair.weight > 0) use(t, t + later, -pair.moved / pair.weight, pair.weight / most);
      }
  }

 private:
  struct Stand {  // one vertex from one frame to the next
    uint32_t vertex = 0;
    double weight = 0;
    glm::dvec2 moved{0};
  };
  struct Contact {
    int first = 0;                  // frame, possibly in a loop's second pass
    bool began_before = false;      // starts before frame 0: complete in the second pass
    std::vector<glm::dvec2> moved;  // [frame] displacement since the first
    std::vector<double> weight;     // [frame]
  };
  struct Pair {
    double weight = 0;
    glm::dvec2 moved{0};  // times the weight
  };

  // Σ ω_i |q_i − mean|² = Σ_{i<j} ω_i ω_j / Σω |q_i − q_j|²: a contact contributes all pairs of its frames.
  void add(const Contact& contact) {
    if (contact.began_before) return;
    const double sum = std::accumulate(contact.weight.begin(), contact.weight.end(), 0.0);
    for (size_t i = 0; i < contact.weight.size(); ++i) {
      weight_at_[size_t(contact.first + int(i)) % weight_at_.size()] += contact.weight[i];
      for (size_t j = i + 1; j < contact.weight.size(); ++j) {
        const double weight = contact.weight[i] * contact.weight[j] / sum;
        Pair& pair = pairs_[(size_t(contact.first) + i) % weight_at_.size() * kLongestStand + (j - i - 1)];
        pair.weight += weight;
        pair.moved += weight * (contact.moved[j] - contact.moved[i]);
      }
    }
  }

  int count_;
  std::vector<Pair> pairs_;        // [frame][later]
  std::vector<double> weight_at_;  // [frame] sum of the vertices' weights
};

// Optimises the steps so that each contact stays in one place as a whole. The per-frame steps that it starts from
// drift by accumulated errors.
void steadySteps(std::vector<GroundStep>& steps, const std::vector<std::vector<ContactCandidate>>& candidates,
                 bool loop, double fps, const glm::dvec2* declared) {
  const int count = int(steps.size());
  for (int round = 0; round < kSteadyingRounds; ++round) {
    const double steadiness =
        kMinSteadiness * std::pow(kMaxSteadiness / kMinSteadiness, double(round) / (kSteadyingRounds - 1));
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(count, 2);
    // Unknown t is the place at frame t + 1; frame 0 is at 0, and a loop continues beyond its end.
    using Form = std::vector<std::pair<int, double>>;
    const auto place = [&](int frame, double factor, Form& form) {
      const int passes = frame / count, rest = frame % count;
      if (passes > 0) form.emplace_back(count - 1, passes * factor);
      if (rest > 0) form.emplace_back(rest - 1, factor);
    };
    const auto travel = [&](int from, int to) {
      Form form;
      place(to, 1, form);
      place(from, -1, form);
      return form;
    };
    const auto want = [&](const Form& form, const glm::dvec2& metres, double weight) {  // weight |form − metres|²
      for (const auto& [i, a] : form) {
        for (const auto& [j, b] : form) entries.emplace_back(i, j, weight * a * b);
        right.row(i) += weight * a * Eigen::RowVector2d(metres.x, metres.y);
      }
    };
    for (int t = 0; t < count; ++t) {
      want(travel(t, t + 1), declared ? *declared : glm::dvec2(0), declared ? kDeclared : 1e-9);
      if (t + 1 == count && !loop) continue;
      Form bend = travel(t + 1, t + 2);
      for (const auto& [i, factor] : travel(t, t + 1)) bend.emplace_back(i, -factor);
      want(bend, glm::dvec2(0), kSmoothness);
    }
    Contacts(candidates, steps, loop, fps).forEachPair([&](int from, int to, const glm::dvec2& metres, double weight) {
      want(travel(from, to), metres, steadiness * weight);
    });
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixX2d places = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
    for (int t = 0; t < count; ++t) {
      Eigen::RowVector2d step = places.row(t);
      if (t > 0) step -= places.row(t - 1);
      steps[size_t(t)].metres = {step.x(), step.y()};
    }
  }
}

}  // namespace

Result<std::vector<glm::vec3>> rootTrack(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                         const ReadPositions& read, std::string* note) {
  FOURDVT_ASSIGN(auto ground, findGround(sequence, read));
  FOURDVT_ASSIGN(auto candidates, findCandidates(sequence, ground, read));
  const glm::dvec2 declared = glm::dvec2(sequence.root_velocity_mps.x, sequence.root_velocity_mps.z) / capture.fps;
  const bool is_declared = glm::length(declared) > 0;
  const glm::dvec2 usual = is_declared ? declared : usualStep(candidates, capture.fps);
  std::vector<GroundStep> steps;
  glm::dvec2 travel(0);
  for (const auto& frame : candidates) steps.push_back(solveStep(frame, capture.fps, usual));
  smoothSteps(steps, sequence.loop, is_declared ? &declared : nullptr);
  steadySteps(steps, candidates, sequence.loop, capture.fps, is_declared ? &declared : nullptr);
  for (const GroundStep& step : steps) travel += step.metres;
  const double count = double(steps.size());
  if (is_declared && glm::length(travel / count - declared) > kAgreement * glm::length(declared)) {
    if (note) {
      *note = "sequence '" + sequence.name + "': the feet travel at " +
              std::to_string(glm::length(travel) / count * capture.fps) + " m/s, root_velocity says " +
              std::to_string(glm::length(declared) * capture.fps) + " m/s; the latter is used";
    }
    for (GroundStep& step : steps) step.metres = declared;
  }
  std::vector<glm::vec3> track = {glm::vec3(0)};
  glm::dvec2 at(0);
  for (const GroundStep& step : steps) {
    at += step.metres;
    track.emplace_back(at.x, at.y, 0);
  }
  return track;
}

namespace {

// True if a vertex stands on the ground in the later frame; step: metres over the ground between the two.
bool stands(const glm::vec3& before, const glm::vec3& now, const glm::vec2& step, float ground, double fps) {
  const glm::vec3 moved = now - before;
  return now.y - ground < kStanding && std::abs(moved.y) * fps < kSoleRise_mps &&
         glm::length(glm::vec2(moved.x, moved.z) + step) * fps < kStandingSlide_mps;
}

// [frame] number of standing vertices that did not stand in the two frames before; cyclic for a loop.
std::vector<int> comingToStand(const std::vector<std::vector<bool>>& standing, bool loop) {
  const int count = int(standing.size());
  std::vector<int> out(standing.size(), 0);
  for (int t = loop ? 0 : 1; t < count; ++t)
    for (size_t v = 0; v < standing[0].size(); ++v) {
      const auto at = [&](int frame) {
        return loop ? standing[size_t((frame + count) % count)][v] : standing[size_t(std::max(0, frame))][v];
      };
      if (at(t) && !at(t - 1) && !at(t - 2)) ++out[size_t(t)];
    }
  return out;
}

}  // namespace

Result<std::vector<uint32_t>> footfalls(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                        const std::vector<glm::vec3>& track, const ReadPositions& read) {
  FOURDVT_ASSIGN(auto ground, findGround(sequence, read));
  const uint32_t count = sequence.frame_count;
  // Marks a vertex as standing in two successive frames if it rests on the ground from one to the other, which
  // includes the frame of its impact.
  std::vector<std::vector<bool>> standing(count);
  FOURDVT_ASSIGN(const Positions first, read(sequence, 0));
  for (std::vector<bool>& frame : standing) frame.resize(first.size());
  Positions before = first;
  for (uint32_t t = 1; t <= (sequence.loop ? count : count - 1); ++t) {
    FOURDVT_ASSIGN(auto frame, read(sequence, t % count));
    const glm::vec2 step(track[t] - track[t - 1]);
    for (size_t v = 0; v < frame.size(); ++v) {
      if (before[v].y - ground >= kStanding || !stands(before[v], frame[v], step, ground, capture.fps)) continue;
      standing[t - 1][v] = standing[t % count][v] = true;
    }
    before = std::move(frame);
  }
  const std::vector<int> coming = comingToStand(standing, sequence.loop);
  // Stretches begin after the longest rest, so that a loop's end cuts none.
  struct Stretch {
    uint32_t first = 0;
    int vertices = 0;
  };
  std::vector<Stretch> stretches;
  const uint32_t rest = std::max(2u, uint32_t(kRest_s * capture.fps));
  uint32_t begin = 0, quiet = 0, longest = 0;
  for (uint32_t t = 0; sequence.loop && t < 2 * count; ++t) {
    quiet = coming[t % count] > 0 ? 0 : quiet + 1;
    if (quiet > longest) longest = quiet, begin = (t + 1) % count;
  }
  quiet = rest;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t t = (begin + i) % count;
    if (coming[t] == 0) {
      ++quiet;
      continue;
    }
    if (quiet >= rest) stretches.push_back({t, 0});
    stretches.back().vertices += coming[t];
    quiet = 0;
  }
  int most = 0;
  for (const Stretch& s : stretches) most = std::max(most, s.vertices);
  std::vector<uint32_t> out;
  for (const Stretch& s : stretches)
    if (s.vertices >= kFootShare * most) out.push_back(s.first);
  std::sort(out.begin(), out.end());
  return out;
}

Result<FootSkate> footSkate(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                            const std::vector<glm::vec3>& track, const ReadPositions& read) {
  FOURDVT_ASSIGN(auto ground, findGround(sequence, read));
  struct Contact {
    int frames = 0;
    glm::vec2 min{0}, max{0};
  };
  std::vector<Contact> contacts;
  std::vector<double> slides;
  const auto finish = [&](Contact& contact) {
    if (contact.frames >= 3) slides.push_back(glm::length(contact.max - contact.min));
    contact = {};
  };
  Positions before;
  for (uint32_t t = 0; t < sequence.frame_count; ++t) {
    FOURDVT_ASSIGN(auto frame, read(sequence, t));
    const Positions& p = frame;
    contacts.resize(p.size());
    if (before.empty()) before = p;
    const glm::vec2 step(track[t] - track[t > 0 ? t - 1 : 0]);
    for (size_t v = 0; v < p.size(); ++v) {
      const glm::vec2 at = glm::vec2(p[v].x, p[v].z) + glm::vec2(track[t]);
      Contact& contact = contacts[v];
      if (!stands(before[v], p[v], step, ground, capture.fps)) {
        finish(contact);
        continue;
      }
      contact.min = contact.frames == 0 ? at : glm::min(contact.min, at);
      contact.max = contact.frames == 0 ? at : glm::max(contact.max, at);
      ++contact.frames;
    }
    before = std::move(frame);
  }
  for (Contact& contact : contacts) finish(contact);
  if (slides.empty()) return FootSkate{};
  std::sort(slides.begin(), slides.end());
  const double sum = std::accumulate(slides.begin(), slides.end(), 0.0);
  return FootSkate{int(slides.size()), sum / double(slides.size()), slides[slides.size() * 95 / 100], slides.back()};
}

}  // namespace fourdvt::bake
