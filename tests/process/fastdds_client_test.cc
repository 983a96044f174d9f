// A client on Fast DDS, which shares no code with Troupe's side, uses the services and actions of stepped runs: two
// runs give the same results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_domain.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;

std::string RosDomain() {
  return std::to_string(TestRosNetwork().domain);
}

// A run in the ROS domain of this test, with additional arguments.
Program RunWithRos(const std::string& world, std::vector<std::string> more) {
  return Troupe(
      Words("run % --domain % --headless --speed max --ros --ros-distro jazzy --ros-interface lo --ros-domain %",
            {WorldPath(world), std::to_string(TestDomain()), RosDomain()}) +
      more);
}

std::vector<json> Lines(Program& program) {
  std::vector<json> lines;
  for (const std::string& line : LinesOf(program.output())) {
    lines.push_back(json::parse(line, nullptr, false));
    EXPECT_TRUE(lines.back().is_object()) << line;
  }
  return lines;
}

class FastDdsClientTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(ProgramPath("fastdds_client"))) {
      GTEST_SKIP() << "fastdds_client was not built: needs libfastrtps-dev and fastddsgen";
    }
  }

  TemporaryFolder folder_;
};

// Steps a run by the control topic.
class Stepper {
 public:
  explicit Stepper(const std::string& session) : client_(NetworkOf(session)) {
    EXPECT_TRUE(client_.WaitForService(kSeconds).ok());
  }
  void Pause() { Do(control::Pause()); }
  Tick Step(std::uint64_t ticks) { return Do(control::Step{.ticks = ticks}); }

 private:
  Tick Do(const control::Request& request) {
    const Result<ControlReply> reply = client_.Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done);
    return reply.ok() ? reply.value().tick : 0;
  }

  ControlClient client_;
};

// Equal up to the rounding of numbers.
void ExpectNear(const json& found, const json& expected) {
  const json flat = expected.flatten();
  const json found_flat = found.flatten();
  ASSERT_EQ(found_flat.size(), flat.size()) << found;
  for (const auto& [path, value] : flat.items()) {
    ASSERT_TRUE(found_flat.contains(path)) << path;
    if (value.is_number_float()) {
      EXPECT_NEAR(found_flat[path].get<double>(), value.get<double>(), 1e-12) << path;
    } else {
      EXPECT_EQ(found_flat[path], value) << path;
    }
  }
}

struct GripperRun {
  std::vector<json> output;  // of the client
  std::string hashes;
};

// Anna's gripper receives goals: an intermediate opening, impossible ones, her box, and open again; the last is
// cancelled.
GripperRun DriveGripper(const std::string& hashes, TemporaryFolder& folder) {
  const std::string session = TestSession(hashes);
  Program run = RunWithRos("hands.json", {"--paused", "--session", session, "--hash-log", folder.Path(hashes)});
  Program client(
      {ProgramPath("fastdds_client"), RosDomain(), "gripper", "/anna/gripper", "0.30", "nan", "9", "0", "0.31!0.205"});
  Stepper stepper(session);
  client.WaitForLine(R"({"accepted":true,"goal":1,)");
  // The number of steps of each goal: the client sends the next goal as soon as it has a result.
  stepper.Step(10);  // 1 cm each at 1 cm/s
  client.WaitForLine(R"({"accepted":true,"goal":4,)");
  stepper.Step(51);  // to the box, and pressing on it
  client.WaitForLine(R"({"accepted":true,"goal":5,)");
  stepper.Step(3);  // the last one passes 0.205 m
  client.WaitForLine("canceled");
  stepper.Step(10);
  EXPECT_EQ(client.Wait(), 0) << client.output();
  run.Interrupt();
  EXPECT_NE(run.output().find("/anna/gripper/gripper_cmd: refused a goal of"), std::string::npos) << run.output();
  return {Lines(client), folder.Read(hashes)};
}

TEST_F(FastDdsClientTest, EqualGripperGoalsGiveEqualHashes) {
  const GripperRun first = DriveGripper("first", folder_);
  std::vector<json> sent;
  std::vector<json> results;
  std::vector<json> canceled;
  std::map<int, std::vector<double>> feedback;
  json statuses;
  for (const json& line : first.output) {
    if (line["topic"] == "sent") sent.push_back(line["accepted"]);
    if (line["topic"] == "result") results.push_back(line);
    if (line["topic"] == "canceled") canceled.push_back(line);
    if (line["topic"] == "feedback") feedback[line["goal"]].push_back(line["position"]);
    if (line["topic"] == "status") statuses = line["goals"];
  }
  EXPECT_THAT(sent, ElementsAre(true, false, false, true, true));
  ASSERT_EQ(results.size(), 3u);
  const auto expect_result = [](const json& result, int goal, int status, double position, bool stalled, bool reached) {
    EXPECT_EQ(result["goal"], goal);
    EXPECT_EQ(result["status"], status);
    EXPECT_NEAR(result["position"].get<double>(), position, 1e-9);
    EXPECT_EQ(result["effort"], 0.0);
    EXPECT_EQ(result["stalled"], stalled);
    EXPECT_EQ(result["reached"], reached);
  };
  expect_result(results[0], 1, 4, 0.3, false, true);
  expect_result(results[1], 4, 4, 0.2, true, false);  // holds the box
  expect_result(results[2], 5, 5, 0.206, false, false);
  EXPECT_THAT(canceled, ElementsAre(json({{"topic", "canceled"}, {"code", 0}, {"goals", 1}})));
  EXPECT_GE(feedback[1].size(), 2u);
  EXPECT_TRUE(std::is_sorted(feedback[1].rbegin(), feedback[1].rend()));
  EXPECT_GE(feedback[4].size(), 20u);
  EXPECT_GE(feedback[5].size(), 1u);
  EXPECT_EQ(statuses, json({{1, 4}, {4, 4}, {5, 5}}));
  EXPECT_EQ(DriveGripper("second", folder_).hashes, first.hashes);
}

