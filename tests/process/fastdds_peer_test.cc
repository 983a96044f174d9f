// A program on Fast DDS, which shares no code with Troupe's side, drives two robots and reads their topics: its
// messages agree with the files that the run writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "command_line/parse_command_line.h"
#include "tests/process/programs.h"
#include "tests/process/run_files.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {
namespace {

using nlohmann::json;

constexpr int kEnough = 200;  // scans

Tick TickOf(const json& message) {
  return message["stamp"].get<std::uint64_t>() / kIntervalNs;
}

// Transforms by the name of their frame; each names its parent.
using Frames = std::map<std::string, json>;

class FastDdsPeerTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(ProgramPath("fastdds_peer"))) {
      GTEST_SKIP() << "fastdds_peer was not built: needs libfastrtps-dev and fastddsgen";
    }
  }

  // Runs a world with a peer that drives two of its robots.
  void Run(const std::string& world = "pen.world",
           const std::vector<std::string>& drives = {"r0=0.25,0.5", "r1=-0.4,0"}) {
    const std::string domain = std::to_string(TestRosNetwork().domain);
    Program peer({ProgramPath("fastdds_peer"), domain, std::to_string(kEnough), drives[0], drives[1]});
    peer.WaitForLine("ready");
    Program run = Troupe(
        Words("run % --domain % --headless --ros --ros-no-hit range-max --ros-interface lo --ros-domain % --ros-distro "
              "jazzy --speed 4 --poses % --scans %",
              {WorldPath(world), std::to_string(TestDomain()), domain, folder_.Path("poses"), folder_.Path("scans")}));
    // Until it has enough scans, however long discovery took.
    peer.WaitForLine("\"enough\"");
    run.Signal(SIGINT);
    ASSERT_EQ(run.Wait(), kExitInterrupted) << run.output();
    for (const std::string& line : LinesOf(peer.output())) {
      const json message = json::parse(line, nullptr, false);
      ASSERT_TRUE(message.is_object()) << line;
      messages_[message["topic"]].push_back(message);
    }
    poses_ = ReadPoses(folder_.Read("poses"));
    scans_ = ReadScans(folder_.Read("scans"));
  }

  void CheckTruth(const std::string& robot);
  void CheckOdometry(const std::string& robot);
  void CheckScans(const std::string& robot);
  void CheckRanges(const std::string& robot);
  void CheckPosesOfBen(Tick tick, const Frames& frames) const;

  TemporaryFolder folder_;
  std::map<std::string, std::vector<json>> messages_;
  std::map<std::pair<Tick, std::string>, LoggedPose> poses_;
  std::map<std::tuple<Tick, std::string, std::string>, std::vector<double>> scans_;
};

void FastDdsPeerTest::CheckTruth(const std::string& robot) {
  const std::vector<json>& truths = messages_["/" + robot + "/ground_truth"];
  EXPECT_GT(truths.size(), 50u);
  for (const json& truth : truths) {
    const Pose& pose = poses_.at({TickOf(truth), robot}).X_WR;
    ASSERT_EQ(truth["frame"], "map");
    ASSERT_EQ(truth["child"], robot + "/base_link");
    ASSERT_EQ(truth["position"], json({pose.x, pose.y, pose.z}));
    ASSERT_NEAR(2.0 * std::atan2(truth["orientation"][2].get<double>(), truth["orientation"][3].get<double>()),
                pose.heading, 1e-12);
    ASSERT_EQ(truth["orientation"][0], 0.0);
    ASSERT_EQ(truth["orientation"][1], 0.0);
  }
}

void FastDdsPeerTest::CheckOdometry(const std::string& robot) {
  const std::vector<json>& odometry = messages_["/" + robot + "/odom"];
  EXPECT_GT(odometry.size(), 50u);
  double variance = 0.0;
  for (const json& message : odometry) {
    ASSERT_EQ(message["frame"], robot + "/odom");
    ASSERT_EQ(message["child"], robot + "/base_link");
    ASSERT_GE(message["pose_covariance"][0].get<double>(), variance);
    variance = message["pose_covariance"][0];
    ASSERT_EQ(message["pose_covariance"][1], 0.0);
    ASSERT_EQ(message["linear"][1], 0.0);
    ASSERT_EQ(message["angular"][0], 0.0);
  }
  EXPECT_GT(variance, 0.0);
}

