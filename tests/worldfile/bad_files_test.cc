// Files of others that are damaged or hostile: each kind ends in one error with its file and line, within the limits of
// docs/world-files.md.
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/worldfile/gazebo_files.h"
#include "worldfile/plans/floor_plan.h"

namespace troupe {
namespace {

using testing::HasSubstr;

constexpr const char* kEntity = "<!DOCTYPE a [<!ENTITY b 'x'><!ENTITY c '&b;&b;&b;&b;'>]>\n";

struct BadFile {
  std::string name;
  std::string text;
  std::string message;
};

std::string WithMesh(const std::string& file) {
  return SdfWorldText(SdfModelText("m", "0 0 0 0 0 0", "<mesh><uri>" + file + "</uri></mesh>"));
}

std::string Collada(const std::string& points, const std::string& indices) {
  return "<COLLADA>\n<library_geometries><geometry id='g'><mesh><source id='p'>\n<float_array id='f' count='9'>" +
         points +
         "</float_array></source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles "
         "count='1'><input semantic='VERTEX' source='#v' offset='0'/>\n<p>" +
         indices +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='s'><node>"
         "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes></COLLADA>";
}

class BadFiles : public testing::Test {
 protected:
  WorldFolder folder_;
};

TEST_F(BadFiles, OfWorldsRobotsAndGraphsAreErrorsWithTheirPlaces) {
  folder_.Write("loop_b.sdf", "<sdf><model name='b'>\n<include><uri>loop_c.sdf</uri></include></model></sdf>");
  folder_.Write("loop_c.sdf", "<sdf><model name='c'>\n\n<include><uri>loop_b.sdf</uri></include></model></sdf>");
  const std::string robot = "<robot name='r' xmlns:xacro='x'>\n";
  const BadFile bad[] = {
      {"a.sdf", kEntity + SdfWorldText(""), "a.sdf:1:14: error: found a declaration of an entity, expected none"},
      {"a.urdf", kEntity + robot + "</robot>", "a.urdf:1:14: error: found a declaration of an entity, expected none"},
      {"a.sdf", SdfWorldText("<include><uri>loop_b.sdf</uri></include>"),
       "loop_c.sdf:3:15: error: found an include of 'loop_b.sdf' inside itself, expected no include loop"},
      {"a.sdf", SdfWorldText("<model name='m'>\n<pose>nan 0 0 0 0 0</pose></model>"),
       "a.sdf:5:7: error: found 'nan' in 'pose', expected a number"},
      {"a.urdf",
       robot + "<link name='b'><collision><origin xyz='0 nan 0'/><geometry><box size='1 1 "
               "1'/></geometry></collision></link></robot>",
       "a.urdf:2:35: error: found 'nan' in 'xyz', expected a number"},
      {"a.xacro", robot + "<xacro:include filename='a.xacro'/></robot>",
       "a.xacro:2:1: error: found macros or includes too deep inside each other, expected fewer"},
      {"a.xacro", robot + "<xacro:macro name='m'><xacro:m/></xacro:macro>\n<xacro:m/></robot>",
       "a.xacro:2:23: error: found macros or includes too deep inside each other, expected fewer"},
      {"a.geojson",
       "{\"type\": \"FeatureCollection\", \"features\": [\n{\"type\": \"Feature\", \"properties\": {\"id\": 1}, "
       "\"geometry\": {\"type\": \"Point\", \"coordinates\": [NaN, 0]}}]}",
       "a.geojson:2:92: error: not valid JSON"},
      {"a.geojson", std::string(100'000, '['), "a.geojson:1:65: error: found deeper nesting, expected at most 64"},
  };
  for (const BadFile& file : bad) {
    folder_.Write(file.name, file.text);
    EXPECT_THAT(folder_.ErrorOf(file.name), HasSubstr(file.message)) << file.text.substr(0, 200);
  }
}

TEST_F(BadFiles, OfMeshesAreErrorsWithTheirPlaces) {
  std::string nan(84 + 50, '\0');
  nan[80] = 1;
  nan[84 + 12 + 2] = '\xc0';  // of the first corner: 0x7fc00000, no number
  nan[84 + 12 + 3] = '\x7f';
  const BadFile bad[] = {
      {"a.stl", nan, "a.stl: error: found a corner of triangle 0 that is no number, expected one"},
      {"a.stl", "solid s\nfacet\nouter loop\nvertex 0 0 nan\nendloop\nendfacet\n",
       "a.stl:4:1: error: found 'nan', expected three numbers"},
      {"a.obj", "v 0 0 0\nv 1 nan 0\nf 1 2 1\n", "a.obj:2:1: error: found 'nan', expected three numbers"},
      {"a.dae", Collada("0 0 0 1 0 0 0 nan 0", "0 1 2"), "a.dae:2:21: error: found a point that is no number"},
      {"a.dae", Collada("0 0 0 1 0 0 0 1 0", "0 1 7"), "a.dae:4:1: error: found the index 7 of a point"},
      {"a.dae", kEntity + Collada("0 0 0 1 0 0 0 1 0", "0 1 2"), "a.dae:1:14: error: found a declaration of an entity"},
  };
  for (const BadFile& file : bad) {
    folder_.Write(file.name, file.text);
    folder_.Write("w.sdf", WithMesh(file.name));
    EXPECT_THAT(folder_.ErrorOf("w.sdf"), HasSubstr(file.message)) << file.name;
  }
}

// The file of ten million triangles has holes on the disk, so that it needs no half of a gigabyte.
TEST_F(BadFiles, OfTenMillionTrianglesAreAnErrorWithoutBeingRead) {
  std::string header(84, '\0');
  header[80] = '\x80';
  header[81] = '\x96';
  header[82] = '\x98';
  folder_.Write("many.stl", header);
  std::filesystem::resize_file(folder_.Path("many.stl"), 84 + 50 * 10'000'000ULL);
  folder_.Write("w.sdf", WithMesh("many.stl"));
  EXPECT_THAT(folder_.ErrorOf("w.sdf"),
              HasSubstr("error: found 500000084 bytes in 'many.stl', expected at most 64000000"));
}

TEST(BadPlans, AreErrorsWithTheirPlaces) {
  const std::string nan = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\nnan\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n";
  EXPECT_THAT(ReadDxfPlan(nan, "a.dxf", 1.0).error().ToString(),
              HasSubstr("a.dxf:10:1: error: found 'nan', expected a number"));
  const std::string loop =
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\na\n0\nINSERT\n2\na\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT"
      "\n2\n"
      "a\n0\nENDSEC\n0\nEOF\n";
  EXPECT_THAT(ReadDxfPlan(loop, "a.dxf", 1.0).error().ToString(),
              HasSubstr("error: found blocks more than 16 deep, or a block in itself, expected fewer"));
  EXPECT_THAT(ReadSvgPlan(kEntity + std::string("<svg/>"), "a.svg", 1.0).error().ToString(),
              HasSubstr("a.svg:1:14: error: found a declaration of an entity"));
  EXPECT_THAT(ReadSvgPlan("<svg>\n<line x1='nan' y1='0' x2='1' y2='1'/></svg>", "a.svg", 1.0).error().ToString(),
              HasSubstr("a.svg:2:7: error: found 'nan' for 'x1', expected a number without a unit"));
}

}  // namespace
}  // namespace troupe
