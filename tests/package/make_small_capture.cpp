// SPDX-License-Identifier: Apache-2.0
// make_small_capture FOLDER [FRAMES] [RIG]: writes a capture that bakes in seconds. A turning textured box, four
// cameras of 160 × 160 pixels, PNG frames and mattes ray-traced analytically (3 × 3 samples), OBJ meshes, one held-out
// camera. RIG: shifted: lenses whose optical axes miss the pictures; mixed: one camera lies on its side, one has twice
// the pixels, two pictures are cropped.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "../unit/lens_shift.h"
#include "base/camera.h"
#include "platform/files.h"

namespace {

using namespace fourdvt;
namespace fs = std::filesystem;

constexpr int kSide = 160, kSamples = 3, kDivisions = 6;
const glm::dvec3 kHalf{0.3, 0.6, 0.2};
const glm::dvec3 kCentre{0, 0.65, 0};
const glm::u8vec3 kBackdrop{0, 177, 64};

glm::dmat3 worldFromBox(int frame) {
  const double a = frame * 6 * 3.14159265358979323846 / 180;
  return {{std::cos(a), 0, -std::sin(a)}, {0, 1, 0}, {std::sin(a), 0, std::cos(a)}};
}

// Colour of the box's side 0..5 = -x +x -y +y -z +z; u, v in 0..1 over the side.
glm::dvec3 colourAt(int side, double u, double v) {
  const bool check = (static_cast<int>(u * 4) + static_cast<int>(v * 8)) % 2;
  const glm::dvec3 base[] = {{200, 70, 60},  {70, 110, 200}, {120, 120, 120},
                             {230, 200, 80}, {150, 80, 170}, {235, 235, 230}};
  return base[side] * (check ? 1.0 : 0.55) * (0.7 + 0.3 * v);
}

struct Axes {
  int normal, across, up;
};
Axes axesOf(int side) { return {side / 2, (side / 2 + 1) % 3, (side / 2 + 2) % 3}; }

// Returns true and the colour if the ray, in the box's frame, hits the box.
bool trace(const glm::dvec3& origin, const glm::dvec3& ray, glm::dvec3& colour) {
  double nearest = -std::numeric_limits<double>::infinity(), farthest = -nearest;
  int side = 0;
  for (int k = 0; k < 3; ++k) {
    double a = (-kHalf[k] - origin[k]) / ray[k], b = (kHalf[k] - origin[k]) / ray[k];
    const int entry = a < b ? 2 * k : 2 * k + 1;
    if (a > b) std::swap(a, b);
    if (a > nearest) nearest = a, side = entry;
    farthest = std::min(farthest, b);
  }
  if (nearest > farthest || nearest < 0) return false;
  const glm::dvec3 p = origin + nearest * ray;
  const Axes axes = axesOf(side);
  colour = colourAt(side, std::clamp(p[axes.across] / kHalf[axes.across] / 2 + 0.5, 0.0, 0.9999),
                    std::clamp(p[axes.up] / kHalf[axes.up] / 2 + 0.5, 0.0, 0.9999));
  return true;
}

// Picture as straight-alpha RGBA, 3 × 3 samples per pixel.
Image photograph(const PinholeCamera& camera, int frame) {
  const glm::dmat3 box_from_world = glm::transpose(worldFromBox(frame));
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  const glm::dvec3 origin = box_from_world * (camera.centreInWorld() - kCentre);
  Image out(camera.width, camera.height, 4);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec3 sum(0), colour;
      int hits = 0;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const double px = x + (s % kSamples + 0.5) / kSamples, py = y + (s / kSamples + 0.5) / kSamples;
        const glm::dvec3 ray((px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy, 1);
        if (trace(origin, box_from_world * world_from_cam * ray, colour)) sum += colour, ++hits;
      }
      if (!hits) continue;
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = static_cast<uint8_t>(sum[c] / hits + 0.5);
      out.at(x, y)[3] = static_cast<uint8_t>(255.0 * hits / (kSamples * kSamples) + 0.5);
    }
  return out;
}

void check(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "make_small_capture: %s\n", status.error().message.c_str());
  std::exit(1);
}

std::string numbered(const std::string& folder, int frame, const char* format) {
  char name[32];
  std::snprintf(name, sizeof name, format, frame);
  return folder + "/" + name;
}

void writePictures(const std::string& folder, const PinholeCamera& camera, int frame) {
  const Image rgba = photograph(camera, frame);
  Image colour(camera.width, camera.height, 3), matte(camera.width, camera.height, 1);
  for (int i = 0; i < camera.width * camera.height; ++i) {
    const int a = rgba.pixels[4 * i + 3];
    for (int c = 0; c < 3; ++c)
      colour.pixels[3 * i + c] =
          static_cast<uint8_t>((rgba.pixels[4 * i + c] * a + kBackdrop[c] * (255 - a) + 127) / 255);
    matte.pixels[i] = static_cast<uint8_t>(a);
  }
  check(platform::writeImage(numbered(folder + "/" + camera.name, frame, "%06d.png"), colour));
  check(platform::writeImage(numbered(folder + "/mask" + camera.name.substr(3), frame, "%06d.png"), matte));
}

