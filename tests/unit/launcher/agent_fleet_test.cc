#include "launcher/agent_fleet.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

class FakeChild final : public Child {
 public:
  pid_t pid() const override { return 1; }
  const std::optional<ProcessEnd>& end() const override { return end_; }
  bool Poll() override { return false; }
  void Signal(int) override {}
  void Kill() override {}

 private:
  std::optional<ProcessEnd> end_;
};

// Remembers what it is to start.
class FakeMachine final : public Machine {
 public:
  const std::string& name() const override { return none_; }
  const std::string& folder() const override { return none_; }
  std::string ProgramPath(const std::string& program) const override { return program; }
  Result<std::unique_ptr<Child>> Start(const std::string&, const std::vector<std::string>& arguments, bool) override {
    started.push_back(arguments);
    return std::unique_ptr<Child>(std::make_unique<FakeChild>());
  }
  std::vector<int> descriptors() const override { return {}; }
  std::vector<std::string> TakeOutput() override { return {}; }
  std::vector<std::string> TakeReports() override { return {}; }
  Status Fetch(const std::string&, const std::string&) override { return std::nullopt; }

  std::vector<std::vector<std::string>> started;

 private:
  std::string none_;
};

class AgentFleetTest : public testing::Test {
 protected:
  void Start(std::size_t robots) {
    ReadyReport ready;
    for (std::size_t i = 0; i < robots; ++i) ready.robots.push_back("r" + std::to_string(i));
    ASSERT_FALSE(fleet_.Start(ready, "127.0.0.1:1", {{&machine_, "lo"}}, std::vector<std::size_t>(robots, 0)));
  }

  RunOptions options_;
  FakeMachine machine_;
  AgentFleet fleet_{options_};
};

TEST_F(AgentFleetTest, StartsAFewAtOnceAndOthersAsThoseJoin) {
  Start(50);
  const std::size_t first = machine_.started.size();
  EXPECT_GT(first, 0u);
  EXPECT_LT(first, 50u);
  EXPECT_EQ(fleet_.size(), 50u);
  ASSERT_FALSE(fleet_.TakeJoined(3));
  EXPECT_EQ(machine_.started.size(), first + 3);
  ASSERT_FALSE(fleet_.TakeJoined(3));
  EXPECT_EQ(machine_.started.size(), first + 3) << "nobody else has joined";
  ASSERT_FALSE(fleet_.TakeJoined(50));
  EXPECT_EQ(machine_.started.size(), 50u);
  EXPECT_NE(machine_.started.front(), machine_.started.back());
}

TEST_F(AgentFleetTest, StartsAllOfASmallRunAtOnce) {
  Start(8);
  EXPECT_EQ(machine_.started.size(), 8u);
}

TEST_F(AgentFleetTest, StartsRobotsThatComeLaterAtOnce) {
  Start(2);
  ASSERT_FALSE(fleet_.Add(std::vector<std::string>(40, "late"), std::vector<std::size_t>(40, 0)));
  EXPECT_EQ(machine_.started.size(), 42u);
}

}  // namespace
}  // namespace troupe
