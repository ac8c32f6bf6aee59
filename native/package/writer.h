// SPDX-License-Identifier: Apache-2.0
// Writes character.gltf (valid glTF 2.0 through tinygltf): base mesh with KHR_draco_mesh_compression, textured material
// (JPEG still), capture cameras as nodes, and the project's extension. Native only.
#pragma once

#include "package/base_mesh.h"
#include "package/character.h"
#include "package/sound.h"

namespace fourdvt::package {

struct ManifestInput {
  Character character;  // all fields set; mesh_uri names the .bin file for `mesh.bytes`
  const EncodedBaseMesh* mesh = nullptr;
  std::string texture_uri;  // UV-space still (JPEG) for plain glTF viewers: layer 1 of the first frame; empty: a mesh
                            // without UVs
  std::string generator;    // "fourdvt X.Y"
  std::string copyright;    // credits, may be empty
  Sounds sounds;            // sequences with sound only
};

// JSON text of character.gltf. Errors: Internal.
Result<std::string> writeManifest(const ManifestInput& input);

}  // namespace fourdvt::package
