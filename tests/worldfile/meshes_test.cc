// Meshes of SDF worlds: STL, OBJ and COLLADA to blocks.
#include <cstring>

#include "tests/worldfile/gazebo_files.h"
#include "worldfile/gazebo/mesh.h"

namespace troupe {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::SizeIs;

struct BoxMesh {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<int, 3>> triangles;
};

// A box, facing outwards.
void AddBox(const std::array<double, 3>& low, const std::array<double, 3>& high, BoxMesh& mesh) {
  const int first = static_cast<int>(mesh.points.size());
  for (int i = 0; i < 8; ++i) {
    mesh.points.push_back(
        {(i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1], (i & 4) != 0 ? high[2] : low[2]});
  }
  for (const auto& t : std::vector<std::array<int, 3>>{{0, 2, 1},
                                                       {1, 2, 3},
                                                       {4, 5, 6},
                                                       {5, 7, 6},
                                                       {0, 1, 4},
                                                       {1, 5, 4},
                                                       {2, 6, 3},
                                                       {3, 6, 7},
                                                       {0, 4, 2},
                                                       {2, 4, 6},
                                                       {1, 3, 5},
                                                       {3, 7, 5}}) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

std::string ObjText(const BoxMesh& mesh) {
  std::string text = "# boxes\no boxes\n";
  for (const auto& p : mesh.points) {
    text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  }
  for (const auto& t : mesh.triangles) {
    text += "f " + std::to_string(t[0] + 1) + "//1 " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  }
  return text;
}

std::string StlBytes(const BoxMesh& mesh) {
  std::string bytes("solid, but binary");
  bytes.resize(80, ' ');
  const auto append = [&bytes](const void* value, std::size_t size) {
    bytes.append(static_cast<const char*>(value), size);
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, 4);
  for (const auto& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (const int corner : t) {
      for (const double value : mesh.points[static_cast<std::size_t>(corner)]) {
        const auto single = static_cast<float>(value);
        append(&single, 4);
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

// Two walls of centimetres, y up, placed by nodes.
const char* const kCollada = R"(<COLLADA><asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="24">0 0 0 100 0 0 0 10 0 100 10 0 0 0 10 100 0 10 0 10 10 100 10 10</float_array>
<technique_common><accessor source="#a" count="8" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#p" offset="1"/>
<vcount>4 4 4 4 4 4</vcount><p>0 0 2 0 3 0 1 0  4 0 5 0 7 0 6 0  0 0 1 0 5 0 4 0  2 0 6 0 7 0 3 0  0 0 4 0 6 0 2 0  1 0 3 0 7 0 5 0</p>
</polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>200 0 0</translate><instance_geometry url="#g"/></node>
<node><matrix>1 0 0 0 0 1 0 50 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

class Meshes : public testing::Test {
 protected:
  LoadedWorld Load(const std::string& file, const std::string& more = "") {
    folder_.Write("w.sdf",
                  SdfWorldText(SdfModelText("m", "0 0 0 0 0 0", "<mesh><uri>" + file + "</uri>" + more + "</mesh>")));
    return folder_.Load("w.sdf");
  }

  WorldFolder folder_;
};

TEST_F(Meshes, ClosedConvexPartsAreExact) {
  BoxMesh mesh;
  AddBox({0, 0, 0}, {1, 2, 1}, mesh);
  AddBox({3, 0, 0.5}, {4, 1, 2}, mesh);
  folder_.Write("a.obj", ObjText(mesh));
  folder_.Write("a.stl", StlBytes(mesh));
  for (const char* file : {"a.obj", "a.stl"}) {
    const LoadedWorld loaded = Load(file);
    EXPECT_TRUE(loaded.warnings.empty());
    ExpectExtent(ExtentOf(loaded.world, "m"), {0, 0, 4, 2}, {0, 2});
    EXPECT_EQ(ExtentOf(loaded.world, "m").blocks, 2U);
  }
  ExpectExtent(ExtentOf(Load("a.stl", "<scale>0.5 0.5 -1</scale>").world, "m"), {0, 0, 2, 1}, {-2, 0});
}

TEST_F(Meshes, ColladaHasUnitsAxesAndNodes) {
  folder_.Write("a.dae", kCollada);
  const LoadedWorld loaded = Load("a.dae");
  EXPECT_TRUE(loaded.warnings.empty());
  // y of the file is up: the second wall is half a metre above the first.
  ExpectExtent(ExtentOf(loaded.world, "m"), {0, -0.1, 3, 0}, {0, 0.6});
  EXPECT_EQ(ExtentOf(loaded.world, "m").blocks, 2U);
}

// Four walls of one piece around a room: a ring, whose hull would fill the room.
TEST_F(Meshes, ARoomOfOnePieceIsFreeInside) {
  BoxMesh mesh;
  AddBox({-2, -2, 0}, {2, 2, 1}, mesh);
  AddBox({-1.8, -1.8, 0}, {1.8, 1.8, 1}, mesh);
  // The inner box faces inwards, and shares its top and bottom with the outer one as rings.
  for (std::size_t i = 12; i < 24; ++i) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  BoxMesh ring;
  ring.points = mesh.points;
  for (const std::size_t box : {0U, 12U}) {
    for (std::size_t i = 4; i < 12; ++i) ring.triangles.push_back(mesh.triangles[box + i]);
  }
  const auto quad = [&](int a, int b, int c, int d) {
    ring.triangles.push_back({a, b, c});
    ring.triangles.push_back({a, c, d});
  };
  for (const auto& [a, b] : std::vector<std::pair<int, int>>{{0, 1}, {1, 3}, {3, 2}, {2, 0}}) {
    quad(a + 8, b + 8, b, a);
    quad(a + 4, b + 4, b + 12, a + 12);
  }
  folder_.Write("room.obj", ObjText(ring));
  const LoadedWorld loaded = Load("room.obj");
  ExpectExtent(ExtentOf(loaded.world, "m"), {-2, -2, 2, 2}, {0, 1}, 0.021);
  const std::vector<Block>& blocks = loaded.world.shape(loaded.world.models[0].shape).blocks;
  EXPECT_LT(blocks.size(), 10U);
  const auto is_inside = [&](const Vec2& p) {
    return std::any_of(blocks.begin(), blocks.end(),
                       [&](const Block& block) { return troupe::Contains(block.outline, p); });
  };
  EXPECT_FALSE(is_inside({0, 0}));
  EXPECT_FALSE(is_inside({1.77, 0}));
  EXPECT_TRUE(is_inside({1.9, 0.3}));
  EXPECT_TRUE(is_inside({-1.9, -1.9}));
}

TEST_F(Meshes, AnOpenSurfaceIsAShellWithAWarning) {
  BoxMesh mesh;
  AddBox({0, 0, 0}, {1, 1, 1}, mesh);
  mesh.triangles.resize(10);  // one side is missing
  folder_.Write("open.obj", ObjText(mesh));
  const LoadedWorld loaded = Load("open.obj");
  ASSERT_THAT(loaded.warnings, SizeIs(1));
  EXPECT_THAT(loaded.warnings[0].message, HasSubstr("whose surface is not closed"));
  const std::vector<Block>& blocks = loaded.world.shape(loaded.world.models[0].shape).blocks;
  EXPECT_FALSE(std::any_of(blocks.begin(), blocks.end(),
                           [](const Block& block) { return troupe::Contains(block.outline, Vec2(0.5, 0.5)); }));
}

TEST_F(Meshes, APartIsChosenByItsName) {
  BoxMesh first;
  AddBox({0, 0, 0}, {1, 1, 1}, first);
  BoxMesh both = first;
  AddBox({5, 0, 0}, {6, 1, 1}, both);
  const std::string text = ObjText(both);
  const std::size_t middle = text.find("f 9");
  folder_.Write("two.obj", text.substr(0, middle) + "o second\n" + text.substr(middle));
  ExpectExtent(ExtentOf(Load("two.obj", "<submesh><name>second</name></submesh>").world, "m"), {5, 0, 6, 1}, {0, 1});
  ExpectExtent(ExtentOf(Load("two.obj", "<submesh><name>second</name><center>1</center></submesh>").world, "m"),
               {-0.5, -0.5, 0.5, 0.5}, {-0.5, 0.5});
}

struct BadMesh {
  std::string file;
  std::string text;
  std::string message;
};

const BadMesh kBadMeshes[] = {
    {"a.stl", "short", "a.stl: error: found 5 bytes, expected an STL file"},
    {"a.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop",
     "a.stl:4:1: error: found '', expected three numbers"},
    {"a.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\nendloop",
     "a.stl:4:1: error: found 'inf', expected three numbers"},
    {"a.obj", "v 1 2 x\n", "a.obj:1:1: error: found 'x', expected three numbers"},
    {"a.obj", "v 1 2 3\nf 0 1 1\n", "a.obj:2:1: error: found the corner '0', expected one of the 1 point so far"},
    {"a.dae", "<COLLADA>\n<asset><unit meter=\"0\"/></asset></COLLADA>",
     "a.dae:2:8: error: found a unit of '0' metres, expected a number above 0"},
    {"a.dae", "<x/>", "a.dae:1:1: error: found the element 'x', expected 'COLLADA'"},
};

TEST(ReadMesh, RefusesDamagedFiles) {
  for (const BadMesh& bad : kBadMeshes) {
    const Result<TriangleMesh> read = ReadMesh(bad.text, bad.file);
    ASSERT_FALSE(read.ok()) << bad.text;
    EXPECT_EQ(read.error().ToString(), bad.message);
  }
}

TEST(ReadMesh, LimitsTriangles) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string face = "f";
  // One polygon of many corners stands for as many triangles.
  for (std::size_t i = 0; i < kMaxMeshTriangles + 3; ++i) face += " 1";
  const Result<TriangleMesh> read = ReadMesh(text + face, "a.obj");
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().ToString(), HasSubstr("a.obj:4:1: error: found more than 2000000 triangles"));
}

TEST(ReadMesh, ColladaNodesThatReferToThemselvesEnd) {
  const Result<TriangleMesh> read = ReadMesh(
      "<COLLADA><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><instance_node url=\"#n\"/><instance_node "
      "url=\"#n\"/></node></visual_scene></library_visual_scenes></COLLADA>",
      "a.dae");
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().message, HasSubstr("too many nodes"));
}

}  // namespace
}  // namespace troupe
