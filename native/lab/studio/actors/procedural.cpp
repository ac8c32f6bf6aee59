// SPDX-License-Identifier: Apache-2.0
// The procedural actor's motions: closed-form joint curves of a phase. Those of gaits depend on a parameter, 0 = walk …
// 1 = run. Mid-stance of the left foot is at phase 0.25 and of the right one at 0.75, whatever the stance duration, so
// that a phase is the same pose of the stride for all parameters; the legs are furthest apart at 0 and 0.5. Between
// walk and run the joint angles of the legs are interpolated, except that a foot on the ground does not slide. The
// other motions keep both feet in place.
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/quaternion.hpp>

#include "lab/studio/actors/body.h"

namespace fourdvt::studio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kTextureSide = 2048;
constexpr double kSurfaceCell_m = 0.025;  // before subdivision

constexpr double kRaised = 2.6;  // radians from arms hanging down to arms raised sideways, 25° off the vertical

struct NamedMotion {
  const char* name;
  bool is_gait;
  double parameter = 0;   // gaits only
  double duration_s = 2;  // this and the following: other motions only
  bool loop = true;
  double raised = 0;  // radians by which the arms rise from the first to the last phase
};
constexpr NamedMotion kMotions[] = {
    {"walk", true, 0}, {"jog", true, 0.5}, {"run", true, 1}, {"stand", false}, {"raise", false, 0, 2, false, kRaised}};

constexpr double kMidStance = 0.25;  // phase
constexpr double kTakesUp =
    0.2;  // share of a swing at either end in which the foot's path changes over between the ground's and the joints'
constexpr double kSlopeStep = 1e-4;  // phase step
constexpr double kStance_m = 0.638;  // travel of a stance foot; a longer way would overstretch the leg

// Parameter-dependent constants.
struct Gait {
  explicit Gait(double w) : w(w) {}
  double mix(double walk, double run) const { return walk + w * (run - walk); }
  double w;
  double duration_s = mix(1.12, 0.76), speed_mps = mix(0.95, 2.6);
  double stance = kStance_m / (speed_mps * duration_s);  // share of the cycle
  double hip_m = mix(0.865, 0.82), bob_m = mix(0.022, -0.030), lift_m = mix(0.10, 0.30);
  double lean = mix(0.04, 0.20), yaw = mix(0.07, 0.16), swing = mix(0.35, 0.75), elbow = mix(0.35, 1.45);
  double toe = mix(0.35, 0.75), sway_m = mix(0.020, 0.010);
};

double smooth(double t) { return t * t * (3 - 2 * t); }

glm::dquat about(const glm::dvec3& axis, double angle) { return glm::angleAxis(angle, axis); }
constexpr glm::dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

// Moves `joint` to `to` and rotates about it.
glm::dmat4 turned(const glm::dquat& turn, const glm::dvec3& joint, const glm::dvec3& to) {
  glm::dmat4 m = glm::mat4_cast(turn);
  m[3] = glm::dvec4(to - turn * joint, 1);
  return m;
}
glm::dvec3 apply(const glm::dmat4& m, const glm::dvec3& p) { return glm::dvec3(m * glm::dvec4(p, 1)); }

struct FootTarget {
  double forward_m, height_m, pitch;
};
FootTarget operator+(const FootTarget& a, const FootTarget& b) {
  return {a.forward_m + b.forward_m, a.height_m + b.height_m, a.pitch + b.pitch};
}
FootTarget operator*(double k, const FootTarget& a) { return {k * a.forward_m, k * a.height_m, k * a.pitch}; }

// Below, `since` is the phase since mid-stance of the foot, -0.5…0.5.

// Stance foot: moves back at the root's speed and stays flat.
FootTarget onGround(const Gait& gait, double since) { return {-gait.speed_mps * gait.duration_s * since, 0, 0}; }

// Foot of walk or run.
FootTarget memberFoot(const Gait& gait, double since) {
  if (std::abs(since) <= 0.5 * gait.stance) return onGround(gait, since);
  const double swing = 1 - gait.stance, travel = gait.speed_mps * gait.duration_s, reach = 0.5 * travel * gait.stance;
  const double t = (since + (since < 0 ? 1 : 0) - 0.5 * gait.stance) / swing, slope = -travel * swing;
  const double h01 = t * t * (3 - 2 * t), h10 = t * (1 - t) * (1 - t), h11 = t * t * (t - 1);
  const double lift = std::sin(kPi * t) * std::sin(kPi * t);
  return {reach * (2 * h01 - 1) + slope * (h10 + h11), gait.lift_m * lift * (1.2 - 0.4 * t),
          gait.toe * lift * std::cos(kPi * t) * 2};
}

