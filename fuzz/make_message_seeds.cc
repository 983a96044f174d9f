// Writes the first inputs of the targets of messages: small samples of each type with every field used.
//   fuzz_make_message_seeds FOLDER
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/model/states.h"
#include "fuzz/targets.h"
#include "recording/mcap/bytes.h"
#include "recording/mcap/reader.h"
#include "recording/recording_writer.h"
#include "ros/connection/topic_types.h"
#include "transport/dds/convert/convert.h"
#include "transport/wire/cdr.h"
#include "transport/wire/message_bytes.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"
#include "worldfile/models/build_world.h"
#include "worldfile/stage/stage_world.h"

namespace troupe::fuzz {
namespace {

constexpr char kWorld[] = R"(
define room model ( size [ 8 8 1 ] boundary 1 noblocks 1 )
define crate model ( size [ 0.5 0.5 0.5 ] gripper_return 1 )
define eye ranger ( sensor ( range [ 0 5 ] fov 180 samples 9 ) )
define lidar ranger ( sensor ( samples 4 planes 2 ) )
define nose position ( size [ 0.4 0.4 0.3 ] fiducial ( ) contact ( ) camera ( ) lidar ( )
  bumper ( noblocks 1 bcount 1 blength 0.2 ) blobfinder ( colors_count 1 colors [ "red" ] ) )
define bot position ( size [ 0.4 0.4 0.3 ] eye ( pose [ 0 0 -0.1 0 ] ) gripper ( pose [ 0.2 0 0 0 ] ) )
room ( name "room" )
crate ( name "crate" pose [ 1 1 0 30 ] )
bot ( name "r0" ctrl "wander" )
nose ( name "r1" pose [ -2 0 0 0 ] fiducial_return 2 fiducial_key 1 )
blinkenlight ( name "light" pose [ 3 0 0 0 ] )
)";

constexpr std::size_t kMaxInputBytes = 8192;  // bytes of an input; as in scripts/fuzz

// The world of recordings, each of which has to fit into an input as a whole.
constexpr char kRecordedWorld[] = R"(
model ( name "crate" pose [ 1 1 0 30 ] size [ 0.5 0.5 0.5 ] gripper_return 1 )
position ( name "r0" size [ 0.4 0.4 0.3 ] gripper ( pose [ 0.2 0 0 0 ] ) )
)";

WorldDescription WorldOf(const char* text) {
  const Result<WorldTree> tree = ParseStageText(text, "seed.world");
  Check(tree.ok());
  Result<LoadedWorld> loaded = BuildWorld(tree.value(), {}, {});
  Check(loaded.ok());
  return std::move(loaded).value().world;
}

WorldDescription SmallWorld() {
  WorldDescription world = WorldOf(kWorld);
  Bitmap bitmap(9, 5);
  for (int x = 0; x < 9; ++x) bitmap.set_occupied(x, x % 5, true);
  ModelDescription map = world.models.front();
  map.name = "map";
  map.parent.reset();
  map.shape = ShapeId(world.shapes.size());
  Shape& shape = world.shapes.emplace_back();
  shape.rectangles_z = {0.0, 1.0};
  world.levels = {{"ground", 0.0}, {"first", 4.0}};
  LaneGraph& lanes = world.lane_graphs.emplace_back();
  lanes.vertices.resize(2);
  lanes.vertices[1].name = "dock";
  lanes.vertices[1].position = {3.0, 0.0};
  lanes.lanes.push_back({.start = 0, .end = 1, .mutex = "narrow", .doors = {}});
  shape.area = PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), {.factor = 0.1}, {.factor = 0.2});
  world.models.push_back(std::move(map));
  return world;
}

