// SPDX-License-Identifier: Apache-2.0
// Fields that the manifests of characters and of live streams have in common. Internal to package/. Does NOT read what
// names files.
#pragma once

#include <string>

#include "package/field_reader.h"

namespace fourdvt::package {

// Name, counts, box, ground, scale, cameras; `appearance` is set before, and from cameras the method is read as well.
void readBody(FieldReader& in, const std::string& at, Character& character);
void readLayout(FieldReader& in, const std::string& at, Sequence& sequence);  // from cameras
// Codec, size, barcode and layers of the tiled picture. layer_count: of all members; 0: from cameras, tiles.
void readPicture(FieldReader& in, const std::string& at, int layer_count, Rendition& rendition);

}  // namespace fourdvt::package
