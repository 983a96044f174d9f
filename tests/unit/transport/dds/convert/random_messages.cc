#include "tests/unit/transport/dds/convert/random_messages.h"

namespace troupe::test {

std::string RandomMessages::Text() {
  std::string text(Below(12), ' ');
  for (char& c : text) c = static_cast<char>(1 + Below(255));
  return text;
}

std::vector<std::string> RandomMessages::Texts() {
  std::vector<std::string> texts(Below(4));
  for (std::string& text : texts) text = Text();
  return texts;
}

Pose RandomMessages::RandomPose() {
  return {Number(), Number(), Number(), Number(-3.0, 3.0)};
}

Interval RandomMessages::RandomInterval(double min, double max) {
  const double middle = 0.5 * (min + max);
  return {Number(min, middle), Number(middle, max)};
}

TwistBounds RandomMessages::RandomBounds(double min, double max) {
  return {RandomInterval(min, max), RandomInterval(min, max), RandomInterval(min, max)};
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
  shape.blocks.resize(Below(4));
  for (Block& block : shape.blocks) {
    block.outline = RandomPolygon();
    block.z = {Number(0.0, 1.0), Number(1.0, 2.0)};
  }
  shape.rectangles.resize(Below(4));
  for (Rectangle& r : shape.rectangles)
    r = {Number(-2.0, -1.0), Number(-2.0, -1.0), Number(1.0, 2.0), Number(1.0, 2.0)};
  shape.rectangles_z = {Number(0.0, 1.0), Number(1.0, 2.0)};
  return shape;
}

ModelDescription RandomMessages::RandomModel(std::size_t index, std::size_t shapes) {
  ModelDescription model;
  model.name = "m" + std::to_string(index) + Text();
  model.type = Text();
  model.X_PM = RandomPose();
  model.shape = ShapeId(Below(shapes));
  model.size_x = Number(0.0);
  model.size_y = Number(0.0);
  model.size_z = Number(0.0);
  model.color = {Number(0.0, 1.0), Number(0.0, 1.0), Number(0.0, 1.0), Number(0.0, 1.0)};
  model.obstacle_return = Coin();
  model.ranger_return = Number();
  model.gripper_return = Coin();
  model.fiducial_return = static_cast<std::int32_t>(Bits());
  model.fiducial_key = static_cast<std::int32_t>(Bits());
  model.show_nose = Coin();
  if (Coin()) model.blinking = {1000, static_cast<std::int64_t>(Below(1001)), Coin()};
  if (Coin()) {
    const double capacity = Number(1.0, 9.0);
    model.power = {Coin(), Coin(), Number(0.0, 1.0), capacity, Number(0.0), Number(0.0), Number(0.0), Number(0.0)};
  }
  if (Coin()) {
    model.map = {1 + static_cast<std::uint32_t>(Below(100)), 1 + static_cast<std::uint32_t>(Below(100)),
                 Number(0.1, 1.0)};
  }
  model.removed = Coin();
  return model;
}

// A sensor of any kind but break beams, which belong to grippers.
SensorParameters RandomMessages::RandomSensor() {
  const auto pixels = [this] { return 1 + static_cast<std::uint32_t>(Below(kMaxImageSide)); };
  switch (Below(7)) {
    case 0: {
      RangerParameters ranger;
      std::vector<RaySensorDescription>& ray_sensors = ranger.ray_sensors.Change();
      ray_sensors.resize(Below(4));
      for (RaySensorDescription& sensor : ray_sensors) {
        sensor = {
            RandomPose(),     RandomInterval(0.0, 50.0), Number(0.0, 6.0), 1 + static_cast<std::uint32_t>(Below(999)),
            Number(0.0, 1.0), Number(0.0, 1.0),          Number(0.0, 1.0)};
        if (Coin()) sensor.elevations = {Number(-1.0, -0.1), Number(0.0, 1.0)};
      }
      return ranger;
    }
    case 1:
      return FiducialParameters{RandomPose(),     RandomInterval(0.0, 9.0),          Number(0.0, 9.0),
                                Number(0.0, 6.0), static_cast<std::int32_t>(Bits()), Coin()};
    case 2: {
      BumperParameters bumper;
      bumper.segments.resize(Below(4));
      for (BumperSegment& segment : bumper.segments) segment = {RandomPose(), Number(0.0, 2.0)};
      bumper.height = Number(0.0, 1.0);
      return bumper;
    }
    case 3:
      return ContactParameters{};
    case 4: {
      BlobfinderParameters finder{RandomPose(), pixels(), pixels(), Number(0.0, 9.0), Number(0.1, 2.9), {}};
      finder.colors.resize(Below(3));
      for (Color& color : finder.colors) color = {Number(0.0, 1.0), Number(0.0, 1.0), Number(0.0, 1.0), 1.0};
      return finder;
    }
    case 5: {
      RadioParameters radio{
          .X_MS = RandomPose(), .channel = static_cast<std::int32_t>(Bits()), .range = Number(0.0, 9.0)};
      for (double* number :
           {&radio.bandwidth, &radio.delay, &radio.loss, &radio.range_loss, &radio.power, &radio.path_loss_exponent,
            &radio.wall_loss, &radio.body_loss, &radio.range_noise, &radio.bearing_noise}) {
        *number = Number(0.1, 1.0);
      }
      radio.range_and_bearing = Coin();
      return radio;
    }
    default:
      return CameraParameters{
          RandomPose(), pixels(), pixels(), RandomInterval(0.0, 9.0), Number(0.1, 2.9), RandomInterval(-1.4, 1.4)};
  }
}

RobotDescription RandomMessages::RandomRobot(ModelId root, const std::string& name) {
  RobotDescription robot;
  robot.name = name;
  robot.root = root;
  robot.drive = {static_cast<DriveType>(Below(3)), Number(0.1, 2.0), RandomBounds(-9.0, 9.0), {}};
  robot.drive.acceleration.x = {Number(-9.0, 0.0), Number(0.0, 9.0)};
  robot.drive.acceleration.y = {Number(-9.0, 0.0), Number(0.0, 9.0)};
  robot.drive.acceleration.heading = {Number(-9.0, 0.0), Number(0.0, 9.0)};
  robot.localization = {static_cast<LocalizationType>(Below(2)), RandomPose(), Number(), Number(), Number()};
  robot.sensors.resize(Below(4));
  for (SensorDescription& sensor : robot.sensors) {
    sensor.name = Text();
    sensor.model = root;
    sensor.period_ticks = 1 + static_cast<std::uint32_t>(Below(1000));
    sensor.parameters = RandomSensor();
  }
  robot.controller = {Text(), Text()};
  return robot;
}

JointDescription RandomMessages::RandomJoint(RobotId robot, ModelId model) {
  JointDescription joint;
  joint.name = "j" + Text();
  joint.robot = robot;
  joint.model = model;
  if (Coin()) {
    joint.type = JointType::kRevolute;
  } else {
    joint.axis_xy = {0.6, 0.0};
    joint.axis_z = -0.8;
  }
  joint.position = RandomInterval(-2.0, 2.0);
  joint.start = Number(joint.position.min, joint.position.max);
  joint.max_speed = Number(0.0, 3.0);
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
  gripper.beams.resize(Below(3));
  for (BreakBeam& beam : gripper.beams) beam = {{Number(), Number()}, {Number(), Number()}, Number()};
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
    DoorDescription door{.model = ModelId(i), .leaves = {{ObjectId(i), RandomPose(), 0.0, 0.0}}};
    (Coin() ? door.leaves[0].turn : door.leaves[0].shift) = Number(-3.0, 3.0);
    door.seconds = Number(0.1, 9.0);
    door.reach = Number(0.0);
    door.opening = Number(0.0, 1.0);
    door.is_operated = Coin();
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
  world.gravity = Number(0.0);
  for (std::size_t i = Below(3); i > 0; --i) world.levels.push_back({Text(), -static_cast<double>(i)});
  for (std::size_t i = Below(3); i > 0; --i) world.lane_graphs.push_back(RandomLanes(world));
  for (std::size_t i = 0; i < world.lane_graphs.size(); ++i) {
    world.lane_graphs[i].number = static_cast<std::uint32_t>(2 * i + Below(2));
  }
  return world;
}

LaneGraph RandomMessages::RandomLanes(const WorldDescription& world) {
  LaneGraph graph;
  graph.vertices.resize(2 + Below(4));
  for (LaneVertex& vertex : graph.vertices) {
    vertex = {Text(), {Number(), Number()}, Number(), Coin(), Text(), Text(), {}, 0};
    if (world.lifts.empty() || Coin()) continue;
    vertex.lift = 0;
    vertex.floor = static_cast<std::uint32_t>(Below(world.lifts[0].floors.size()));
  }
  graph.lanes.resize(Below(5));
  for (Lane& lane : graph.lanes) {
    lane.start = static_cast<std::uint32_t>(Below(graph.vertices.size() - 1));
    lane.end = static_cast<std::uint32_t>(graph.vertices.size() - 1);
    lane.is_bidirectional = Coin();
    lane.speed_limit = Number(0.0);
    lane.facing = static_cast<LaneFacing>(Below(3));
    lane.mutex = Text();
    for (std::size_t i = 0; i < world.doors.size() && Coin(); ++i) {
      lane.doors.push_back({static_cast<std::uint32_t>(i), static_cast<double>(i)});
    }
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
  return {Bits(),
          Bits(),
          static_cast<std::uint32_t>(Bits()),
          Bits(),
          Text(),
          static_cast<std::uint32_t>(Bits()),
          Texts(),
          static_cast<Edition>(Bits()),
          static_cast<Incarnation>(Bits()),
          Texts(),
          RandomPlace()};
}

std::optional<ControllerCheckpoint> RandomMessages::RandomPlace() {
  if (Coin()) return std::nullopt;
  return ControllerCheckpoint{static_cast<Edition>(Bits()), Bits(), Coin()};
}

std::vector<AdmissionMessage> RandomMessages::Admissions() {
  std::vector<AdmissionMessage> answers(Below(4));
  for (AdmissionMessage& answer : answers) answer = {Bits(), Bits(), Coin(), Text()};
  return answers;
}

void RandomMessages::FillManipulation(WorldState& state) {
  state.joints.resize(Below(6));
  state.grippers.resize(Below(4));
  state.objects.resize(Below(6));
  for (JointState& joint : state.joints) joint = {Number(), Number(), Coin()};
  for (GripperState& gripper : state.grippers) {
    gripper = {MaybeId<ModelId>(50), MaybeId<ModelId>(50), MaybeId<ObjectId>(state.objects.size())};
  }
  for (ObjectState& object : state.objects) {
    object = {RandomPose(), static_cast<ObjectMode>(Below(3)), Number(), {}, MaybeId<ModelId>(50)};
    object.holder = MaybeId<GripperId>(state.grippers.size());
    if (object.holder) object.mode = ObjectMode::kHeld;
  }
}

RadioMessage RandomMessages::RandomMessage(std::size_t robots) {
  RadioMessage message{.radio = Below(9), .to = MaybeId<RobotId>(robots)};
  message.bytes.resize(Below(40));
  for (std::uint8_t& byte : message.bytes) byte = static_cast<std::uint8_t>(Below(256));
  return message;
}

FrameMessage RandomMessages::Frame() {
  FrameMessage frame;
  frame.run = Bits();
  frame.state.tick = Bits();
  frame.state.robots.resize(Below(20));
  for (RobotState& robot : frame.state.robots) {
    robot = {RandomPose(), {Number(), Number(), Number()}, Coin()};
  }
  FillManipulation(frame.state);
  frame.state.stores.resize(Below(4));
  for (StoreState& store : frame.state.stores) store = {Number(), Number()};
  frame.state.imus.resize(Below(4));
  for (ImuState& imu : frame.state.imus) imu = {Number(), Number(), Number()};
  frame.state.lights.resize(Below(4));
  for (LightState& light : frame.state.lights) light = {Coin()};
  frame.state.cameras.resize(Below(4));
  for (CameraState& camera : frame.state.cameras) camera = {Number(), Number()};
  frame.state.doors.resize(Below(4));
  for (DoorState& door : frame.state.doors) door = {Number(0.0, 1.0), Number(0.0, 1.0), Coin(), Coin()};
  frame.state.lifts.resize(Below(4));
  for (LiftState& lift : frame.state.lifts) {
    lift = {Number(), static_cast<std::uint32_t>(Bits()), MaybeId<RobotId>(frame.state.robots.size()), Coin()};
  }
  frame.state.people.resize(Below(4));
  for (PersonState& person : frame.state.people) {
    const auto number = [this] { return static_cast<std::uint32_t>(Below(100)); };
    person = {{Number(), Number(), Number(), Number()}, Number(), Number(), 0, 0, 0, 0, 0};
    for (std::uint32_t* field :
         {&person.goals, &person.goal, &person.goals_chosen, &person.dwell_ticks, &person.watch_ticks}) {
      *field = number();
    }
  }
  if (!frame.state.robots.empty()) frame.state.transmissions.resize(Below(5));
  for (RadioTransmission& transmission : frame.state.transmissions) {
    const std::size_t robots = frame.state.robots.size();
    transmission = {RobotId(Below(robots)), Bits(), Bits(), Below(64), RandomMessage(robots)};
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
  frame.events.resize(Below(5));
  for (Event& event : frame.events) {
    event.tick = frame.state.tick;
    event.type = static_cast<EventType>(Below(12));
    if (Coin() && !frame.state.robots.empty()) event.robot = RobotId(Below(frame.state.robots.size()));
    event.other = MaybeId<ModelId>(1000);
    event.object = MaybeId<ModelId>(1000);
    event.detail = Text();
  }
  for (std::size_t robot = Below(4); robot < frame.state.robots.size(); robot += 1 + Below(6)) {
    frame.commands.push_back(Command(RobotId(robot)));
  }
  return frame;
}

RobotCommand RandomMessages::Command(RobotId robot) {
  RobotCommand command;
  command.robot = robot;
  if (Coin()) command.twist = {Number(), Number(), Number()};
  command.grippers.resize(Below(3));
  for (GripperOrder& order : command.grippers) {
    order.gripper = Below(5);
    if (Coin()) order.opening = Number(0.0, 100.0);
    if (Coin()) order.lift = Number(0.0, 100.0);
  }
  if (Coin()) return command;
  command.goal.emplace().number = static_cast<std::uint32_t>(Bits());
  for (std::size_t count = Below(4); count > 0; --count) command.goal->waypoints.emplace_back(Number(), Number());
  if (Coin()) command.goal->heading = Number(-3.0, 3.0);
  return command;
}

HistoryMessage RandomMessages::History() {
  HistoryMessage history{Bits(), {}, RandomPlace(), {}, static_cast<Incarnation>(Bits())};
  history.agents.resize(Below(4));
  for (AgentId& agent : history.agents) agent = Bits();
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
    message.proposals.back().lights.resize(Below(3));
    for (LightOrder& order : message.proposals.back().lights) order = {Below(5), Coin()};
    message.proposals.back().cameras.resize(Below(3));
    for (CameraOrder& order : message.proposals.back().cameras) order = {Below(5), Number(), Number()};
    if (Coin()) message.proposals.back().say = Text();
    message.proposals.back().doors.resize(Below(3));
    for (DoorOrder& order : message.proposals.back().doors) order = {Below(5), Number()};
    message.proposals.back().lifts.resize(Below(3));
    for (LiftOrder& order : message.proposals.back().lifts) order = {Below(5), Below(5), Coin()};
    robot += 1 + Below(10);
  }
  message.reports = Texts();
  message.paused = Coin();
  message.edition = static_cast<Edition>(Bits());
  message.incarnation = static_cast<Incarnation>(Bits());
  return message;
}

ControlReply RandomMessages::Reply() {
  ControlReply message;
  message.client = Bits();
  message.number = Bits();
  message.done = Coin();
  message.problem = Text();
  message.state = static_cast<RunState>(Below(4));
  message.tick = Bits();
  message.state_hash = Bits();
  message.edition = static_cast<Edition>(Bits());
  for (std::uint64_t count = Below(4); count > 0; --count) {
    EntityReport entity{.name = Text(), .type = Text(), .kind = static_cast<EntityKind>(Below(3))};
    entity.X_WE = RandomPose();
    entity.twist = {Number(), Number(), Number()};
    if (Coin())
      entity.agent = AgentReport{Text(), static_cast<std::uint32_t>(Bits()), Coin(), Number(0.0, 5.0), Bits()};
    message.entities.push_back(std::move(entity));
  }
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
