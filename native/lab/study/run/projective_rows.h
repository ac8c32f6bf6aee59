// SPDX-License-Identifier: Apache-2.0
// Vocabulary of projective.csv, shared by the steps of `fourdvt-lab methods` and its report. Columns and settings are
// those of evaluate.csv (rows.h). M4D is Montage4D (Du et al. 2019), FT Floating Textures (Eisemann et al. 2008); full
// citations are in projective_study.h.
//
// A condition is everything but the method: an axis and the place on it. Axes change one thing at a time from the base,
// which is the capture's own surface, its own calibration and kClosest cameras.
//
// table       method          setting                       quantities
// ----------  --------------  ----------------------------  -----------------------------------------------------------
// condition   one of methods  axis=A at=PLACE proxy=P       means over the held-out views of the measured frames:
//                             closest=M views=N             kPsnrFgDb, kSsimFg, kPsnrCommonDb, kRmse, kGradientRatio,
//                                                           kShiftTolerantDb; of a run of consecutive frames at an
//                                                           omitted input camera: kFlickerLevels (with meshes
//                                                           of constant topology), kFrameS (median: all that a new
//                                                           frame needs, read-back included), kRatioToFvvr, kViewS
//                                                           (axis proxy: of another view of the same frame)
// view        likewise        axis= at= view=CAM frame=F    kPsnrFgDb, kSsimFg of one view
// cross       likewise        proxy=P own=0|1               M4D Table 2: means at the input cameras; own=1: with the
//                                                           camera's own picture among those that are drawn from, as
//                                                           the paper can be read. kRmse, kPsnrFgDb, kSsimFg
// stage       likewise        proxy=P pass=LABEL (last)     M4D Table 3: kFrameMs of one pass, or "upload"
// pictures    method, empty   file=NAME.jpg [axis= at=]     any; the quantity is a caption key (kPicture…)
// tried       candidates      as condition                  what the bake chooses by, at input cameras that are left
//                                                           out: kBlendedDb, kBlendedSsim, kPsnrFgDb, kSsimFg,
//                                                           kStatedCost; kTaken: the one that it takes; without a
//                                                           method: kShiftPx
// choice      one of methods  proxy=P                       kTaken: this one is to be taken (tables/projective.h)
//                             proxy=P text=WHY              kRefused: against which rule it is
// promise     empty           text=CLAIM: MEASURED; WHY     the papers' promises: kHolds, kFails, kNotMeasured
// about       empty           text=…                        facts, as in evaluate.csv
//
// Rows of choice and promise follow from the others.
#pragma once

#include "lab/study/run/rows.h"

namespace fourdvt::study::rows {

inline constexpr const char* kCondition = "condition";
inline constexpr const char* kConditionView = "view";
inline constexpr const char* kCross = "cross";
inline constexpr const char* kStage = "stage";
inline constexpr const char* kTried = "tried";
inline constexpr const char* kChoice = "choice";
inline constexpr const char* kPromise = "promise";

// Axes.
inline constexpr const char* kAxisProxy = "proxy";              // at: the proxy's name
inline constexpr const char* kAxisCameras = "cameras";          // at: M
inline constexpr const char* kAxisRotation = "rotation";        // at: σ in degrees
inline constexpr const char* kAxisTranslation = "translation";  // at: σ in mm
inline constexpr const char* kAxisFocal = "focal";              // at: σ in percent
inline constexpr const char* kAxisGain = "gain";                // at: σ in percent
inline constexpr const char* kAxisStandoff = "standoff";        // at: largest distance from the given mesh, mm
inline constexpr const char* kAxisMixed = "mixed";              // at: 1

// Proxies: the base, and the surfaces made from pictures alone.
inline constexpr const char* kProxyGiven = "given";
inline constexpr const char* kProxyHull = "hull";
inline constexpr const char* kProxyRefined = "refined";
inline constexpr const char* kProxyPlane = "plane";

inline constexpr int kClosest = 4;  // cameras per picture at the base

// Methods of the axes and the goals; conditions.h has all.
inline constexpr const char* kMethodLinear = "linear";
inline constexpr const char* kMethodFloating = "floating";
inline constexpr const char* kMethodFloatingPairs = "floating-pairs";
inline constexpr const char* kMethodFloatingStatic = "floating-static";
inline constexpr const char* kMethodHoloportation = "holoportation";
inline constexpr const char* kMethodMontage = "montage4d";
inline constexpr const char* kMethodSweep = "sweep";

inline constexpr const char* kRmse = "rmse";
inline constexpr const char* kShiftTolerantDb = "shift_tolerant_db";
inline constexpr const char* kFlickerLevels = "flicker_levels";
inline constexpr const char* kFrameS = "frame_s";
inline constexpr const char* kViewS = "view_s";
inline constexpr const char* kBlendedDb = "blended_psnr_db";
inline constexpr const char* kOwnDb = "own_psnr_db";
inline constexpr const char* kBlendedSsim = "blended_ssim";
inline constexpr const char* kStatedCost = "stated_cost";
inline constexpr const char* kShiftPx = "shift_px";
inline constexpr const char* kTaken = "taken";
inline constexpr const char* kRefused = "refused";
inline constexpr const char* kHolds = "holds";
inline constexpr const char* kFails = "fails";
inline constexpr const char* kNotMeasured = "not measured";

inline constexpr const char* kPictureMethods = "methods_sheet";  // FT Fig. 8; axis= at= view= frame=
inline constexpr const char* kPictureCloseUps = "methods_close_ups";
inline constexpr const char* kPictureCross = "methods_cross";  // view=
inline constexpr const char* kPictureWorstViews = "methods_worst";

}  // namespace fourdvt::study::rows
