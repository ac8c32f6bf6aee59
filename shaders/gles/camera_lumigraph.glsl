// Unstructured lumigraph weights (BBMGC01: Chris Buehler, Michael Bosse, Leonard McMillan, Steven Gortler, Michael
// Cohen: Unstructured Lumigraph Rendering. SIGGRAPH, 2001). A camera's penalty is the angle at the point between its
// ray and the view's; its weight (1 - angle / bound) / angle falls smoothly to 0 at the bound. BOUNDED: the bound is
// the angle of the farthest camera of this draw, independent of visibility, so that cameras enter and leave the choice
// with weight 0, and occlusion does not move the bound. Otherwise all cameras are in use and the bound is the opposite
// direction. In place of the paper's resolution penalty, a camera fades out towards the minimum cosine.
#define COMPARES_CAMERAS
#include "camera_shade.glsl"

const float kMinAngle = 1e-3;  // radians; keeps the weight finite in the view's direction
const float kMinShare = 1e-3;  // keeps a camera at the bound usable where no other sees the point
const float kFade = 0.3;         // range of cosine
const float kOpposite = 3.14159265;

float angle_bound;

float angleBetween(vec3 a, vec3 b) { return atan(length(cross(a, b)), dot(a, b)); }

void compareCameras(vec3 point, vec3 to_eye) {
#ifdef BOUNDED
  angle_bound = kMinAngle;
  for (int i = 0; i < CAMERAS; ++i)
    angle_bound = max(angle_bound, angleBetween(normalize(u_centres[i].xyz - point), to_eye));
#else
  angle_bound = kOpposite;
#endif
}

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) {
  float angle = max(angleBetween(to_camera, to_eye), kMinAngle);
  float resolution = smoothstep(u_least_cosine, u_least_cosine + kFade, cosine);
  return resolution * max(1.0 - angle / angle_bound, kMinShare) / angle;
}
