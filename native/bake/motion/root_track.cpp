// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/root_track.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace fourdvt::bake {
namespace {

constexpr float kLow = 0.05f;          // metres above the ground below which vertices are examined
constexpr float kStanding = 0.015f;    // metres above the ground at which a vertex counts much less
constexpr double kSoleRise_mps = 0.2;  // vertical speed at which a vertex counts much less
constexpr double kSlow_mps = 0.2;      // sliding speed at which a vertex counts much less, at the end of the search
constexpr double kSlowAtFirst_mps = 0.8;
constexpr double kStandingSlide_mps = 0.5;  // a vertex that slides faster does not stand: the foot swings
constexpr int kSearches = 10;
constexpr double kFewStand = 0.3;    // share of the most weight that ever stands, at which a contact is half certain
constexpr double kSmoothness = 0.1;  // weight of smooth steps against contacts of certainty 1
constexpr double kDeclared = 0.05;   // certainty of the declared velocity, which decides where there is no contact
constexpr double kAgreement = 0.2;   // share of the declared speed within which the measured one agrees

struct Candidate {  // a vertex near the ground, from one frame to the next
  float height = 0;
  glm::vec3 moved{0};
};

struct Step {  // travel over the ground between two frames
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

// [frame] the vertices near the ground and how they move until the next frame; a loop's last frame leads to its first.
Result<std::vector<std::vector<Candidate>>> findCandidates(const capture::CaptureSequence& sequence, float ground,
                                                           const ReadPositions& read) {
  std::vector<std::vector<Candidate>> candidates(sequence.frame_count);
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
      if (height < kLow) candidates[t].push_back({std::max(height, 0.f), after[v] - before[v]});
    }
    before = std::move(next);
  }
  return candidates;
}

double square(double x) { return x * x; }

// Weight by which a vertex stands: it is low and neither rises nor falls.
double standing(const Candidate& c, double fps) {
  return std::exp(-square(c.height / kStanding) - square(c.moved.y * fps / kSoleRise_mps));
}

// The usual step over the ground if none is declared: the median over the vertices that stand.
glm::dvec2 usualStep(const std::vector<std::vector<Candidate>>& candidates, double fps) {
  std::vector<double> x, z;
  for (const auto& frame : candidates) {
    for (const Candidate& c : frame) {
      if (standing(c, fps) < 0.3) continue;
      x.push_back(-c.moved.x);
      z.push_back(-c.moved.z);
    }
  }
  if (x.empty()) return glm::dvec2(0);
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + long(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  return {median(x), median(z)};
}

// Finds the step by which standing vertices slide least; fast-sliding vertices count less and less.
Step solveStep(const std::vector<Candidate>& candidates, double fps, const glm::dvec2& usual) {
  Step step{usual, 0};
  for (int search = 0; search < kSearches; ++search) {
    const double share = double(search) / (kSearches - 1);
    const double slow = kSlowAtFirst_mps * std::pow(kSlow_mps / kSlowAtFirst_mps, share) / fps;
    glm::dvec2 sum(0);
    double weight = 0;
    for (const Candidate& c : candidates) {
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

// Keeps certain steps and lets the others follow their neighbours' velocity. `declared` may be null.
void smoothSteps(std::vector<Step>& steps, bool loop, const glm::dvec2* declared) {
  double max_weight = 0;
  for (const Step& step : steps) max_weight = std::max(max_weight, step.weight);
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

}  // namespace

Result<std::vector<glm::vec3>> rootTrack(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                         const ReadPositions& read, std::string* note) {
  FOURDVT_ASSIGN(auto ground, findGround(sequence, read));
  FOURDVT_ASSIGN(auto candidates, findCandidates(sequence, ground, read));
  const glm::dvec2 declared = glm::dvec2(sequence.root_velocity_mps.x, sequence.root_velocity_mps.z) / capture.fps;
  const bool is_declared = glm::length(declared) > 0;
  const glm::dvec2 usual = is_declared ? declared : usualStep(candidates, capture.fps);
  std::vector<Step> steps;
  glm::dvec2 travel(0);
  for (const auto& frame : candidates) steps.push_back(solveStep(frame, capture.fps, usual));
  smoothSteps(steps, sequence.loop, is_declared ? &declared : nullptr);
  for (const Step& step : steps) travel += step.metres;
  const double count = double(steps.size());
  if (is_declared && glm::length(travel / count - declared) > kAgreement * glm::length(declared)) {
    if (note) {
      *note = "sequence '" + sequence.name + "': the feet travel at " +
              std::to_string(glm::length(travel) / count * capture.fps) + " m/s, root_velocity says " +
              std::to_string(glm::length(declared) * capture.fps) + " m/s; the latter is used";
    }
    for (Step& step : steps) step.metres = declared;
  }
  std::vector<glm::vec3> track = {glm::vec3(0)};
  glm::dvec2 at(0);
  for (const Step& step : steps) {
    at += step.metres;
    track.emplace_back(at.x, at.y, 0);
  }
  return track;
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
      const glm::vec3 moved = p[v] - before[v];
      const bool stands = p[v].y - ground < kStanding && std::abs(moved.y) * capture.fps < kSoleRise_mps &&
                          glm::length(glm::vec2(moved.x, moved.z) + step) * capture.fps < kStandingSlide_mps;
      const glm::vec2 at = glm::vec2(p[v].x, p[v].z) + glm::vec2(track[t]);
      Contact& contact = contacts[v];
      if (!stands) {
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
