// SPDX-License-Identifier: Apache-2.0
// The step "motion" and its parts: blend, alignment and transitions of motion classes (Casas et al. 2014, 5-6).
#pragma once

#include "lab/study/motion/stage.h"
#include "lab/study/motion/truth.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

// Runs the step. Sequences without a class have no rows.
Result<Rows> runMotion(const StudyContext& context);

struct MotionSubject {
  const StudyContext& context;
  std::string folder;  // the baked character
  MotionStage& stage;
  const MotionTruth* truth = nullptr;  // null: none
  const package::Sequence& motion() const { return stage.motion(); }
  bool quick() const { return context.options.quick; }
  // Evenly spread phases of the class.
  std::vector<uint32_t> phases(size_t count) const;
  // The product's kAlign… methods among `wanted`, in the tables' order; kAlignBaked only if the stream is aligned.
  std::vector<AlignMethod> methods(const std::vector<AlignMethod>& wanted) const;
};

Result<Rows> measureBlend(const MotionSubject& subject);        // blend.cpp: mm and ms of the mesh blend
Result<Rows> measureFlow(const MotionSubject& subject);         // flow.cpp: against OpenCV, against truth
Result<Rows> measureAppearance(const MotionSubject& subject);   // appearance.cpp: Casas et al. 2014 Fig. 8, sharpness
Result<Rows> measureCost(const MotionSubject& subject);         // cost.cpp: ms a frame, characters
Result<Rows> measureTransitions(const MotionSubject& subject);  // transitions.cpp: with the real player
Result<Rows> measureSkate(const MotionSubject& subject);        // transitions.cpp
Result<Rows> drawMotionPictures(const MotionSubject& subject);  // pictures.cpp: Casas et al. 2014 Fig. 7-8

// Azimuths of a ring, between the cameras rather than on them.
std::vector<double> motionAzimuths_deg(size_t count);

}  // namespace fourdvt::study
