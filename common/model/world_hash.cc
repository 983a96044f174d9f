// The hash of a world description.
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "common/base/hash.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

class DescriptionHasher {
 public:
  void Add(double value) { hasher_.Add(value); }
  void Add(std::uint64_t value) { hasher_.Add(value); }
  void Add(const std::string& text) { hasher_.Add(std::string_view(text)); }
  void Add(const Vec2& p) {
    Add(p.x());
    Add(p.y());
  }
  void Add(const Pose& pose) {
    Add(pose.x);
    Add(pose.y);
    Add(pose.z);
    Add(pose.heading);
  }
  void Add(const ZRange& z) {
    Add(z.min);
    Add(z.max);
  }
  void Add(const Interval& interval) {
    Add(interval.min);
    Add(interval.max);
  }
  void Add(const TwistBounds& bounds) {
    Add(bounds.x);
    Add(bounds.y);
    Add(bounds.heading);
  }
  void Add(const Rectangle& r) {
    Add(r.min_x);
    Add(r.min_y);
    Add(r.max_x);
    Add(r.max_y);
  }
  void Add(const Block& block) {
    AddAll(block.outline);
    Add(block.z);
  }
  // An area counts as the list of its rectangles, or of blocks where it is turned: the hash is that of the geometry.
  void Add(const Shape& shape) {
    if (!shape.area) {
      AddAll(shape.blocks);
      AddAll(shape.rectangles);
      Add(shape.rectangles_z);
      return;
    }
    const PixelArea& area = *shape.area;
    const bool turned = area.X_MA().heading != 0.0;
    Add(std::uint64_t{shape.blocks.size() + (turned ? area.cover().count() : 0)});
    for (const Block& block : shape.blocks) Add(block);
    const Transform2 transform(area.X_MA());
    if (turned) {
      area.ForEach([&](const Rectangle& r) {
        Add(std::uint64_t{4});
        for (const Vec2& corner : Corners(r)) Add(Vec2(transform * corner));
        Add(shape.rectangles_z);
      });
    }
    Add(std::uint64_t{turned ? 0 : area.cover().count()});
    if (!turned) area.ForEach([this](const Rectangle& r) { Add(r); });
    Add(turned ? ZRange() : shape.rectangles_z);
  }
  void Add(const ModelDescription& model) {
    Add(model.name);
    Add(model.type);
    Add(std::uint64_t{model.parent ? model.parent->index() + 1 : 0});
    Add(model.X_PM);
    Add(std::uint64_t{model.shape.index()});
    for (double value : {model.size_x, model.size_y, model.size_z}) Add(value);
    for (double value : {model.color.r, model.color.g, model.color.b, model.color.a}) Add(value);
    Add(std::uint64_t{model.obstacle_return});
    Add(model.ranger_return);
    Add(std::uint64_t{model.gripper_return});
    Add(static_cast<std::uint64_t>(model.fiducial_return));
    Add(std::uint64_t{model.show_nose});
    // Only where they are used, so that other worlds have the hashes that they always had.
    if (model.removed) Add(std::uint64_t{1});
    if (model.fiducial_key != 0) {
      Add(std::string("fiducial_key"));
      Add(static_cast<std::uint64_t>(model.fiducial_key));
    }
    if (!(model.power == PowerDescription{})) {
      Add(std::string("power"));
      Add(std::uint64_t{model.power.has_store});
      Add(std::uint64_t{model.power.endless});
      for (const double value : {model.power.joules, model.power.capacity, model.power.watts, model.power.mass,
                                 model.power.give_watts, model.power.take_watts}) {
        Add(value);
      }
    }
    if (model.blinking.is_light()) {
      Add(std::string("blinking"));
      Add(static_cast<std::uint64_t>(model.blinking.period_ns));
      Add(static_cast<std::uint64_t>(model.blinking.on_ns));
      if (!model.blinking.is_switched_on) Add(std::string("switched off"));
    }
  }
  void Add(const DriveDescription& drive) {
    Add(static_cast<std::uint64_t>(drive.type));
    Add(drive.wheelbase);
    Add(drive.velocity);
    Add(drive.acceleration);
  }
  void Add(const LocalizationDescription& localization) {
    Add(static_cast<std::uint64_t>(localization.type));
    Add(localization.origin);
    for (double error : {localization.error_x, localization.error_y, localization.error_heading}) Add(error);
  }
  void Add(const RaySensorDescription& sensor) {
    Add(sensor.X_MS);
    Add(sensor.range);
    Add(sensor.fov);
    Add(std::uint64_t{sensor.samples});
    for (double noise : {sensor.noise_variance, sensor.noise_proportional, sensor.noise_angle}) Add(noise);
    if (sensor.elevations.empty()) return;  // as it always was
    Add(std::string("elevations"));
    for (double elevation : sensor.elevations) Add(elevation);
  }
  // The two kinds of the first worlds keep their hashes.
  void Add(const RangerParameters& ranger) { AddAll(*ranger.ray_sensors); }
  void Add(const BreakBeamParameters& beams) { AddAll(beams.beams); }
  template <typename Parameters>
  void Add(const Parameters& parameters) requires requires {
    Parameters::kType;
  }
  {
    Add(std::string(Parameters::kType));
    for (const SensorField& field : FieldsOf(parameters)) {
      for (double number : field.numbers) Add(number);
    }
  }
  void Add(const SensorDescription& sensor) {
    Add(sensor.name);
    Add(std::uint64_t{sensor.model.index()});
    Add(std::uint64_t{sensor.period_ticks});
    std::visit([this](const auto& parameters) { Add(parameters); }, sensor.parameters);
  }
  void Add(const RobotDescription& robot) {
    Add(robot.name);
    Add(std::uint64_t{robot.root.index()});
    Add(robot.drive);
    Add(robot.localization);
    AddAll(robot.sensors);
    Add(robot.controller.name);
    Add(robot.controller.parameters);
    if (robot.ros == RosIdentity()) return;  // so that worlds without one have the hash that they always had
    Add(std::uint64_t{robot.ros.domain ? *robot.ros.domain + 1 : 0});
    Add(robot.ros.name_space);
  }
  void Add(const NamedPlace& place) {
    Add(place.name);
    Add(place.description);
    AddAll(place.tags);
    Add(place.X_WN);
  }
  void Add(const DoorLeaf& leaf) {
    Add(std::uint64_t{leaf.object.index()});
    Add(leaf.X_WH);
    Add(leaf.turn);
    Add(leaf.shift);
  }
  void Add(const DoorDescription& door) {
    Add(door.model);
    AddAll(door.leaves);
    for (double value : {door.seconds, door.reach, door.opening}) Add(value);
    Add(std::uint64_t{door.is_operated});
  }
  void AddNumbers(const std::vector<std::size_t>& numbers) {
    Add(std::uint64_t{numbers.size()});
    for (const std::size_t number : numbers) Add(std::uint64_t{number});
  }
  void Add(const LiftFloor& floor) {
    Add(floor.name);
    Add(floor.z);
    AddNumbers(floor.doors);
  }
  void Add(const LiftDescription& lift) {
    Add(lift.model);
    Add(std::uint64_t{lift.cabin.index()});
    AddNumbers(lift.cabin_doors);
    AddAll(lift.floors);
    Add(std::uint64_t{lift.floor});
    Add(lift.speed);
  }
  void Add(const JointDescription& joint) {
    Add(joint.name);
    Add(std::uint64_t{joint.robot.index()});
    Add(std::uint64_t{joint.model.index()});
    Add(static_cast<std::uint64_t>(joint.type));
    Add(joint.axis_xy);
    Add(joint.axis_z);
    Add(joint.position);
    Add(joint.start);
    Add(joint.max_speed);
  }
  void Add(const BreakBeam& beam) {
    Add(beam.from);
    Add(beam.to);
    Add(beam.z);
  }
  void Add(const GripperDescription& gripper) {
    Add(gripper.name);
    for (std::size_t index : {gripper.robot.index(), gripper.model.index(), gripper.left.index(), gripper.right.index(),
                              gripper.left_pad.index(), gripper.right_pad.index()}) {
      Add(std::uint64_t{index});
    }
    Add(std::uint64_t{gripper.lift ? gripper.lift->index() + 1 : 0});
    AddAll(gripper.beams);
    Add(std::uint64_t{gripper.autosnatch});
  }
  void Add(const GoalSet& set) {
    Add(set.name);
    AddAll(set.points);
    Add(set.reach);
    Add(set.wait);
    AddAll(set.next);
    if (set.heights.empty()) return;  // as before there were any
    Add(std::string("heights"));
    AddAll(set.heights);
  }
  void Add(const NextGoals& next) {
    Add(std::uint64_t{next.goals});
    Add(next.weight);
  }
  void Add(const PersonDescription& person) {
    Add(person.root);
    for (double number : {person.radius, person.speed, person.max_speed}) Add(number);
    Add(static_cast<std::uint64_t>(person.reaction));
    Add(std::uint64_t{person.goals});
    Add(std::uint64_t{person.leader ? person.leader->index() + 1 : 0});
  }
  void Add(const LevelDescription& level) {
    Add(level.name);
    Add(level.z);
  }
  void Add(const LaneVertex& vertex) {
    for (const std::string& text : {vertex.name, vertex.dock, vertex.mutex}) Add(text);
    Add(vertex.position);
    Add(vertex.z);
    Add(std::uint64_t{vertex.is_charger});
    Add(std::uint64_t{vertex.lift ? std::uint64_t{*vertex.lift} + 1 : 0});
    Add(std::uint64_t{vertex.floor});
  }
  void Add(const LaneDoor& door) {
    Add(std::uint64_t{door.door});
    Add(door.at);
  }
  void Add(const Lane& lane) {
    Add(std::uint64_t{lane.start});
    Add(std::uint64_t{lane.end});
    Add(std::uint64_t{lane.is_bidirectional});
    Add(lane.speed_limit);
    Add(static_cast<std::uint64_t>(lane.facing));
    Add(lane.mutex);
    AddAll(lane.doors);
  }
  void Add(const LaneGraph& graph) {
    Add(std::uint64_t{graph.number});
    AddAll(graph.vertices);
    AddAll(graph.lanes);
  }
  void Add(ModelId model) { Add(std::uint64_t{model.index()}); }
  template <typename T>
  void AddAll(const std::vector<T>& values) {
    Add(std::uint64_t{values.size()});
    for (const T& value : values) Add(value);
  }
  std::uint64_t value() const { return hasher_.value(); }

