#include "launcher/supervise/agent_fleet.h"

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

// Records the requested processes.
class FakeHost final : public Host {
 public:
  const std::string& name() const override { return none_; }
  const std::string& folder() const override { return none_; }
  std::string ProgramPath(const std::string& program) const override { return program; }
  Result<std::unique_ptr<Child>> Start(const std::string&, const std::vector<std::string>& arguments, bool) override {
    started.push_back(arguments);
    return std::unique_ptr<Child>(std::make_unique<FakeChild>());
  }
  std::vector<int> descriptors() const override { return {}; }
  std::vector<std::string> ReadOutput() override { return {}; }
  std::vector<std::string> ReadReports() override { return {}; }
  Status Fetch(const std::string&, const std::string&) override { return Status(); }

  std::vector<std::vector<std::string>> started;

 private:
  std::string none_;
};

class AgentFleetTest : public testing::Test {
 protected:
  void Start(std::size_t robots) {
    ReadyReport ready;
    for (std::size_t i = 0; i < robots; ++i) ready.robots.push_back("r" + std::to_string(i));
    ASSERT_TRUE(fleet_.Start(ready, "127.0.0.1:1", {{&host_, "lo"}}, std::vector<std::size_t>(robots, 0)).ok());
  }

  RunOptions options_;
  FakeHost host_;
  AgentFleet fleet_{options_};
};

TEST_F(AgentFleetTest, StartsALimitedNumberAndOthersAsAgentsJoin) {
  Start(50);
  const std::size_t first = host_.started.size();
  EXPECT_GT(first, 0u);
  EXPECT_LT(first, 50u);
  EXPECT_EQ(fleet_.size(), 50u);
  ASSERT_TRUE(fleet_.StartAfterJoins(3).ok());
  EXPECT_EQ(host_.started.size(), first + 3);
  ASSERT_TRUE(fleet_.StartAfterJoins(3).ok());
  EXPECT_EQ(host_.started.size(), first + 3) << "no further agent has joined";
  ASSERT_TRUE(fleet_.StartAfterJoins(50).ok());
  EXPECT_EQ(host_.started.size(), 50u);
  EXPECT_NE(host_.started.front(), host_.started.back());
}

TEST_F(AgentFleetTest, StartsAllOfASmallRunAtOnce) {
  Start(8);
  EXPECT_EQ(host_.started.size(), 8u);
}

TEST_F(AgentFleetTest, StartsAgentsOfNewRobotsAtOnce) {
  Start(2);
  ASSERT_TRUE(fleet_.Add(std::vector<std::string>(40, "late"), std::vector<std::size_t>(40, 0)).ok());
  EXPECT_EQ(host_.started.size(), 42u);
}

}  // namespace
}  // namespace troupe
