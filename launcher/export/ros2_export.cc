// The topics that ROS 2 tools see of a live run (robot-agent/ros, world-service/observers/ros), as a bag.
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/file.h"
#include "common/base/json_writer.h"
#include "common/signals/state_tables.h"
#include "common/spatial/occupancy_grid.h"
#include "launcher/export/mcap_file.h"
#include "launcher/export/run_export.h"
#include "ros/connection/topic_types.h"
#include "ros/connection/type_descriptions.h"
#include "ros/messages/convert.h"
#include "ros/messages/names.h"
#include "ros/messages/robot_frames.h"
#include "transport/wire/cdr.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

// The types of fields by their numbers (type_description_interfaces/msg/FieldType), without those of strings with a
// bound, which no topic here has.
constexpr const char* kFieldTypes[] = {"",      "",       "int8",  "uint8",  "int16",   "uint16",
                                       "int32", "uint32", "int64", "uint64", "float32", "float64",
                                       "",      "char",   "",      "bool",   "byte",    "string"};
constexpr std::uint8_t kArrays = 48;      // added to the type: of fixed size,
constexpr std::uint8_t kBounded = 96;     // with at most so many elements,
constexpr std::uint8_t kUnbounded = 144;  // or any number

// In the text form of .msg files, since readers of bags without the packages decode by it (MCAP's encoding ros2msg).
std::string FieldText(const ros::DescribedField& field) {
  const std::uint8_t element = field.type % kArrays;
  std::string text = field.nested_type;
  if (const std::size_t msg = text.find("/msg/"); msg != std::string::npos) text.erase(msg, 4);  // "std_msgs/Header"
  if (text.empty()) text = element < std::size(kFieldTypes) ? kFieldTypes[element] : "";
  if (field.type >= kUnbounded) {
    text += "[]";
  } else if (field.type >= kBounded) {
    text += fmt::format("[<={}]", field.capacity);
  } else if (field.type >= kArrays) {
    text += fmt::format("[{}]", field.capacity);
  }
  return text + " " + field.name + "\n";
}

// The text of a .msg file, followed by the texts of the types in it.
std::string MessageDefinition(const std::string& ros_type) {
  std::string text;
  for (const ros::DescribedType& type : ros::DescribeType(ros_type)) {
    if (type.name != ros_type) {
      std::string name = type.name;
      name.erase(name.find("/msg/"), 4);
      text += std::string(80, '=') + "\nMSG: " + name + "\n";
    }
    for (const ros::DescribedField& field : type.fields) text += FieldText(field);
  }
  return text;
}

// As rosbag2 writes the quality of service; that of Humble, which later versions read.
// Numbers of rmw's enums: keep last, reliable, transient local or volatile.
std::string QosText(bool is_latched) {
  constexpr const char* kForever = "sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: 1\n  depth: {}\n  reliability: 1\n  durability: {}\n  deadline:\n    {}  lifespan:\n    {}"
      "  liveliness: 1\n  liveliness_lease_duration:\n    {}  avoid_ros_namespace_conventions: false",
      is_latched ? 1 : 10, is_latched ? 1 : 2, kForever, kForever, kForever);
}

constexpr const char* kQos = "offered_qos_profiles";

// A bag needs no ROS here: messages are made by the functions of the live topics (ros/messages), and their types are
// described by the generated descriptors.
class Ros2Export final : public RunExport {
 public:
  // `metadata`: the path of metadata.yaml; empty: none.
  Ros2Export(McapFile file, std::string name, std::string metadata)
      : file_(std::move(file)), name_(std::move(name)), metadata_(std::move(metadata)) {}

