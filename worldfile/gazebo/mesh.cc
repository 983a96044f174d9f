#include "worldfile/gazebo/mesh.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kStlHeader = 84;    // bytes: a text of 80, and the number of triangles
constexpr std::size_t kStlTriangle = 50;  // bytes: normal, three corners, an attribute

Error TooManyTriangles(const std::string& path, int line = 0) {
  return {{path, line, line > 0 ? 1 : 0},
          "found more than " + std::to_string(kMaxMeshTriangles) + " triangles, expected fewer"};
}

std::uint32_t LittleEndian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

Result<TriangleMesh> ReadBinaryStl(std::string_view content, const std::string& path) {
  const std::size_t count = LittleEndian(content.data() + 80);
  if (count > kMaxMeshTriangles) return TooManyTriangles(path);
  TriangleMesh mesh;
  mesh.points.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* const corners = content.data() + kStlHeader + i * kStlTriangle + 12;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = [&](std::size_t axis) {
        return static_cast<double>(std::bit_cast<float>(LittleEndian(corners + 12 * k + 4 * axis)));
      };
      const Vec3 p{number(0), number(1), number(2)};
      if (!IsFinite(p)) {
        return Error{{path}, "found a corner of triangle " + std::to_string(i) + " that is no number, expected one"};
      }
      triangle[k] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(p);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// The words of a text of lines, with the number of the line.
class LineWords {
 public:
  explicit LineWords(std::string_view text) : text_(text) {}

  // False at the end of the text.
  bool NextLine() {
    if (at_ > text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    at_ = end + 1;
    ++number_;
    return true;
  }
  // The next word of the line; empty at its end.
  std::string_view Next() {
    const std::size_t begin = line_.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    line_.remove_prefix(begin);
    const std::string_view word = line_.substr(0, line_.find_first_of(" \t"));
    line_.remove_prefix(word.size());
    return word;
  }
  // What is left of the line.
  std::string_view Rest() const {
    const std::size_t begin = line_.find_first_not_of(" \t");
    return begin == std::string_view::npos ? std::string_view() : line_.substr(begin);
  }
  int number() const { return number_; }

 private:
  std::string_view text_;
  std::string_view line_;
  std::size_t at_ = 0;
  int number_ = 0;
};

// Three numbers of a line.
Result<Vec3> ReadPoint(LineWords& words, const std::string& path) {
  double numbers[3] = {};
  for (double& number : numbers) {
    const std::string_view word = words.Next();
    const std::optional<LeadingNumber> read = ReadLeadingNumber(word);
    if (!read || !read->is_all) {
      return Error{{path, words.number(), 1}, "found " + Quoted(word) + ", expected three numbers"};
    }
    number = read->value;
  }
  return Vec3{numbers[0], numbers[1], numbers[2]};
}

Result<TriangleMesh> ReadTextStl(std::string_view content, const std::string& path) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> corners;
  for (LineWords words(content); words.NextLine();) {
    const std::string_view word = words.Next();
    if (word == "vertex") {
      const Result<Vec3> point = ReadPoint(words, path);
      if (!point.ok()) return point.error();
      corners.push_back(static_cast<std::uint32_t>(mesh.points.size()));
      mesh.points.push_back(point.value());
    } else if (word == "endloop") {
      if (corners.size() != 3) {
        return Error{{path, words.number(), 1},
                     "found " + CountText(corners.size(), "corner") + " in a loop, expected three"};
      }
      if (mesh.triangles.size() == kMaxMeshTriangles) return TooManyTriangles(path, words.number());
      mesh.triangles.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (corners.size() > 3) {
      return Error{{path, words.number(), 1}, "found more than three corners in a loop, expected three"};
    }
  }
  return mesh;
}

// By its size: the text of the header of a binary file may begin with "solid", too.
Result<TriangleMesh> ReadStl(std::string_view content, const std::string& path) {
  const bool has_header = content.size() >= kStlHeader;
  const bool is_binary =
      has_header && content.size() >= kStlHeader + kStlTriangle * std::size_t{LittleEndian(content.data() + 80)};
  const std::size_t begin = content.find_first_not_of(" \t\r\n");
  const bool is_text = begin != std::string_view::npos && content.substr(begin).starts_with("solid") &&
                       content.find("facet") != std::string_view::npos;
  if (is_text && content.find('\0') == std::string_view::npos) return ReadTextStl(content, path);
  if (is_binary) return ReadBinaryStl(content, path);
  if (has_header) {
    return Error{{path},
                 "found " + CountText(content.size(), "byte") + " for " +
                     CountText(LittleEndian(content.data() + 80), "triangle") +
                     ", expected an STL file: 84 bytes and 50 for each triangle, or a text"};
  }
  return Error{{path}, "found " + CountText(content.size(), "byte") + ", expected an STL file"};
}

// The index of a point in "7", "7/1/2" or "-1/..": from 1, or from the end.
std::optional<std::uint32_t> ObjIndex(std::string_view word, std::size_t points) {
  word = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  const std::from_chars_result read = std::from_chars(word.data(), word.data() + word.size(), index);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size()) return std::nullopt;
  const auto count = static_cast<std::int64_t>(points);
  if (index < 0) index += count + 1;
  if (index < 1 || index > count) return std::nullopt;
  return static_cast<std::uint32_t>(index - 1);
}

Result<TriangleMesh> ReadObj(std::string_view content, const std::string& path) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> corners;
  for (LineWords words(content); words.NextLine();) {
    const std::string_view word = words.Next();
    if (word == "v") {
      const Result<Vec3> point = ReadPoint(words, path);
      if (!point.ok()) return point.error();
      mesh.points.push_back(point.value());
    } else if (word == "o" || word == "g") {
      mesh.parts.push_back({std::string(words.Rest()), mesh.triangles.size()});
    } else if (word == "f") {
      corners.clear();
      for (std::string_view corner = words.Next(); !corner.empty(); corner = words.Next()) {
        const std::optional<std::uint32_t> index = ObjIndex(corner, mesh.points.size());
        if (!index) {
          return Error{{path, words.number(), 1},
                       "found the corner " + Quoted(corner) + ", expected one of the " +
                           CountText(mesh.points.size(), "point") + " so far"};
        }
        corners.push_back(*index);
      }
      for (std::size_t i = 2; i < corners.size(); ++i) {
        if (mesh.triangles.size() == kMaxMeshTriangles) return TooManyTriangles(path, words.number());
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
      }
    }
  }
  return mesh;
}

}  // namespace

Result<TriangleMesh> ReadMesh(std::string_view content, const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (ending == ".stl") return ReadStl(content, path);
  if (ending == ".obj") return ReadObj(content, path);
  if (ending == ".dae") return ReadCollada(content, path);
  return Error{{path}, "found a mesh that ends in " + Quoted(ending) + ", expected .stl, .obj or .dae"};
}

TriangleMesh PartOf(const TriangleMesh& mesh, const std::string& name) {
  TriangleMesh part;
  part.points = mesh.points;
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    if (mesh.parts[i].name != name) continue;
    const std::size_t end = i + 1 < mesh.parts.size() ? mesh.parts[i + 1].first : mesh.triangles.size();
    part.triangles.insert(part.triangles.end(),
                          mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.parts[i].first),
                          mesh.triangles.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return part;
}

}  // namespace troupe
