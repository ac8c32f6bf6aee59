// SPDX-License-Identifier: Apache-2.0
// A small rigged GLB: a square tube of 0.2 x 1 x 0.2 m on two joints ("root" at the ground, "tip" half-way up).
// Animations turn the tip about x: "still" holds it, "bend" swings it by 80 degrees and back, "stride" also travels 1.5
// m along z in its 1 s, "fall" ends lying. Tests change one part and write the file.
#pragma once

#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace fourdvt::testing {

class StudioModel {
 public:
  static constexpr int kRings = 11;  // of 4 corners; the seam's corner is duplicated: 5 vertices per ring
  static constexpr float kHalf = 0.1f, kHeight = 1.0f;
  tinygltf::Model gltf;
  int position = 0, uv = 0, joints = 0, weights = 0, indices = 0;  // accessors

  StudioModel() {
    gltf.asset.version = "2.0";
    gltf.buffers.emplace_back();
    addMesh();
    addNodes();
    addTexture();
    addAnimation("still", {0, 1}, {0, 0}, 0);
    addAnimation("bend", {0, 0.5f, 1}, {0, 80, 0}, 0);
    addAnimation("stride", {0, 0.5f, 1}, {0, 40, 0}, 1.5f);
    addAnimation("fall", {0, 0.8f}, {0, 90}, 0);
  }

  tinygltf::Primitive& primitive() { return gltf.meshes[0].primitives[0]; }

  std::string write(const std::string& path) {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    tinygltf::TinyGLTF writer;
    writer.WriteGltfSceneToFile(&gltf, path, true, true, false, true);
    return path;
  }

  template <class T>
  int accessor(const std::vector<T>& values, int type, int component, size_t count) {
    auto& data = gltf.buffers[0].data;
    data.resize((data.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = values.size() * sizeof(T);
    data.resize(data.size() + view.byteLength);
    std::memcpy(data.data() + view.byteOffset, values.data(), view.byteLength);
    gltf.bufferViews.push_back(view);
    tinygltf::Accessor out;
    out.bufferView = int(gltf.bufferViews.size()) - 1;
    out.type = type;
    out.componentType = component;
    out.count = count;
    gltf.accessors.push_back(out);
    return int(gltf.accessors.size()) - 1;
  }

  // Angles of the tip about x, degrees, at the times; and travel along z at the end.
  void addAnimation(const std::string& name, const std::vector<float>& times, const std::vector<float>& degrees,
                    float travel_m) {
    std::vector<float> turns, places;
    for (size_t i = 0; i < times.size(); ++i) {
      const float half = degrees[i] * 3.14159265f / 360;
      turns.insert(turns.end(), {std::sin(half), 0, 0, std::cos(half)});
      places.insert(places.end(), {0, 0, travel_m * times[i] / times.back()});
    }
    tinygltf::Animation animation;
    animation.name = name;
    const int input = accessor(times, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, times.size());
    const auto add = [&](const std::vector<float>& values, int type, const char* path, int node) {
      tinygltf::AnimationSampler sampler;
      sampler.input = input;
      sampler.output = accessor(values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, times.size());
      tinygltf::AnimationChannel channel;
      channel.sampler = int(animation.samplers.size());
      channel.target_node = node;
      channel.target_path = path;
      animation.samplers.push_back(sampler);
      animation.channels.push_back(channel);
    };
    add(turns, TINYGLTF_TYPE_VEC4, "rotation", 1);
    if (travel_m != 0) add(places, TINYGLTF_TYPE_VEC3, "translation", 0);
    gltf.animations.push_back(animation);
  }

 private:
  void addMesh() {
    std::vector<float> positions, uvs, shares;
    std::vector<uint8_t> bones;
    std::vector<uint16_t> faces;
    const float x[] = {-kHalf, kHalf, kHalf, -kHalf, -kHalf}, z[] = {kHalf, kHalf, -kHalf, -kHalf, kHalf};
    for (int ring = 0; ring < kRings; ++ring)
      for (int k = 0; k < 5; ++k) {
        const float up = float(ring) / (kRings - 1);
        positions.insert(positions.end(), {x[k], kHeight * up, z[k]});
        uvs.insert(uvs.end(), {0.05f + 0.225f * float(k), 0.95f - 0.9f * up});
        bones.insert(bones.end(), {0, 1, 0, 0});
        const float tip = up > 0.5f ? 1.0f : 0.0f;
        shares.insert(shares.end(), {1 - tip, tip, 0, 0});
        if (k == 4 || ring == kRings - 1) continue;
        const auto a = uint16_t(5 * ring + k);
        for (const int corner : {0, 1, 6, 0, 6, 5}) faces.push_back(uint16_t(a + corner));
      }
    const size_t count = positions.size() / 3;
    position = accessor(positions, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, count);
    gltf.accessors[position].minValues = {-kHalf, 0, -kHalf};
    gltf.accessors[position].maxValues = {kHalf, kHeight, kHalf};
    uv = accessor(uvs, TINYGLTF_TYPE_VEC2, TINYGLTF_COMPONENT_TYPE_FLOAT, count);
    joints = accessor(bones, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, count);
    weights = accessor(shares, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_FLOAT, count);
    indices = accessor(faces, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, faces.size());
    tinygltf::Primitive p;
    p.mode = TINYGLTF_MODE_TRIANGLES;
    p.attributes = {{"POSITION", position}, {"TEXCOORD_0", uv}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}};
    p.indices = indices;
    p.material = 0;
    gltf.meshes.emplace_back();
    gltf.meshes[0].name = "tube";
    gltf.meshes[0].primitives.push_back(p);
  }

  void addNodes() {
    gltf.nodes.resize(3);
    gltf.nodes[0].name = "root";
    gltf.nodes[0].children = {1};
    gltf.nodes[1].name = "tip";
    gltf.nodes[1].translation = {0, 0.5, 0};
    gltf.nodes[2].name = "body";
    gltf.nodes[2].mesh = 0;
    gltf.nodes[2].skin = 0;
    std::vector<float> binds(32, 0);
    for (int k = 0; k < 4; ++k) binds[5 * k] = binds[16 + 5 * k] = 1;
    binds[16 + 13] = -0.5f;
    tinygltf::Skin skin;
    skin.joints = {0, 1};
    skin.inverseBindMatrices = accessor(binds, TINYGLTF_TYPE_MAT4, TINYGLTF_COMPONENT_TYPE_FLOAT, 2);
    gltf.skins.push_back(skin);
    tinygltf::Scene scene;
    scene.nodes = {0, 2};
    gltf.scenes.push_back(scene);
    gltf.defaultScene = 0;
  }

  // 64 x 64: red increases to the right, green downwards.
  void addTexture() {
    tinygltf::Image image;
    image.width = image.height = 64;
    image.component = 4;
    image.bits = 8;
    image.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    image.mimeType = "image/png";
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        for (const int c : {4 * x, 4 * y, 90, 255}) image.image.push_back(static_cast<uint8_t>(c));
    gltf.images.push_back(image);
    tinygltf::Texture texture;
    texture.source = 0;
    gltf.textures.push_back(texture);
    tinygltf::Material material;
    material.pbrMetallicRoughness.baseColorTexture.index = 0;
    gltf.materials.push_back(material);
  }
};

}  // namespace fourdvt::testing
