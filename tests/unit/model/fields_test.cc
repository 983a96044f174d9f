#include "troupe/fields.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/ids.h"
#include "troupe/pose.h"

namespace troupe {
namespace {

struct Inner {
  std::optional<RobotId> robot = {};
  std::vector<std::uint8_t> bytes = {};
  static constexpr auto Fields() { return std::tuple{Field{"robot", &Inner::robot}, Field{"bytes", &Inner::bytes}}; }
};

struct Outer {
  RobotId id;
  Pose pose = {};
  std::string text = {};
  std::optional<Twist> twist = {};
  Inner inner = {};
  std::vector<Inner> list = {};
  bool flag = false;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"inner", &Outer::inner}, Field{"id", &Outer::id},       Field{"pose", &Outer::pose},
        Field{"text", &Outer::text},   Field{"twist", &Outer::twist}, Field{"list", &Outer::list},
        Field{"flag", &Outer::flag},
    };
  }
};

TEST(FieldsTest, MembersOfAllKindsCount) {
  EXPECT_EQ(kMemberCount<Pose>, 4u);
  EXPECT_EQ(kMemberCount<Inner>, 2u);
  EXPECT_EQ(kMemberCount<Outer>, 7u);
}

TEST(FieldsTest, AMemberThatIsListedTwiceIsFound) {
  EXPECT_TRUE(fields_internal::AreDistinct(Outer::Fields()));
  EXPECT_FALSE(fields_internal::AreDistinct(std::tuple{Field{"x", &Pose::x}, Field{"y", &Pose::x}}));
}

TEST(FieldsTest, LeavesReachIntoBranchesInTheOrderOfTheLists) {
  Outer row;
  std::vector<std::string> names;
  std::vector<const void*> places;
  ForEachLeaf<Outer>([&](const auto& leaf) {
    names.emplace_back(leaf.name);
    places.push_back(&leaf.Of(row));
  });
  EXPECT_EQ(names, (std::vector<std::string>{"robot", "bytes", "id", "x", "y", "z", "heading", "text", "twist", "list",
                                             "flag"}));
  EXPECT_EQ(places,
            (std::vector<const void*>{&row.inner.robot, &row.inner.bytes, &row.id, &row.pose.x, &row.pose.y,
                                      &row.pose.z, &row.pose.heading, &row.text, &row.twist, &row.list, &row.flag}));
}

}  // namespace
}  // namespace troupe