  // The stamps are the times of the recording, which do not decrease, and not the ticks, which an edit may set back.
  Status Add(const ReplayedWorld& world, std::uint64_t time) override {
    constexpr std::uint64_t kSecond = 1'000'000'000;
    world_ = &world;
    time_ = time;
    stamp_ = {static_cast<std::int32_t>(time / kSecond), static_cast<std::uint32_t>(time % kSecond)};
    readings_.SetState(world);
    if (scene_ != world.scene()) ChangeWorld();
    AddTransforms();
    for (const Event& event : world.events()) {
      dds::WireArena arena;
      Write("/events", ros::String{arena.Copy(EventText(world.world(), event))});
    }
    if (!world.world().objects.empty()) {
      dds::WireArena arena;
      Write("/objects", ros::MakeObjectMarkers(*scene_, world.state(), arena), true);
    }
    for (Robot& robot : robots_) AddRobot(robot);
    AddTables();
    return std::exchange(status_, Status());
  }

  Status Close() override {
    if (Status closed = file_.Close(); !closed.ok() || metadata_.empty()) return closed;
    const Status written = WriteWholeFile(metadata_, MetadataText());
    return written.ok() ? written : Status(Error{{metadata_}, written.error().message, ErrorCode::kFailure});
  }

 private:
  struct Robot {
    RobotId id;
    std::string prefix;  // of its topics, "/anna/"
    ros::FrameNames frames;
    ros::RobotFrames tree;
    ros::SensorTopics sensors;
  };

  const WorldDescription& description() const { return world_->world(); }

  // Latched topics are written again for each world: the newest message counts for a player that begins later.
  void ChangeWorld() {
    scene_ = world_->scene();
    things_.emplace(description());
    robots_.clear();
    const std::vector<std::string> names = ros::RobotNames(description());
    std::vector<std::vector<std::string>> links(description().robots.size());
    dds::WireArena arena;
    std::vector<ros::TransformStamped> fixed;
    for (std::size_t i = 0; i < description().robots.size(); ++i) {
      const RobotId id(i);
      if (!RobotExists(description(), id)) continue;
      const ros::FrameNames frames = ros::FramesOf(names[i], true, ros::BaseFrameOf(description().robots[i]));
      Robot& robot =
          robots_.emplace_back(Robot{id, "/" + names[i] + "/", frames, ros::RobotFramesOf(*scene_, id, frames),
                                     ros::SensorTopicsOf(description().robots[i])});
      links[i] = robot.tree.links;
      for (const ros::FixedFrame& frame : robot.tree.fixed) {
        fixed.push_back(ros::MakeTransform(stamp_, frame, arena));
      }
      Write(robot.prefix + "robot_description",
            ros::String{arena.Copy(ros::MakeRobotDescription(*scene_, id, names[i], frames))}, true);
    }
    Write("/tf_static", ros::MakeTfMessage(fixed, arena), true);
    const OccupancyGrid grid = MakeOccupancyGrid(*scene_, std::nullopt, UsualMapHeight(*scene_));
    Write("/map", ros::MakeMap(grid, arena), true);
    Write("/blocks", ros::MakeBlockMarkers(*scene_, links, arena, has_world_), true);
    has_world_ = true;
  }

  void AddTransforms() {
    dds::WireArena arena;
    std::vector<ros::TransformStamped> transforms;
    const WorldState& state = world_->state();
    for (const Robot& robot : robots_) {
      transforms.push_back(
          ros::MakeTransform(stamp_, ros::kMapFrame, robot.frames.base, state.robots[robot.id.index()].X_WR, arena));
      for (const ros::MovingFrame& frame : robot.tree.moving) {
        const Pose pose = ros::X_PF(frame, description(), state.joints[frame.joint.index()].position);
        transforms.push_back(ros::MakeTransform(stamp_, frame.parent, frame.frame, pose, arena));
      }
    }
    if (!transforms.empty()) Write("/tf", ros::MakeTfMessage(transforms, arena));
  }

  // ROS has no type of message for a table: texts of JSON, as the rows of Foxglove's tables.
  void AddTables() {
    const SignalView view{*things_, description(), world_->state()};
    for (const StateTable& table : StateTables()) {
      if (!table.varies && things_->count(KindOf(table.name)) == 0) continue;
      dds::WireArena arena;
      text_.clear();
      JsonWriter json(text_);
      WriteRows(table, view, json);
      Write("/tables/" + table.name, ros::String{arena.Copy(text_)});
    }
  }

