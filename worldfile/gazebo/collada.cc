// The geometry of COLLADA 1.4 and 1.5: triangles, polylists and polygons of the geometries that the nodes of the scene
// place, in metres by the file's unit, with a file whose y axis is up turned about x, as Gazebo does.
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include "worldfile/gazebo/mesh.h"
#include "worldfile/text/xml_reader.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxPlacedNodes = 100'000;
constexpr int kMaxNodeDepth = 60;  // with the nodes that nodes refer to

// The numbers of a list; nothing if it has another word.
template <typename Number>
std::optional<std::vector<Number>> ListOf(std::string_view text) {
  std::vector<Number> numbers;
  for (std::size_t at = text.find_first_not_of(" \t\r\n"); at != std::string_view::npos;
       at = text.find_first_not_of(" \t\r\n", at)) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    Number number{};
    const std::from_chars_result read = std::from_chars(text.data() + at, text.data() + end, number);
    if (read.ec != std::errc() || read.ptr != text.data() + end) return std::nullopt;
    numbers.push_back(number);
    at = end;
  }
  return numbers;
}

// Of an element in the file: its line and column.
using Place = std::pair<int, int>;

Place PlaceOf(const XmlElement& element) {
  return {element.line, element.column};
}

struct Geometry {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

class ColladaReader {
 public:
  ColladaReader(const XmlElement& root, const std::string& path) : root_(root), path_(path) {}

  Result<TriangleMesh> Read() {
    if (root_.name != "COLLADA") {
      Fail(root_, "found the element " + Quoted(root_.name) + ", expected 'COLLADA'");
      return *error_;
    }
    IndexIds(root_);
    const XmlElement* const scenes = root_.Find("library_visual_scenes");
    const XmlElement* scene = scenes != nullptr ? scenes->Find("visual_scene") : nullptr;
    if (const XmlElement* const chosen = root_.Find("scene")) {
      const XmlElement* const instance = chosen->Find("instance_visual_scene");
      if (const XmlElement* const found = instance != nullptr ? Refer(*instance, "url") : nullptr) scene = found;
    }
    const Transform3 to_metres = Root();
    if (scene != nullptr) {
      for (const XmlElement& child : scene->children) {
        if (child.name == "node") PlaceNode(child, to_metres, 1);
      }
    } else if (const XmlElement* const library = root_.Find("library_geometries")) {
      for (const XmlElement& geometry : library->children) PlaceGeometry(geometry, to_metres, NameOf(geometry));
    }
    if (error_) return *error_;
    return std::move(mesh_);
  }

 private:
  void Fail(const XmlElement& element, const std::string& message) {
    if (!error_) error_ = Error{XmlPlace(element, path_), message};
  }

  void IndexIds(const XmlElement& element) {
    if (const std::string* const id = element.FindAttribute("id")) ids_.emplace(*id, &element);
    for (const XmlElement& child : element.children) IndexIds(child);
  }

  // The element that an attribute "#id" names; null if there is none.
  const XmlElement* Refer(const XmlElement& element, const char* attribute) const {
    const std::string* const text = element.FindAttribute(attribute);
    if (text == nullptr || !text->starts_with("#")) return nullptr;
    const auto found = ids_.find(text->substr(1));
    return found == ids_.end() ? nullptr : found->second;
  }

  static std::string NameOf(const XmlElement& element) {
    const std::string* name = element.FindAttribute("name");
    if (name == nullptr) name = element.FindAttribute("id");
    return name != nullptr ? *name : "";
  }

  // From the units and axes of the file.
  Transform3 Root() {
    double metre = 1.0;
    bool is_y_up = true;  // the default of COLLADA
    if (const XmlElement* const asset = root_.Find("asset")) {
      const XmlElement* const unit = asset->Find("unit");
      const std::string* const text = unit != nullptr ? unit->FindAttribute("meter") : nullptr;
      if (text != nullptr) {
        const std::optional<LeadingNumber> number = ReadLeadingNumber(*text);
        if (number && number->value > 0.0) {
          metre = number->value;
        } else {
          Fail(*unit, "found a unit of " + Quoted(*text) + " metres, expected a number above 0");
        }
      }
      const XmlElement* const up = asset->Find("up_axis");
      if (up != nullptr) is_y_up = up->Trimmed() == "Y_UP";
    }
    if (is_y_up) return Transform3::FromRows({Vec3{metre, 0, 0}, Vec3{0, 0, -metre}, Vec3{0, metre, 0}}, {});
    return Transform3::FromRows({Vec3{metre, 0, 0}, Vec3{0, metre, 0}, Vec3{0, 0, metre}}, {});
  }

