// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/class_plan.h"

#include <algorithm>
#include <cmath>

#include "bake/motion/hybrid_blend.h"
#include "bake/motion/time_warp.h"
#include "motion/placement.h"

namespace fourdvt::bake {
namespace {

constexpr size_t kFeatures = 300;      // vertices that the time warp compares
constexpr uint32_t kCheckPhases = 64;  // maximum number of phases at which the blend's bound is checked
constexpr int kTriangleChecks = 12, kTriangleSegments = 4;

struct Source {
  const capture::CaptureSequence* sequence = nullptr;
  std::vector<glm::vec3> track;
  PoseFeatures features;
  package::Member member;
};

// Name of the class in messages.
std::string placeOf(const capture::Capture& capture, const capture::CaptureClass& source) {
  return capture.folder + "/capture.json: class '" + source.name + "'";
}

// Checks that given values differ, and that those of two parameters span triangles; measured values follow later.
Status checkGivenValues(const capture::Capture& capture, const capture::CaptureClass& source) {
  std::vector<package::Member> members;
  for (const auto& declared : source.members) {
    if (declared.parameter.empty()) return {};
    package::Member& member = members.emplace_back();
    member.name = declared.sequence;
    member.parameter = declared.parameter;
  }
  FOURDVT_TRY(classSimplices(members, placeOf(capture, source)));
  return {};
}

// `vertices`: those that the time warp compares.
Result<Source> openSource(const capture::Capture& capture, const capture::CaptureClass::MemberOf& declared,
                          const std::vector<uint32_t>& vertices, const ReadPositions& read,
                          std::vector<std::string>& notes) {
  Source source;
  source.sequence = capture.find(declared.sequence);
  std::string note;
  FOURDVT_ASSIGN(auto track, rootTrack(capture, *source.sequence, read, &note));
  if (!note.empty()) notes.push_back(note);
  source.track = std::move(track);
  std::vector<Positions> frames;
  for (uint32_t t = 0; t < source.sequence->frame_count; ++t) {
    FOURDVT_ASSIGN(auto positions, read(*source.sequence, t));
    frames.emplace_back();
    for (uint32_t v : vertices) frames.back().push_back(positions[v]);
  }
  source.features = poseFeatures(frames, source.sequence->loop);
  source.member.name = declared.sequence;
  source.member.duration_s = source.sequence->frame_count / capture.fps;
  source.member.travel = source.track.back();
  source.member.parameter = declared.parameter;
  if (declared.parameter.empty()) source.member.parameter = {speedOf(source.member)};
  return source;
}

glm::vec3 joined(const glm::vec3& first, const glm::vec3& then) {
  return {motion::moved({glm::vec2(first), first.z}, then).ground_m, first.z + then.z};
}

// The root track at a fractional frame; a loop's continues into its next passes.
glm::vec3 trackAt(const Source& source, double frame) {
  const double count = source.sequence->frame_count;
  glm::vec3 passes(0);
  for (; source.sequence->loop && frame >= count; frame -= count) passes = joined(passes, source.track.back());
  const size_t before = std::min(size_t(frame), source.track.size() - 2);
  return joined(passes, glm::mix(source.track[before], source.track[before + 1], float(frame - double(before))));
}

ClassMember warpedMember(const Source& source, const Source& longest) {
  ClassMember member;
  member.source = source.sequence;
  if (&source == &longest) {
    for (uint32_t p = 0; p < source.sequence->frame_count; ++p) member.source_frame.push_back(p);
  } else {
    member.source_frame = warpTime(longest.features, source.features, source.sequence->loop);
  }
  const glm::vec3 start = trackAt(source, member.source_frame[0]);
  for (double frame : member.source_frame) member.root.push_back(motion::stepBetween(start, trackAt(source, frame)));
  return member;
}

size_t referenceOf(std::vector<std::vector<float>>& references, const std::vector<float>& weights) {
  for (size_t r = 0; r < references.size(); ++r) {
    float distance = 0;
    for (size_t m = 0; m < weights.size(); ++m) distance += std::abs(weights[m] - references[r][m]);
    if (distance < 1e-5f) return r;
  }
  references.push_back(weights);
  return references.size() - 1;
}

std::vector<HybridSimplex> makeHybrid(const std::vector<BlendSimplex>& simplices, const std::vector<int>& segments,
                                      int checks, size_t member_count, std::vector<std::vector<float>>& references) {
  references.clear();
  std::vector<HybridSimplex> out;
  for (size_t s = 0; s < simplices.size(); ++s) {
    const BlendSimplex& simplex = simplices[s];
    HybridSimplex hybrid{
        simplex, segments[s], hybridNodes(simplex.interval(), segments[s], checks, mixOf(simplex)), {}};
    for (const Shares& node : hybrid.nodes)
      hybrid.references.push_back(referenceOf(references, simplexWeights(simplices[s], node, member_count)));
    out.push_back(std::move(hybrid));
  }
  return out;
}

// Selects the references: measures the errors, then splits the worst simplex until all are within the bound or no
// reference is left.
class ReferenceChooser {
 public:
  ReferenceChooser(std::vector<BlendSimplex> simplices, const ClassOptions& options, size_t member_count)
      : simplices_(std::move(simplices)), options_(options), member_count_(member_count) {
    const bool intervals = simplices_[0].interval();
    const int max_segments = intervals ? options.max_references + 1 : kTriangleSegments;
    // The outermost nodes of n segments lie about 4.9 / (n + 1)² from the ends: on a grid this fine they stay apart.
    const int min_checks = std::max(2 * max_segments, (max_segments + 1) * (max_segments + 1) / 8);
    checks_ = intervals ? std::max(options.check_weights - 1, min_checks) : kTriangleChecks;
    for (const BlendSimplex& simplex : simplices_) errors_.emplace_back(simplex, mixOf(simplex), checks_, max_segments);
  }

