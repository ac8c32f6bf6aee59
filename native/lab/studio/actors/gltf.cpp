// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/actors/gltf.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

namespace fourdvt::studio {
namespace {

constexpr int kAtlasSide = 4096, kPlainSide = 64;  // texels: largest atlas; tile of a material without a texture
constexpr float kUvSlack = 1e-4f;

std::string oneLine(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  Result<GltfModel> read() {
    FOURDVT_TRY(load());
    FOURDVT_TRY(readNodes());
    FOURDVT_TRY(readMeshes());
    if (out_.topology.face_vertices.empty()) return error(ErrorId::Unsupported, "has no mesh; export one with a rig");
    if (!any_skin_)
      return error(ErrorId::Unsupported, "has no skinned mesh; export it with its armature (JOINTS_0 and WEIGHTS_0)");
    FOURDVT_TRY(readAnimations());
    FOURDVT_TRY(paintAtlas());
    out_.topology.vertex_count = static_cast<uint32_t>(out_.vertices.size());
    return std::move(out_);
  }

 private:
  Error error(ErrorId id, const std::string& what) const { return {id, path_ + ": " + what}; }

  Status load() {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path_, ignored))
      return error(ErrorId::FileMissing, "no such file; check the path of the model");
    tinygltf::TinyGLTF loader;
    std::string problem, warning;
    const bool binary = path_.size() >= 4 && path_.compare(path_.size() - 4, 4, ".glb") == 0;
    const bool loaded = binary ? loader.LoadBinaryFromFile(&gltf_, &problem, &warning, path_)
                               : loader.LoadASCIIFromFile(&gltf_, &problem, &warning, path_);
    if (!loaded)
      return error(ErrorId::FileUnreadable,
                   "not a readable glTF 2.0 file (" + oneLine(problem) + "); export it again as .glb");
    return {};
  }

  Status readNodes() {
    out_.nodes.resize(gltf_.nodes.size());
    for (size_t i = 0; i < gltf_.nodes.size(); ++i) {
      const tinygltf::Node& node = gltf_.nodes[i];
      out_.nodes[i].rest = restOf(node);
      for (const int child : node.children) {
        if (child < 0 || size_t(child) >= out_.nodes.size() || out_.nodes[child].parent >= 0 || child == int(i))
          return error(ErrorId::FileUnreadable, "its nodes do not form a tree; export it again");
        out_.nodes[child].parent = static_cast<int>(i);
      }
    }
    std::vector<uint8_t> done(out_.nodes.size(), 0);
    for (size_t before = out_.nodes.size() + 1; out_.node_order.size() != before;) {
      before = out_.node_order.size();
      for (size_t i = 0; i < out_.nodes.size(); ++i) {
        const int parent = out_.nodes[i].parent;
        if (done[i] || (parent >= 0 && !done[parent])) continue;
        done[i] = 1;
        out_.node_order.push_back(static_cast<int>(i));
      }
    }
    if (out_.node_order.size() != out_.nodes.size())
      return error(ErrorId::FileUnreadable, "its nodes form a ring; export it again");
    return {};
  }