class Seeds {
 public:
  explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void Write(const std::string& target, const std::string& name, Bytes bytes) const {
    const std::filesystem::path path = folder_ / target;
    std::filesystem::create_directories(path);
    std::ofstream file(path / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  template <typename Message>
  void WriteMessage(const std::string& target, const Message& message) const {
    Write(target, "seed.cdr", wire::ToBytes(message));
  }
  // A sample behind the number of its type.
  template <typename Wire>
  void WriteRos(int number, const std::string& name, const Wire& sample) const {
    std::vector<std::byte> bytes = wire::ToCdr(sample);
    bytes.insert(bytes.begin(), static_cast<std::byte>(number));
    Write("ros_sample", name + ".cdr", bytes);
  }

 private:
  std::filesystem::path folder_;
};

// A world that changes, and a step.
HistoryMessage SmallHistory(const WorldDescription& world) {
  HistoryMessage history{1, {AgentId(7)}, ControllerCheckpoint{0, 3, true}, {}};
  HistoryEntry& first = history.entries.emplace_back();
  first.frame.run = 1;
  first.frame.state = PlacedState(world);
  first.world = world;
  first.step_follows = true;
  HistoryEntry second = first;
  second.world.reset();
  ++second.frame.state.tick;
  second.frame.state.robots[0].X_WR.x += 0.5;
  history.entries.push_back(std::move(second));
  return history;
}

void WriteFrames(const Seeds& seeds, const WorldDescription& world) {
  FrameMessage frame;
  frame.run = 1;
  frame.state = PlacedState(world);
  frame.events.push_back({.tick = 0, .type = EventType::kStallBegan, .robot = RobotId(0)});
  frame.awaited = {AgentId(7)};
  seeds.WriteMessage("frame", frame);

  FrameMessage before;  // as the target has it
  before.run = 1;
  before.state.tick = 7;
  before.state.robots.resize(3);
  before.state.joints.resize(2);
  before.state.grippers.resize(1);
  before.state.objects.resize(2);
  FrameMessage after = before;
  after.state.tick = 8;
  after.state.robots[1].X_WR.x = 1.0;
  after.state.joints[0].position = 0.1;
  after.state.objects[1].X_WO.y = 2.0;
  dds::WireArena arena;
  seeds.Write("changes", "seed.cdr", wire::ToCdr(dds::ToWire(after, &before.state, arena)));
}

void WriteRosSamples(const Seeds& seeds) {
  char text[] = "robot_0";
  char frame[] = "map";
  seeds.WriteRos(0, "twist", geometry_msgs_msg_dds__Twist_{{0.5, 0.0, 0.0}, {0.0, 0.0, 0.2}});
  geometry_msgs_msg_dds__TwistStamped_ stamped{};
  stamped.header.frame_id = frame;
  seeds.WriteRos(1, "twist_stamped", stamped);
  control_msgs_action_dds__GripperCommand_SendGoal_Request_ goal{};
  goal.goal.command.position = 0.1;
  seeds.WriteRos(2, "gripper_goal", goal);
  seeds.WriteRos(3, "cancel", action_msgs_srv_dds__CancelGoal_Request_{});
  simulation_interfaces_srv_dds__GetEntities_Request_ entities{};
  entities.filters.filter = text;
  seeds.WriteRos(4, "entities", entities);
  simulation_interfaces_srv_dds__SetEntityState_Request_ state{};
  state.entity = text;
  state.state.header.frame_id = frame;
  state.state.pose.orientation.w = 1.0;
  seeds.WriteRos(5, "state", state);
  simulation_interfaces_srv_dds__SpawnEntity_Request_ spawn{};
  spawn.name = spawn.uri = spawn.resource_string = spawn.entity_namespace = text;
  spawn.initial_pose.header.frame_id = frame;
  seeds.WriteRos(7, "spawn", spawn);
}

// Two steps, an edit and a step, with keyframes at the first and the third state.
void WriteRecordings(const Seeds& seeds, const WorldDescription& world) {
  RecordedRun run;
  run.world = world;
  std::vector<std::byte> file;
  RecordingWriter writer = RecordingWriter::Create(mcap::MakeMemorySink(file), run).value();
  const auto scene = std::make_shared<const Scene>(world);
  FrameMessage frame;
  frame.state = InitialState(*scene);
  for (std::uint64_t number = 0; number < 5; ++number) {
    RecordedTick tick;
    tick.number = number;
    if (number == 3) {
      const control::SetPose move{"r0", {-1.0, -1.0, 0.0, 0.5}};
      tick.edit = RecordedEdit{frame, move, {}};
      frame.state = SetPose(scene, frame.state, move.name, move.pose).value().state;
      ++frame.edition;
    } else if (number > 0) {
      tick.proposals = {{RobotId(0), {0.01, 0.0, 0.01}, {}}};
      frame.state = Step(*scene, frame.state, tick.proposals).state;
    }
    frame.state_hash = StateHash(frame.state);
    tick.tick = frame.state.tick;
    tick.edition = frame.edition;
    tick.state_hash = frame.state_hash;
    if (number % 2 == 0) tick.keyframe = frame;
    Check(writer.Add(tick).ok());
  }
  Check(writer.Close().ok());

  // Without the texts of the schemas, which are longer than an input.
  const mcap::Reader reader = mcap::Reader::Open(mcap::MakeMemorySource("seed.mcap", file)).value();
  std::vector<std::byte> small = {std::byte{0}};
  std::vector<std::byte> messages = {std::byte{1}};
  mcap::Writer copy = mcap::Writer::Create(mcap::MakeMemorySink(small), kRecordingProfile, "").value();
  for (const ChannelType& channel : kChannelTypes) {
    copy.AddChannel({copy.AddSchema({channel.type, "", ""}), channel.topic, "cdr"});
  }
  ByteWriter out(messages);
  for (std::size_t i = 0; i < reader.chunks().size(); ++i) {
    const mcap::Chunk chunk = reader.ReadChunk(i).value();
    for (const mcap::Message& message : chunk.messages) {
      copy.Add(message);
      out.Write(static_cast<std::uint8_t>(message.channel));
      out.WriteWithLength<std::uint16_t>([&] { out.WriteBytes(message.data); });
    }
    Check(copy.EndChunk().ok());
    out.Write(std::uint8_t{255});
  }
  Check(copy.Close().ok());
  Check(small.size() <= kMaxInputBytes && messages.size() <= kMaxInputBytes);
  seeds.Write("recording", "file.bin", small);
  seeds.Write("recording", "messages.bin", messages);
}

int Main(const char* folder) {
  const Seeds seeds(folder);
  const WorldDescription world = SmallWorld();
  Check(Validate(world).ok());
  seeds.WriteMessage("session",
                     SessionMessage{.run = 1, .host = "here", .pid = 1, .lease_seconds = 2.0, .world = world});
  seeds.WriteMessage("join", JoinMessage{.run = 1, .agent = 7, .host = "here", .pid = 1, .robots = {"r0", "r1"}});
  seeds.WriteMessage("admissions", std::vector<AdmissionMessage>{{1, 7, true, ""}, {1, 8, false, "no such robot"}});
  WriteFrames(seeds, world);
  seeds.WriteMessage("frame_request", troupe::FrameRequest{5});
  seeds.WriteMessage("history", SmallHistory(world));
  ProposalMessage proposal;
  proposal.proposals = {{RobotId(0), {0.5, 0.0, 0.1}, {0.1, 0.2}}};
  seeds.WriteMessage("proposal", proposal);
  control::CommandRobot command{.name = "r0"};
  command.twist = troupe::Twist{0.5, 0.0, 0.1};
  command.grippers = {{.gripper = 0, .opening = 100.0}};
  command.goal = troupe::Goal{1, {{1.0, 2.0}}, 0.5};
  seeds.WriteMessage("control", ControlRequest{.request = command});
  troupe::ControlReply reply;
  reply.problem = "no";
  reply.entities.push_back({"r0", "position", EntityKind::kRobot, {1.0, 2.0, 0.0, 0.5}, {0.1, 0.0, 0.0}});
  seeds.WriteMessage("control_reply", reply);
  seeds.WriteMessage("status", StatusMessage());
  WriteRosSamples(seeds);
  WriteRecordings(seeds, WorldOf(kRecordedWorld));
  return 0;
}

}  // namespace
}  // namespace troupe::fuzz

int main(int argc, char** argv) {
  if (argc == 2) return troupe::fuzz::Main(argv[1]);
  std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
  return 2;
}
