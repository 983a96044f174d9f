#include "world-service/observers/recorder/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

class RecorderTest : public testing::Test {
 protected:
  std::string Text() const { return test::TextOf(path_); }
  FrameMessage Frame(Tick tick) const {
    FrameMessage frame;
    frame.state = PlacedState(world_);
    frame.state.tick = tick;
    frame.state_hash = 0xabc0 + tick;
    frame.state.robots[0].X_WR = {0.1, -1e-300, 0.0, 1.0 / 3.0};
    frame.state.robots[1].stalled = true;
    return frame;
  }
  // Writes frames 0 to 2.
  void Record(const OutputFiles& files, const std::vector<Event>& events = {}) {
    std::unique_ptr<Recorder> recorder = test::ValueOf(Recorder::Create(world_, files));
    for (Tick tick = 0; tick <= 2; ++tick) {
      FrameMessage frame = Frame(tick);
      if (tick == 2) frame.events = events;
      EXPECT_TRUE(recorder->OnTick({frame, {}}).ok());
    }
    EXPECT_TRUE(recorder->OnEnd().ok());
  }

  WorldDescription world_ = test::PlaneWorld(2);
  const test::TemporaryFolder folder_;
  const std::string path_ = folder_.Path("file");
};

TEST_F(RecorderTest, HashLogHasALineForEachTick) {
  Record({.hash_log = path_, .poses = "", .record = ""});
  EXPECT_EQ(Text(), "0 000000000000abc0\n1 000000000000abc1\n2 000000000000abc2\n");
}

TEST_F(RecorderTest, PosesReadBackToTheLastBit) {
  world_.robots[1].name = world_.models[1].name = "odd, \"name\"";
  Record({.hash_log = "", .poses = path_, .record = ""});
  const std::vector<std::string> lines = test::LinesOf(Text());
  EXPECT_EQ(lines.at(0), "tick,robot,x,y,z,heading,stalled");
  const std::string& line = lines.at(1);
  EXPECT_EQ(line, "0,r0,0.1,-1e-300,0,0.3333333333333333,0");
  double heading = 0.0;
  const std::size_t at = line.find("0.333");
  std::from_chars(line.data() + at, line.data() + line.size(), heading);
  EXPECT_EQ(heading, 1.0 / 3.0);
  EXPECT_EQ(lines.at(2), "0,\"odd, \"\"name\"\"\",0,10,0,0,1");
}

TEST_F(RecorderTest, RecordIsAJsonObjectForEachTick) {
  Record({.hash_log = "", .poses = "", .record = path_},
         {{2, EventType::kStallBegan, RobotId(0), ModelId(1), "\xff not \"UTF-8\""}});
  const std::vector<std::string> lines = test::LinesOf(Text());
  const auto header = nlohmann::json::parse(lines.at(0));
  EXPECT_EQ(header["world"], "plane");
  EXPECT_EQ(header["robots"], nlohmann::json({"r0", "r1"}));
  EXPECT_EQ(header["interval_ns"], 100000000);
  ASSERT_EQ(lines.size(), 4u);
  for (std::size_t tick = 0; tick <= 2; ++tick) {
    const auto frame = nlohmann::json::parse(lines[tick + 1]);
    EXPECT_EQ(frame["tick"], tick);
    EXPECT_EQ(frame["hash"], "000000000000abc" + std::to_string(tick));
    EXPECT_EQ(frame["robots"], nlohmann::json::parse("[[0.1,-1e-300,0,0.3333333333333333,0],[0,10,0,0,1]]"));
    EXPECT_EQ(frame.contains("events"), tick == 2);
    if (tick == 2) {
      EXPECT_EQ(frame["events"][0]["event"], "stall_began");
      EXPECT_EQ(frame["events"][0]["robot"], "r0");
      EXPECT_EQ(frame["events"][0]["other"], "r1");
    }
  }
}

// A robot with a lift that is the gripper and turns, which is enough for a recorder, and two boxes.
class ManipulationRecorderTest : public RecorderTest {
 protected:
  ManipulationRecorderTest() {
    for (const char* name : {"r1.lift", "box", "lid, \"red\""}) {
      world_.models.push_back(world_.models.back());
      world_.models.back().name = name;
      world_.models.back().X_PM = {1.0, 0.0, 0.5, 0.0};
    }
    world_.models[2].parent = world_.robots[1].root;
    JointDescription joint{.name = "lift", .robot = RobotId(1), .model = ModelId(2)};
    world_.joints = {joint};
    GripperDescription gripper{.robot = RobotId(0), .model = ModelId(2)};
    gripper.left = gripper.right = JointId(0);
    gripper.left_pad = gripper.right_pad = ModelId(2);
    world_.grippers = {gripper};
    world_.objects = {ModelId(3), ModelId(4)};
    state_ = PlacedState(world_);
    state_.joints[0] = {0.25, -0.5, true};
    state_.grippers[0] = {ModelId(3), {}, ObjectId(0)};
    state_.objects[0].mode = ObjectMode::kHeld;
    state_.objects[0].holder = GripperId(0);
    state_.objects[1].mode = ObjectMode::kResting;
    state_.objects[1].support = ModelId(3);
  }
  void RecordState(const OutputFiles& files, const std::vector<Event>& events = {}) {
    std::unique_ptr<Recorder> recorder = test::ValueOf(Recorder::Create(world_, files));
    FrameMessage frame{.state = state_, .events = events};
    EXPECT_TRUE(recorder->OnTick({frame, {}}).ok());
    EXPECT_TRUE(recorder->OnEnd().ok());
  }
  WorldState state_;
};

