#include "tests/unit/transport/dds/convert/random_messages.h"

#include <algorithm>

namespace troupe::test {

std::vector<std::string> RandomMessages::Texts() {
  std::vector<std::string> texts;
  Fill(texts);
  return texts;
}

Pose RandomMessages::RandomPose() {
  return {Number(), Number(), Number(), Number(-3.0, 3.0)};
}

// A triangle or a quadrilateral, as a loader would leave it.
Polygon RandomMessages::RandomPolygon() {
  Polygon polygon = {{Number(-2.0, -1.0), Number(-2.0, -1.0)},
                     {Number(1.0, 2.0), Number(-2.0, -1.0)},
                     {Number(1.0, 2.0), Number(1.0, 2.0)}};
  if (Coin()) polygon.push_back({Number(-2.0, -1.0), Number(1.0, 2.0)});
  return Normalized(polygon).value();
}

Shape RandomMessages::RandomShape() {
  Shape shape;
  Fill(shape);
  for (Block& block : shape.blocks) block.outline = RandomPolygon();
  for (Rectangle& r : shape.rectangles)
    r = {Number(-2.0, -1.0), Number(-2.0, -1.0), Number(1.0, 2.0), Number(1.0, 2.0)};
  return shape;
}

ModelDescription RandomMessages::RandomModel(std::size_t index, std::size_t shapes) {
  ModelDescription model;
  Fill(model);
  model.name.insert(0, "m" + std::to_string(index));
  model.shape = ShapeId(Below(shapes));
  model.power.capacity = std::max(model.power.capacity, model.power.joules);
  model.blinking.period_ns = std::max(model.blinking.period_ns, model.blinking.on_ns);
  if (Coin()) model.map = {};
  model.map.columns = model.map.resolution > 0.0 ? model.map.columns + 1 : 0;
  model.map.rows = model.map.resolution > 0.0 ? model.map.rows + 1 : 0;
  return model;
}

RobotDescription RandomMessages::RandomRobot(ModelId root, const std::string& name) {
  RobotDescription robot;
  Fill(robot);
  robot.name = name;
  robot.root = root;
  robot.ros.domain.reset();  // one robot has it
  for (MountedFrame& frame : robot.frames) frame.model = root;
  TwistBounds& acceleration = robot.drive.acceleration;
  for (Interval* bound : {&acceleration.x, &acceleration.y, &acceleration.heading}) {
    *bound = {Number(-9.0, 0.0), Number(0.0, 9.0)};
  }
  for (SensorDescription& sensor : robot.sensors) {
    sensor.model = root;
    auto* const ranger = std::get_if<RangerParameters>(&sensor.parameters);
    if (ranger == nullptr) continue;
    for (RaySensorDescription& rays : ranger->ray_sensors.Change())
      std::sort(rays.elevations.begin(), rays.elevations.end());
  }
  return robot;
}

JointDescription RandomMessages::RandomJoint(RobotId robot, ModelId model) {
  JointDescription joint;
  Fill(joint);
  joint.name.insert(0, "j");
  joint.robot = robot;
  joint.model = model;
  joint.axis_xy = joint.type == JointType::kRevolute ? Vec2(0.0, 0.0) : Vec2(0.6, 0.0);
  joint.axis_z = joint.type == JointType::kRevolute ? 1.0 : -0.8;
  joint.start = Number(joint.position.min, joint.position.max);
  return joint;
}

void RandomMessages::AddGripper(WorldDescription& world) {
  const std::size_t root = world.models.size();
  const RobotId robot(world.robots.size());
  for (std::size_t i = 0; i < 4; ++i) {
    world.models.push_back(RandomModel(root + i, world.shapes.size()));
    if (i > 0) world.models.back().parent = ModelId(root + (i == 1 ? 0 : 1));
  }
  world.robots.push_back(RandomRobot(ModelId(root), world.models[root].name));
  const std::size_t first = world.joints.size();
  for (std::size_t i = 1; i < 4; ++i) world.joints.push_back(RandomJoint(robot, ModelId(root + i)));
  GripperDescription gripper{.name = Text(),
                             .robot = robot,
                             .model = ModelId(root + 1),
                             .left = JointId(first + 1),
                             .right = JointId(first + 2),
                             .left_pad = ModelId(root + 2),
                             .right_pad = ModelId(root + 3),
                             .beams = {}};
  if (Coin()) gripper.lift = JointId(first);
  Fill(gripper.beams);
  gripper.autosnatch = Coin();
  world.grippers.push_back(gripper);
}

WorldDescription RandomMessages::RandomWorld() {
  WorldDescription world;
  world.name = Text();
  world.seed = Bits();
  world.interval_ns = 1 + static_cast<std::int64_t>(Below(1'000'000'000));
  world.shapes.resize(1 + Below(5));
  for (Shape& shape : world.shapes) shape = RandomShape();
  const std::size_t models = Below(12);
  for (std::size_t i = 0; i < models; ++i) {
    world.models.push_back(RandomModel(i, world.shapes.size()));
    if (i > 0 && Coin()) {
      world.models[i].parent = ModelId(Below(i));
    } else if (Coin()) {
      world.robots.push_back(RandomRobot(ModelId(i), world.models[i].name));
    } else if (world.models[i].gripper_return) {
      world.objects.emplace_back(i);
    }
  }
  for (std::size_t grippers = Below(3); grippers > 0; --grippers) AddGripper(world);
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (!world.doors.empty() && Coin()) break;
    DoorDescription door;
    Fill(door);
    door.model = ModelId(i);
    door.leaves.assign(1, {ObjectId(i), RandomPose(), 0.0, 0.0});
    (Coin() ? door.leaves[0].turn : door.leaves[0].shift) = Number(-3.0, 3.0);
    world.doors.push_back(door);
  }
  if (world.doors.size() < world.objects.size() && Coin()) {
    LiftDescription lift{
        .model = ModelId(0), .cabin = ObjectId(world.objects.size() - 1), .cabin_doors = {}, .floors = {}};
    for (std::size_t i = 1 + Below(3); i > 0; --i) lift.floors.push_back({Text(), Number(), {}});
    if (!world.doors.empty()) lift.cabin_doors = lift.floors[0].doors = {Below(world.doors.size())};
    lift.floor = static_cast<std::uint32_t>(Below(lift.floors.size()));
    lift.speed = Number(0.1, 9.0);
    world.lifts.push_back(lift);
  }
  AddPeople(world);
  world.gravity = Number(0.0);
  Fill(world.places);
  for (std::size_t i = Below(3); i > 0; --i) world.levels.push_back({Text(), -static_cast<double>(i)});
  for (std::size_t i = Below(3); i > 0; --i) world.lane_graphs.push_back(RandomLanes(world));
  for (std::size_t i = 0; i < world.lane_graphs.size(); ++i) {
    world.lane_graphs[i].number = static_cast<std::uint32_t>(2 * i + Below(2));
  }
  for (std::size_t i = 0; i < world.robots.size() && !world.lane_graphs.empty() && Coin(); ++i) {
    LaneTrip& trip = world.lane_trips.emplace_back();
    trip.robot = RobotId(i);
    trip.goals = {1};
    if (Coin()) continue;
    trip.path = {0, 1};
    trip.steps = {0, static_cast<std::uint32_t>(1 + Below(5))};
  }
  return world;
}

void RandomMessages::AddPeople(WorldDescription& world) {
  Fill(world.goal_sets);
  if (world.goal_sets.empty()) return;
  const auto any_set = [&] { return static_cast<std::uint32_t>(Below(world.goal_sets.size())); };
  for (GoalSet& set : world.goal_sets) {
    set.heights.resize(Coin() ? set.points.size() : 0);
    for (NextGoals& next : set.next) next.goals = any_set();
  }
  Fill(world.people);
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    PersonDescription& person = world.people[i];
    if (person.speed > person.max_speed) std::swap(person.speed, person.max_speed);
    person.goals = any_set();
    if (i > 0 && Coin()) person.leader = PersonId(0);
    person.root = ModelId(world.models.size());
    world.models.push_back(RandomModel(world.models.size(), world.shapes.size()));
  }
}

LaneGraph RandomMessages::RandomLanes(const WorldDescription& world) {
  LaneGraph graph;
  graph.vertices.resize(2 + Below(4));
  for (LaneVertex& vertex : graph.vertices) {
    Fill(vertex);
    vertex.lift.reset();
    vertex.is_between = false;
    if (world.lifts.empty() || Coin()) continue;
    vertex.lift = 0;
    vertex.floor = static_cast<std::uint32_t>(Below(world.lifts[0].floors.size()));
  }
  graph.lanes.resize(Below(5));
  for (Lane& lane : graph.lanes) {
    Fill(lane);
    lane.start = static_cast<std::uint32_t>(Below(graph.vertices.size() - 1));
    lane.end = static_cast<std::uint32_t>(graph.vertices.size() - 1);
    lane.doors.clear();
    for (std::size_t i = 0; i < world.doors.size() && Coin(); ++i) {
      lane.doors.push_back({static_cast<std::uint32_t>(i), static_cast<double>(i)});
    }
  }
  // A waiting point on a lane to the last vertex.
  if (!graph.lanes.empty()) {
    const auto point = static_cast<std::uint32_t>(graph.vertices.size());
    LaneVertex& vertex = graph.vertices.emplace_back(graph.vertices.front());
    vertex.is_between = true;
    graph.lanes.push_back(graph.lanes.front());
    graph.lanes.front().end = graph.lanes.back().start = point;
  }
  return graph;
}

SessionMessage RandomMessages::Session() {
  return {Bits(),        static_cast<std::uint32_t>(Bits()),
          Text(),        static_cast<std::uint32_t>(Bits()),
          Number(0.0),   Coin(),
          RandomWorld(), static_cast<Edition>(Bits())};
}

JoinMessage RandomMessages::Join() {
  JoinMessage join;
  Fill(join);
  return join;
}

std::vector<AdmissionMessage> RandomMessages::Admissions() {
  std::vector<AdmissionMessage> answers;
  Fill(answers);
  return answers;
}

FrameMessage RandomMessages::Frame() {
  FrameMessage frame;
  WorldState& state = frame.state;
  frame.run = Bits();
  Fill(state);
  for (GripperState& gripper : state.grippers) {
    gripper = {MaybeId<ModelId>(50), MaybeId<ModelId>(50), MaybeId<ObjectId>(state.objects.size())};
  }
  for (ObjectState& object : state.objects) {
    object.support = MaybeId<ModelId>(50);
    object.holder = MaybeId<GripperId>(state.grippers.size());
    object.mode = object.holder ? ObjectMode::kHeld : static_cast<ObjectMode>(Below(3));
  }
  for (LiftState& lift : state.lifts) lift.session = MaybeId<RobotId>(state.robots.size());
  if (state.robots.empty()) {
    state.transmissions.clear();
    state.traffic_robots.clear();
    state.traffic_moves.clear();
    state.charging_robots.clear();
    state.jobs.clear();
    state.waits.clear();
  }
  for (ChargingRobot& robot : state.charging_robots) robot.robot = RobotId(Below(state.robots.size()));
  for (Job& job : state.jobs) job.robot = MaybeId<RobotId>(state.robots.size());
  for (TrafficRobot& robot : state.traffic_robots) robot.robot = RobotId(Below(state.robots.size()));
  for (TrafficMove& move : state.traffic_moves) move.robot = RobotId(Below(state.robots.size()));
  for (RobotWait& wait : state.waits) {
    wait.robot = RobotId(Below(state.robots.size()));
    wait.thing = MaybeId<ModelId>(50);
  }
  for (RadioTransmission& transmission : state.transmissions) {
    transmission.from = RobotId(Below(state.robots.size()));
    transmission.message.to = MaybeId<RobotId>(state.robots.size());
  }
  frame.state_hash = Bits();
  frame.last = Coin();
  frame.paused = Coin();
  frame.holds = Coin();
  frame.edition = static_cast<Edition>(Bits());
  frame.world_edition = static_cast<Edition>(Bits());
  frame.fresh_edition = static_cast<Edition>(Bits());
  frame.incarnation = static_cast<Incarnation>(Bits());
  frame.remembered = Coin();
  frame.awaited.resize(Below(4));
  for (AgentId& agent : frame.awaited) agent = Bits();
  Fill(frame.events);
  for (Event& event : frame.events) {
    event.tick = frame.state.tick;
    event.robot = MaybeId<RobotId>(frame.state.robots.size());
    event.other = MaybeId<ModelId>(1000);
    event.object = MaybeId<ModelId>(1000);
  }
  for (std::size_t robot = Below(4); robot < frame.state.robots.size(); robot += 1 + Below(6)) {
    frame.commands.push_back(Command(RobotId(robot)));
  }
  return frame;
}

RobotCommand RandomMessages::Command(RobotId robot) {
  RobotCommand command;
  Fill(command);
  command.robot = robot;
  return command;
}

HistoryMessage RandomMessages::History() {
  HistoryMessage history{.run = Bits()};
  Fill(history.agents);
  Fill(history.after);
  history.incarnation = static_cast<Incarnation>(Bits());
  FrameMessage frame = Frame();
  frame.events.clear();
  for (std::size_t count = 1 + Below(4); count > 0; --count) {
    history.entries.push_back({frame, Coin(), {}});
    if (Coin()) history.entries.back().world = RandomWorld();
    if (Below(3) == 0) {
      frame = Frame();
      frame.events.clear();
    } else {  // as after a step
      ++frame.state.tick;
      frame.state_hash = Bits();
      if (!frame.state.robots.empty()) frame.state.robots[Below(frame.state.robots.size())].X_WR = RandomPose();
    }
  }
  return history;
}

ProposalMessage RandomMessages::Proposal() {
  ProposalMessage message;
  message.run = Bits();
  message.agent = Bits();
  message.tick = Bits();
  std::size_t robot = Below(10);
  for (std::size_t count = Below(5); count > 0; --count) {
    message.proposals.push_back({RobotId(robot), {Number(), Number(), Number()}, {}});
    message.proposals.back().joint_velocities.resize(Below(4));
    for (double& velocity : message.proposals.back().joint_velocities) velocity = Number();
    std::vector<Order>& orders = message.proposals.back().orders;
    for (std::size_t i = Below(3); i > 0; --i) orders.push_back(LightOrder{Below(5), Coin()});
    for (std::size_t i = Below(3); i > 0; --i) orders.push_back(CameraOrder{Below(5), Number(), Number()});
    for (std::size_t i = Below(3); i > 0; --i) orders.push_back(DoorOrder{Below(5), Number()});
    for (std::size_t i = Below(3); i > 0; --i) orders.push_back(LiftOrder{Below(5), Below(5), Coin()});
    for (std::size_t i = Below(2); i > 0; --i) {
      orders.push_back(TrafficOrder{static_cast<std::uint32_t>(Below(50)), {}, Coin(), 3, Number(), Coin()});
    }
    for (std::size_t i = Below(2); i > 0; --i)
      orders.push_back(ChargeOrder{static_cast<std::uint32_t>(Below(50)), Coin()});
    for (std::size_t i = Below(2); i > 0; --i) orders.push_back(JobOrder{Coin(), Coin(), Coin()});
    for (std::size_t i = Below(2); i > 0; --i) orders.push_back(WaitOrder{MaybeId<ModelId>(50), {}});
    for (std::size_t i = Below(2); i > 0; --i) orders.push_back(LoadOrder{ModelId(Below(50)), Coin(), Number(), 0.5});
    if (Coin()) message.proposals.back().say = Text();
    for (std::size_t i = Below(3); i > 0; --i) message.proposals.back().fleet.push_back({FleetTopic::kState, Text()});
    robot += 1 + Below(10);
  }
  message.reports = Texts();
  message.paused = Coin();
  message.edition = static_cast<Edition>(Bits());
  message.incarnation = static_cast<Incarnation>(Bits());
  return message;
}

ControlRequest RandomMessages::Request() {
  ControlRequest message{Bits(), Bits(), {}};
  Fill(message.request);
  return message;
}

ControlReply RandomMessages::Reply() {
  ControlReply message;
  Fill(message);
  message.state_hash = Bits();
  return message;
}

StatusMessage RandomMessages::Status() {
  return {Bits(),
          Bits(),
          Bits(),
          Number(),
          Number(),
          Number(),
          static_cast<std::uint32_t>(Bits()),
          static_cast<std::uint32_t>(Bits()),
          Texts(),
          Number(),
          static_cast<Edition>(Bits()),
          static_cast<Incarnation>(Bits()),
          Coin() ? std::optional(Number(0.1, 9.0)) : std::nullopt,
          {Number(), Number(), Number(), Number()}};
}

}  // namespace troupe::test
