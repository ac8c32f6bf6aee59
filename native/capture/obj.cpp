// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: positions, wedge UVs if required, polygons. Everything else in the file is skipped.

#include "capture/capture.h"
#include "capture/mesh_readers.h"
#include "capture/polygon.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

struct Corner {
  uint32_t vertex = 0, uv = 0;
  bool operator==(const Corner&) const = default;
};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& path, bool with_uvs, const MeshTopology* split_as)
      : text_(text), path_(path), with_uvs_(with_uvs), split_as_(split_as) {}

  Result<UvMesh> parse() {
    FOURDVT_TRY(forEachLine(&ObjParser::pointLine));
    if (mesh_.positions.empty()) return error(ErrorId::MeshIndex, "no vertices in it; export the mesh as OBJ again");
    if (with_uvs_ && mesh_.topology.uvs.empty()) return error(ErrorId::MeshNoUvs, kNoUvs);
    vertices_so_far_ = uvs_so_far_ = 0;
    FOURDVT_TRY(forEachLine(&ObjParser::faceLine));
    line_ = 0;
    if (mesh_.topology.face_vertices.empty()) {
      return error(ErrorId::MeshIndex, "no faces in it; export the mesh with its faces");
    }
    mesh_.topology.vertex_count = static_cast<uint32_t>(mesh_.positions.size());
    return std::move(mesh_);
  }

 private:
  Error error(ErrorId id, const std::string& what) const {
    std::string message = path_;
    if (line_ > 0) message.append(":").append(std::to_string(line_));
    return {id, message.append(": ").append(what)};
  }

  Status forEachLine(Status (ObjParser::*handle)(std::string_view keyword, std::string_view rest)) {
    TextLines lines(text_, {.comment_behind = true, .continued = true});
    std::string_view line;
    while (lines.next(line)) {
      line_ = lines.number();
      const std::string_view keyword = takeWord(line);
      FOURDVT_TRY((this->*handle)(keyword, line));
    }
    line_ = 0;
    return {};
  }

  Status pointLine(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") {
      Fields fields(rest);
      const auto x = fields.number<float>(), y = fields.number<float>(), z = fields.number<float>();
      if (!fields.problem().empty()) {
        return error(ErrorId::MeshNotFinite, "a vertex needs three finite numbers, but " + fields.problem() +
                                                 "; repair this frame of the mesh");
      }
      mesh_.positions.emplace_back(x, y, z);
    } else if (keyword == "vt" && with_uvs_) {
      return uvLine(rest);
    }
    return {};
  }

  Status uvLine(std::string_view rest) {
    Fields fields(rest);
    const auto u = fields.number<float>(), v = fields.number<float>();
    if (!fields.problem().empty()) {
      return error(ErrorId::MeshNotFinite,
                   "a texture coordinate needs two finite numbers, but " + fields.problem() + "; export the UVs again");
    }
    const auto uv = inTile({u, v});
    if (!uv) return error(ErrorId::MeshUvRange, kUvsOutside);
    mesh_.topology.uvs.emplace_back(uv->x, 1.0f - uv->y);
    return {};
  }

  Status faceLine(std::string_view keyword, std::string_view rest) {
    if (keyword == "v") ++vertices_so_far_;
    if (keyword == "vt") ++uvs_so_far_;
    if (keyword != "f") return {};
    corners_.clear();
    Corner corner;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      FOURDVT_TRY(parseCorner(word, corner));
      corners_.push_back(corner);
    }
    if (corners_.size() < 3) return error(ErrorId::MeshIndex, "a face needs at least three corners; repair the mesh");
    return addPolygon();
  }

  Status addPolygon() {
    triangles_.clear();
    if (!splitAsBefore()) {
      triangles_.clear();
      places_.clear();
      for (const Corner& corner : corners_) places_.push_back(mesh_.positions[corner.vertex]);
      if (!splitPolygon(places_, triangles_)) return error(ErrorId::Unsupported, tooManyCorners(corners_.size()));
    }
    for (const glm::uvec3& t : triangles_) {
      const Corner &a = corners_[t.x], &b = corners_[t.y], &c = corners_[t.z];
      mesh_.topology.face_vertices.emplace_back(a.vertex, b.vertex, c.vertex);
      if (with_uvs_) mesh_.topology.face_uvs.emplace_back(a.uv, b.uv, c.uv);
    }
    return {};
  }

  // Reuses the triangles of `split_as`; false if they do not fit this polygon's corners.
  bool splitAsBefore() {
    const size_t first = mesh_.topology.face_vertices.size(), count = corners_.size() - 2;
    if (!split_as_ || count == 1 || split_as_->face_vertices.size() < first + count) return false;
    for (size_t t = 0; t < count; ++t) {
      glm::uvec3 triangle;
      for (int k = 0; k < 3; ++k) {
        const Corner corner{split_as_->face_vertices[first + t][k], split_as_->face_uvs[first + t][k]};
        const size_t of_fan = k == 0 ? 0 : t + static_cast<size_t>(k);
        const auto found = corners_[of_fan] == corner ? corners_.begin() + static_cast<ptrdiff_t>(of_fan)
                                                      : std::find(corners_.begin(), corners_.end(), corner);
        if (found == corners_.end()) return false;
        triangle[k] = static_cast<uint32_t>(found - corners_.begin());
      }
      triangles_.push_back(triangle);
    }
    return true;
  }

  // Parses "vertex/uv" or "vertex/uv/normal"; without UVs also "vertex" and "vertex//normal".
  Status parseCorner(std::string_view word, Corner& out) const {
    const size_t slash = word.find('/');
    const std::string_view tail = slash == std::string_view::npos ? std::string_view() : word.substr(slash + 1);
    const std::string_view uv = tail.substr(0, tail.find('/'));
    if (with_uvs_ && uv.empty()) return error(ErrorId::MeshNoUvs, kNoUvs);
    if (!resolve(word.substr(0, slash), vertices_so_far_, mesh_.positions.size(), out.vertex) ||
        (with_uvs_ && !resolve(uv, uvs_so_far_, mesh_.topology.uvs.size(), out.uv))) {
      return error(ErrorId::MeshIndex, "a face index is out of range; export the mesh again");
    }
    return {};
  }

  // Resolves an index. OBJ counts from 1; negative indices count back from the last element read.
  static bool resolve(std::string_view word, size_t so_far, size_t size, uint32_t& out) {
    const auto index = toNumber<int64_t>(word);
    if (!index || *index == 0) return false;
    if (*index < -static_cast<int64_t>(so_far) || *index > static_cast<int64_t>(size)) return false;
    out = static_cast<uint32_t>(*index > 0 ? *index - 1 : static_cast<int64_t>(so_far) + *index);
    return true;
  }

  std::string_view text_;
  const std::string& path_;
  const bool with_uvs_;
  const MeshTopology* split_as_;  // may be null
  int line_ = 0;                  // named in messages; 0: the whole file
  size_t vertices_so_far_ = 0, uvs_so_far_ = 0;
  UvMesh mesh_;
  std::vector<Corner> corners_;        // corners of one face
  std::vector<glm::vec3> places_;      // positions of its corners
  std::vector<glm::uvec3> triangles_;  // triangles of its corners
};

}  // namespace

Result<UvMesh> parseObj(std::string_view text, const std::string& path, const MeshTopology* split_as) {
  return ObjParser(text, path, true, split_as).parse();
}

Result<TriangleMesh> parseObjSurface(std::string_view text, const std::string& path) {
  FOURDVT_ASSIGN(auto mesh, ObjParser(text, path, false, nullptr).parse());
  return TriangleMesh{std::move(mesh.positions), std::move(mesh.topology.face_vertices)};
}

}  // namespace fourdvt::capture
