#include "common/run/run_settings.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

TEST(RunSettings, ConvertsEveryWordToItsValueAndBack) {
  EXPECT_EQ(FindByName<Mode>("lockstep"), Mode::kLockstep);
  EXPECT_EQ(FindByName<Mode>("realtime"), Mode::kRealtime);
  EXPECT_EQ(FindByName<OnAgentLoss>("freeze"), OnAgentLoss::kFreeze);
  EXPECT_EQ(FindByName<OnAgentLoss>("pause"), OnAgentLoss::kPause);
  EXPECT_EQ(FindByName<OnAgentLoss>("abort"), OnAgentLoss::kAbort);
  for (const std::string_view word : NamesOf(Mode())) EXPECT_EQ(NameOf(*FindByName<Mode>(word)), word);
  for (const std::string_view word : NamesOf(OnAgentLoss())) EXPECT_EQ(NameOf(*FindByName<OnAgentLoss>(word)), word);
  for (const char* word : {"", "Lockstep", "fast", "lockstep "}) {
    EXPECT_FALSE(FindByName<Mode>(word)) << word;
    EXPECT_FALSE(FindByName<OnAgentLoss>(word)) << word;
  }
}

TEST(RunSettings, ConvertsSpeedsWithoutLoss) {
  EXPECT_EQ(ParseSpeed("max").value(), std::nullopt);
  EXPECT_EQ(ToString(Speed()), "max");
  for (const double factor : {1.0, 0.1, 1.0 / 3.0, 1e6, 12.5}) {
    EXPECT_EQ(ParseSpeed(ToString(Speed(factor))).value(), factor);
  }
  for (const char* text : {"", "0", "-1", "nan", "inf", "2x", " 2", "Max"}) {
    const Result<Speed> speed = ParseSpeed(text);
    ASSERT_FALSE(speed.ok()) << text;
    EXPECT_EQ(speed.error().message,
              "found '" + std::string(text) + "', expected a multiple of real time above 0, or max");
  }
}

TEST(RunOverrides, ReplaceOnlyTheSettingsGiven) {
  RunSettings settings{.ticks = 7, .speed = 3.0, .on_agent_loss = OnAgentLoss::kPause};
  RunOverrides().ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 7u);
  EXPECT_EQ(settings.speed, 3.0);
  EXPECT_EQ(settings.on_agent_loss, OnAgentLoss::kPause);

  RunOverrides overrides;
  overrides.speed.emplace(std::nullopt);
  overrides.mode = Mode::kRealtime;
  overrides.robots_per_process = 4;
  overrides.ros = true;
  overrides.ApplyTo(settings);
  EXPECT_EQ(settings.ticks, 7u);
  EXPECT_EQ(settings.speed, std::nullopt);
  EXPECT_EQ(settings.mode, Mode::kRealtime);
  EXPECT_EQ(settings.robots_per_process, 4u);
  EXPECT_TRUE(settings.ros);
}

TEST(RunOverrides, AWatchedRunHasTheSpeedForPeopleUnlessOneIsGiven) {
  RunSettings settings;
  EXPECT_EQ(settings.pace(), std::nullopt);
  RunOverrides watched;
  watched.is_watched = true;
  watched.ApplyTo(settings);
  EXPECT_EQ(settings.pace(), 1.0);
  EXPECT_EQ(settings.speed, std::nullopt);  // which a recording keeps
  watched.speed.emplace(std::nullopt);
  watched.ApplyTo(settings);
  EXPECT_EQ(settings.pace(), std::nullopt);
  watched.speed.emplace(3.0);
  watched.ApplyTo(settings);
  EXPECT_EQ(settings.pace(), 3.0);
}

}  // namespace
}  // namespace troupe