void FastDdsPeerTest::CheckScans(const std::string& robot) {
  const std::vector<json>& scans = messages_["/" + robot + "/scan"];
  EXPECT_GT(scans.size(), 100u);
  for (const json& scan : scans) {
    const std::vector<double>& logged = scans_.at({TickOf(scan), robot, "ranger:1.0"});
    ASSERT_EQ(scan["ranges"].get<std::vector<float>>(), std::vector<float>(logged.begin(), logged.end()));
    ASSERT_EQ(scan["intensities"].size(), logged.size());
    ASSERT_EQ(scan["frame"], robot + "/scan");
    ASSERT_EQ(scan["limits"], json({0.0, 8.0}));
    ASSERT_NEAR(scan["angles"][0].get<double>(), -0.5 * kPi, 1e-6);
    ASSERT_NEAR(scan["angles"][1].get<double>(), 0.5 * kPi, 1e-6);
    ASSERT_NEAR(scan["angles"][2].get<double>(), kPi / 18.0, 1e-6);
    ASSERT_EQ(scan["times"][0], 0.0);
    ASSERT_NEAR(scan["times"][1].get<double>(), 0.1, 1e-6);
  }
}

void FastDdsPeerTest::CheckRanges(const std::string& robot) {
  const std::vector<json>& ranges = messages_["/" + robot + "/sonar"];
  EXPECT_GT(ranges.size(), 150u);
  for (const json& range : ranges) {
    const std::string frame = range["frame"];
    const std::string sensor = "ranger:0." + frame.substr(frame.size() - 1);
    ASSERT_EQ(frame.substr(0, frame.size() - 1), robot + "/sonar_");
    ASSERT_EQ(range["range"].get<float>(), static_cast<float>(scans_.at({TickOf(range), robot, sensor}).front()));
    ASSERT_EQ(range["radiation"], 0);
    ASSERT_EQ(range["limits"], json({0.0, 4.0}));
    ASSERT_NEAR(range["fov"].get<double>(), kPi / 18.0, 1e-6);
  }
}

TEST_F(FastDdsPeerTest, ReadsTheValuesThatTheRunWritesToItsFiles) {
  Run();
  for (const char* robot : {"r0", "r1"}) {
    SCOPED_TRACE(robot);
    CheckTruth(robot);
    CheckOdometry(robot);
    CheckScans(robot);
    CheckRanges(robot);
  }

  const auto was_driven = [&](const std::string& robot, double vx, double wz) {
    for (const json& odometry : messages_["/" + robot + "/odom"]) {
      if (odometry["linear"][0] == vx && odometry["angular"][2] == wz) return true;
    }
    return false;
  };
  EXPECT_TRUE(was_driven("r0", 0.25, 0.5));
  EXPECT_TRUE(was_driven("r1", -0.4, 0.0));

  std::set<bool> stalled;
  for (const json& message : messages_["/r1/stalled"]) stalled.insert(message["data"].get<bool>());
  EXPECT_EQ(stalled, (std::set<bool>{false, true})) << "r1 backs into a wall";
}

// Every frame has one parent, and all lead to the map.
TEST_F(FastDdsPeerTest, SeesOneTreeOfFrames) {
  Run();
  std::map<std::string, std::string> parents;
  for (const char* topic : {"/tf_static", "/tf"}) {
    for (const json& message : messages_[topic]) {
      for (const json& transform : message["transforms"]) {
        const auto [parent, is_new] = parents.emplace(transform["child"], transform["frame"]);
        ASSERT_EQ(parent->second, transform["frame"]) << transform;
      }
    }
  }
  EXPECT_EQ(parents.size(), 4u * 6u);  // odom, base_link, scan and three sonars of each robot
  for (const auto& [child, parent] : parents) {
    std::string ancestor = parent;
    for (int steps = 0; ancestor != "map" && steps < 10; ++steps) ancestor = parents[ancestor];
    EXPECT_EQ(ancestor, "map") << child;
  }
  for (const json& message : messages_["/tf_static"]) {
    for (const json& transform : message["transforms"]) {
      if (transform["child"] != "r0/scan") continue;
      EXPECT_EQ(transform["translation"][0], 0.1);
      EXPECT_EQ(transform["translation"][1], 0.0);
      EXPECT_GT(transform["translation"][2].get<double>(), 0.29) << "on top of the robot";
    }
  }

  std::set<std::string> nodes;
  for (const json& message : messages_["ros_discovery_info"]) {
    for (const json& node : message["nodes"]) {
      nodes.insert(node["namespace"].get<std::string>() + " " + node["name"].get<std::string>());
    }
  }
  EXPECT_THAT(nodes, testing::IsSupersetOf({"/ world", "/r0 robot", "/r1 robot", "/r2 robot", "/r3 robot"}));
}

