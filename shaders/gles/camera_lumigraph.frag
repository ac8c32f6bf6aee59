// SPDX-License-Identifier: Apache-2.0
// Unstructured lumigraph rendering (camera_lumigraph.glsl).
#include "camera_lumigraph.glsl"