  // One of the transforms of a node; nothing for another element.
  std::optional<Transform3> Step(const XmlElement& element) {
    const bool is_matrix = element.name == "matrix";
    const bool is_rotate = element.name == "rotate";
    const bool is_translate = element.name == "translate";
    if (!is_matrix && !is_rotate && !is_translate && element.name != "scale") return std::nullopt;
    const std::optional<std::vector<double>> n = ListOf<double>(element.text);
    const std::size_t count = is_matrix ? 16 : is_rotate ? 4 : 3;
    if (!n || n->size() != count) {
      Fail(element, "found a " + Quoted(element.name) + " without its numbers, expected " + std::to_string(count));
      return std::nullopt;
    }
    const std::vector<double>& v = *n;
    if (is_matrix) {
      return Transform3::FromRows({Vec3{v[0], v[1], v[2]}, Vec3{v[4], v[5], v[6]}, Vec3{v[8], v[9], v[10]}},
                                  {v[3], v[7], v[11]});
    }
    if (is_translate) return Transform3::FromRpy({v[0], v[1], v[2]}, 0, 0, 0);
    if (is_rotate) {
      const double length = Length({v[0], v[1], v[2]});
      if (!(length > 0.0)) return Transform3();
      const SinCosResult half = SinCos(0.5 * DegreesToRadians(v[3]));
      return Transform3::FromQuaternion({}, v[0] / length * half.sin, v[1] / length * half.sin,
                                        v[2] / length * half.sin, half.cos);
    }
    return Transform3::FromRows({Vec3{v[0], 0, 0}, Vec3{0, v[1], 0}, Vec3{0, 0, v[2]}}, {});
  }

  void PlaceNode(const XmlElement& node, Transform3 T, int depth) {
    if (depth > kMaxNodeDepth || ++placed_ > kMaxPlacedNodes) {
      Fail(node, "found too many nodes inside each other, or placed again, expected fewer");
    }
    if (error_) return;
    for (const XmlElement& child : node.children) {
      if (const std::optional<Transform3> step = Step(child)) T = T * *step;
    }
    for (const XmlElement& child : node.children) {
      if (error_) return;
      if (child.name == "node") {
        PlaceNode(child, T, depth + 1);
      } else if (child.name == "instance_node") {
        if (const XmlElement* const other = Refer(child, "url")) PlaceNode(*other, T, depth + 1);
      } else if (child.name == "instance_geometry") {
        if (const XmlElement* const geometry = Refer(child, "url")) PlaceGeometry(*geometry, T, NameOf(node));
      }
    }
  }

  void PlaceGeometry(const XmlElement& element, const Transform3& T, const std::string& name) {
    const XmlElement* const mesh = element.Find("mesh");
    if (mesh == nullptr || error_) return;
    const auto [entry, is_new] = geometries_.try_emplace(PlaceOf(*mesh));
    if (is_new) entry->second = ReadGeometry(*mesh);
    const Geometry& geometry = entry->second;
    if (mesh_.triangles.size() + geometry.triangles.size() > kMaxMeshTriangles) {
      Fail(element, "found more than " + std::to_string(kMaxMeshTriangles) + " triangles, expected fewer");
    }
    if (error_) return;
    mesh_.parts.push_back({name, mesh_.triangles.size()});
    const auto first = static_cast<std::uint32_t>(mesh_.points.size());
    for (const Vec3& point : geometry.points) {
      mesh_.points.push_back(T * point);
      if (!IsFinite(mesh_.points.back())) Fail(element, "found a point that is no number, expected finite ones");
    }
    for (const auto& t : geometry.triangles) mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }

  // The points of a `source` of positions.
  std::vector<Vec3> ReadPoints(const XmlElement& source) {
    const XmlElement* const array = source.Find("float_array");
    if (array == nullptr) return {};
    const std::optional<std::vector<double>> numbers = ListOf<double>(array->text);
    if (!numbers) {
      Fail(*array, "found a list with a word that is no number, expected numbers");
      return {};
    }
    std::size_t stride = 3;
    const XmlElement* const technique = source.Find("technique_common");
    const XmlElement* const accessor = technique != nullptr ? technique->Find("accessor") : nullptr;
    const std::string* const text = accessor != nullptr ? accessor->FindAttribute("stride") : nullptr;
    const std::optional<LeadingNumber> found = text != nullptr ? ReadLeadingNumber(*text) : std::nullopt;
    if (found && found->value >= 3.0 && found->value <= 64.0) stride = static_cast<std::size_t>(found->value);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i + 3 <= numbers->size(); i += stride) {
      points.push_back({(*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]});
    }
    return points;
  }

