// SPDX-License-Identifier: Apache-2.0
// Unstructured lumigraph rendering (BBMGC01).
#include "camera_lumigraph.glsl"