FootTarget footAt(const Gait& gait, double since);  // any gait

glm::dmat4 pelvisAt(const Gait& gait, double phase) {
  const double a = 2 * kPi * phase;
  const glm::dvec3 shift(gait.sway_m * std::sin(a), gait.hip_m - kHipRest.y - gait.bob_m * std::cos(2 * a), 0);
  return turned(about(kY, -gait.yaw * std::cos(a)), kPelvisRest, kPelvisRest + shift);
}

// Inputs of the skeleton; limbs: left, right.
struct Posture {
  struct Limbs {
    FootTarget foot;
    glm::dquat upper_arm, forearm;  // world
  };
  glm::dmat4 pelvis;
  glm::dquat spine, chest, head;  // world
  double ankle_m;                 // from the middle
  std::array<Limbs, 2> limbs;
};

Posture stride(const Gait& gait, double phase) {
  const double a = 2 * kPi * phase, twist = gait.yaw * std::cos(a);
  Posture out;
  out.pelvis = pelvisAt(gait, phase);
  out.spine = about(kX, 0.6 * gait.lean);
  out.chest = about(kY, twist) * about(kX, gait.lean);
  out.head = about(kX, 0.3 * gait.lean + 0.03 * std::cos(2 * a));
  out.ankle_m = gait.mix(0.11, 0.08);
  for (const bool left : {true, false}) {
    Posture::Limbs& limbs = out.limbs[left ? 0 : 1];
    const double since = phase + (left ? 0 : 0.5) - kMidStance;
    limbs.foot = footAt(gait, since - std::floor(since + 0.5));
    // The arm swings against the leg of its side.
    const double side = left ? 1 : -1, opposite = 2 * kPi * (phase + (left ? 0.5 : 0));
    const double swing = -gait.swing * std::cos(opposite) + 0.15 * gait.w;
    const double bend = gait.elbow * (1 + 0.25 * std::cos(opposite));
    limbs.upper_arm = out.chest * about(kX, swing) * about(kZ, -side * 0.62);
    limbs.forearm = out.chest * about(kX, swing - bend) * about(kZ, -side * 0.68);
  }
  return out;
}

// Standing upright with breathing and sway, one period a phase; arms raised sideways from hanging down.
Posture standing(double phase, double raised) {
  const double a = 2 * kPi * phase, breath = 0.5 - 0.5 * std::cos(a), up = raised / kRaised;
  Posture out;
  out.pelvis = turned(about(kY, 0.01 * std::sin(a)), kPelvisRest,
                      kPelvisRest + glm::dvec3(0.006 * std::sin(a), -0.012, 0.004 * std::cos(a)));
  out.spine = about(kX, 0.02 - 0.008 * breath);
  out.chest = about(kX, 0.03 - 0.02 * breath);
  out.head = about(kX, 0.01 * std::sin(a));
  out.ankle_m = 0.13;
  for (const bool left : {true, false}) {
    Posture::Limbs& limbs = out.limbs[left ? 0 : 1];
    const double side = left ? 1 : -1;
    limbs.foot = {0, 0, 0};
    limbs.upper_arm = out.chest * about(kZ, side * (raised - 0.60 + 0.02 * breath));
    limbs.forearm = out.chest * about(kX, -0.15 * (1 - up)) * about(kZ, side * (raised - 0.66 + 0.02 * breath));
  }
  return out;
}

class Skeleton {
 public:
  explicit Skeleton(const Posture& posture) {
    torso(posture);
    for (const bool left : {true, false}) {
      leg(posture, left);
      arm(posture.limbs[left ? 0 : 1], left);
    }
  }
  const std::array<glm::dmat4, kBoneCount>& bones() const { return bones_; }

 private:
  static glm::dvec3 sided(const glm::dvec3& p, bool left) { return left ? p : glm::dvec3(-p.x, p.y, p.z); }
  static Bone sided(Bone bone, bool left) { return left ? bone : static_cast<Bone>(bone + 3); }