// Drives r0 by another Twist before each of a thousand steps.
std::string StepAThousandTimes(const std::string& hashes, TemporaryFolder& folder) {
  Program run = RunWithRos("pen.world", {"--paused", "--ros-reliable-commands", "--hash-log", folder.Path(hashes)});
  Program client({ProgramPath("fastdds_client"), RosDomain(), "step", "1000", "/r0=0.4"});
  client.WaitForLine("\"stepped\"");
  EXPECT_EQ(client.Wait(), 0);
  EXPECT_THAT(client.output(), testing::HasSubstr(R"({"repeated":0,"steps":1000,"topic":"stepped"})"));
  run.Interrupt();
  return folder.Read(hashes);
}

TEST_F(FastDdsClientTest, AThousandEqualStepsGiveEqualHashes) {
  const std::string first = StepAThousandTimes("first", folder_);
  EXPECT_EQ(std::count(first.begin(), first.end(), '\n'), 1001);
  EXPECT_TRUE(StepAThousandTimes("second", folder_) == first);
}

// Spawns a rover, moves it, steps and deletes it, and compares every field of every response.
TEST_F(FastDdsClientTest, QueriesAndEditsTheWorldByItsServices) {
  Program run = RunWithRos("pen.world", {"--paused"});
  run.WaitForLine("ready");
  Program client({ProgramPath("fastdds_world"), RosDomain()});
  EXPECT_EQ(client.Wait(), 0) << client.output();
  run.Interrupt();
  const json ok = {1, ""};
  const auto state = [&](double x, double heading, std::int64_t nanoseconds) {
    return json{{"topic", "state"},
                {"result", ok},
                {"stamp", {0, nanoseconds}},
                {"frame", "map"},
                {"position", {x, -2.0, 0.0}},
                {"orientation", {0.0, 0.0, std::sin(heading / 2.0), std::cos(heading / 2.0)}},
                {"linear", {0.0, 0.0, 0.0}},
                {"angular", {0.0, 0.0, 0.0}},
                {"acceleration", {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}}};
  };
  std::vector<json> lines = Lines(client);
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[0], json({{"topic", "features"},
                            {"features", {0,  1,  2,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 20,
                                          21, 22, 23, 24, 25, 26, 31, 32, 33, 40, 41, 43, 44, 45, 50}},
                            {"formats", {"world", "inc", "json"}},
                            {"info", "Troupe: world pen"}}));
  EXPECT_EQ(lines[1], json({{"topic", "spawned"}, {"result", ok}, {"name", "late"}}));
  ExpectNear(lines[2], state(0.5, 1.0, 0));
  EXPECT_EQ(lines[3], json({{"topic", "set"}, {"result", ok}}));
  ExpectNear(lines[4], state(1.0, 2.0, 0));
  EXPECT_EQ(lines[5], json({{"topic", "stepped"}, {"result", ok}}));
  ExpectNear(lines[6], state(1.0, 2.0, 300'000'000));
  EXPECT_EQ(lines[7], json({{"topic", "deleted"}, {"result", ok}}));
  EXPECT_EQ(lines[8]["result"], json({2, "no entity 'late'"}));
  EXPECT_EQ(lines[9]["topic"], "done");
}

// A reader that requires reliable delivery of every sample, and hangs.
TEST_F(FastDdsClientTest, AStoppedReaderDelaysNoTick) {
  const std::string session = TestSession("stopped");
  Program run = RunWithRos("pen.world", {"--session", session});
  Program reader(
      {ProgramPath("fastdds_peer"), RosDomain(), "1", "r0=0.3,0.1", "r1=0.3,0.1", "r2=0.3,0.1", "r3=0.3,0.1"});
  reader.WaitForLine("ready");
  reader.WaitForLine("\"enough\"");
  reader.Signal(SIGSTOP);
  Stepper stepper(session);
  stepper.Pause();
  const Tick before = stepper.Step(1);
  EXPECT_EQ(stepper.Step(3000), before + 3000);
  reader.Signal(SIGCONT);
  run.Interrupt();
}

}  // namespace
}  // namespace troupe::test
