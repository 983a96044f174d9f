#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "transport/dds/binding/wire.h"
#include "world-service/observers/ros/request_values.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

Result<EntityFilter> MakeFilter(std::string expression) {
  simulation_interfaces_msg_dds__EntityFilters_ filters{};
  filters.filter = expression.data();
  return EntityFilter::Make(filters);
}

bool Matches(const EntityFilter& filter, const std::string& name, EntityKind kind,
             const std::vector<std::string>& tags = {}) {
  EntityReport entity;
  entity.kind = kind;
  return filter.Matches(name, entity, CategoryOf(kind), tags);
}

TEST(EntityFilter, AnExpressionMatchesAnywhereInAName) {
  const EntityFilter filter = test::ValueOf(MakeFilter("bot_[0-9]+$"));
  EXPECT_TRUE(Matches(filter, "robot_12", EntityKind::kRobot));
  EXPECT_FALSE(Matches(filter, "robot_12a", EntityKind::kRobot));
}

TEST(EntityFilter, AnEmptyFilterMatchesRobotsObjectsAndPeople) {
  const EntityFilter filter = test::ValueOf(MakeFilter(""));
  EXPECT_TRUE(Matches(filter, "box", EntityKind::kObject));
  EXPECT_TRUE(Matches(filter, "guest0", EntityKind::kPerson));
  EXPECT_FALSE(Matches(filter, "wall", EntityKind::kModel));
}

TEST(EntityFilter, AnInvalidExpressionIsRefused) {
  const Result<EntityFilter> filter = MakeFilter("(");
  ASSERT_FALSE(filter.ok());
  EXPECT_THAT(filter.error().message, testing::StartsWith("found the filter '(', expected a regular expression: "));
}

TEST(EntityFilter, AnExpressionThatWouldFillTheMemoryIsRefused) {
  EXPECT_FALSE(MakeFilter("(((a{1,500}){1,500}){1,500}){1,500}").ok());
}

TEST(EntityFilter, AnExpressionOfExponentialTimeInBacktrackersIsFast) {
  EXPECT_FALSE(Matches(test::ValueOf(MakeFilter("^(a+)+$")), std::string(60, 'a') + "b", EntityKind::kRobot));
}

TEST(EntityFilter, TagsMatchAnyOrAll) {
  dds::WireArena arena;
  simulation_interfaces_msg_dds__EntityFilters_ filters{};
  arena.FillStrings(filters.tags.tags, {"red", "fast"});
  const Result<EntityFilter> any = EntityFilter::Make(filters);
  filters.tags.filter_mode = 1;
  const Result<EntityFilter> all = EntityFilter::Make(filters);
  EXPECT_TRUE(Matches(any.value(), "a", EntityKind::kRobot, {"blue", "fast"}));
  EXPECT_FALSE(Matches(any.value(), "a", EntityKind::kRobot, {"blue"}));
  EXPECT_FALSE(Matches(all.value(), "a", EntityKind::kRobot, {"blue", "fast"}));
  EXPECT_TRUE(Matches(all.value(), "a", EntityKind::kRobot, {"red", "blue", "fast"}));
}

using Points = std::vector<std::array<double, 3>>;

Result<BoundsFilter> MakeBounds(std::uint8_t type, const Points& points) {
  dds::WireArena arena;
  simulation_interfaces_msg_dds__Bounds_ bounds{};
  bounds.type = type;
  auto* out = arena.Fill(bounds.points, points.size());
  for (const auto& [x, y, z] : points) *out++ = {x, y, z};
  return BoundsFilter::Make(bounds);
}

// A box of 2 m x 1 m x 0.5 m, turned by 90 degrees.
EntityReport BoxAt(double x, double y, double z) {
  return {.X_WE = {x, y, z, 1.5707963267948966}, .box = {{-1.0, -0.5, 1.0, 0.5}, {0.0, 0.5}}};
}

TEST(BoundsFilter, ABoxOverlapsInAreaAndHeight) {
  const Result<BoundsFilter> box = MakeBounds(1, {{1.0, 1.0, 1.0}, {-1.0, -1.0, 0.0}});
  EXPECT_TRUE(box.value().Overlaps(BoxAt(0.0, 1.9, 0.0)));
  EXPECT_FALSE(box.value().Overlaps(BoxAt(1.6, 0.0, 0.0))) << "its half width is 0.5";
  EXPECT_FALSE(box.value().Overlaps(BoxAt(0.0, 0.0, 1.1)));
  EXPECT_FALSE(box.value().Overlaps(EntityReport())) << "an entity without a body";
}

TEST(BoundsFilter, ASphereOverlapsTheNearestPointOfABox) {
  const Result<BoundsFilter> sphere = MakeBounds(3, {{0.0, 0.0, 0.25}, {1.0, 0.0, 0.0}});
  EXPECT_TRUE(sphere.value().Overlaps(BoxAt(1.4, 0.0, 0.0)));
  EXPECT_FALSE(sphere.value().Overlaps(BoxAt(1.6, 0.0, 0.0)));
  EXPECT_FALSE(sphere.value().Overlaps(BoxAt(1.4, 1.9, 0.0))) << "beyond the corner";
}

TEST(BoundsFilter, AHullHasNoCornersOfItsBox) {
  const Result<BoundsFilter> hull = MakeBounds(2, {{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 4.0, 1.0}, {1.0, 1.0, 0.5}});
  EXPECT_TRUE(hull.value().Overlaps(BoxAt(1.0, 1.0, 0.0)));
  EXPECT_FALSE(hull.value().Overlaps(BoxAt(3.9, 3.9, 0.0)));
}

TEST(BoundsFilter, BoundsThatAreNotValidAreRefused) {
  EXPECT_EQ(MakeBounds(1, {{0.0, 0.0, 0.0}}).error().message, "found bounds with 1 points, expected 2");
  EXPECT_EQ(MakeBounds(2, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}).error().message,
            "found bounds with 2 points, expected at least 3");
  EXPECT_EQ(MakeBounds(7, {}).error().message, "found bounds of type 7, expected 0 to 3");
  EXPECT_FALSE(MakeBounds(3, {{std::nan(""), 0.0, 0.0}, {1.0, 0.0, 0.0}}).ok());
}

TEST(EventLine, NamesTheRobotAndTheObstacle) {
  SmallWorld world;
  world.AddRobot("r0", {});
  world.AddBox("wall", 5.0, 0.0, 2.0, 1.0, {0.0, 0.5});
  Event event;
  event.tick = 7;
  event.robot = RobotId(0);
  event.other = ModelId(1);
  EXPECT_EQ(EventLine(world.world(), event),
            R"({"detail":"","event":"stall_began","other":"wall","robot":"r0","tick":7})");
}

}  // namespace
}  // namespace troupe
