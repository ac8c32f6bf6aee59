// SPDX-License-Identifier: Apache-2.0
// Vocabulary of evaluate.csv, shared by the steps and the report. A missing row removes its part of the report; rows
// not listed here stay in the CSV only. LVDT is Volino and Hilton 2013, 4DVT Casas et al. 2014; full citations are in
// study.h.
//
// `setting` is "key=value key=value"; keys in any order. `sequence` is empty for a row over all sequences. Percentages
// are 0..100 with unit "percent", rates are bits (not bytes) per second with unit "bit/s", times "s" or "ms".
//
// table         method            setting                          quantities
// ------------  ----------------  -------------------------------  ---------------------------------------------------
// table1        fvvr, naive,      layers=3 size=512 codec=h264     kLoadingS, kTotalBytes (all that is loaded),
//               spatial,          crf=23                           kVideoBytes, kGeometryBytes, kLabelBytes,
//               temporal-paper,   (fvvr: any)                      kOtherBytes (manifest, index, base mesh),
//               per-texel, joint                                   kVideoBps, kLoadingAllS; kPercentOfMasked
//                                                                  (kTotalBytes against the foreground-only
//                                                                  multi-view); against FVVR: kSsimFg, kSsimFull,
//                                                                  kPsnrFgDb, kPsnrFullDb; kPercentAt…, kBeyondAt….
//                                                                  fvvr: loading, kTotalBytes (masked PNG multi-view)
//               joint-default     as baked by default              as above: the product's own settings
// multiview     multiview         cameras=8 frames=28              LVDT Table 1: kRawBytes, kCompressedBytes (PNG),
//                                                                  kMaskedBytes (PNG, background masked)
// multiview-    h264              crf=23                           foreground-only multi-view as one video per camera:
// codec                                                            kVideoBytes, kPsnrFgDb (the cameras' pictures);
//                                                                  kHeldOutPsnrDb, kHeldOutSsim: FVVR from the decoded
//                                                                  videos against the held-out cameras (its mattes
//                                                                  and meshes cost it nothing); kTunedPsnrDb,
//                                                                  kTunedSsim: the same at its best
// layers        joint             layers=L size=S                  LVDT Fig. 5: kSsimFg, kSsimFull, kPsnrFgDb;
//                                                                  Fig. 7: kImageBytes (layers as PNG, a frame),
//                                                                  kVideoBytes (sequence), kVideoBps, kGpuBytes;
//               naive             layers=L size=S                  the same, where measured (the papers' own labels)
//               fvvr              any                              kMaskedBytes (PNG, a frame, all cameras),
//                                                                  kGpuBytes
// speed         layered, fvvr     layers=3 size=512 [closest=M]    kFramesPerS, kFrameMs. closest: FVVR from the M
//                                                                  cameras nearest to the view; without it: from all
//               layered           [closest=M]                      kRatioToFvvr: frame rate against FVVR's with M
//                                                                  cameras; kDrawRatioToFvvr: draws only
//               layered, fvvr     [closest=M] pass=<name> (last)   kFrameMs of one pass ("shadow cast", "layered",
//                                                                  "depth maps", "upload" …)
// labels        as table1         layer=1.. (1-based)              kSeamPercent, kFlipPercent: over all faces;
//                                                                  kSeenSeamPercent, kSeenFlipPercent, kMeanPenalty:
//                                                                  over faces that a camera sees
//                                 empty                            kEnergy (joint formulation), kEmptyPercent,
//                                                                  kLabelMsFrame, kLabelBps
//               joint             solve=global|windowed            kEnergy of both solves of one sequence, where
//                                                                  measured
// label-parts   naive, spatial,   layer=1..                        as labels: modes, and joint without its liberties
//               temporal-paper,                                    (joint-no-unseen: faces that no camera sees stay
//               joint, joint-no-                                   empty; joint-no-partial: no cameras that see a face
//               unseen, …                                          in part; joint-neither), labelled from the same
//                                                                  costs of one sequence's first frames
// held-out      fvvr, fvvr-tuned, views=N                          against held-out cameras: kPsnrFgDb, kSsimFg,
//               fvvr-closest,     (joint-default as baked)         kPsnrCommonDb (common part of the silhouettes),
//               naive …, joint-                                    kPsnrSeenDb, kSsimSeen, kPsnrFullDb, kSsimFull
//               default
// held-out-     as held-out       view=CAMERA frame=N              the same, view by view, for paired differences
// views
// tuning        fvvr              closest=M facing=P view=P        as held-out, on the first sequence: FVVR by its
//                                 cosine=X filter=F unseen=U       options (render::FvvrOptions)
// rate          codec name        preset=medium crf=23 size=1024   one point per setting: kVideoBps, kSsimFg,
//               (h264, vp9, av1)  layers=3 layout=default          kPsnrFgDb, kEncodeMsFrame. layout: "default"
//                                 (or layout=equal)                (layer 1 large) or "equal". A curve: same method,
//                                                                  preset, size, layers and layout; crf varies
//               h264              chosen=1 preset=… crf=…          kVideoBps, kSsimFg: the default, the measured knee
// bake          joint-default     stage=<name>                     kSecondsFrame by stage
//                                 empty                            kSecondsFrame of the whole bake, kPeakRssBytes
// seams         as table1         view=grazing|mid                 kSeamContrast along chart seams and kSeamControl
//                                                                  beside them, levels of 255 (seam_contrast.h);
//                                                                  kFringePercent of the silhouette's pixels
// pictures      method or empty   file=NAME.jpg [layers= size=     value: any; quantity is a caption key below
//                                 frame= view= score= width=       (kPicture…)
//                                 height=]
// motion-blend  linear, hybrid,   references=R [baked=1]           against the non-linear blend: kErrorMaxMm,
//               nonlinear                                          kErrorRmsMm; kBlendMs a frame, kRatioToNonlinear
// motion-flow   flow-gpu,         against=opencv|truth size=S      kDifferenceMeanPx, kDifferenceTailPx (95 %), to the
//               flow-dis,                                          truth also kDifferenceMeanMm, …TailMm; against=none
//               opencv-dis, …                                      (flow-opencv): the size of the flow itself
// motion-       none, baked,      w=W mesh=blend|truth             against the studio's truth: kPsnrFgDb, kSsimFg.
// appearance    baked-mean,       region=common|whole              mesh: drawn on; common: both silhouettes only
//               flow-gpu, flow-   (method empty: w=W)              kMeshMeanMm/Tail: blended mesh to the true one
//               gpu-detail, flow-opencv
// motion-       likewise          w=W                              kGradientRatio, kGradientRatioLeast, kDetailRatio
// sharpness                                                        against the members' own looks
// motion-cost   likewise,         size=WxH [characters=N]          kFrameMs, kRatioToNone; baked: kCharactersPerFlow:
//               flow-dis                                           as many take as long as one by flow-gpu
// motion-       empty             from=A to=B                      kLatencyMeanS, kLatencyMaxS, kFitMeanMm, kFitMaxMm
// transitions                                                      (planned from all frames); as played:
//                                                                  kLatencyPlayedMeanS, kLatencyPlayedS (the
//                                                                  longest), kStepMm, kOwnStepMm, kChangeLevels,
//                                                                  kOwnChangeLevels (largest of both)
// motion-skate  empty             at=PARAMETER (class)             kContacts, kSkateMeanMm, kSkateTailMm, kSkateMaxMm
// trends        empty             empty                            written by no step: the report judges them
// about         empty             value in setting: text=…         kAbout…: quantity names the fact, the rest of the
//               (rest of line)                                     setting after "text=" is its text, spaces allowed
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "lab/study/run/context.h"