  void torso(const Posture& posture) {
    bones_[Pelvis] = posture.pelvis;
    bones_[Spine] = turned(posture.spine, kWaistRest, apply(bones_[Pelvis], kWaistRest));
    const glm::dvec3 upper(0, 1.25, 0);
    bones_[Chest] = turned(posture.chest, upper, apply(bones_[Spine], upper));
    bones_[Head] = turned(posture.head, kNeckRest, apply(bones_[Chest], kNeckRest));
  }

  void leg(const Posture& posture, bool left) {
    const FootTarget& foot = posture.limbs[left ? 0 : 1].foot;
    const glm::dvec3 hip_rest = sided(kHipRest, left), knee_rest = sided(kKneeRest, left);
    const glm::dvec3 ankle_rest = sided(kAnkleRest, left), hip = apply(bones_[Pelvis], hip_rest);
    glm::dvec3 ankle(sided({posture.ankle_m, 0, 0}, left).x, kAnkleRest.y + foot.height_m, foot.forward_m);
    const double thigh = glm::length(knee_rest - hip_rest), shin = glm::length(ankle_rest - knee_rest);
    const double most = 0.999 * (thigh + shin), distance = glm::min(glm::length(ankle - hip), most);
    const glm::dvec3 line = glm::normalize(ankle - hip);
    ankle = hip + distance * line;
    const double along = (thigh * thigh - shin * shin + distance * distance) / (2 * distance);
    const double aside = std::sqrt(std::max(0.0, thigh * thigh - along * along));
    const glm::dvec3 front = glm::normalize(kZ - glm::dot(kZ, line) * line);
    const glm::dvec3 knee = hip + along * line + aside * front;
    const auto between = [](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::rotation(glm::normalize(a), glm::normalize(b));
    };
    bones_[sided(ThighL, left)] = turned(between(knee_rest - hip_rest, knee - hip), hip_rest, hip);
    bones_[sided(ShinL, left)] = turned(between(ankle_rest - knee_rest, ankle - knee), knee_rest, knee);
    bones_[sided(FootL, left)] = turned(about(kX, foot.pitch), ankle_rest, ankle);
  }

  void arm(const Posture::Limbs& limbs, bool left) {
    const glm::dvec3 shoulder_rest = sided(kShoulderRest, left), elbow_rest = sided(kElbowRest, left);
    const glm::dvec3 wrist_rest = sided(kWristRest, left), shoulder = apply(bones_[Chest], shoulder_rest);
    bones_[sided(UpperArmL, left)] = turned(limbs.upper_arm, shoulder_rest, shoulder);
    const glm::dvec3 elbow = apply(bones_[sided(UpperArmL, left)], elbow_rest);
    bones_[sided(ForearmL, left)] = turned(limbs.forearm, elbow_rest, elbow);
    bones_[sided(HandL, left)] = turned(limbs.forearm, wrist_rest, apply(bones_[sided(ForearmL, left)], wrist_rest));
  }

  std::array<glm::dmat4, kBoneCount> bones_;
};

// Position of the left foot by interpolated joint angles of walk and run; the right foot mirrors it half a cycle later.
FootTarget byJoints(const Gait& gait, double since) {
  static const Gait walk(0), run(1);
  const double phase = since + kMidStance;
  const Skeleton slow(stride(walk, phase)), fast(stride(run, phase));
  const auto turn = [&](Bone bone) {
    const auto of = [&](const Skeleton& s) { return glm::quat_cast(glm::dmat3(s.bones()[bone])); };
    return glm::slerp(of(slow), of(fast), gait.w);
  };
  const glm::dvec3 knee = apply(pelvisAt(gait, phase), kHipRest) + turn(ThighL) * (kKneeRest - kHipRest);
  const glm::dvec3 ankle = knee + turn(ShinL) * (kAnkleRest - kKneeRest);
  const double pitch = gait.mix(memberFoot(walk, since).pitch, memberFoot(run, since).pitch);
  return {ankle.z, ankle.y - kAnkleRest.y, pitch};
}