  Geometry ReadGeometry(const XmlElement& mesh) {
    Geometry geometry;
    std::map<Place, std::uint32_t> firsts;  // by source, its first point
    for (const XmlElement& primitive : mesh.children) {
      const bool is_polylist = primitive.name == "polylist";
      const bool is_fan = primitive.name == "polygons" || primitive.name == "trifans";
      const bool is_strip = primitive.name == "tristrips";
      if (primitive.name != "triangles" && !is_polylist && !is_fan && !is_strip) continue;
      std::size_t stride = 1;
      std::size_t offset = 0;
      const XmlElement* source = nullptr;
      for (const XmlElement& input : primitive.children) {
        if (input.name != "input") continue;
        const std::string* const text = input.FindAttribute("offset");
        const std::optional<LeadingNumber> number = text != nullptr ? ReadLeadingNumber(*text) : std::nullopt;
        const std::size_t own =
            number && number->value >= 0.0 && number->value < 64.0 ? static_cast<std::size_t>(number->value) : 0;
        stride = std::max(stride, own + 1);
        const std::string* const semantic = input.FindAttribute("semantic");
        if (semantic == nullptr || *semantic != "VERTEX") continue;
        offset = own;
        const XmlElement* const vertices = Refer(input, "source");
        if (vertices == nullptr) continue;
        for (const XmlElement& of_vertices : vertices->children) {
          const std::string* const meaning = of_vertices.FindAttribute("semantic");
          if (meaning != nullptr && *meaning == "POSITION") source = Refer(of_vertices, "source");
        }
      }
      if (source == nullptr) {
        Fail(primitive, "found " + Quoted(primitive.name) + " without an input of positions, expected one");
        return geometry;
      }
      const auto [first, is_new] = firsts.emplace(PlaceOf(*source), static_cast<std::uint32_t>(geometry.points.size()));
      if (is_new) {
        const std::vector<Vec3> points = ReadPoints(*source);
        geometry.points.insert(geometry.points.end(), points.begin(), points.end());
      }
      std::optional<std::vector<std::uint64_t>> counts;
      if (const XmlElement* const vcount = is_polylist ? primitive.Find("vcount") : nullptr) {
        counts = ListOf<std::uint64_t>(vcount->text);
      }
      for (const XmlElement& p : primitive.children) {
        if (p.name != "p" || error_) continue;
        const std::optional<std::vector<std::uint64_t>> list = ListOf<std::uint64_t>(p.text);
        if (!list) {
          Fail(p, "found a list with a word that is no index, expected indices");
          return geometry;
        }
        std::vector<std::uint64_t> corners;
        for (std::size_t i = offset; i < list->size(); i += stride) corners.push_back(first->second + (*list)[i]);
        AddFaces(p, corners, counts, is_fan, is_strip, geometry);
      }
    }
    return geometry;
  }

  void AddFaces(const XmlElement& p, const std::vector<std::uint64_t>& corners,
                const std::optional<std::vector<std::uint64_t>>& counts, bool is_fan, bool is_strip,
                Geometry& geometry) {
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      const std::uint64_t most = std::max({corners[a], corners[b], corners[c]});
      if (most >= geometry.points.size()) {
        Fail(p, "found the index " + std::to_string(most) + " of a point, expected one of " +
                    CountText(geometry.points.size(), "point"));
      } else if (geometry.triangles.size() >= kMaxMeshTriangles) {
        Fail(p, "found more than " + std::to_string(kMaxMeshTriangles) + " triangles, expected fewer");
      } else {
        geometry.triangles.push_back({static_cast<std::uint32_t>(corners[a]), static_cast<std::uint32_t>(corners[b]),
                                      static_cast<std::uint32_t>(corners[c])});
      }
    };
    const auto add_fan = [&](std::size_t begin, std::size_t count) {
      for (std::size_t i = 2; i < count && !error_; ++i) add(begin, begin + i - 1, begin + i);
    };
    if (is_fan) {
      add_fan(0, corners.size());
    } else if (is_strip) {
      for (std::size_t i = 2; i < corners.size() && !error_; ++i) add(i - 2, i - 1, i);
    } else if (counts) {
      std::size_t begin = 0;
      for (const std::uint64_t count : *counts) {
        if (count > corners.size() - begin) {
          Fail(p, "found fewer corners than 'vcount' says, expected all of them");
          return;
        }
        add_fan(begin, count);
        begin += count;
      }
    } else {
      for (std::size_t i = 0; i + 3 <= corners.size() && !error_; i += 3) add(i, i + 1, i + 2);
    }
  }

  const XmlElement& root_;
  const std::string& path_;
  std::map<std::string, const XmlElement*> ids_;
  std::map<Place, Geometry> geometries_;  // by mesh
  std::size_t placed_ = 0;
  TriangleMesh mesh_;
  std::optional<Error> error_;
};

}  // namespace

Result<TriangleMesh> ReadCollada(std::string_view content, const std::string& path) {
  const Result<XmlElement> root = ParseXml(content, path);
  if (!root.ok()) return root.error();
  return ColladaReader(root.value(), path).Read();
}

}  // namespace troupe