Pose PoseOf(const json& transform) {
  const json& shift = transform["translation"];
  const json& turn = transform["rotation"];
  return {shift[0], shift[1], shift[2], 2.0 * std::atan2(turn[2].get<double>(), turn[3].get<double>())};
}

// The pose of a frame in the map.
Pose PoseInMap(const Frames& frames, std::string frame) {
  Pose pose;
  for (int steps = 0; frame != "map"; frame = frames.at(frame)["frame"]) {
    pose = PoseOf(frames.at(frame)) * pose;
    EXPECT_LT(++steps, 10) << frame;
  }
  return pose;
}

Frames FixedFrames(const std::vector<json>& messages) {
  Frames fixed;
  for (const json& message : messages) {
    for (const json& transform : message["transforms"]) {
      EXPECT_TRUE(fixed.emplace(transform["child"], transform).second) << transform;
    }
  }
  return fixed;
}

std::map<Tick, Frames> MovingFrames(const std::vector<json>& messages) {
  std::map<Tick, Frames> moving;
  for (const json& message : messages) {
    for (const json& transform : message["transforms"]) {
      EXPECT_TRUE(moving[TickOf(transform)].emplace(transform["child"], transform).second) << transform;
    }
  }
  return moving;
}

// The heights of the lift by tick.
std::map<Tick, double> LiftHeights(const std::vector<json>& messages) {
  std::map<Tick, double> lifts;
  for (const json& message : messages) {
    EXPECT_EQ(message["name"], json({"gripper_lift", "gripper_lift_left", "gripper_lift_right"}));
    EXPECT_EQ(message["effort"], json::array());
    lifts[TickOf(message)] = message["position"][0];
  }
  return lifts;
}

void FastDdsPeerTest::CheckPosesOfBen(Tick tick, const Frames& frames) const {
  const std::pair<const char*, const char*> frames_and_names[] = {
      {"ben/base_link", "ben"},
      {"ben/gripper_lift_link", "ben.gripper.lift"},
      {"ben/gripper_lift_left_link", "ben.gripper.lift.left"},
      {"ben/gripper_lift_right_link", "ben.gripper.lift.right"}};
  for (const auto& [frame, name] : frames_and_names) {
    const Pose& logged = poses_.at({tick, name}).X_WR;
    const Pose seen = PoseInMap(frames, frame);
    ASSERT_NEAR(seen.x, logged.x, 1e-12) << frame;
    ASSERT_NEAR(seen.y, logged.y, 1e-12) << frame;
    ASSERT_NEAR(seen.z, logged.z, 1e-12) << frame;
    ASSERT_NEAR(seen.heading, logged.heading, 1e-12) << frame;
  }
}

// The peer speaks through the radios of two robots, and hears what they receive: also from the robots' own controllers.
TEST_F(FastDdsPeerTest, ExchangesMessagesByRadio) {
  Run("../../../worlds/scenarios/radio.json", {"cleo=0.02,0.05", "dora=-0.05,0.1"});
  // The receptions by tick and sender, as the scan log of cleo has them.
  std::map<std::pair<Tick, std::string>, std::vector<json>> logged;
  for (const std::string& line : LinesOf(folder_.Read("scans"))) {
    const json reading = json::parse(line);
    if (reading["robot"] != "cleo" || reading["sensor"] != "radio") continue;
    for (const json& received : reading["received"]) {
      logged[{received["tick"].get<Tick>(), received["from"]}].push_back(received);
    }
  }
  std::set<std::string> texts;
  EXPECT_GT(messages_["/cleo/radio/received"].size(), 50u);
  for (const json& message : messages_["/cleo/radio/received"]) {
    json received = json::parse(message["data"].get<std::string>());
    texts.insert(received["text"]);
    received.erase("text");
    const std::vector<json>& expected = logged[{received["tick"].get<Tick>(), received["from"]}];
    EXPECT_THAT(expected, testing::Contains(received));
  }
  EXPECT_THAT(texts, testing::IsSupersetOf({"a peer speaks for dora", "here is dora"}));
}

// The lines of --scans that have `key`, by tick and robot.
std::map<std::pair<Tick, std::string>, json> LinesWith(const std::string& scans, const char* key) {
  std::map<std::pair<Tick, std::string>, json> found;
  for (const std::string& text : LinesOf(scans)) {
    const json line = json::parse(text);
    if (line.contains(key)) found[{line["tick"], line["robot"]}] = line[key];
  }
  return found;
}

