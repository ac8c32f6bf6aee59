// Unstructured lumigraph weights (BBMGC01): the penalty of a camera is the angle at the point between its
// ray and the view's, and its weight (1 - angle / bound) / angle falls smoothly to 0 where the angle reaches the bound.
// BOUNDED: the bound is the angle of the farthest camera of this draw, whether or not it sees the point, so that a camera
// that enters or leaves the choice has no weight then, and what hides a camera moves no bound. Else all cameras are in
// use, none enters or leaves, and the bound is the opposite direction.
// In place of the paper's penalty of resolution, a camera fades out towards the cosine at which it is not used any more.
#define COMPARES_CAMERAS
#include "camera_shade.glsl"

const float kLeastAngle = 1e-3;  // radians: a camera in the view's direction has a finite weight
const float kLeastShare = 1e-3;  // where only the camera at the bound sees the point, it is shown all the same
const float kFade = 0.3;         // of the cosine
const float kOpposite = 3.14159265;

float angle_bound;

float angleBetween(vec3 a, vec3 b) { return atan(length(cross(a, b)), dot(a, b)); }

void compareCameras(vec3 point, vec3 to_eye) {
#ifdef BOUNDED
  angle_bound = kLeastAngle;
  for (int i = 0; i < CAMERAS; ++i)
    angle_bound = max(angle_bound, angleBetween(normalize(u_centres[i].xyz - point), to_eye));
#else
  angle_bound = kOpposite;
#endif
}

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) {
  float angle = max(angleBetween(to_camera, to_eye), kLeastAngle);
  float resolution = smoothstep(u_least_cosine, u_least_cosine + kFade, cosine);
  return resolution * max(1.0 - angle / angle_bound, kLeastShare) / angle;
}