  void AddRobot(const Robot& robot) {
    const WorldState& state = world_->state();
    const RobotState& own = state.robots[robot.id.index()];
    {
      dds::WireArena arena;
      Write(robot.prefix + "ground_truth",
            ros::MakeOdometry(stamp_, ros::kMapFrame, robot.frames.base, own.X_WR, own.twist, {}, arena));
      Write(robot.prefix + "stalled", ros::Bool{own.stalled});
    }
    if (!robot.tree.moving.empty()) {
      std::vector<ros::NamedJoint> joints;
      for (const ros::MovingFrame& frame : robot.tree.moving) {
        joints.push_back({frame.joint_name, state.joints[frame.joint.index()]});
      }
      dds::WireArena arena;
      Write(robot.prefix + "joint_states", ros::MakeJointState(stamp_, joints, arena));
    }
    const RobotDescription& model = description().robot(robot.id);
    if (const std::optional<std::size_t> store = scene_->store_of(model.root)) {
      dds::WireArena arena;
      Write(robot.prefix + "battery",
            ros::MakeBatteryState(stamp_, robot.frames.base, description().model(scene_->stores()[*store].model).power,
                                  state.stores[*store], arena));
    }
    AddRangers(robot);
    AddOthers(robot);
  }

  void AddRangers(const Robot& robot) {
    for (const ros::LaserTopic& laser : robot.sensors.lasers) {
      const RangerReading* const reading = ReadingOf(robot, laser.ranger);
      if (reading == nullptr) continue;
      const double period =
          description().robot(robot.id).sensors[laser.ranger].period_ticks * description().interval_seconds();
      dds::WireArena arena;
      Write(robot.prefix + laser.topic, ros::MakeLaserScan(stamp_, robot.frames.prefix + laser.frame,
                                                           reading->scan(laser.sensor), period, true, arena));
    }
    for (const ros::CloudTopic& cloud : robot.sensors.clouds) {
      const RangerReading* const reading = ReadingOf(robot, cloud.ranger);
      if (reading == nullptr) continue;
      dds::WireArena arena;
      Write(robot.prefix + cloud.topic + "/points",
            ros::MakeScanCloud(stamp_, robot.frames.prefix + cloud.frame, reading->scan(cloud.sensor), arena));
    }
    for (const ros::SonarTopic& sonar : robot.sensors.sonars) {
      const RangerReading* const reading = ReadingOf(robot, sonar.ranger);
      if (reading == nullptr) continue;
      for (const ros::SonarTopic::Sensor& sensor : sonar.sensors) {
        dds::WireArena arena;
        Write(robot.prefix + sonar.topic,
              ros::MakeRange(stamp_, robot.frames.prefix + sensor.frame, reading->scan(sensor.index), arena));
      }
    }
  }

  // Cameras are left out: their pictures would be most of the file.
  void AddOthers(const Robot& robot) {
    for (const ros::KindTopic& topic : robot.sensors.finders) {
      if (!readings_.IsDue(robot.id, topic.sensor)) continue;
      const FiducialReading* const reading = readings_.Measure(robot.id, topic.sensor).As<FiducialReading>();
      if (reading == nullptr) continue;
      dds::WireArena arena;
      Write(robot.prefix + topic.topic + "/detections",
            ros::MakeFiducialDetections(stamp_, robot.frames.prefix + topic.frame, description(), *reading, arena));
    }
    for (const ros::KindTopic& topic : robot.sensors.imus) {
      if (!readings_.IsDue(robot.id, topic.sensor)) continue;
      const ImuReading* const reading = readings_.Measure(robot.id, topic.sensor).As<ImuReading>();
      if (reading == nullptr) continue;
      dds::WireArena arena;
      Write(robot.prefix + topic.topic + "/data",
            ros::MakeImuMessage(stamp_, robot.frames.prefix + topic.frame, *reading, arena));
    }
  }