  static NodeTransform restOf(const tinygltf::Node& node) {
    NodeTransform t;
    if (node.matrix.size() == 16) {
      glm::dmat4 m;
      std::copy(node.matrix.begin(), node.matrix.end(), &m[0][0]);
      t.translation = glm::dvec3(m[3]);
      for (int k = 0; k < 3; ++k) t.scale[k] = glm::length(glm::dvec3(m[k]));
      if (glm::determinant(glm::dmat3(m)) < 0) t.scale.x = -t.scale.x;
      t.rotation = glm::quat_cast(
          glm::dmat3(glm::dvec3(m[0]) / t.scale.x, glm::dvec3(m[1]) / t.scale.y, glm::dvec3(m[2]) / t.scale.z));
    }
    if (node.translation.size() == 3) t.translation = {node.translation[0], node.translation[1], node.translation[2]};
    if (node.scale.size() == 3) t.scale = {node.scale[0], node.scale[1], node.scale[2]};
    if (node.rotation.size() == 4)
      t.rotation = {node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]};
    return t;
  }

  // Reads the values of an accessor as doubles, `components` per element; normalises integers if the accessor requires
  // it.
  Status numbers(int index, int components, const char* what, std::vector<double>& out) const {
    const Error broken = error(ErrorId::FileUnreadable, std::string(what) + " cannot be read; export it again");
    if (index < 0 || size_t(index) >= gltf_.accessors.size()) return broken;
    const tinygltf::Accessor& a = gltf_.accessors[index];
    if (a.sparse.isSparse || a.bufferView < 0)
      return error(ErrorId::Unsupported, std::string(what) + " is stored sparsely; export without sparse accessors");
    const int size = tinygltf::GetComponentSizeInBytes(uint32_t(a.componentType));
    if (size_t(a.bufferView) >= gltf_.bufferViews.size() || size < 1 || size > 4 ||
        tinygltf::GetNumComponentsInType(uint32_t(a.type)) != components)
      return broken;
    const tinygltf::BufferView& view = gltf_.bufferViews[a.bufferView];
    const int stride = a.ByteStride(view);
    if (view.buffer < 0 || size_t(view.buffer) >= gltf_.buffers.size() || stride < 1) return broken;
    const auto& data = gltf_.buffers[view.buffer].data;
    const size_t start = view.byteOffset + a.byteOffset, element = size_t(size) * components;
    if (a.count > 0 && (a.count > data.size() || start + (a.count - 1) * stride + element > data.size())) return broken;
    out.clear();
    for (size_t i = 0; i < a.count; ++i)
      for (int c = 0; c < components; ++c)
        out.push_back(number(&data[start + i * stride + size_t(c) * size], a.componentType, a.normalized));
    if (!std::all_of(out.begin(), out.end(), [](double v) { return std::isfinite(v); }))
      return error(ErrorId::MeshNotFinite, std::string(what) + " holds numbers that are not finite; repair the model");
    return {};
  }

  template <class T>
  static double integer(const unsigned char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return normalized ? std::max(-1.0, double(value) / double(std::numeric_limits<T>::max())) : double(value);
  }
  static double number(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return integer<int8_t>(bytes, normalized);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return integer<uint8_t>(bytes, normalized);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return integer<int16_t>(bytes, normalized);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return integer<uint16_t>(bytes, normalized);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return integer<uint32_t>(bytes, false);
      default: {
        float value;
        std::memcpy(&value, bytes, sizeof value);
        return value;
      }
    }
  }

  Status readMeshes() {
    for (size_t i = 0; i < gltf_.nodes.size(); ++i) {
      const tinygltf::Node& node = gltf_.nodes[i];
      if (node.mesh < 0) continue;
      if (size_t(node.mesh) >= gltf_.meshes.size()) return error(ErrorId::FileUnreadable, "a node has no such mesh");
      const size_t first_joint = out_.joints.size();
      if (node.skin >= 0) {
        FOURDVT_TRY(readSkin(node.skin));
      } else {
        out_.joints.push_back({static_cast<int>(i), glm::dmat4(1)});  // rigidly attached to its node
      }
      for (const tinygltf::Primitive& primitive : gltf_.meshes[node.mesh].primitives)
        FOURDVT_TRY(readPrimitive(primitive, gltf_.meshes[node.mesh].name, first_joint, node.skin >= 0));
    }
    return {};
  }

  Status readSkin(int index) {
    any_skin_ = true;
    if (size_t(index) >= gltf_.skins.size()) return error(ErrorId::FileUnreadable, "a node has no such skin");
    const tinygltf::Skin& skin = gltf_.skins[index];
    std::vector<double> binds;
    if (skin.inverseBindMatrices >= 0)
      FOURDVT_TRY(numbers(skin.inverseBindMatrices, 16, "inverse bind matrices", binds));
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      if (skin.joints[j] < 0 || size_t(skin.joints[j]) >= out_.nodes.size())
        return error(ErrorId::FileUnreadable, "a skin's joint is no node; export it again");
      GltfJoint joint{skin.joints[j], glm::dmat4(1)};
      if (binds.size() >= 16 * (j + 1)) std::copy_n(&binds[16 * j], 16, &joint.bind[0][0]);
      out_.joints.push_back(joint);
    }
    return {};
  }

  Status readPrimitive(const tinygltf::Primitive& primitive, const std::string& mesh, size_t first_joint,
                       bool skinned) {
    const std::string name = "mesh \"" + mesh + "\"";
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1)
      return error(ErrorId::Unsupported, name + " has strips, fans, lines or points; export triangles");
    const auto attribute = [&](const char* key) {
      const auto it = primitive.attributes.find(key);
      return it == primitive.attributes.end() ? -1 : it->second;
    };
    if (attribute("TEXCOORD_0") < 0)
      return error(ErrorId::MeshNoUvs, name + " has no texture coordinates; unwrap it and export with UVs");
    std::vector<double> positions, uvs, joints, weights, indices;
    FOURDVT_TRY(numbers(attribute("POSITION"), 3, "POSITION", positions));
    FOURDVT_TRY(numbers(attribute("TEXCOORD_0"), 2, "TEXCOORD_0", uvs));
    const size_t count = positions.size() / 3;
    if (skinned) {
      if (attribute("JOINTS_0") < 0 || attribute("WEIGHTS_0") < 0)
        return error(ErrorId::Unsupported, name + " has a skin but no JOINTS_0 and WEIGHTS_0; export its weights");
      FOURDVT_TRY(numbers(attribute("JOINTS_0"), 4, "JOINTS_0", joints));
      FOURDVT_TRY(numbers(attribute("WEIGHTS_0"), 4, "WEIGHTS_0", weights));
    }
    if (uvs.size() != 2 * count || (skinned && (joints.size() != 4 * count || weights.size() != 4 * count)))
      return error(ErrorId::FileUnreadable, name + " has attributes of different lengths; export it again");
    if (primitive.indices >= 0) {
      FOURDVT_TRY(numbers(primitive.indices, 1, "indices", indices));
    } else {
      for (size_t i = 0; i < count; ++i) indices.push_back(double(i));
    }
    for (const double i : indices)
      if (i >= double(count)) return error(ErrorId::MeshIndex, name + " has an index out of range; export it again");
    std::vector<uint32_t> vertices(count);
    for (size_t i = 0; i < count; ++i) {
      GltfVertex vertex{{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}, {}, {1, 0, 0, 0}};
      vertex.joints.fill(static_cast<uint16_t>(first_joint));
      if (skinned && !bind(&joints[4 * i], &weights[4 * i], first_joint, vertex))
        return error(ErrorId::MeshIndex, name + " has a joint out of range; export it again");
      vertices[i] = weld(vertex);
    }
    return addFaces(primitive.material, name, indices, vertices, uvs);
  }

  bool bind(const double* joints, const double* weights, size_t first_joint, GltfVertex& out) const {
    const double sum = weights[0] + weights[1] + weights[2] + weights[3];
    for (int k = 0; k < 4; ++k) {
      const size_t joint = first_joint + size_t(joints[k]);
      if (joint >= out_.joints.size() || joint > 0xffff) return false;
      out.joints[k] = static_cast<uint16_t>(joint);
      out.weights[k] = static_cast<float>(sum > 0 ? weights[k] / sum : k == 0);
    }
    return true;
  }

  // Joins vertices that the exporter split for their UVs or normals.
  uint32_t weld(const GltfVertex& v) {
    std::array<int64_t, 11> key{};
    for (int k = 0; k < 3; ++k) key[k] = std::llround(v.position[k] * 1e6);
    for (int k = 0; k < 4; ++k) {
      key[3 + k] = v.weights[k] > 0 ? v.joints[k] : -1;
      key[7 + k] = std::llround(v.weights[k] * 1e3);
    }
    const auto [it, fresh] = welded_.try_emplace(key, uint32_t(out_.vertices.size()));
    if (fresh) out_.vertices.push_back(v);
    return it->second;
  }

  Status addFaces(int material, const std::string& name, const std::vector<double>& indices,
                  const std::vector<uint32_t>& vertices, const std::vector<double>& uvs) {
    glm::dvec2 low(1e9), high(-1e9);
    for (const double i : indices) {
      const glm::dvec2 uv(uvs[2 * size_t(i)], uvs[2 * size_t(i) + 1]);
      low = glm::min(low, uv);
      high = glm::max(high, uv);
    }
    const glm::dvec2 shift = glm::floor(low + double(kUvSlack));
    if (glm::any(glm::greaterThan(high - shift, glm::dvec2(1 + kUvSlack))))
      return error(ErrorId::MeshUvRange, name + " repeats its texture; unwrap it so that its UVs lie in [0,1]");
    const uint32_t first_uv = static_cast<uint32_t>(out_.topology.uvs.size());
    for (size_t i = 0; i < vertices.size(); ++i)
      out_.topology.uvs.push_back(glm::clamp(glm::vec2(glm::dvec2(uvs[2 * i], uvs[2 * i + 1]) - shift), 0.0f, 1.0f));
    const auto known = std::find(materials_.begin(), materials_.end(), material);
    uv_materials_.resize(out_.topology.uvs.size(), int(known - materials_.begin()));
    if (known == materials_.end()) materials_.push_back(material);
    for (size_t i = 0; i + 2 < indices.size(); i += 3) {
      const glm::uvec3 corner{uint32_t(indices[i]), uint32_t(indices[i + 1]), uint32_t(indices[i + 2])};
      const glm::uvec3 face{vertices[corner.x], vertices[corner.y], vertices[corner.z]};
      if (face.x == face.y || face.y == face.z || face.z == face.x) continue;
      out_.topology.face_vertices.push_back(face);
      out_.topology.face_uvs.push_back(first_uv + corner);
    }
    return {};
  }

  Status readAnimations() {
    for (const tinygltf::Animation& source : gltf_.animations) {
      GltfAnimation animation;
      animation.name = source.name;
      animation.start_s = 1e9;
      animation.end_s = -1e9;
      for (const tinygltf::AnimationChannel& channel : source.channels)
        FOURDVT_TRY(readChannel(source, channel, animation));
      if (animation.channels.empty() || !(animation.end_s > animation.start_s))
        continue;  // single pose, or morphs only
      out_.animations.push_back(std::move(animation));
    }
    if (out_.animations.empty())
      return error(ErrorId::Unsupported, "has no animation that moves its nodes; export it with its actions");
    return {};
  }

  Status readChannel(const tinygltf::Animation& source, const tinygltf::AnimationChannel& channel,
                     GltfAnimation& animation) {
    static const std::map<std::string, GltfChannel::Path> kPaths{{"translation", GltfChannel::Path::Translation},
                                                                 {"rotation", GltfChannel::Path::Rotation},
                                                                 {"scale", GltfChannel::Path::Scale}};
    const auto path = kPaths.find(channel.target_path);
    if (path == kPaths.end() || channel.target_node < 0) return {};
    if (channel.sampler < 0 || size_t(channel.sampler) >= source.samplers.size() ||
        size_t(channel.target_node) >= out_.nodes.size())
      return error(ErrorId::FileUnreadable, "animation \"" + source.name + "\" is broken; export it again");
    const tinygltf::AnimationSampler& sampler = source.samplers[channel.sampler];
    GltfChannel out;
    out.node = channel.target_node;
    out.path = path->second;
    if (sampler.interpolation == "STEP") out.between = GltfChannel::Between::Step;
    if (sampler.interpolation == "CUBICSPLINE") out.between = GltfChannel::Between::Cubic;
    const int components = out.path == GltfChannel::Path::Rotation ? 4 : 3;
    std::vector<double> values;
    FOURDVT_TRY(numbers(sampler.input, 1, "animation times", out.times));
    FOURDVT_TRY(numbers(sampler.output, components, "animation values", values));
    const size_t keys = out.between == GltfChannel::Between::Cubic ? 3 * out.times.size() : out.times.size();
    if (out.times.empty() || values.size() != keys * components || !std::is_sorted(out.times.begin(), out.times.end()))
      return error(ErrorId::FileUnreadable, "animation \"" + source.name + "\" is broken; export it again");
    for (size_t i = 0; i < keys; ++i) {
      glm::dvec4 value(0);
      for (int c = 0; c < components; ++c) value[c] = values[i * components + c];
      out.values.push_back(value);
    }
    animation.start_s = std::min(animation.start_s, out.times.front());
    animation.end_s = std::max(animation.end_s, out.times.back());
    animation.channels.push_back(std::move(out));
    return {};
  }

  // Puts the materials' textures as tiles into one picture and moves the UVs along.
  Status paintAtlas() {
    std::vector<cv::Mat> tiles;
    for (const int material : materials_) {
      cv::Mat tile;
      FOURDVT_TRY(baseColour(material, tile));
      tiles.push_back(std::move(tile));
    }
    const int across = static_cast<int>(std::ceil(std::sqrt(double(tiles.size()))));
    cv::Size side(0, 0);
    for (const cv::Mat& tile : tiles) side = {std::max(side.width, tile.cols), std::max(side.height, tile.rows)};
    side = {std::min(side.width, kAtlasSide / across), std::min(side.height, kAtlasSide / across)};
    const int down = (int(tiles.size()) + across - 1) / across;
    out_.texture = Image(across * side.width, down * side.height, 3);
    cv::Mat atlas(out_.texture.height, out_.texture.width, CV_8UC3, out_.texture.pixels.data());
    for (size_t i = 0; i < tiles.size(); ++i) {
      const cv::Rect place(int(i) % across * side.width, int(i) / across * side.height, side.width, side.height);
      cv::resize(tiles[i], atlas(place), side, 0, 0, cv::INTER_AREA);
    }
    for (size_t i = 0; i < out_.topology.uvs.size(); ++i) {
      const glm::vec2 tile(uv_materials_[i] % across, uv_materials_[i] / across);
      out_.topology.uvs[i] = (tile + out_.topology.uvs[i]) / glm::vec2(across, down);
    }
    return {};
  }

  Status baseColour(int material, cv::Mat& out) const {
    glm::dvec3 factor(1);
    int texture = -1;
    if (material >= 0 && size_t(material) < gltf_.materials.size()) {
      const auto& pbr = gltf_.materials[material].pbrMetallicRoughness;
      if (pbr.baseColorFactor.size() >= 3)
        factor = {pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2]};
      texture = pbr.baseColorTexture.index;
    }
    // The factor is in linear light, but pictures here are sRGB-coded.
    factor = glm::pow(glm::clamp(factor, 0.0, 1.0), glm::dvec3(1 / 2.2));
    out = cv::Mat(kPlainSide, kPlainSide, CV_8UC3, cv::Scalar(255, 255, 255));
    if (texture >= 0) {
      const int source = size_t(texture) < gltf_.textures.size() ? gltf_.textures[texture].source : -1;
      const bool known = source >= 0 && size_t(source) < gltf_.images.size();
      if (!known || gltf_.images[source].image.empty() || gltf_.images[source].bits != 8 ||
          gltf_.images[source].component < 3)
        return error(ErrorId::Unsupported, "a base colour texture is no 8-bit RGB PNG or JPEG; export it as one");
      const tinygltf::Image& image = gltf_.images[source];
      const cv::Mat pixels(image.height, image.width, CV_8UC(image.component),
                           const_cast<uint8_t*>(image.image.data()));
      if (image.component == 4) {
        cv::cvtColor(pixels, out, cv::COLOR_RGBA2RGB);
      } else {
        out = pixels.clone();
      }
    }
    cv::multiply(out, cv::Scalar(factor.x, factor.y, factor.z), out);
    return {};
  }

  const std::string path_;
  tinygltf::Model gltf_;
  GltfModel out_;
  bool any_skin_ = false;
  std::map<std::array<int64_t, 11>, uint32_t> welded_;
  std::vector<int> materials_;     // the glTF's materials, in order of first use
  std::vector<int> uv_materials_;  // [uv] index into materials_
};

}  // namespace

glm::dvec4 GltfChannel::at(double time_s) const {
  const bool cubic = between == Between::Cubic;
  const auto value = [&](size_t key) { return values[cubic ? 3 * key + 1 : key]; };
  const size_t next = size_t(std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
  if (next == 0) return value(0);
  if (next == times.size() || between == Between::Step) return value(next - 1);
  const double length = times[next] - times[next - 1], t = (time_s - times[next - 1]) / length;
  const glm::dvec4 a = value(next - 1), b = value(next);
  if (cubic) {
    const glm::dvec4 leave = values[3 * (next - 1) + 2] * length, arrive = values[3 * next] * length;
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * leave + (3 * t2 - 2 * t3) * b + (t3 - t2) * arrive;
  }
  if (path != Path::Rotation) return glm::mix(a, b, t);
  const glm::dquat turn = glm::slerp(glm::dquat(a.w, a.x, a.y, a.z), glm::dquat(b.w, b.x, b.y, b.z), t);
  return {turn.x, turn.y, turn.z, turn.w};
}

Result<GltfModel> readGltf(const std::string& path) { return Reader(path).read(); }

}  // namespace fourdvt::studio
