// Recordings in the formats of other programs. scripts/mcap-check reads them with libraries of others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recording/mcap/reader.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Key;
using testing::Pair;
using testing::SizeIs;
using testing::StartsWith;

constexpr int kExportedTicks = 60;
constexpr const char* kTables[] = {"/tables/robots", "/tables/joints", "/tables/grippers", "/tables/objects"};

// A recording of a robot that grips a box.
class ExportTest : public testing::Test {
 protected:
  ExportTest() {
    OutputOf(Troupe({"run", std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/stage_stacking.json",
                     "--in-process", "--headless", "--ticks", std::to_string(kExportedTicks), "--record",
                     Path("run.mcap"), "--poses", Path("run-poses")}));
  }
  std::string Path(const std::string& name) const { return folder_.Path(name); }
  Finished Export(const std::string& format, const std::string& output, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"export", Path("run.mcap"), "--format", format, "-o", Path(output)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Finish(Troupe(arguments));
  }
  // By topic: the name of its schema, and its messages.
  struct Topic {
    std::string type;
    std::string encoding;
    std::string definition;
    std::vector<std::string> messages;
  };
  std::map<std::string, Topic> ReadMcap(const std::string& name, const std::string& profile) const {
    std::map<std::string, Topic> topics;
    const Result<mcap::Reader> reader = mcap::Reader::Open(mcap::OpenFileSource(Path(name)).value());
    EXPECT_TRUE(reader.ok() && !reader.value().damage() && reader.value().CheckData().ok());
    if (!reader.ok()) return topics;
    EXPECT_EQ(reader.value().profile(), profile);
    for (const auto& [id, channel] : reader.value().channels()) {
      const mcap::Schema& schema = reader.value().schemas().at(channel.schema);
      topics[channel.topic] = {schema.name, channel.message_encoding + " " + schema.encoding, schema.data, {}};
    }
    for (std::size_t i = 0; i < reader.value().chunks().size(); ++i) {
      const Result<mcap::Chunk> chunk = reader.value().ReadChunk(i);
      EXPECT_TRUE(chunk.ok());
      for (const mcap::Message& message : chunk.value().messages) {
        const auto* const bytes = reinterpret_cast<const char*>(message.data.data());
        topics[reader.value().channels().at(message.channel).topic].messages.emplace_back(bytes, message.data.size());
      }
    }
    return topics;
  }

  TemporaryFolder folder_;
};

TEST_F(ExportTest, ForFoxgloveHasTheSceneAndTheFramesOfEachTick) {
  EXPECT_THAT(OutputOf(Export("foxglove", "f.mcap")), HasSubstr("61 states, of ticks 0 to 60, in "));
  const std::map<std::string, Topic> topics = ReadMcap("f.mcap", "");
  ASSERT_THAT(topics, Contains(Key("/scene")));
  EXPECT_EQ(topics.at("/scene").type, "foxglove.SceneUpdate");
  EXPECT_EQ(topics.at("/scene").encoding, "json jsonschema");
  EXPECT_THAT(topics.at("/scene").messages, SizeIs(1));
  EXPECT_THAT(topics.at("/tf").messages, SizeIs(kExportedTicks + 1));
  for (const char* const name : kTables) EXPECT_THAT(topics.at(name).messages, SizeIs(kExportedTicks + 1)) << name;
  const nlohmann::json robots = nlohmann::json::parse(topics.at("/tables/robots").messages.back());
  EXPECT_EQ(robots["timestamp"]["sec"], 6);
  EXPECT_EQ(robots["rows"][0]["name"], "r");
  for (const auto& [name, topic] : topics) {
    EXPECT_TRUE(nlohmann::json::accept(topic.definition)) << name;
    for (const std::string& message : topic.messages) EXPECT_TRUE(nlohmann::json::accept(message)) << name;
  }
  const nlohmann::json frames = nlohmann::json::parse(topics.at("/tf").messages.back())["transforms"];
  EXPECT_EQ(frames[0]["parent_frame_id"], "map");
  EXPECT_EQ(frames[0]["child_frame_id"], "r");
  EXPECT_EQ(frames[0]["timestamp"]["sec"], 6);
}

