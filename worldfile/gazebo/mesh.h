// Triangle meshes of files: STL (binary and text), Wavefront OBJ and COLLADA (.dae), by readers of this folder: what is
// needed of these formats are points, triangles, units and the nodes that place them, and a library of a hundred
// formats would be the largest dependency of a build and the least trusted one. Lengths in m, axis z up.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"
#include "worldfile/gazebo/transform3.h"

namespace troupe {

inline constexpr std::size_t kMaxMeshTriangles = 2'000'000;

struct TriangleMesh {
  // The triangles of one named part, up to those of the next one.
  struct Part {
    std::string name;
    std::size_t first = 0;
  };
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of points
  std::vector<Part> parts;
};

// The mesh in the content of a file, by the ending of its path. The error is a content that is damaged, of another
// format, or has more than kMaxMeshTriangles; `path` is for messages.
Result<TriangleMesh> ReadMesh(std::string_view content, const std::string& path);

// Only the triangles of the parts of that name; none if the mesh has no such part.
TriangleMesh PartOf(const TriangleMesh& mesh, const std::string& name);

// A COLLADA document (collada.cc).
Result<TriangleMesh> ReadCollada(std::string_view content, const std::string& path);

}  // namespace troupe
