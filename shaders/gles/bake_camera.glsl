// One capture camera: its picture (premultiplied, alpha = matte) and the depth map of the mesh seen from it.
uniform mat4 cam_from_world;
uniform vec4 intrinsics;      // fx, fy, cx, cy in pixels
uniform vec4 size_near_far;   // pixels, pixels, metres, metres
uniform float depth_bias;     // metres
uniform float min_cosine;   // cosine of face normal and camera ray
uniform sampler2D picture;
uniform sampler2D depth_map;  // drawn y up: GL row 0 is the picture's bottom row

// Depth along the optical axis in metres; the far plane where nothing was drawn.
float mappedDepth(vec2 pixel) {
  ivec2 size = ivec2(size_near_far.xy);
  ivec2 at = clamp(ivec2(floor(pixel)), ivec2(0), size - 1);
  float z = 2.0 * texelFetch(depth_map, ivec2(at.x, size.y - 1 - at.y), 0).r - 1.0;
  float near = size_near_far.z, far = size_near_far.w;
  return 2.0 * near * far / (far + near - z * (far - near));
}

vec2 pixelOf(vec3 point_in_cam) { return intrinsics.xy * point_in_cam.xy / point_in_cam.z + intrinsics.zw; }

// True if the surface point faces the camera above a grazing angle, lies inside its picture (one pixel of margin) and
// is not behind the depth map. The bias grows with the depth that one pixel spans on this slope.
bool isSeen(vec3 point_in_cam, vec3 normal_in_cam, vec2 pixel, out float bias) {
  float cosine = -dot(normal_in_cam, normalize(point_in_cam));
  float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, max(min_cosine, 0.05));
  bias = depth_bias + slope * point_in_cam.z / intrinsics.x;
  bool inside = all(greaterThan(pixel, vec2(1.0))) && all(lessThan(pixel, size_near_far.xy - 1.0));
  return cosine > min_cosine && point_in_cam.z > size_near_far.z && inside && point_in_cam.z <= mappedDepth(pixel) + bias;
}
