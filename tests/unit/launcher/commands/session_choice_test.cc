#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "launcher/commands/commands.h"

namespace troupe {
namespace {

using testing::ElementsAre;

TEST(SessionChoiceTest, OfOneRunIsMadeSoon) {
  SessionChoice choice;
  choice.Update({}, true, 0.05);
  choice.Update({"a"}, true, 0.1);
  EXPECT_FALSE(choice.is_made()) << "another one may answer";
  choice.Update({"a"}, true, 0.1 + SessionChoice::kMinQuiet);
  EXPECT_TRUE(choice.is_made());
  EXPECT_THAT(choice.sessions(), ElementsAre("a"));
}

TEST(SessionChoiceTest, NamesBothRunsWhenTheSecondIsDiscoveredLater) {
  SessionChoice choice;
  choice.Update({"a"}, true, 0.1);
  choice.Update({"a", "b"}, true, 0.5);
  EXPECT_TRUE(choice.is_made());
  EXPECT_THAT(choice.sessions(), ElementsAre("a", "b"));
}

TEST(SessionChoiceTest, WaitsLongerForAKnownRunAndOnASlowMachine) {
  SessionChoice choice;
  choice.Update({"a"}, false, 0.1);
  choice.Update({"a"}, false, 1.5);
  EXPECT_FALSE(choice.is_made()) << "a run that is known to exist is not discovered yet";
  choice.Update({"a"}, false, 0.1 + SessionChoice::kMaxQuiet);
  EXPECT_TRUE(choice.is_made());

  SessionChoice slow;
  slow.Update({"a"}, true, 0.25);
  slow.Update({"a"}, true, 1.2);
  EXPECT_FALSE(slow.is_made()) << "the first one took a quarter of a second, and others may take several times as long";
  slow.Update({"a"}, true, 1.25);
  EXPECT_TRUE(slow.is_made());
}

TEST(SessionChoiceTest, IsNotMadeWithoutARun) {
  SessionChoice choice;
  choice.Update({}, true, 4.0);
  choice.Update({"a"}, true, 4.5);
  choice.Update({}, true, 4.6);
  EXPECT_FALSE(choice.is_made());
}

}  // namespace
}  // namespace troupe
