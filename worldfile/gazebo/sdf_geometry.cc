// The geometries of SDF and URDF.
#include <algorithm>
#include <utility>

#include "worldfile/gazebo/sdf_file.h"
#include "worldfile/gazebo/xml_values.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxOutline = 1'000;  // corners

// A number or numbers in a child, as in SDF, or in an attribute, as in URDF.
std::vector<double> EitherNumbers(const XmlValues& values, const XmlElement& shape, std::string_view name,
                                  const std::vector<double>& otherwise) {
  if (const XmlElement* const child = shape.Find(name)) return values.Numbers(*child, otherwise);
  return values.AttributeNumbers(shape, name, otherwise);
}

Vec3 PositiveSize(const XmlValues& values, const XmlElement& shape, std::string_view name) {
  const std::vector<double> n = EitherNumbers(values, shape, name, {1, 1, 1});
  if (!(std::min({n[0], n[1], n[2]}) > 0.0) && !values.diagnostics().failed()) {
    values.Fail(shape, "found a " + Quoted(shape.name) + " of " + NumberText(n[0]) + " x " + NumberText(n[1]) + " x " +
                           NumberText(n[2]) + ", expected lengths above 0");
  }
  return {n[0], n[1], n[2]};
}

void ReadPolylines(const XmlValues& values, const XmlElement& geometry, std::vector<SolidShape>& solids) {
  std::size_t count = 0;
  for (const XmlElement& polyline : geometry.children) {
    if (polyline.name != "polyline") continue;
    SolidShape solid;
    solid.kind = SolidShape::Kind::kPrism;
    solid.length = values.Size(polyline, "height", 1.0);
    for (const XmlElement& point : polyline.children) {
      if (point.name != "point") continue;
      const std::vector<double> n = values.Numbers(point, {0, 0});
      solid.outline.emplace_back(n[0], n[1]);
    }
    if (solid.outline.size() > 1 && solid.outline.front() == solid.outline.back()) solid.outline.pop_back();
    if (solid.outline.size() > kMaxOutline) {
      values.Fail(polyline, "found an outline of " + std::to_string(solid.outline.size()) +
                                " points, expected at most " + std::to_string(kMaxOutline));
    }
    if (solid.outline.size() < 3) {
      values.Warn(polyline, "found an outline of " + CountText(solid.outline.size(), "point") +
                                ", expected at least three; it is left out");
      continue;
    }
    if (++count == 2) values.Warn(polyline, "outlines inside others are holes in Gazebo; here they are solid");
    solids.push_back(std::move(solid));
  }
}

void ReadMeshShape(const XmlValues& values, const XmlElement& mesh, ModelFiles& files,
                   std::vector<SolidShape>& solids) {
  const XmlElement* const element = mesh.Find("uri");
  const std::string uri = element != nullptr ? std::string(element->Trimmed()) : XmlValues::Attribute(mesh, "filename");
  const SourceLocation where = element != nullptr ? XmlTextPlace(*element, values.file()) : values.At(mesh);
  const Result<std::string> path = files.Find(uri, values.file(), where);
  if (!path.ok()) {
    values.diagnostics().Fail(path.error().where, path.error().message);
    return;
  }
  const Result<std::shared_ptr<const TriangleMesh>> read = files.ReadMesh(path.value(), where);
  if (!read.ok()) {
    values.diagnostics().Fail(read.error().where, read.error().message);
    return;
  }
  SolidShape solid;
  solid.kind = SolidShape::Kind::kMesh;
  solid.mesh = read.value();
  const std::vector<double> scale = EitherNumbers(values, mesh, "scale", {1, 1, 1});
  solid.size = {scale[0], scale[1], scale[2]};
  if (const XmlElement* const submesh = mesh.Find("submesh")) {
    const std::string name = XmlValues::Text(*submesh, "name");
    TriangleMesh part = PartOf(*solid.mesh, name);
    if (part.triangles.empty()) {
      values.Warn(*submesh,
                  "found no part " + Quoted(name) + " in " + QuotedPath(path.value()) + "; the whole is used");
    } else {
      if (XmlValues::Flag(*submesh, "center", false)) {
        Vec3 low = part.points[part.triangles.front()[0]];
        Vec3 high = low;
        for (const auto& t : part.triangles) {
          for (const std::uint32_t corner : t) {
            const Vec3& p = part.points[corner];
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
          }
        }
        for (Vec3& p : part.points) p = p - (low + high) * 0.5;
      }
      solid.mesh = std::make_shared<const TriangleMesh>(std::move(part));
    }
  }
  if (solid.mesh->triangles.empty()) {
    values.diagnostics().Warn(where, "found no triangles in " + QuotedPath(path.value()) + "; it is left out");
    return;
  }
  solids.push_back(std::move(solid));
}

}  // namespace

std::vector<SolidShape> ReadGeometry(const XmlElement& geometry, const std::string& file, ModelFiles& files,
                                     Diagnostics& diagnostics) {
  const XmlValues values(file, diagnostics);
  std::vector<SolidShape> solids;
  bool has_polylines = false;
  for (const XmlElement& shape : geometry.children) {
    if (diagnostics.failed()) return {};
    SolidShape solid;
    if (shape.name == "box") {
      solid.kind = SolidShape::Kind::kBox;
      solid.size = PositiveSize(values, shape, "size");
    } else if (shape.name == "cylinder" || shape.name == "capsule" || shape.name == "cone") {
      solid.kind = shape.name == "cylinder"  ? SolidShape::Kind::kCylinder
                   : shape.name == "capsule" ? SolidShape::Kind::kCapsule
                                             : SolidShape::Kind::kCone;
      solid.radius = values.Size(shape, "radius", 0.5);
      solid.length = values.Size(shape, "length", 1.0);
    } else if (shape.name == "sphere") {
      solid.kind = SolidShape::Kind::kSphere;
      solid.radius = values.Size(shape, "radius", 1.0);
    } else if (shape.name == "ellipsoid") {
      solid.kind = SolidShape::Kind::kEllipsoid;
      solid.size = PositiveSize(values, shape, "radii");
    } else if (shape.name == "mesh") {
      ReadMeshShape(values, shape, files, solids);
      continue;
    } else if (shape.name == "polyline") {
      if (!std::exchange(has_polylines, true)) ReadPolylines(values, geometry, solids);
      continue;
    } else if (shape.name == "heightmap" || shape.name == "image") {
      values.Warn(shape, "a " + Quoted(shape.name) + " is left out: robots drive on planes");
      continue;
    } else {
      continue;  // a plane is the ground, and "empty" is nothing
    }
    solids.push_back(std::move(solid));
  }
  return diagnostics.failed() ? std::vector<SolidShape>() : solids;
}

}  // namespace troupe