namespace fourdvt::study::rows {

// Tables.
inline constexpr const char* kTable1 = "table1";
inline constexpr const char* kMultiview = "multiview";
inline constexpr const char* kMultiviewCodec = "multiview-codec";
inline constexpr const char* kLayers = "layers";
inline constexpr const char* kSpeed = "speed";
inline constexpr const char* kLabels = "labels";
inline constexpr const char* kLabelParts = "label-parts";
inline constexpr const char* kHeldOut = "held-out";
inline constexpr const char* kHeldOutViews = "held-out-views";
inline constexpr const char* kTuning = "tuning";
inline constexpr const char* kRate = "rate";
inline constexpr const char* kBake = "bake";
inline constexpr const char* kSeams = "seams";
inline constexpr const char* kPictures = "pictures";
inline constexpr const char* kAbout = "about";
inline constexpr const char* kMotionBlend = "motion-blend";
inline constexpr const char* kMotionFlow = "motion-flow";
inline constexpr const char* kMotionAppearance = "motion-appearance";
inline constexpr const char* kMotionSharpness = "motion-sharpness";
inline constexpr const char* kMotionCost = "motion-cost";
inline constexpr const char* kMotionTransitions = "motion-transitions";
inline constexpr const char* kMotionSkate = "motion-skate";

// Names of methods; those of labellings are bake::Labelling::name.
inline constexpr const char* kFvvr = "fvvr";
inline constexpr const char* kFvvrGiven = "fvvr-as-given";   // on mesh and cameras before refinement
inline constexpr const char* kFvvrTuned = "fvvr-tuned";      // at its best: render::tunedFvvr
inline constexpr const char* kFvvrClosest = "fvvr-closest";  // from the kClosestCameras nearest to the view
inline constexpr int kClosestCameras = 3;                    // M: equal to the number of layers
inline constexpr const char* kNaive = "naive";
inline constexpr const char* kSpatial = "spatial";
inline constexpr const char* kTemporalPaper = "temporal-paper";
inline constexpr const char* kPerTexel = "per-texel";  // texels chosen per texel, weighted per face, unlike LVDT
inline constexpr const char* kJoint = "joint";
inline constexpr const char* kJointDefault = "joint-default";
inline constexpr const char* kJointNoUnseen = "joint-no-unseen";    // faces visible in no camera stay empty
inline constexpr const char* kJointNoPartial = "joint-no-partial";  // without cameras in which a face is partly visible
inline constexpr const char* kJointNeither = "joint-neither";
inline constexpr const char* kMethodMultiview = "multiview";
inline constexpr const char* kMethodLayered = "layered";
inline constexpr const char* kLinear = "linear";
inline constexpr const char* kHybrid = "hybrid";
inline constexpr const char* kNonlinear = "nonlinear";
inline constexpr const char* kAlignNone = "none";
inline constexpr const char* kAlignBaked = "baked";
inline constexpr const char* kAlignBakedMean = "baked-mean";      // without restored contrast
inline constexpr const char* kFlowGpu = "flow-gpu";               // Farneback
inline constexpr const char* kFlowGpuDetail = "flow-gpu-detail";  // with restored contrast in the picture; study only
inline constexpr const char* kFlowDis = "flow-dis";
inline constexpr const char* kFlowOpencv = "flow-opencv";  // Farneback
inline constexpr const char* kOpencvDis = "opencv-dis";

// Quantities.
inline constexpr const char* kLoadingS = "loading_s";  // from start to the first picture
inline constexpr const char* kLoadingAllS =
    "loading_all_s";  // the whole sequence decoded and uploaded, as in the papers
inline constexpr const char* kTotalBytes = "total_bytes";
inline constexpr const char* kVideoBytes = "video_bytes";
inline constexpr const char* kGeometryBytes = "geometry_bytes";
inline constexpr const char* kLabelBytes = "label_bytes";
inline constexpr const char* kOtherBytes = "other_bytes";
inline constexpr const char* kVideoBps = "video_bps";
inline constexpr const char* kLabelBps = "label_bps";
inline constexpr const char* kPercentOfMasked = "percent_of_masked";
inline constexpr const char* kPercentAtPsnr = "percent_at_equal_held_out_psnr";
inline constexpr const char* kPercentAtSsim = "percent_at_equal_held_out_ssim";
inline constexpr const char* kBeyondAtPsnr = "beyond_range_at_held_out_psnr";
inline constexpr const char* kBeyondAtSsim = "beyond_range_at_held_out_ssim";
inline constexpr const char* kPercentAtTunedPsnr = "percent_at_equal_tuned_psnr";
inline constexpr const char* kPercentAtTunedSsim = "percent_at_equal_tuned_ssim";
inline constexpr const char* kBeyondAtTunedPsnr = "beyond_range_at_tuned_psnr";
inline constexpr const char* kBeyondAtTunedSsim = "beyond_range_at_tuned_ssim";
inline constexpr const char* kHeldOutPsnrDb = "held_out_psnr_fg_db";
inline constexpr const char* kHeldOutSsim = "held_out_ssim_fg";
inline constexpr const char* kTunedPsnrDb = "tuned_psnr_fg_db";  // kHeldOutPsnrDb by FVVR at its best
inline constexpr const char* kTunedSsim = "tuned_ssim_fg";
inline constexpr const char* kSsimFg = "ssim_fg";
inline constexpr const char* kSsimFull = "ssim_full";
inline constexpr const char* kPsnrFgDb = "psnr_fg_db";
inline constexpr const char* kPsnrFgSeDb = "psnr_fg_se_db";  // standard error of the mean over views
inline constexpr const char* kSsimFgSe = "ssim_fg_se";
inline constexpr const char* kPsnrFullDb = "psnr_full_db";
inline constexpr const char* kPsnrCommonDb = "psnr_common_db";
inline constexpr const char* kPsnrSeenDb = "psnr_seen_db";  // over pixels that an input camera sees
inline constexpr const char* kSsimSeen = "ssim_seen";
inline constexpr const char* kRawBytes = "raw_bytes";
inline constexpr const char* kCompressedBytes = "compressed_bytes";
inline constexpr const char* kMaskedBytes = "masked_bytes";
inline constexpr const char* kImageBytes = "image_bytes_frame";
inline constexpr const char* kGpuBytes = "gpu_bytes";
inline constexpr const char* kFramesPerS = "frames_per_s";
inline constexpr const char* kFrameMs = "frame_ms";
inline constexpr const char* kRatioToFvvr = "ratio_to_fvvr";
inline constexpr const char* kDrawRatioToFvvr = "draw_ratio_to_fvvr";  // depth maps and shading; no upload, no geometry
inline constexpr const char* kSeamPercent = "seam_percent";
inline constexpr const char* kFlipPercent = "flip_percent";
inline constexpr const char* kSeenSeamPercent = "seen_seam_percent";  // over faces visible in a camera
inline constexpr const char* kSeenFlipPercent = "seen_flip_percent";
inline constexpr const char* kMeanPenalty = "mean_penalty";
inline constexpr const char* kEnergy = "energy";
inline constexpr const char* kEmptyPercent = "empty_percent";
inline constexpr const char* kLabelMsFrame = "label_ms_frame";
inline constexpr const char* kEncodeMsFrame = "encode_ms_frame";
inline constexpr const char* kSecondsFrame = "seconds_frame";
inline constexpr const char* kPeakRssBytes = "peak_rss_bytes";
inline constexpr const char* kSeamContrast = "seam_contrast";
inline constexpr const char* kSeamControl = "seam_control";
inline constexpr const char* kFringePercent = "fringe_percent";
inline constexpr const char* kErrorMaxMm = "error_max_mm";
inline constexpr const char* kErrorRmsMm = "error_rms_mm";
inline constexpr const char* kMeshMeanMm = "mesh_mean_mm";
inline constexpr const char* kMeshTailMm = "mesh_tail_mm";
inline constexpr const char* kBlendMs = "blend_ms";
inline constexpr const char* kRatioToNonlinear = "ratio_to_nonlinear";
inline constexpr const char* kDifferenceMeanPx = "difference_mean_px";
inline constexpr const char* kDifferenceTailPx = "difference_tail_px";
inline constexpr const char* kDifferenceMeanMm = "difference_mean_mm";
inline constexpr const char* kDifferenceTailMm = "difference_tail_mm";
inline constexpr const char* kGradientRatio = "gradient_ratio";
inline constexpr const char* kGradientRatioLeast = "gradient_ratio_least";
inline constexpr const char* kDetailRatio = "detail_ratio";
inline constexpr const char* kRatioToNone = "ratio_to_none";
inline constexpr const char* kCharactersPerFlow = "characters_per_flow";
inline constexpr const char* kLatencyMeanS = "latency_mean_s";
inline constexpr const char* kLatencyMaxS = "latency_max_s";
inline constexpr const char* kLatencyPlayedMeanS = "latency_played_mean_s";
inline constexpr const char* kLatencyPlayedS = "latency_played_s";
inline constexpr const char* kFitMeanMm = "fit_mean_mm";
inline constexpr const char* kFitMaxMm = "fit_max_mm";
inline constexpr const char* kStepMm = "step_mm";
inline constexpr const char* kOwnStepMm = "own_step_mm";
inline constexpr const char* kChangeLevels = "change_levels";
inline constexpr const char* kOwnChangeLevels = "own_change_levels";
inline constexpr const char* kContacts = "contacts";
inline constexpr const char* kSkateMeanMm = "skate_mean_mm";
inline constexpr const char* kSkateTailMm = "skate_tail_mm";
inline constexpr const char* kSkateMaxMm = "skate_max_mm";

// Pictures: caption keys.
inline constexpr const char* kPictureLayers = "layers_sheet";    // with camera maps (LVDT Fig. 3-4, 4DVT Fig. 4-5)
inline constexpr const char* kPictureChanges = "label_changes";  // camera maps of three frames, changes marked
inline constexpr const char* kPictureErrorMap = "error_map";     // reference, ours, difference; layers= size=
inline constexpr const char* kPictureGrazing = "grazing";        // grazing view with crops; view=
inline constexpr const char* kPictureWorst = "worst_held_out";   // truth, ours, FVVR, differences; frame= view=
inline constexpr const char* kPictureMotionColumns = "motion_columns";  // w = 0 … 1, one row per method; frame= view=
inline constexpr const char* kPictureMotionCrops = "motion_crops";      // half way, one row per method; frame= view=
inline constexpr const char* kPictureTransition = "motion_transition";  // tick by tick; from= to=

// Facts (table "about"): any quantity name is printed verbatim; these come first.
inline constexpr const char* kAboutCommand = "command";
inline constexpr const char* kAboutDevice = "device";    // GL renderer
inline constexpr const char* kAboutEncoder = "encoder";  // library and version

// Unit of a quantity, by its name: "dB" for psnr_fg_db, "" for ssim_fg.
const char* unitOf(const std::string& quantity);

// True for keys whose value extends to the end of the setting, as it may contain spaces.
inline bool isLastKey(const std::string& key) { return key == "text" || key == "pass" || key == "stage"; }

// Value of `key` in a setting; empty if absent.
inline std::string settingText(const std::string& setting, const std::string& key) {
  const std::string padded = " " + setting + " ", wanted = " " + key + "=";
  const size_t at = padded.find(wanted);
  if (at == std::string::npos) return {};
  const size_t start = at + wanted.size();
  if (isLastKey(key)) return setting.substr(start - 1);
  return padded.substr(start, padded.find(' ', start) - start);
}
// Value of `key` as a number; NaN if absent.
inline double settingNumber(const std::string& setting, const std::string& key) {
  const std::string text = settingText(setting, key);
  return text.empty() ? std::numeric_limits<double>::quiet_NaN() : std::strtod(text.c_str(), nullptr);
}

}  // namespace fourdvt::study::rows
