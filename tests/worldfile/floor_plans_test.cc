// Floor plans: the lines of DXF and SVG, the walls that become of them, and faults with file and line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "troupe/polygon.h"
#include "worldfile/load_world.h"
#include "worldfile/plans/floor_plan.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::HasSubstr;

// The lines "code value" of a DXF file, one pair each.
std::string Dxf(const std::string& pairs) {
  std::string text;
  std::size_t at = 0;
  while (at < pairs.size()) {
    const std::size_t end = std::min(pairs.find('\n', at), pairs.size());
    const std::string line = pairs.substr(at, end - at);
    at = end + 1;
    if (line.empty()) continue;
    const std::size_t blank = line.find(' ');
    text += line.substr(0, blank) + "\n" + line.substr(blank + 1) + "\n";
  }
  return text;
}

const std::string kMetres = "0 SECTION\n2 HEADER\n9 $INSUNITS\n70 6\n0 ENDSEC\n";
std::string Entities(const std::string& pairs) {
  return "0 SECTION\n2 ENTITIES\n" + pairs + "0 ENDSEC\n0 EOF\n";
}

FloorPlan DxfPlan(const std::string& pairs, PlanUnit unit = {}) {
  return ValueOf(ReadDxfPlan(Dxf(pairs), "p.dxf", unit));
}

double LengthOf(const PlanLayer& layer) {
  double length = 0.0;
  for (const PlanLine& line : layer.lines) length += (line.end - line.start).norm();
  return length;
}

TEST(FloorPlans, OfDxfHaveLinesArcsAndPolylinesByLayers) {
  const FloorPlan plan =
      DxfPlan(kMetres + Entities("0 LINE\n8 WALL\n10 0\n20 0\n11 4\n21 3\n"
                                 "0 ARC\n8 CURVE\n10 1\n20 1\n40 2\n50 350\n51 80\n"
                                 "0 CIRCLE\n8 CURVE\n10 1\n20 1\n40 0.5\n"
                                 "0 LWPOLYLINE\n8 WALL\n90 2\n70 1\n10 0\n20 0\n42 1\n10 2\n20 0\n42 0\n"
                                 "0 POLYLINE\n8 WALL\n70 0\n0 VERTEX\n10 0\n20 0\n0 VERTEX\n10 0\n20 5\n0 SEQEND\n"
                                 "0 TEXT\n8 NOTES\n10 0\n20 0\n1 hall\n0 SPLINE\n8 CURVE\n"));
  ASSERT_EQ(plan.layers.size(), 2u);
  EXPECT_EQ(plan.layers[0].name, "WALL");
  EXPECT_EQ(plan.layers[0].lines[0].end, Vec2(4.0, 3.0));
  // A line of 5 m, a half circle with its chord, and a line of 5 m.
  EXPECT_NEAR(LengthOf(plan.layers[0]), 5.0 + kPi + 2.0 + 5.0, 0.03);
  EXPECT_NEAR(LengthOf(plan.layers[1]), 2.0 * kPi / 2.0 + kPi, 0.03);  // 90 degrees of 2 m
  for (const PlanLine& line : plan.layers[1].lines) {
    const double radius = (0.5 * (line.start + line.end) - Vec2(1.0, 1.0)).norm();
    EXPECT_TRUE(std::fabs(radius - 2.0) < 0.006 || std::fabs(radius - 0.5) < 0.006) << radius;
  }
  // The half circle of the bulge is below the chord from (0, 0) to (2, 0): counter-clockwise.
  double lowest = 0.0;
  for (const PlanLine& line : plan.layers[0].lines) lowest = std::min(lowest, line.start.y());
  EXPECT_NEAR(lowest, -1.0, 0.01);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_THAT(plan.warnings[0].ToString(), HasSubstr("found 1 of the type 'SPLINE'"));
}

