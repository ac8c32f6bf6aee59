// SPDX-License-Identifier: Apache-2.0
// Comparisons of layered characters as steps of a study, with their defining files. Steps may read earlier steps' files
// in StudyContext::work().
#pragma once

#include "lab/study/run/context.h"

namespace fourdvt::study {

Result<Rows> runReference(
    const StudyContext& context);                      // reference.cpp: FVVR's pictures of the ring, masked multi-view
Result<Rows> runFvvr(const StudyContext& context);     // fvvr.cpp: FVVR and its options at the held-out cameras
Result<Rows> runMethods(const StudyContext& context);  // methods.cpp: Casas et al. 2014 Table 1, held-out truth
Result<Rows> runLabels(const StudyContext& context);   // labels.h: the joint labelling without its parts
Result<Rows> runLayers(
    const StudyContext& context);  // layers.cpp: Volino and Hilton 2013 Fig. 5-7, Table 1; Casas et al. Fig. 9
Result<Rows> runLayerVideos(const StudyContext& context);  // layers.cpp, as videos
Result<Rows> runRate(const StudyContext& context);         // rate.cpp: rate-distortion of one to three layers
Result<Rows> runCodecs(const StudyContext& context);       // rate.cpp: codecs, presets, layouts, sizes
Result<Rows> runSpeed(const StudyContext& context);        // speed.cpp: Volino and Hilton 2013, 4.4; time per pass
Result<Rows> runPictures(const StudyContext& context);     // pictures.cpp: layers with camera maps, grazing views

}  // namespace fourdvt::study