FootTarget footAt(const Gait& gait, double since) {
  if (gait.w == 0 || gait.w == 1) return memberFoot(gait, since);
  const double ends = 0.5 * gait.stance, swing = 1 - gait.stance;
  if (std::abs(since) <= ends) return onGround(gait, since);
  const auto gap = [&](double at) { return onGround(gait, at) + -1 * byJoints(gait, at); };
  FootTarget foot = byJoints(gait, since);
  for (const double side : {1.0, -1.0}) {  // once since the foot left the ground, once until it lands
    const double away = side * since < 0 ? 1 + side * since - ends : side * since - ends, u = away / (kTakesUp * swing);
    if (u >= 1) continue;
    const FootTarget at_end = gap(side * ends), before = gap(side * (ends - kSlopeStep));
    const FootTarget slope = (kTakesUp * swing / kSlopeStep) * (at_end + -1 * before);
    foot = foot + (1 - u) * (1 - u) * ((1 + 2 * u) * at_end + u * slope);
  }
  return foot;
}

class ProceduralActor final : public Actor {
 public:
  ProceduralActor(std::vector<NamedMotion> named, std::vector<Motion> motions, double mesh_cell_m, bool plain_clothes)
      : named_(std::move(named)), motions_(std::move(motions)), tracked_(meshBody(mesh_cell_m)) {
    surface_ = subdivideOnBody(meshBody(kSurfaceCell_m));
    texture_ = paintBody(surface_, kTextureSide, plain_clothes);
    for (const glm::vec3& p : surface_.positions) weights_.push_back(boneWeights(p));
  }

  const std::vector<Motion>& motions() const override { return motions_; }
  const RestMesh& surface() const override { return surface_; }
  const RestMesh& tracked() const override { return tracked_; }
  const Image& texture() const override { return texture_; }

  void pose(std::span<const double> shares, double phase, Positions& out) override {
    const Skeleton skeleton(postureAt(shares, phase));
    std::array<glm::mat4, kBoneCount> bones;
    for (int b = 0; b < kBoneCount; ++b) bones[b] = glm::mat4(skeleton.bones()[b]);
    out.resize(surface_.positions.size());
    for (size_t v = 0; v < out.size(); ++v) {
      glm::vec4 sum(0);
      for (int b = 0; b < kBoneCount; ++b)
        if (weights_[v][b] > 1e-5f) sum += weights_[v][b] * (bones[b] * glm::vec4(surface_.positions[v], 1));
      out[v] = glm::vec3(sum) / sum.w;
    }
  }

 private:
  Posture postureAt(std::span<const double> shares, double phase) const {
    double w = 0;
    for (size_t i = 0; i < shares.size(); ++i) {
      if (!named_[i].is_gait && shares[i] > 0) return standing(phase, named_[i].raised * smooth(phase));
      w += shares[i] * named_[i].parameter;
    }
    return stride(Gait(w), phase - std::floor(phase));
  }

  const std::vector<NamedMotion> named_;  // [motion]
  const std::vector<Motion> motions_;
  const RestMesh tracked_;
  RestMesh surface_;
  Image texture_;
  std::vector<std::array<float, kBoneCount>> weights_;
};

}  // namespace

Result<std::unique_ptr<Actor>> createProceduralActor(const std::vector<std::string>& names, double mesh_cell_m,
                                                     bool plain_clothes) {
  std::vector<NamedMotion> named;
  std::vector<Motion> motions;
  for (const std::string& name : names) {
    const auto* known = std::find_if(std::begin(kMotions), std::end(kMotions),
                                     [&](const NamedMotion& motion) { return name == motion.name; });
    if (known == std::end(kMotions))
      return Error{ErrorId::InvalidArgument,
                   "the procedural actor has no motion \"" + name + "\"; choose among walk, jog, run, stand and raise"};
    named.push_back(*known);
    if (known->is_gait) {
      const Gait gait(known->parameter);
      motions.push_back({name, gait.duration_s, true, {0, 0, gait.speed_mps}, true});
    } else {
      motions.push_back({name, known->duration_s, known->loop});
    }
  }
  if (motions.empty())
    return Error{ErrorId::InvalidArgument, "the procedural actor needs motions: walk, jog, run, stand or raise"};
  return std::unique_ptr<Actor>(
      std::make_unique<ProceduralActor>(std::move(named), std::move(motions), mesh_cell_m, plain_clothes));
}

}  // namespace fourdvt::studio