// Writes each side as a grid of kDivisions² squares with its own chart; corners of neighbouring sides coincide in
// position, but are separate vertices.
void writeMesh(const std::string& path, int frame) {
  std::ofstream out(path);
  const glm::dmat3 rotation = worldFromBox(frame);
  const int n = kDivisions + 1;
  for (int side = 0; side < 6; ++side) {
    const Axes axes = axesOf(side);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double u = double(i) / kDivisions, v = double(j) / kDivisions;
        glm::dvec3 p(0);
        p[axes.normal] = side % 2 ? kHalf[axes.normal] : -kHalf[axes.normal];
        p[axes.across] = (2 * u - 1) * kHalf[axes.across];
        p[axes.up] = (2 * v - 1) * kHalf[axes.up];
        p = rotation * p + kCentre;
        out << "v " << p.x << " " << p.y << " " << p.z << "\nvt " << (side % 3 + 0.06 + 0.88 * u) / 3 << " "
            << (side / 3 + 0.06 + 0.88 * v) / 2 << "\n";
      }
  }
  for (int side = 0; side < 6; ++side)
    for (int j = 0; j < kDivisions; ++j)
      for (int i = 0; i < kDivisions; ++i) {
        int q[4] = {side * n * n + j * n + i + 1, 0, 0, 0};
        q[1] = q[0] + 1, q[2] = q[1] + n, q[3] = q[0] + n;
        if (side % 2 == 0) std::swap(q[1], q[3]);
        for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
          out << "f";
          for (int k : t) out << " " << q[k] << "/" << q[k];
          out << "\n";
        }
      }
}

PinholeCamera ringCamera(const std::string& name, double azimuth_deg, double elevation_deg) {
  PinholeCamera camera = cameraFromOrbit({azimuth_deg, elevation_deg, 4, kCentre, 24}, kSide, kSide);
  camera.name = name;
  return camera;
}

void writeCameras(const std::string& folder, const std::vector<PinholeCamera>& cameras) {
  fs::create_directories(folder);
  std::ofstream models(folder + "/cameras.txt"), images(folder + "/images.txt");
  models.precision(12);
  images.precision(12);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const PinholeCamera& c = cameras[i];
    const glm::dquat q = glm::quat_cast(glm::dmat3(c.cam_from_world));
    models << i + 1 << " PINHOLE " << c.width << " " << c.height << " " << c.fx << " " << c.fy << " " << c.cx << " "
           << c.cy << "\n";
    images << i + 1 << " " << q.w << " " << q.x << " " << q.y << " " << q.z << " " << c.cam_from_world[3].x << " "
           << c.cam_from_world[3].y << " " << c.cam_from_world[3].z << " " << i + 1 << " " << c.name << "\n\n";
  }
}

// Shifts the lens; the box stays in the middle of the picture at the same size.
PinholeCamera shifted(PinholeCamera camera) {
  const double angle = glm::radians(35.0), cosine = std::cos(angle);
  camera.fx *= cosine * cosine;
  camera.fy *= cosine;
  return testing::withShiftedLens(camera, angle);
}

void mixRig(std::vector<PinholeCamera>& cameras) {
  cameras[0].cam_from_world =
      glm::rotate(glm::dmat4(1), glm::radians(90.0), glm::dvec3(0, 0, 1)) * cameras[0].cam_from_world;
  cameras[0].width = 224, cameras[0].height = 128;
  cameras[0].cx = 112, cameras[0].cy = 64;
  cameras[1].width = cameras[1].height = 2 * kSide;
  for (double* length : {&cameras[1].fx, &cameras[1].fy, &cameras[1].cx, &cameras[1].cy}) *length *= 2;
  for (const size_t c : {0, 2}) cameras[c].width -= 40, cameras[c].cx -= 30;  // 30 columns at the left, 10 at the right
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) return std::fprintf(stderr, "usage: make_small_capture FOLDER [FRAMES] [RIG]\n"), 2;
  const std::string root = argv[1], sequence = root + "/turn";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 6;
  std::vector<PinholeCamera> cameras, test{ringCamera("test00", 45, 10)};
  for (int c = 0; c < 4; ++c) cameras.push_back(ringCamera("cam0" + std::to_string(c), 20 + 90 * c, c % 2 ? 35 : -5));
  const std::string rig = argc > 3 ? argv[3] : "";
  if (rig == "shifted") std::transform(cameras.begin(), cameras.end(), cameras.begin(), shifted);
  if (rig == "mixed") mixRig(cameras);
  writeCameras(root + "/cameras", cameras);
  writeCameras(root + "/cameras_test", test);
  fs::create_directories(sequence + "/mesh");
  fs::create_directories(sequence + "/test00");
  for (const PinholeCamera& camera : cameras) {
    fs::create_directories(sequence + "/" + camera.name);
    fs::create_directories(sequence + "/mask" + camera.name.substr(3));
  }
  for (int f = 0; f < frames; ++f) {
    for (const PinholeCamera& camera : cameras) writePictures(sequence, camera, f);
    writeMesh(numbered(sequence + "/mesh", f, "%06d.obj"), f);
  }
  check(platform::writeImage(sequence + "/test00/0000.png", photograph(test[0], 0)));
  std::ofstream(root + "/capture.json")
      << "{\"name\": \"box\", \"fps\": 25, \"units\": \"metre\", \"up_axis\": \"Y\", \"sequences\": "
      << "[{\"name\": \"turn\", \"frames\": " << frames << ", \"loop\": false, \"test_frames\": [0]}]}\n";
  return 0;
}