 private:
  Hasher hasher_;
};

}  // namespace

std::uint64_t Hash(const WorldDescription& world) {
  DescriptionHasher hasher;
  hasher.Add(world.name);
  hasher.Add(world.seed);
  hasher.Add(static_cast<std::uint64_t>(world.interval_ns));
  hasher.AddAll(world.shapes);
  hasher.AddAll(world.models);
  hasher.AddAll(world.robots);
  hasher.AddAll(world.joints);
  hasher.AddAll(world.grippers);
  hasher.AddAll(world.objects);
  hasher.Add(world.gravity);
  if (!world.places.empty()) hasher.AddAll(world.places);
  // Worlds without these have the hash that they had before there were any.
  if (!world.doors.empty()) {
    hasher.Add(std::string("doors"));
    hasher.AddAll(world.doors);
  }
  if (!world.lifts.empty()) {
    hasher.Add(std::string("lifts"));
    hasher.AddAll(world.lifts);
  }
  if (!world.people.empty()) {
    hasher.AddAll(world.goal_sets);
    hasher.AddAll(world.people);
  }
  if (!world.levels.empty() || !world.lane_graphs.empty()) {
    hasher.Add(std::string("site"));
    hasher.AddAll(world.levels);
    hasher.AddAll(world.lane_graphs);
  }
  return hasher.value();
}

}  // namespace troupe
