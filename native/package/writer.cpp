// SPDX-License-Identifier: Apache-2.0
#include "package/writer.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/text.h"

#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

#include "base/hash.h"

namespace fourdvt::package {
namespace {

using tinygltf::Value;

constexpr double kNear_m = 0.05, kFar_m = 100;

Value number(double v) {
  // Prints whole numbers without a fraction if they fit an int.
  if (v == std::floor(v) && std::abs(v) < 2147483647.0) return Value(static_cast<int>(v));
  return Value(v);
}

template <class Range>
Value numbers(const Range& values) {
  Value::Array out;
  for (double v : values) out.push_back(number(v));
  return Value(out);
}

Value hashValue(uint64_t hash) { return Value(hexDigits(hash)); }

Value vec3(const glm::dvec3& v) { return numbers(std::initializer_list<double>{v.x, v.y, v.z}); }
Value rect(const Rect& r) {
  return numbers(std::initializer_list<double>{double(r.x), double(r.y), double(r.width), double(r.height)});
}

Value cameraValue(const PinholeCamera& camera) {
  std::vector<double> matrix;
  for (int i = 0; i < 16; ++i) matrix.push_back(camera.cam_from_world[i / 4][i % 4]);
  return Value(Value::Object{{"name", Value(camera.name)},
                             {"width", number(camera.width)},
                             {"height", number(camera.height)},
                             {"fx", number(camera.fx)},
                             {"fy", number(camera.fy)},
                             {"cx", number(camera.cx)},
                             {"cy", number(camera.cy)},
                             {"camFromWorld", numbers(matrix)}});
}

Value renditionValue(const Rendition& rendition) {
  const Value barcode(
      Value::Object{{"rect", rect(rendition.barcode.rect)}, {"cellSize", number(rendition.barcode.cell_size)}});
  Value::Object out{{"uri", Value(rendition.video_uri)},  {"byteLength", number(double(rendition.video_bytes))},
                    {"codec", Value(rendition.codec)},    {"width", number(rendition.width)},
                    {"height", number(rendition.height)}, {"barcode", barcode}};
  Value::Array layers;
  for (const Rect& r : rendition.layers) layers.push_back(rect(r));
  if (layers.empty())
    out["tiles"] = rect(rendition.tiles);
  else
    out["layers"] = Value(layers);
  return Value(out);
}

Value memberValue(const Member& member) {
  return Value(Value::Object{{"name", Value(member.name)},
                             {"parameter", numbers(member.parameter)},
                             {"duration", number(member.duration_s)},
                             {"travel", vec3(member.travel)}});
}

Value spaceValue(const ParameterSpace& space) {
  Value::Array names, samples, simplices;
  for (const std::string& name : space.names) names.push_back(Value(name));
  for (const ParameterSample& sample : space.samples) {
    samples.push_back(Value(Value::Object{
        {"at", numbers(sample.at)}, {"weights", numbers(sample.weights)}, {"offsets", numbers(sample.offsets)}}));
  }
  for (const auto& simplex : space.simplices) simplices.push_back(numbers(simplex));
  return Value(Value::Object{{"names", Value(names)}, {"samples", Value(samples)}, {"simplices", Value(simplices)}});
}

// Adds members and parameters; for a plain sequence its only member.
void addMembers(const Sequence& s, Value::Object& out) {
  Value::Array members;
  for (const Member& member : s.members) members.push_back(memberValue(member));
  if (!members.empty()) out["members"] = Value(members);
  if (!s.isClass()) return;
  out["parameterSpace"] = spaceValue(s.space);
  out["referenceCount"] = number(s.reference_count);
  out["detailCorrelation"] = number(s.detail_correlation);
}

Value soundValue(const Sound& sound) {
  Value::Array encodings;
  for (const SoundEncoding& encoding : sound.encodings) {
    Value::Array segments;
    for (const SoundSegment& segment : encoding.segments)
      segments.push_back(numbers(std::initializer_list<double>{double(segment.bytes), double(segment.samples)}));
    encodings.push_back(Value(Value::Object{{"uri", Value(encoding.uri)},
                                            {"byteLength", number(double(encoding.bytes))},
                                            {"hash", hashValue(encoding.hash)},
                                            {"type", Value(encoding.mime_type)},
                                            {"priming", number(encoding.priming)},
                                            {"segments", Value(segments)}}));
  }
  Value::Object out{{"sampleRate", number(sound.sample_rate)},
                    {"channels", number(sound.channels)},
                    {"segmentDuration", number(sound.segment_s)},
                    {"encodings", Value(encodings)}};
  if (!sound.steps.empty()) out["steps"] = numbers(sound.steps);
  return Value(out);
}

// sound: null: none.
Value sequenceValue(const Sequence& s, const Sound* sound) {
  Value::Array renditions;
  for (const Rendition& r : s.renditions) renditions.push_back(renditionValue(r));
  Value::Object stream{{"uri", Value(s.stream_uri)},
                       {"byteLength", number(double(s.stream_bytes))},
                       {"headerLength", number(s.stream_header_bytes)},
                       {"headerHash", hashValue(s.stream_header_hash)}};
  if (s.coarse_renditions > 0)
    stream["coarse"] = Value(
        Value::Object{{"renditions", number(s.coarse_renditions)}, {"byteLength", number(double(s.coarse_bytes))}});
  Value::Object out{
      {"name", Value(s.name)},          {"frameCount", number(s.frame_count)},       {"fps", number(s.fps)},
      {"loop", Value(s.loop)},          {"rootVelocity", vec3(s.root_velocity_mps)}, {"stream", Value(stream)},
      {"renditions", Value(renditions)}};
  if (sound) out["sound"] = soundValue(*sound);
  if (s.layout_width > 0)
    out["layout"] = numbers(std::initializer_list<double>{double(s.layout_width), double(s.layout_height)});
  else
    addMembers(s, out);
  return Value(out);
}

Value roomValue(const Room& room) {
  Value::Array faces;
  for (const Rect& face : room.faces) faces.push_back(rect(face));
  return Value(Value::Object{{"min", vec3(room.box.min)},
                             {"max", vec3(room.box.max)},
                             {"uri", Value(room.picture_uri)},
                             {"byteLength", number(double(room.picture_bytes))},
                             {"hash", hashValue(room.picture_hash)},
                             {"width", number(room.width)},
                             {"height", number(room.height)},
                             {"faces", Value(faces)}});
}

Value methodValue(const DrawingMethod& method) {
  Value::Object out{{"name", Value(method.name)}};
  if (method.sweep_band_m > 0) out["sweepBand"] = number(method.sweep_band_m);
  return Value(out);
}

Value startValue(const Start& start) {
  return Value(Value::Object{
      {"uri", Value(start.uri)}, {"byteLength", number(double(start.bytes))}, {"hash", hashValue(start.hash)}});
}

Value extensionValue(const Character& c, const Sounds& sounds) {
  Value::Array cameras, sequences;
  for (const PinholeCamera& camera : c.cameras) cameras.push_back(cameraValue(camera));
  for (const Sequence& s : c.sequences) {
    const auto sound = sounds.find(s.name);
    sequences.push_back(sequenceValue(s, sound == sounds.end() ? nullptr : &sound->second));
  }
  const Value mesh(Value::Object{{"uri", Value(c.mesh_uri)},
                                 {"byteOffset", number(double(c.mesh_offset))},
                                 {"byteLength", number(double(c.mesh_bytes))},
                                 {"hash", hashValue(c.mesh_hash)}});
  const Value bounds(Value::Object{{"min", vec3(c.bounds.min)}, {"max", vec3(c.bounds.max)}});
  Value::Object out{{"version", number(c.version)},
                    {"name", Value(c.name)},
                    {"vertexCount", number(c.vertex_count)},
                    {"faceCount", number(c.face_count)},
                    {"mesh", mesh},
                    {"poster", Value(Value::Object{{"uri", Value(c.poster_uri)}})},
                    {"bounds", bounds},
                    {"groundY", number(c.ground_y_m)},
                    {"cameras", Value(cameras)},
                    {"sequences", Value(sequences)}};
  if (c.appearance == AppearanceKind::Cameras)
    out["appearance"] = Value(std::string("cameras"));
  else
    out["layerCount"] = number(c.layer_count);
  if (!c.graph_uri.empty()) {
    out["graph"] = Value(Value::Object{
        {"uri", Value(c.graph_uri)}, {"byteLength", number(double(c.graph_bytes))}, {"hash", hashValue(c.graph_hash)}});
  }
  if (c.length_scale != 1) out["lengthScale"] = number(c.length_scale);
  if (!c.method.name.empty()) out["method"] = methodValue(c.method);
  if (!c.room.picture_uri.empty()) out["room"] = roomValue(c.room);
  if (!c.start.uri.empty()) out["start"] = startValue(c.start);
  return Value(out);
}

int addAccessor(tinygltf::Model& model, int component_type, int type, size_t count) {
  tinygltf::Accessor accessor;
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

void addMesh(tinygltf::Model& model, const ManifestInput& in) {
  const EncodedBaseMesh& mesh = *in.mesh;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = in.character.mesh_offset;
  view.byteLength = mesh.bytes.size();
  model.bufferViews.push_back(view);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  primitive.indices = addAccessor(model, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                                  size_t(3) * mesh.decoded.topology.faceCount());
  const int position = addAccessor(model, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, mesh.point_count);
  for (int i = 0; i < 3; ++i) {
    model.accessors[position].minValues.push_back(mesh.point_bounds.min[i]);
    model.accessors[position].maxValues.push_back(mesh.point_bounds.max[i]);
  }
  primitive.attributes["POSITION"] = position;
  Value::Object attributes{{"POSITION", Value(mesh.position_attribute)}};
  if (mesh.uv_attribute >= 0) {
    primitive.attributes["TEXCOORD_0"] =
        addAccessor(model, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, mesh.point_count);
    attributes["TEXCOORD_0"] = Value(mesh.uv_attribute);
  }
  if (mesh.colour_attribute >= 0) {
    const int colours =
        addAccessor(model, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC3, mesh.point_count);
    model.accessors[size_t(colours)].normalized = true;
    primitive.attributes["COLOR_0"] = colours;
    attributes["COLOR_0"] = Value(mesh.colour_attribute);
  }
  primitive.extensions["KHR_draco_mesh_compression"] =
      Value(Value::Object{{"bufferView", Value(0)}, {"attributes", Value(attributes)}});
  tinygltf::Mesh gltf_mesh;
  gltf_mesh.name = in.character.name;
  gltf_mesh.primitives.push_back(primitive);
  model.meshes.push_back(gltf_mesh);
}

// Adds the still as texture; else vertex colours, or plain grey.
void addMaterial(tinygltf::Model& model, const std::string& texture_uri, bool coloured) {
  tinygltf::Material material;
  material.name = "still";
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 1;
  material.extensions["KHR_materials_unlit"] = Value(Value::Object{});
  if (texture_uri.empty()) {
    if (!coloured) material.pbrMetallicRoughness.baseColorFactor = {0.5, 0.5, 0.5, 1};
    model.materials.push_back(material);
    return;
  }
  tinygltf::Image image;
  image.uri = texture_uri;
  model.images.push_back(image);
  tinygltf::Sampler sampler;
  sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  model.samplers.push_back(sampler);
  tinygltf::Texture texture;
  texture.source = 0;
  texture.sampler = 0;
  model.textures.push_back(texture);
  material.pbrMetallicRoughness.baseColorTexture.index = 0;
  model.materials.push_back(material);
}

// glTF cameras look along -Z with +Y up: COLMAP's axes with y and z negated.
int addCameraNode(tinygltf::Model& model, const PinholeCamera& camera) {
  tinygltf::Camera gltf_camera;
  gltf_camera.name = camera.name;
  gltf_camera.type = "perspective";
  gltf_camera.perspective.aspectRatio = double(camera.width) / camera.height;
  gltf_camera.perspective.yfov = 2 * std::atan(0.5 * camera.height / camera.fy);
  gltf_camera.perspective.znear = kNear_m;
  gltf_camera.perspective.zfar = kFar_m;
  model.cameras.push_back(gltf_camera);
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  const glm::dvec3 centre = camera.centreInWorld();
  tinygltf::Node node;
  node.name = camera.name;
  node.camera = static_cast<int>(model.cameras.size()) - 1;
  for (int column = 0; column < 3; ++column) {
    const double sign = column == 0 ? 1 : -1;
    for (int row = 0; row < 3; ++row) node.matrix.push_back(sign * world_from_cam[column][row] + 0.0);
    node.matrix.push_back(0);
  }
  node.matrix.insert(node.matrix.end(), {centre.x, centre.y, centre.z, 1});
  model.nodes.push_back(node);
  return static_cast<int>(model.nodes.size()) - 1;
}

void addScene(tinygltf::Model& model, const Character& character) {
  tinygltf::Node root, body;
  root.name = character.name;
  body.name = "body";
  body.mesh = 0;
  model.nodes = {root, body};
  model.nodes[0].children.push_back(1);
  for (const PinholeCamera& camera : character.cameras) {
    const int node = addCameraNode(model, camera);
    model.nodes[0].children.push_back(node);
  }
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  model.scenes.push_back(scene);
  model.defaultScene = 0;
}

}  // namespace

Result<std::string> writeManifest(const ManifestInput& input) {
  const Character& c = input.character;
  if (!input.mesh || input.mesh->bytes.size() != c.mesh_bytes) {
    return Error{ErrorId::Internal, "character.gltf: mesh length differs from the encoded mesh"};
  }
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = input.generator;
  model.asset.copyright = input.copyright;
  addMesh(model, input);
  addMaterial(model, input.texture_uri, input.mesh->colour_attribute >= 0);
  addScene(model, c);
  model.extensionsUsed = {"KHR_draco_mesh_compression", "KHR_materials_unlit", kExtensionName};
  model.extensionsRequired = {"KHR_draco_mesh_compression"};
  model.extensions[kExtensionName] = extensionValue(c, input.sounds);
  std::ostringstream text;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, text, false, false)) {
    return Error{ErrorId::Internal, "character.gltf: tinygltf could not write it"};
  }
  // tinygltf's stream writer embeds buffers; the mesh file stays external.
  nlohmann::json json = nlohmann::json::parse(text.str(), nullptr, false);
  if (json.is_discarded()) return Error{ErrorId::Internal, "character.gltf: tinygltf wrote broken JSON"};
  json["buffers"] = nlohmann::json::array({{{"uri", c.mesh_uri}, {"byteLength", c.mesh_offset + c.mesh_bytes}}});
  return json.dump(1) + "\n";
}

}  // namespace fourdvt::package