  // Null unless the ranger is due.
  const RangerReading* ReadingOf(const Robot& robot, std::size_t ranger) {
    return readings_.IsDue(robot.id, ranger) ? readings_.Measure(robot.id, ranger).ranger() : nullptr;
  }

  // Keeps the first error, which Add returns.
  template <typename Message>
  void Write(const std::string& topic, const Message& message, bool is_latched = false) {
    if (!status_.ok()) return;
    const std::uint16_t id = file_.FindTopic(topic, [&]() -> McapFile::Topic {
      const std::string type = ros::RosTypeName(dds::TopicTraits<Message>::descriptor()->m_typename);
      std::map<std::string, std::string> metadata = {{kQos, QosText(is_latched)},
                                                     {"topic_type_hash", ros::HashOfRosType(type)}};
      return {topic, {type, "ros2msg", MessageDefinition(type)}, "cdr", std::move(metadata)};
    });
    status_ = file_.Write(id, time_, wire::ToCdr(message));
  }

  std::string MetadataText() const;

  McapFile file_;
  const std::string name_;      // of the MCAP file, in its folder
  const std::string metadata_;  // path
  const ReplayedWorld* world_ = nullptr;
  std::shared_ptr<const Scene> scene_;
  bool has_world_ = false;
  std::vector<Robot> robots_;
  std::optional<Things> things_;  // of scene_
  std::string text_;              // of a table, while it is written
  RunReadings readings_;
  std::uint64_t time_ = 0;
  ros::Time stamp_ = {};
  Status status_;
};

// A text in quotation marks of YAML.
// The names of topics need no other escapes: ROS allows letters, digits, '_', '/' and '~'.
std::string YamlText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

// Version 5 of the metadata is that of Humble; later versions of rosbag2 read it.
std::string Ros2Export::MetadataText() const {
  const std::uint64_t duration = file_.last_time() - file_.first_time();
  const std::string name = YamlText(name_);
  std::string text = fmt::format(
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: {}\n"
      "  starting_time:\n    nanoseconds_since_epoch: {}\n  message_count: {}\n  topics_with_message_count:\n",
      duration, file_.first_time(), file_.messages());
  for (const auto& [id, topic] : file_.counts()) {
    text += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
        "        offered_qos_profiles: {}\n      message_count: {}\n",
        YamlText(topic.name), topic.type, YamlText(topic.metadata.at(kQos)), topic.messages);
  }
  return text + fmt::format(
                    "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - {}\n"
                    "  files:\n    - path: {}\n      starting_time:\n        nanoseconds_since_epoch: {}\n"
                    "      duration:\n        nanoseconds: {}\n      message_count: {}\n",
                    name, name, file_.first_time(), duration, file_.messages());
}

}  // namespace

// rosbag2 names the file for its folder, with the number of the split.
std::vector<std::string> FilesOfRos2Export(const std::string& path) {
  if (path.ends_with(".mcap")) return {path};
  const std::filesystem::path folder = std::filesystem::absolute(path).lexically_normal();
  const std::string name = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
  return {path + "/" + name + "_0.mcap", path + "/metadata.yaml"};
}

Result<std::unique_ptr<RunExport>> MakeRos2Export(const std::string& path) {
  const std::vector<std::string> files = FilesOfRos2Export(path);
  if (files.size() > 1) {
    std::error_code failure;
    std::filesystem::create_directories(path, failure);
    if (failure) return Error{{path}, "cannot make the folder: " + failure.message(), ErrorCode::kFailure};
  }
  Result<McapFile> mcap = McapFile::Create(files.front(), "ros2");
  if (!mcap.ok()) return mcap.error();
  return std::unique_ptr<RunExport>(std::make_unique<Ros2Export>(
      std::move(mcap).value(), std::filesystem::path(files.front()).filename(), files.size() > 1 ? files.back() : ""));
}

}  // namespace troupe
