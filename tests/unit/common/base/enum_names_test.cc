#include "troupe/enum_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "troupe/event.h"

namespace troupe {
namespace {

enum class Gate : unsigned char { kShut, kAjar, kOpen };
constexpr auto NamesOf(Gate) {
  return std::array{"shut", "ajar", "open"};
}

TEST(EnumNamesTest, EachValueHasTheNameAtItsPlace) {
  EXPECT_STREQ(NameOf(Gate::kShut), "shut");
  EXPECT_STREQ(NameOf(Gate::kOpen), "open");
  EXPECT_STREQ(NameOf(static_cast<Gate>(3)), "unknown");
  EXPECT_EQ(LastOf(Gate()), Gate::kOpen);
  EXPECT_THAT(AllNames<Gate>(), testing::ElementsAre("shut", "ajar", "open"));
}

TEST(EnumNamesTest, ANameStandsForItsValueOnly) {
  EXPECT_EQ(FindByName<Gate>("ajar"), Gate::kAjar);
  for (const char* other : {"", "Ajar", "aja", "ajar ", "unknown"}) EXPECT_FALSE(FindByName<Gate>(other)) << other;
}

// A name that is missing would shift those after it.
TEST(EnumNamesTest, TheLastTypeOfEventsHasTheLastName) {
  EXPECT_EQ(LastOf(EventType()), EventType::kPersonLeft);
  EXPECT_STREQ(NameOf(EventType::kPersonLeft), "person_left");
  for (const std::string& name : AllNames<EventType>()) EXPECT_EQ(NameOf(*FindByName<EventType>(name)), name);
}

}  // namespace
}  // namespace troupe