TEST_F(ExportTest, ForRosIsABag) {
  OutputOf(Export("ros2", "bag"));
  const std::map<std::string, Topic> topics = ReadMcap("bag/bag_0.mcap", "ros2");
  const std::string metadata = folder_.Read("bag/metadata.yaml");
  EXPECT_THAT(metadata, StartsWith("rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"));
  EXPECT_THAT(metadata, HasSubstr("  relative_file_paths:\n    - \"bag_0.mcap\"\n"));
  for (const auto& [name, topic] : topics) {
    EXPECT_EQ(topic.encoding, "cdr ros2msg") << name;
    EXPECT_THAT(metadata, HasSubstr("name: \"" + name + "\"\n        type: " + topic.type)) << name;
    EXPECT_FALSE(topic.definition.empty()) << name;
  }
  for (const char* name : {"/tf", "/tf_static", "/map", "/blocks", "/objects", "/r/ground_truth", "/r/joint_states",
                           "/r/robot_description", "/events"}) {
    EXPECT_THAT(topics, Contains(Key(name)));
  }
  for (const char* const name : kTables) EXPECT_THAT(topics.at(name).messages, SizeIs(kExportedTicks + 1)) << name;
  EXPECT_THAT(topics.at("/tables/objects").messages.back(), HasSubstr("{\"name\":\"box\",\"x\":"));
  EXPECT_THAT(topics.at("/tf").messages, SizeIs(kExportedTicks + 1));
  EXPECT_THAT(topics.at("/tf").definition,
              HasSubstr("geometry_msgs/TransformStamped[] transforms\n" + std::string(80, '=') +
                        "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"));
  OutputOf(Export("ros2", "alone.mcap", {"--from", "10", "--to", "19"}));
  EXPECT_THAT(ReadMcap("alone.mcap", "ros2").at("/tf").messages, SizeIs(10));
}

TEST_F(ExportTest, ForTablesHasTheColumnsThatTheirFirstLinesName) {
  OutputOf(Export("csv", "tables"));
  const auto lines = [&](const std::string& name) {
    std::vector<std::string> all;
    for (const std::string& line : LinesOf(folder_.Read(name))) all.push_back(line);
    return all;
  };
  const std::vector<std::string> poses = lines("tables/poses.csv");
  ASSERT_THAT(poses, SizeIs(kExportedTicks + 2));
  EXPECT_EQ(poses[0],
            "time,tick,robot,x,y,z,heading,vx,vy,wz,stalled,speed,level,energy,capacity,charging,"
            "waiting,arrivals,waits_for,goods,loaded,wants_charge,wait_time,blocked_by");
  // The numbers are those of --poses.
  std::vector<std::string> of_run;
  for (const std::string& line : lines("run-poses")) {
    if (line.starts_with("60,r,")) of_run.push_back(line);
  }
  ASSERT_THAT(of_run, SizeIs(1));
  const std::string pose = of_run[0].substr(0, of_run[0].find(",robot,"));
  EXPECT_THAT(poses.back(), StartsWith("6," + pose.substr(0, pose.rfind(',')) + ","));
  for (const char* name : {"objects", "joints", "events", "readings"}) {
    const std::vector<std::string> table = lines(std::string("tables/") + name + ".csv");
    ASSERT_FALSE(table.empty()) << name;
    const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
    for (const std::string& line : table) EXPECT_EQ(commas(line), commas(table[0])) << line;
  }
  EXPECT_THAT(lines("tables/objects.csv"), SizeIs(testing::Gt(kExportedTicks)));
  EXPECT_THAT(folder_.Read("tables/events.csv"), HasSubstr(",gripped,r,box,"));
  OutputOf(Export("csv", "poses.csv"));
  EXPECT_EQ(folder_.Read("poses.csv"), folder_.Read("tables/poses.csv"));
}

TEST_F(ExportTest, RefusesWhatIsNoRecordingAndTheRecordingAsOutput) {
  EXPECT_THAT(OutputOf(Export("foxglove", "run.mcap"), 2), HasSubstr("which the command reads"));
  EXPECT_THAT(OutputOf(Export("xml", "x"), 2), HasSubstr("expected one of foxglove, ros2, csv"));
  EXPECT_THAT(OutputOf(Export("csv", "t", {"--from", "1000"}), 2), HasSubstr("found tick 1000, expected at most"));
  EXPECT_THAT(OutputOf(Troupe({"export", Path("run-poses"), "--format", "csv", "-o", Path("t")}), 2),
              HasSubstr("run-poses: error: "));
}

}  // namespace
}  // namespace troupe::test