// Two robots with grippers at once. The frames connect the map with every link and sensor, each of them once. Those of
// ben, which has gps, agree with the poses of ben and its joints in --poses.
TEST_F(FastDdsPeerTest, SeesTheFramesOfTwoGrippersMove) {
  Run("hands.json", {"anna=0.02,0.05", "ben=-0.05,0.1"});
  const Frames fixed = FixedFrames(messages_["/tf_static"]);
  const std::map<Tick, double> lifts = LiftHeights(messages_["/ben/joint_states"]);
  std::set<double> heights;
  std::size_t complete = 0;
  for (const auto& [tick, frames] : MovingFrames(messages_["/tf"])) {
    Frames all = fixed;
    for (const auto& [child, transform] : frames) ASSERT_TRUE(all.emplace(child, transform).second) << child;
    if (all.size() != 13) continue;  // before the peer has discovered both robots
    ++complete;
    for (const auto& [child, transform] : all) PoseInMap(all, child);
    ASSERT_NO_FATAL_FAILURE(CheckPosesOfBen(tick, all));
    if (!lifts.contains(tick)) continue;
    heights.insert(lifts.at(tick));
    ASSERT_NEAR(PoseInMap(all, "ben/gripper_lift_link").z, 0.04 + lifts.at(tick), 1e-12);
  }
  EXPECT_GT(complete, 50u);
  EXPECT_GT(heights.size(), 10u) << "the lift moved";
  EXPECT_EQ(fixed.at("ben/scan")["frame"], "ben/gripper_lift_link");
  // 10,000 J, of which 8 W consume 0.8 J in a tick.
  EXPECT_GT(messages_["/ben/battery"].size(), 50u);
  for (const json& message : messages_["/ben/battery"]) {
    ASSERT_NEAR(message["percentage"].get<double>(), 1.0 - 8e-5 * static_cast<double>(TickOf(message)), 1e-6);
    ASSERT_EQ(message["status"], TickOf(message) == 0 ? 4 : 2) << "it is full at the start, and discharging after that";
    ASSERT_EQ(message["frame"], "ben/base_link");
  }
  EXPECT_TRUE(messages_["/anna/battery"].empty());
  const auto forces = LinesWith(folder_.Read("scans"), "force");
  EXPECT_GT(messages_["/ben/imu/data"].size(), 50u);
  for (const json& message : messages_["/ben/imu/data"]) {
    ASSERT_EQ(message["force"], forces.at({TickOf(message), "ben"}));
    ASSERT_NEAR(message["force_variance"].get<double>(), 0.05 * 0.05, 1e-12);
    ASSERT_EQ(message["frame"], "ben/imu");
  }
  EXPECT_EQ(fixed.at("anna/scan")["frame"], "anna/base_link");

  EXPECT_THAT(messages_["/ben/robot_description"].front()["data"].get<std::string>(),
              testing::HasSubstr(R"(<joint name="gripper_lift" type="prismatic"><parent link="ben/base_link"/>)"));
  for (const json& message : messages_["/ben/gripper/state"]) {
    const json state = json::parse(message["data"].get<std::string>());
    EXPECT_NEAR(state["largest_opening"].get<double>(), 0.32, 1e-9);
  }
  json anna;  // as listed last: services are listed once Fast DDS serves them
  for (const json& message : messages_["ros_discovery_info"]) {
    for (const json& node : message["nodes"]) {
      if (node["namespace"] == "/anna") anna = node;
    }
  }
  EXPECT_EQ(anna["readers"], 1 + 2 + 3 + 6 + 1) << "cmd_vel, gripper and lift, the action, parameters, types";
  EXPECT_EQ(anna["writers"], 9 + 2 + 3 + 6 + 3) << "topics, the action's, its services, parameters, rosout, "
                                                   "parameter_events, types";
}