TEST_F(ManipulationRecorderTest, PosesHaveObjectsAndJointsAfterTheRobots) {
  RecordState({.hash_log = "", .poses = path_, .record = ""});
  EXPECT_EQ(Text(),
            "tick,robot,x,y,z,heading,stalled,kind,position,mode,on\n"
            "0,r0,0,0,0,0,0,robot,,,\n"
            "0,r1,0,10,0,0,0,robot,,,\n"
            "0,box,1,0,0.5,0,0,object,,held,r1.lift\n"
            "0,\"lid, \"\"red\"\"\",1,0,0.5,0,0,object,,resting,box\n"
            "0,r1.lift,1,10,0.75,0,1,joint,0.25,,\n");
}

TEST_F(RecorderTest, PosesHaveDoorsAndLiftsAsEveryTable) {
  world_.models.push_back(world_.models.back());
  world_.models.back().name = "gate";
  world_.models.push_back(world_.models.back());
  world_.models.back().name = "hoist";
  world_.models.push_back(world_.models.back());
  world_.models.back().name = "cabin";
  world_.objects = {ModelId(4)};
  world_.doors = {{.model = ModelId(2), .leaves = {}, .opening = 0.5}};
  world_.lifts = {{.model = ModelId(3), .cabin = ObjectId(0), .cabin_doors = {}, .floors = {{"up", 1.5, {}}}}};
  std::unique_ptr<Recorder> recorder = test::ValueOf(Recorder::Create(world_, {.poses = path_}));
  FrameMessage frame{.state = PlacedState(world_)};
  frame.state.objects[0].X_WO = {1.0, 2.0, 1.5, 0.0};
  frame.state.lifts[0].z = 1.5;
  frame.state.lifts[0].blocked = true;
  EXPECT_TRUE(recorder->OnTick({frame, {}}).ok());
  EXPECT_TRUE(recorder->OnEnd().ok());
  EXPECT_THAT(Text(), HasSubstr("\n0,gate,0,10,0,0,0,door,0.5,,\n0,hoist,1,2,1.5,0,1,lift,1.5,up,\n"));
}

TEST_F(ManipulationRecorderTest, TheRecordHasThemToo) {
  RecordState({.hash_log = "", .poses = "", .record = path_},
              {{0, EventType::kGripped, RobotId(1), {}, "lift", ModelId(3)}});
  const std::vector<std::string> lines = test::LinesOf(Text());
  const auto header = nlohmann::json::parse(lines.at(0));
  EXPECT_EQ(header["joints"], nlohmann::json({"r1.lift"}));
  EXPECT_EQ(header["grippers"], nlohmann::json({"r1.lift"}));
  EXPECT_EQ(header["objects"], nlohmann::json({"box", "lid, \"red\""}));
  const auto frame = nlohmann::json::parse(lines.at(1));
  EXPECT_EQ(frame["joints"], nlohmann::json::parse("[[0.25,-0.5,1]]"));
  EXPECT_EQ(frame["grippers"], nlohmann::json::parse(R"([["box",null,"box"]])"));
  EXPECT_EQ(frame["objects"],
            nlohmann::json::parse(R"([[1.0,0.0,0.5,0.0,"held","r1.lift"],[1.0,0.0,0.5,0.0,"resting","box"]])"));
  EXPECT_EQ(frame["events"][0],
            nlohmann::json::parse(R"({"event":"gripped","robot":"r1","object":"box","detail":"lift"})"));
}

TEST_F(RecorderTest, RecordOfAWorldWithoutRobotsIsJsonToo) {
  world_ = test::PlaneWorld(0);
  std::unique_ptr<Recorder> recorder =
      test::ValueOf(Recorder::Create(world_, {.hash_log = "", .poses = "", .record = path_}));
  EXPECT_TRUE(recorder->OnTick({FrameMessage{}, {}}).ok());
  EXPECT_TRUE(recorder->OnEnd().ok());
  const std::string text = Text();
  EXPECT_EQ(nlohmann::json::parse(text.substr(text.find('\n')))["robots"], nlohmann::json::array());
}

TEST_F(RecorderTest, ReportsAFileThatCannotBeMade) {
  const Result<std::unique_ptr<Recorder>> recorder =
      Recorder::Create(world_, {.hash_log = "/nowhere/h", .poses = "", .record = ""});
  ASSERT_FALSE(recorder.ok());
  EXPECT_EQ(recorder.error().ToString(), "/nowhere/h: error: cannot open for writing: No such file or directory");
}

TEST_F(RecorderTest, ReportsAFullDisk) {
  std::unique_ptr<Recorder> recorder =
      test::ValueOf(Recorder::Create(world_, {.hash_log = "", .poses = "/dev/full", .record = ""}));
  Status error;
  for (Tick tick = 0; tick < 10000 && error.ok(); ++tick) error = recorder->OnTick({Frame(tick), {}});
  ASSERT_FALSE(error.ok());
  EXPECT_THAT(error.error().ToString(), HasSubstr("/dev/full: error: cannot write: No space left"));
  EXPECT_FALSE(recorder->OnEnd().ok());
}

TEST_F(RecorderTest, ReportsADiskThatIsFullAtTheEnd) {
  std::unique_ptr<Recorder> recorder =
      test::ValueOf(Recorder::Create(world_, {.hash_log = "/dev/full", .poses = "", .record = ""}));
  EXPECT_TRUE(recorder->OnTick({Frame(0), {}}).ok());  // still in the buffer
  EXPECT_FALSE(recorder->OnEnd().ok());
}

}  // namespace
}  // namespace troupe