TEST(FloorPlans, OfDxfHaveBlocksWithTheirScalesTurnsAndCopies) {
  const std::string blocks =
      "0 SECTION\n2 BLOCKS\n0 BLOCK\n8 0\n2 DESK\n70 0\n10 1\n20 0\n0 LINE\n8 0\n10 1\n20 0\n11 2\n21 0\n0 ENDBLK\n"
      "0 BLOCK\n2 PAIR\n10 0\n20 0\n0 INSERT\n8 0\n2 DESK\n10 0\n20 0\n0 INSERT\n8 CHAIR\n2 DESK\n10 0\n20 5\n0 "
      "ENDBLK\n0 ENDSEC\n";
  const FloorPlan plan = DxfPlan(kMetres + blocks +
                                 Entities("0 INSERT\n8 FURNITURE\n2 PAIR\n10 10\n20 20\n41 2\n42 1\n50 90\n"
                                          "0 INSERT\n8 ROW\n2 DESK\n10 0\n20 0\n70 3\n71 2\n44 1.5\n45 4\n"));
  ASSERT_EQ(plan.layers.size(), 3u);
  EXPECT_EQ(plan.layers[0].name, "FURNITURE");
  ASSERT_EQ(plan.layers[0].lines.size(), 1u);
  EXPECT_NEAR((plan.layers[0].lines[0].start - Vec2(10.0, 20.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((plan.layers[0].lines[0].end - Vec2(10.0, 22.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(plan.layers[1].name, "CHAIR");
  EXPECT_NEAR((plan.layers[1].lines[0].start - Vec2(5.0, 20.0)).norm(), 0.0, 1e-9);
  ASSERT_EQ(plan.layers[2].lines.size(), 6u);
  EXPECT_EQ(plan.layers[2].lines[5].start, Vec2(3.0, 4.0));
}

TEST(FloorPlans, OfDxfHaveTheUnitOfTheFileOrTheOneThatIsGiven) {
  const std::string line = Entities("0 LINE\n8 0\n10 0\n20 0\n11 1000\n21 0\n");
  const auto length = [&](const std::string& header, PlanUnit unit) {
    return LengthOf(DxfPlan(header + line, unit).layers[0]);
  };
  EXPECT_DOUBLE_EQ(length("0 SECTION\n2 HEADER\n9 $INSUNITS\n70 4\n0 ENDSEC\n", {}), 1.0);
  EXPECT_DOUBLE_EQ(length("0 SECTION\n2 HEADER\n9 $INSUNITS\n70 4\n0 ENDSEC\n", 0.01), 10.0);
  EXPECT_DOUBLE_EQ(length("", 0.0254), 25.4);
}

TEST(FloorPlans, OfDxfWithFaultsAreNamedWithTheirLines) {
  const std::string loop = "0 SECTION\n2 BLOCKS\n0 BLOCK\n2 A\n0 INSERT\n2 A\n0 INSERT\n2 A\n0 ENDBLK\n0 ENDSEC\n";
  const struct {
    std::string text;
    const char* error;
  } cases[] = {
      {"hello\n", "p.dxf:1:1: error: found 'hello', expected the number of a group"},
      {"0\nSECTION\n2\n", "p.dxf:3:1: error: found the end of the file"},
      {"", "found no group 0"},
      {"AutoCAD Binary DXF\r\n\x1a", "found a binary DXF file"},
      {Dxf(Entities("0 LINE\n8 0\n10 0\n20 0\n11 1\n21 0\n")), "found no unit ($INSUNITS)"},
      {Dxf(kMetres + Entities("0 LINE\n8 0\n10 zero\n")), "p.dxf:20:1: error: found 'zero', expected a number"},
      {Dxf(kMetres + Entities("0 LINE\n8 0\n10 nan\n")), "found 'nan', expected a number"},
      {Dxf(kMetres + Entities("0 LINE\n8 0\n10 0\n20 0\n11 1e9\n21 0\n")), "found a point beyond 1000 km"},
      {Dxf(kMetres + Entities("0 INSERT\n8 0\n2 NONE\n")), "found no block 'NONE'"},
      {Dxf(kMetres + loop + Entities("0 INSERT\n8 0\n2 A\n")), "a block in itself"},
      {Dxf(kMetres + loop + Entities("0 INSERT\n8 0\n2 A\n70 1000\n71 1000\n")), "found more than 10000 copies"},
      {Dxf(kMetres + Entities("0 CIRCLE\n8 0\n40 1e300\n")), "found a point beyond 1000 km"},
  };
  for (const auto& each : cases) {
    const Result<FloorPlan> plan = ReadDxfPlan(each.text, "p.dxf", {});
    ASSERT_FALSE(plan.ok()) << each.text;
    EXPECT_THAT(plan.error().ToString(), HasSubstr(each.error));
  }
}

std::string Svg(const std::string& content, const std::string& size = R"(width="200mm" viewBox="0 0 100 50")") {
  return "<svg xmlns='http://www.w3.org/2000/svg' " + size + ">\n" + content + "\n</svg>";
}

FloorPlan SvgPlan(const std::string& content) {
  return ValueOf(ReadSvgPlan(Svg(content, ""), "p.svg", 1.0));
}

TEST(FloorPlans, OfSvgHaveShapesWithTheirTransformsAndLayers) {
  const FloorPlan plan = SvgPlan(R"svg(
    <g inkscape:groupmode="layer" inkscape:label="Walls" transform="translate(10 0)">
      <line x1="0" y1="0" x2="3" y2="4"/>
      <g transform="rotate(90) scale(2)"><polyline points="0,0 1,0 1,1"/></g>
      <rect width="2" height="1"/><polygon points="0 0 1 0 0 1"/>
    </g>
    <g id="round"><circle cx="1" cy="1" r="2"/><ellipse rx="3" ry="3"/></g>
    <g display="none"><line x2="9"/></g><defs><line x2="9"/></defs><use href="#a"/>)svg");
  ASSERT_EQ(plan.layers.size(), 2u);
  EXPECT_EQ(plan.layers[0].name, "Walls");
  const std::vector<PlanLine>& lines = plan.layers[0].lines;
  ASSERT_EQ(lines.size(), 1u + 2u + 4u + 3u);
  EXPECT_EQ(lines[0].end, Vec2(13.0, -4.0));  // y is up
  EXPECT_NEAR((lines[1].end - Vec2(10.0, -2.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(plan.layers[1].name, "round");
  EXPECT_NEAR(LengthOf(plan.layers[1]), 2.0 * kPi * 5.0, 0.06);
  ASSERT_EQ(plan.warnings.size(), 1u);
}

TEST(FloorPlans, OfSvgFollowThePathsOfAllCommands) {
  const struct {
    const char* path;
    double length;
  } cases[] = {
      {"M0 0L3 4", 5.0},
      {"m1,1 3,4 -3-4", 10.0},
      {"M0 0H4V3Z", 12.0},
      {"M0 0h4v3z", 12.0},
      {"M0 0 A2 2 0 0 1 4 0", 2.0 * kPi},
      {"M0 0 a2 2 0 1 0 2 2", 3.0 * kPi},
      {"M0 0 a2 2 0 002 2", kPi},
      {"M0 0C0 1 0 2 0 3S0 5 0 6", 6.0},
      {"M0 0Q1 0 2 0T4 0t2 0", 6.0},
      {"M0 0 A0 2 0 0 1 4 0", 4.0},
  };
  for (const auto& each : cases) {
    const FloorPlan plan = SvgPlan("<path d='" + std::string(each.path) + "'/>");
    ASSERT_EQ(plan.layers.size(), 1u) << each.path;
    EXPECT_NEAR(LengthOf(plan.layers[0]), each.length, 0.05) << each.path;
  }
}

TEST(FloorPlans, OfSvgHaveTheUnitOfThePage) {
  const FloorPlan plan = ValueOf(ReadSvgPlan(Svg("<line x2='50'/>"), "p.svg", {}));
  EXPECT_NEAR(LengthOf(plan.layers[0]), 0.1, 1e-9);  // half of 200 mm
}

TEST(FloorPlans, OfSvgWithFaultsAreNamedWithTheirLines) {
  const struct {
    std::string content;
    const char* error;
  } cases[] = {
      {"<path d='M0 0 L'/>", "p.svg:2:7: error: found '' in 'd', expected a command of a path"},
      {"<path d='M0 0 X1'/>", "found '1' in 'd'"},
      {"<path d='1 2'/>", "in 'd'"},
      {"<line x1='a'/>", "p.svg:2:7: error: found 'a' for 'x1', expected a number without a unit"},
      {"<g transform='spin(3)'/>", "found 'spin(3)' in 'transform'"},
      {"<polyline points='0,0 b'/>", "found 'b' in 'points'"},
      {"<line x1='1e9'/>", "found a point beyond 1000 km"},
      {"<line", "p.svg:"},
  };
  for (const auto& each : cases) {
    const Result<FloorPlan> plan = ReadSvgPlan(Svg(each.content), "p.svg", 1.0);
    ASSERT_FALSE(plan.ok()) << each.content;
    EXPECT_THAT(plan.error().ToString(), HasSubstr(each.error));
  }
  EXPECT_THAT(ReadSvgPlan(Svg("", ""), "p.svg", {}).error().ToString(), HasSubstr("found no size of the page"));
  EXPECT_THAT(ReadSvgPlan("<html/>", "p.svg", {}).error().ToString(), HasSubstr("expected 'svg'"));
}

TEST(FloorPlans, AreWallsOfTheirThicknessAndHeight) {
  const FloorPlan plan =
      DxfPlan(kMetres + Entities("0 LINE\n8 WALL\n10 5\n20 5\n11 9\n21 5\n0 LINE\n8 WALL\n10 9\n20 5\n11 5\n21 5\n"
                                 "0 LINE\n8 GLASS\n10 5\n20 5\n11 5\n21 8\n0 LINE\n8 NOTES\n10 0\n20 0\n11 1\n21 0\n"));
  PlanWalls walls{0.2, 2.5, {{"WALL", 2.5}, {"GL*", 1.0}}};
  test::TemporaryFolder folder;
  const LoadedWorld loaded = ValueOf(LoadWorld(folder.Write("w.world", ValueOf(PlanWorldText(plan, walls, "p.dxf")))));
  ASSERT_EQ(loaded.world.models.size(), 2u);
  const ModelDescription& wall = loaded.world.models[0];
  EXPECT_EQ(wall.name, "WALL");
  const Shape& shape = loaded.world.shape(wall.shape);
  ASSERT_EQ(shape.blocks.size(), 1u);  // the second line is the first one
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& corner : shape.blocks[0].outline) box.Extend(wall.X_PM.translation() + corner);
  // The origin is the lower left corner of all walls.
  EXPECT_NEAR(box.min_x, 0.0, 1e-5);
  EXPECT_NEAR(box.max_x, 4.2, 1e-5);
  EXPECT_NEAR(box.min_y, 0.0, 1e-5);
  EXPECT_NEAR(box.max_y, 0.2, 1e-5);
  EXPECT_NEAR(shape.blocks[0].z.max, 2.5, 1e-5);
  EXPECT_NEAR(loaded.world.shape(loaded.world.models[1].shape).blocks[0].z.max, 1.0, 1e-5);
  walls.rules = {{"NONE", 1.0}};
  EXPECT_THAT(PlanWorldText(plan, walls, "p.dxf").error().ToString(),
              HasSubstr("expected one of 'WALL', 'GLASS', 'NOTES'"));
}

}  // namespace
}  // namespace troupe