  Status measure(const ClassPlan& plan, const NonlinearBlend& blend, const ReadPositions& read,
                 const std::function<bool(double)>& progress) {
    const uint32_t stride = (plan.frame_count + kCheckPhases - 1) / kCheckPhases;
    for (uint32_t phase = 0; phase < plan.frame_count; phase += stride) {
      if (!progress(double(phase) / plan.frame_count)) return Error{ErrorId::Interrupted, "stopped while planning"};
      std::vector<Positions> members;
      for (const ClassMember& member : plan.members) {
        FOURDVT_ASSIGN(auto positions, memberPositions(member, phase, read));
        members.push_back(std::move(positions));
      }
      for (HybridErrors& errors : errors_) errors.add(blend, members);
    }
    return {};
  }

  std::vector<HybridSimplex> choose(ClassPlan& plan) const {
    std::vector<int> segments(simplices_.size(), 1);
    plan.linear_error_m = largest(segments);
    while (largest(segments) > options_.blend_error_m) {
      const std::vector<int> next = refined(segments);
      makeHybrid(simplices_, next, checks_, member_count_, plan.reference_weights);
      if (next == segments || plan.reference_weights.size() > size_t(options_.max_references)) break;
      segments = next;
    }
    plan.hybrid_error_m = largest(segments);
    return makeHybrid(simplices_, segments, checks_, member_count_, plan.reference_weights);
  }

 private:
  double errorOf(size_t simplex, int segments) const { return errors_[simplex].of(segments).max_m; }
  double largest(const std::vector<int>& segments) const {
    double error = 0;
    for (size_t s = 0; s < segments.size(); ++s) error = std::max(error, errorOf(s, segments[s]));
    return error;
  }
  // Triangles share edges and are therefore split all together.
  std::vector<int> refined(std::vector<int> segments) const {
    size_t worst = 0;
    for (size_t s = 1; s < segments.size(); ++s)
      if (errorOf(s, segments[s]) > errorOf(worst, segments[worst])) worst = s;
    for (size_t s = 0; s < segments.size(); ++s) {
      if (simplices_[s].interval() && s != worst) continue;
      segments[s] = std::min(segments[s] + 1, errors_[s].maxSegments());
    }
    return segments;
  }

