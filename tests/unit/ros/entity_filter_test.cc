#include "world-service/observers/ros/entity_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace troupe {
namespace {

Result<EntityFilter> MakeFilter(std::string expression) {
  simulation_interfaces_msg_dds__EntityFilters_ filters{};
  filters.filter = expression.data();
  return EntityFilter::Make(filters);
}

TEST(EntityFilter, AnExpressionMatchesAnywhereInAName) {
  const Result<EntityFilter> filter = MakeFilter("bot_[0-9]+$");
  ASSERT_TRUE(filter.ok()) << filter.error().ToString();
  EXPECT_TRUE(filter.value().Matches("robot_12", EntityKind::kRobot));
  EXPECT_FALSE(filter.value().Matches("robot_12a", EntityKind::kRobot));
}

TEST(EntityFilter, AnEmptyFilterMatchesRobotsAndObjects) {
  const Result<EntityFilter> filter = MakeFilter("");
  ASSERT_TRUE(filter.ok());
  EXPECT_TRUE(filter.value().Matches("box", EntityKind::kObject));
  EXPECT_FALSE(filter.value().Matches("wall", EntityKind::kModel));
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
  const Result<EntityFilter> filter = MakeFilter("^(a+)+$");
  ASSERT_TRUE(filter.ok());
  EXPECT_FALSE(filter.value().Matches(std::string(60, 'a') + "b", EntityKind::kRobot));
}

}  // namespace
}  // namespace troupe
