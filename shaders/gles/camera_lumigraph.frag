// SPDX-License-Identifier: Apache-2.0
// Unstructured lumigraph rendering (BBMGC01), by the angular penalty alone.
#include "camera_lumigraph.glsl"
