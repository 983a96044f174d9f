#include "ros/connection/type_descriptions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe::ros {
namespace {

TEST(DescribeType, ListsFieldsAndAllTypesInIt) {
  const std::vector<DescribedType> types = DescribeType("geometry_msgs/msg/TwistStamped");
  std::vector<std::string> names;
  for (const DescribedType& type : types) names.push_back(type.name);
  EXPECT_THAT(names,
              testing::ElementsAre("geometry_msgs/msg/TwistStamped", "builtin_interfaces/msg/Time",
                                   "geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3", "std_msgs/msg/Header"));
  ASSERT_EQ(types.front().fields.size(), 2u);
  EXPECT_EQ(types.front().fields[0].name, "header");
  EXPECT_EQ(types.front().fields[0].type, 1) << "nested";
  EXPECT_EQ(types.front().fields[0].nested_type, "std_msgs/msg/Header");
}

TEST(DescribeType, HasTheCapacitiesOfArrays) {
  const std::vector<DescribedType> types = DescribeType("geometry_msgs/msg/PoseWithCovariance");
  ASSERT_FALSE(types.empty());
  const DescribedField& covariance = types.front().fields.back();
  EXPECT_EQ(covariance.name, "covariance");
  EXPECT_EQ(covariance.type, 11 + 48) << "an array of float64";
  EXPECT_EQ(covariance.capacity, 36u);
}

TEST(DescribeType, KnowsNoOtherTypes) {
  for (const char* name : {"", "x", "std_msgs/msg/NoSuch", "std_msgs/msg/String data", "a\nb"}) {
    EXPECT_TRUE(DescribeType(name).empty()) << name;
  }
}

}  // namespace
}  // namespace troupe::ros