  std::vector<BlendSimplex> simplices_;
  ClassOptions options_;
  size_t member_count_;
  int checks_ = 0;
  std::vector<HybridErrors> errors_;
};

Result<std::vector<Source>> openSources(const capture::Capture& capture, const capture::CaptureClass& source,
                                        const ReadPositions& read, ClassPlan& plan) {
  FOURDVT_ASSIGN(auto first, read(*capture.find(source.members[0].sequence), 0));
  const std::vector<uint32_t> vertices = spreadVertices(first, kFeatures);
  std::vector<Source> sources;
  for (const auto& member : source.members) {
    FOURDVT_ASSIGN(auto opened, openSource(capture, member, vertices, read, plan.notes));
    sources.push_back(std::move(opened));
  }
  const auto before = [](const Source& a, const Source& b) { return a.member.parameter[0] < b.member.parameter[0]; };
  if (source.parameters.size() == 1 && !std::is_sorted(sources.begin(), sources.end(), before)) {
    std::stable_sort(sources.begin(), sources.end(), before);
    plan.notes.push_back("class '" + source.name + "': its members were put in order of " + source.parameters[0]);
  }
  return sources;
}

// Sets the common time to that of the longest member.
void planTime(const std::vector<Source>& sources, ClassPlan& plan) {
  const auto shorter = [](const Source& a, const Source& b) {
    return a.sequence->frame_count < b.sequence->frame_count;
  };
  const Source& longest = *std::max_element(sources.begin(), sources.end(), shorter);
  double duration_s = 0;
  for (const Source& source : sources) {
    plan.members.push_back(warpedMember(source, longest));
    plan.manifest.push_back(source.member);
    const glm::vec3 start = trackAt(source, plan.members.back().source_frame[0]);
    if (source.sequence->loop)
      plan.manifest.back().travel = motion::stepBetween(start, joined(source.track.back(), start));
    duration_s += source.member.duration_s / double(sources.size());
  }
  plan.frame_count = longest.sequence->frame_count;
  plan.loop = longest.sequence->loop;
  plan.fps = plan.frame_count / duration_s;
}

}  // namespace

Status checkClass(const capture::Capture& capture, const capture::CaptureClass& source) {
  const auto impossible = [&](const std::string& what) {
    return Error{ErrorId::CaptureJson, placeOf(capture, source) + ": " + what};
  };
  const size_t parameters = source.parameters.size();
  if (parameters < 1 || parameters > size_t(package::kMaxParameters)) return impossible("give it one parameter or two");
  if (source.members.size() < 2 || source.members.size() > size_t(package::kMaxMembers))
    return impossible("a class has 2 to " + std::to_string(package::kMaxMembers) + " members");
  for (const auto& member : source.members) {
    const capture::CaptureSequence* sequence = capture.find(member.sequence);
    if (!sequence || sequence->frame_count == 0) return impossible("no sequence '" + member.sequence + "'");
    if (sequence->loop != capture.find(source.members[0].sequence)->loop)
      return impossible("'" + member.sequence + "' and '" + source.members[0].sequence +
                        "' are not both loops; leave one out");
    if (!member.parameter.empty() && member.parameter.size() != parameters)
      return impossible("'" + member.sequence + "' needs one value per parameter");
    if (member.parameter.empty() && (parameters != 1 || source.parameters[0] != capture::kMeasuredParameter))
      return impossible("only " + std::string(capture::kMeasuredParameter) + " is measured: give '" + member.sequence +
                        "' its value of every parameter");
  }
  return checkGivenValues(capture, source);
}

Result<ClassPlan> planClass(const capture::Capture& capture, const capture::CaptureClass& source,
                            const CapturedMeshes& meshes, const ClassOptions& options,
                            const std::function<bool(double)>& progress) {
  FOURDVT_TRY(checkClass(capture, source));
  const ReadPositions& read = meshes.read;
  ClassPlan plan;
  plan.source = &source;
  FOURDVT_ASSIGN(auto sources, openSources(capture, source, read, plan));
  planTime(sources, plan);
  FOURDVT_ASSIGN(auto simplices, classSimplices(plan.manifest, placeOf(capture, source)));
  FOURDVT_ASSIGN(auto pose, memberPositions(plan.members[0], 0, read));
  FOURDVT_ASSIGN(const auto blend, NonlinearBlend::create(meshes.topology, pose));
  ReferenceChooser chooser(std::move(simplices), options, plan.members.size());
  FOURDVT_TRY(chooser.measure(plan, blend, read, progress));
  const std::vector<HybridSimplex> hybrid = chooser.choose(plan);
  const bool measured =
      std::all_of(source.members.begin(), source.members.end(), [](const auto& m) { return m.parameter.empty(); });
  plan.space = parameterTable(plan.manifest, source.parameters, std::vector<bool>(source.parameters.size(), measured),
                              hybrid, plan.reference_weights.size());
  if (!progress(1)) return Error{ErrorId::Interrupted, "stopped while planning"};
  return plan;
}

Result<std::vector<ClassMember>> classMembers(const capture::Capture& capture, const capture::CaptureClass& source,
                                              const ReadPositions& read) {
  FOURDVT_TRY(checkClass(capture, source));
  ClassPlan plan;
  FOURDVT_ASSIGN(auto sources, openSources(capture, source, read, plan));
  planTime(sources, plan);
  return std::move(plan.members);
}

Result<Positions> memberPositions(const ClassMember& member, uint32_t phase, const ReadPositions& read) {
  const double at = member.source_frame[phase];
  const long count = long(member.source->frame_count), before = long(std::floor(at));
  const float u = float(at - double(before));
  const std::array<float, 4> shares = {0.5f * u * (-1 + u * (2 - u)), 1 + 0.5f * u * u * (-5 + 3 * u),
                                       0.5f * u * (1 + u * (4 - 3 * u)), 0.5f * u * u * (u - 1)};
  Positions out;
  for (long i = 0; i < 4; ++i) {
    if (shares[size_t(i)] == 0) continue;
    const long frame = before - 1 + i;
    const long kept = member.source->loop ? (frame % count + count) % count : std::clamp(frame, 0l, count - 1);
    auto read_frame = read(*member.source, uint32_t(kept));
    if (!read_frame) return read_frame;
    out.resize(read_frame.value().size(), glm::vec3(0));
    for (size_t v = 0; v < out.size(); ++v) out[v] += shares[size_t(i)] * read_frame.value()[v];
  }
  return out;
}

std::vector<Positions> referenceOffsets(const NonlinearBlend& blend, const ClassPlan& plan,
                                        std::span<const Positions> members) {
  std::vector<Positions> offsets;
  for (const auto& weights : plan.reference_weights) {
    offsets.push_back(blend.blend(members, weights));
    const Positions linear = linearBlend(members, weights);
    for (size_t v = 0; v < linear.size(); ++v) offsets.back()[v] -= linear[v];
  }
  return offsets;
}

std::vector<double> stepPhases(std::span<const uint32_t> frames, std::span<const double> source_frame,
                               uint32_t loop_frames, uint32_t phases) {
  std::vector<double> out;
  const auto nextFrame = [&](size_t p) {
    return p + 1 < source_frame.size() ? source_frame[p + 1] : source_frame[0] + loop_frames;
  };
  for (const uint32_t frame : frames) {
    for (size_t p = 0; p < source_frame.size(); ++p) {
      const double a = source_frame[p], b = nextFrame(p);
      double at = frame;
      if (loop_frames > 0)
        while (at < a - 1e-9) at += loop_frames;
      if (at < a - 1e-9 || !(at < b)) continue;
      out.push_back((double(p) + (at - a) / (b - a)) / phases);
      break;
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<double> meanSteps(const std::vector<std::vector<double>>& members, bool loop) {
  std::vector<double> out = members[0];
  for (const auto& member : members)
    if (member.size() != out.size()) return out;
  for (size_t i = 0; i < out.size(); ++i) {
    double sum = 0;
    for (const auto& member : members) {
      double nearest = 1;
      for (const double phase : member) {
        double away = phase - out[i];
        if (loop) away -= std::round(away);
        if (std::abs(away) < std::abs(nearest)) nearest = away;
      }
      sum += nearest;
    }
    out[i] += sum / double(members.size());
    if (loop) out[i] -= std::floor(out[i]);
    if (loop && out[i] >= 1) out[i] = 0;  // a rounding error below 0
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace fourdvt::bake