TEST_F(FastDdsPeerTest, ReadsTheDetectionsOfFindersAsTheRunLogsThem) {
  Run("seen.world", {"r0=0.05,0.5", "r1=0,-0.6"});
  const std::string log = folder_.Read("scans");
  const auto fiducials = LinesWith(log, "fiducials");
  const auto blobs = LinesWith(log, "blobs");
  std::size_t found = 0;
  std::size_t colors = 0;
  for (const std::string robot : {"r0", "r1"}) {
    EXPECT_GT(messages_["/" + robot + "/fiducial/detections"].size(), 50u);
    for (const json& message : messages_["/" + robot + "/fiducial/detections"]) {
      ASSERT_EQ(message["frame"], robot + "/fiducial");
      const json& logged = fiducials.at({TickOf(message), robot});
      ASSERT_EQ(message["detections"].size(), logged.size());
      for (std::size_t i = 0; i < logged.size(); ++i, ++found) {
        const json& seen = message["detections"][i];
        const json& pose = logged[i]["pose"];
        ASSERT_EQ(seen["class"], std::to_string(logged[i]["id"].get<int>()));
        ASSERT_EQ(seen["id"], logged[i]["model"]);
        ASSERT_EQ(seen["position"], json({pose[0], pose[1], pose[2]}));
        ASSERT_NEAR(seen["orientation"][2].get<double>(), std::sin(0.5 * pose[3].get<double>()), 1e-12);
        ASSERT_EQ(seen["size"], logged[i]["size"]);
        ASSERT_NEAR(seen["center"][2].get<double>(), pose[2].get<double>() + 0.5 * logged[i]["size"][2].get<double>(),
                    1e-12);
      }
    }
    EXPECT_GT(messages_["/" + robot + "/blobfinder/detections"].size(), 50u);
    for (const json& message : messages_["/" + robot + "/blobfinder/detections"]) {
      ASSERT_EQ(message["frame"], robot + "/blobfinder");
      const json& logged = blobs.at({TickOf(message), robot});
      ASSERT_EQ(message["detections"].size(), logged.size());
      for (std::size_t i = 0; i < logged.size(); ++i, ++colors) {
        const double width = logged[i]["right"].get<double>() - logged[i]["left"].get<double>();
        ASSERT_EQ(message["detections"][i]["box"][0].get<double>(), logged[i]["left"].get<double>() + 0.5 * width);
        ASSERT_EQ(message["detections"][i]["box"][2].get<double>(), width);
        ASSERT_THAT(message["detections"][i]["class"].get<std::string>(),
                    testing::AnyOf("#ff0000", "#0000ff", "#00ff00"));
      }
    }
  }
  EXPECT_GT(found, 50u);
  EXPECT_GT(colors, 50u);
  bool has_frame = false;
  for (const json& message : messages_["/tf_static"]) {
    for (const json& transform : message["transforms"]) has_frame |= transform["child"] == "r0/blobfinder";
  }
  EXPECT_TRUE(has_frame);
}

TEST_F(FastDdsPeerTest, ReadsTheMapTheBlocksAndTheRobots) {
  Run();
  ASSERT_EQ(messages_["/map"].size(), 1u);
  const json& map = messages_["/map"].front();
  EXPECT_EQ(map["frame"], "map");
  EXPECT_NEAR(map["resolution"].get<double>(), 0.05, 1e-6);
  EXPECT_EQ(map["width"], 128);  // 6.4 m
  EXPECT_EQ(map["height"], 128);
  EXPECT_NEAR(map["origin"][0].get<double>(), -3.2, 1e-9);
  EXPECT_EQ(map["cells"], 128 * 128);
  EXPECT_EQ(map["occupied"].get<int>() + map["free"].get<int>(), 128 * 128);
  EXPECT_EQ(map["occupied"], 4 * 4 * 124);  // the walls; the bars are below and above the scanners

  ASSERT_EQ(messages_["/blocks"].size(), 1u);
  std::set<std::string> frames;
  for (const json& marker : messages_["/blocks"].front()["markers"]) {
    frames.insert(marker["frame"]);
    EXPECT_EQ(marker["type"], 11);
    EXPECT_EQ(marker["points"].get<int>() % 3, 0);
    EXPECT_EQ(marker["scale"], json({1.0, 1.0, 1.0}));
  }
  EXPECT_EQ(frames, (std::set<std::string>{"map", "r0/base_link", "r1/base_link", "r2/base_link", "r3/base_link"}));

  ASSERT_EQ(messages_["/r0/robot_description"].size(), 1u);
  EXPECT_THAT(messages_["/r0/robot_description"].front()["data"].get<std::string>(),
              testing::HasSubstr("<link name=\"r0/base_link\">"));
  EXPECT_TRUE(messages_["/r0/joint_states"].empty()) << "r0 has no joints";

  EXPECT_GT(messages_["/r0/sonar/points"].size(), 50u);
  for (const json& cloud : messages_["/r0/sonar/points"]) {
    ASSERT_EQ(cloud["frame"], "r0/base_link");
    ASSERT_EQ(cloud["steps"][0], 12);
    ASSERT_EQ(cloud["data"].size(), 12u * cloud["size"][0].get<unsigned>());
    ASSERT_EQ(cloud["fields"], json({{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}}));
  }

  bool stalled = false;
  for (const json& message : messages_["/events"]) {
    const json event = json::parse(message["data"].get<std::string>());
    stalled = stalled || (event["event"] == "stall_began" && event["robot"] == "r1");
  }
  EXPECT_TRUE(stalled);
}

}  // namespace
}  // namespace troupe::test
