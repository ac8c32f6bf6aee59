// SPDX-License-Identifier: Apache-2.0
// The comparisons of layered characters, as steps of a study; each is defined in the file that its comment names. They
// may use what earlier steps left in StudyContext::work().
#pragma once

#include "lab/study/run/context.h"

namespace fourdvt::study {

Result<Rows> runReference(
    const StudyContext& context);                      // reference.cpp: FVVR's pictures of the ring, masked multi-view
Result<Rows> runMethods(const StudyContext& context);  // methods.cpp: 4DVT Table 1, held-out truth
Result<Rows> runLabels(const StudyContext& context);   // labels.h: the joint labelling without its parts
Result<Rows> runLayers(const StudyContext& context);   // layers.cpp: LVDT Fig. 5-7, Table 1; 4DVT Fig. 9
Result<Rows> runLayerVideos(const StudyContext& context);  // the same as videos
Result<Rows> runRate(const StudyContext& context);         // rate.cpp: rate-distortion of one to three layers
Result<Rows> runCodecs(const StudyContext& context);       // the same of codecs, presets, layouts, sizes
Result<Rows> runSpeed(const StudyContext& context);        // speed.cpp: LVDT 4.4, the time of every pass
Result<Rows> runPictures(const StudyContext& context);     // pictures.cpp: layers with camera maps, grazing views

}  // namespace fourdvt::study
