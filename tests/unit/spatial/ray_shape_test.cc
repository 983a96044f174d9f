#include "common/spatial/ray_shape.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/spatial/scene.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

using Kind = RayShape::Passage::Kind;

// The shape of a body of one piece with these vertices.
RayShape ShapeOf(const std::vector<Vec2>& vertices) {
  Body body;
  body.pieces.push_back({vertices, {0.0, 1.0}, {}, true, 1.0});
  body.piece_links.push_back(0);
  body.radius = 1.0;
  body.z = {0.0, 1.0};
  RayShapes shapes;
  return shapes[shapes.Add(body)];
}

std::vector<Vec2> RegularPolygon(int count, double radius) {
  std::vector<Vec2> vertices;
  for (int i = 0; i < count; ++i) {
    const SinCosResult trig = SinCos(2.0 * kPi * i / count);
    vertices.emplace_back(radius * trig.cos, radius * trig.sin);
  }
  return vertices;
}

RayShape::Passage Pass(const RayShape& shape, const Vec2& point, const Vec2& direction) {
  return shape.Pass(shape.pieces[0], direction, Cross(direction, point));
}

TEST(RayShape, FindsTheEdgesThatALinePasses) {
  const std::vector<Vec2> square = {{0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}};
  RayShape::Passage passage = Pass(ShapeOf(square), {0.0, 0.1}, {1.0, 0.0});
  EXPECT_EQ(passage.kind, Kind::kThrough);
  EXPECT_EQ(passage.enter, 2u);
  EXPECT_EQ(passage.leave, 0u);
  passage = Pass(ShapeOf(square), {0.1, 0.0}, {0.0, -1.0});
  EXPECT_EQ(passage.enter, 1u);
  EXPECT_EQ(passage.leave, 3u) << "from the last vertex to the first";
}

TEST(RayShape, ReportsALineTooNearToAVertex) {
  const RayShape shape = ShapeOf({{0.5, 0.0}, {0.0, 0.5}, {-0.5, 0.0}, {0.0, -0.5}});
  EXPECT_EQ(Pass(shape, {0.0, 0.5}, {1.0, 0.0}).kind, Kind::kUnclear);
  EXPECT_EQ(Pass(shape, {0.0, 0.0}, {1.0, 0.0}).kind, Kind::kUnclear);
  EXPECT_EQ(Pass(shape, {0.0, 0.501}, {1.0, 0.0}).kind, Kind::kApart);
  EXPECT_EQ(Pass(shape, {0.0, 0.499}, {1.0, 0.0}).kind, Kind::kThrough);
  EXPECT_EQ(Pass(ShapeOf(RegularPolygon(100, 1.0)), {0.0, 0.0}, {0.6, 0.8}).kind, Kind::kUnclear) << "too many";
}

TEST(RayShape, IsRightAboutAnyLine) {
  int through = 0;
  for (int count = 3; count <= 32; ++count) {
    const std::vector<Vec2> vertices = RegularPolygon(count, 0.7);
    const RayShape shape = ShapeOf(vertices);
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      const auto random = [&](std::uint64_t which) {
        return RandomUniform({static_cast<std::uint64_t>(count), seed, which});
      };
      const Vec2 point(2.0 * random(0) - 1.0, 2.0 * random(1) - 1.0);
      const SinCosResult trig = SinCos(2.0 * kPi * random(2));
      const Vec2 direction(trig.cos, trig.sin);
      const auto is_left = [&](std::size_t i) { return Cross(direction, vertices[i % vertices.size()] - point) > 0.0; };
      std::size_t left = 0;
      for (std::size_t i = 0; i < vertices.size(); ++i) left += is_left(i) ? 1 : 0;
      const RayShape::Passage passage = Pass(shape, point, direction);
      const bool apart = left == 0 || left == vertices.size();
      ASSERT_TRUE(passage.kind != Kind::kApart || apart);
      if (passage.kind != Kind::kThrough) continue;
      ++through;
      ASSERT_TRUE(is_left(passage.enter) && !is_left(passage.enter + 1));
      ASSERT_TRUE(!is_left(passage.leave) && is_left(passage.leave + 1));
    }
  }
  EXPECT_GT(through, 3000);
}

}  // namespace
}  // namespace troupe
