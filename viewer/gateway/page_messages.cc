#include "viewer/gateway/page_messages.h"

#include <algorithm>
#include <utility>

#include "common/picture/rectangle_outline.h"

namespace troupe {
namespace {

void Write(PageWriter& writer, const Polygon& outline) {
  writer.WriteCount(outline.size());
  for (const Vec2& point : outline) {
    writer.WriteFloat(point.x());
    writer.WriteFloat(point.y());
  }
}

void Write(PageWriter& writer, const ZRange& z) {
  writer.WriteFloat(z.min);
  writer.WriteFloat(z.max);
}

void Write(PageWriter& writer, const Rectangle& r) {
  writer.WriteFloat(r.min_x);
  writer.WriteFloat(r.min_y);
  writer.WriteFloat(r.max_x);
  writer.WriteFloat(r.max_y);
}

// The pixels of an area, reduced to at most kMaxArea along each side: a byte for eight, row by row from below.
void WritePixels(PageWriter& writer, const PixelArea& area) {
  const PixelRectangle bounds = area.cover().bounds();
  const int reduction = std::max(
      {1, (bounds.x1 - bounds.x0 + kMaxArea - 1) / kMaxArea, (bounds.y1 - bounds.y0 + kMaxArea - 1) / kMaxArea});
  const int width = (bounds.x1 - bounds.x0 + reduction - 1) / reduction;
  const int height = (bounds.y1 - bounds.y0 + reduction - 1) / reduction;
  std::vector<std::uint8_t> bits((static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 7) / 8, 0);
  area.cover().ForEach([&](const PixelRectangle& r) {
    for (int y = (r.y0 - bounds.y0) / reduction; y <= (r.y1 - 1 - bounds.y0) / reduction; ++y) {
      for (int x = (r.x0 - bounds.x0) / reduction; x <= (r.x1 - 1 - bounds.x0) / reduction; ++x) {
        const std::size_t bit =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        bits[bit >> 3] = static_cast<std::uint8_t>(bits[bit >> 3] | (1U << (bit & 7U)));
      }
    }
  });
  // Line 0 of the last pixel of a reduced row may lie beyond the bounds.
  Write(writer, area.InMetres({bounds.x0, bounds.y0, bounds.x0 + width * reduction, bounds.y0 + height * reduction}));
  writer.WritePose(area.X_MA());
  writer.WriteCount(static_cast<std::size_t>(width));
  writer.WriteCount(static_cast<std::size_t>(height));
  writer.WriteBytes(std::as_bytes(std::span(bits)));
}

void Write(PageWriter& writer, const Shape& shape) {
  writer.WriteCount(shape.blocks.size());
  for (const Block& block : shape.blocks) {
    Write(writer, block.z);
    Write(writer, block.outline);
  }
  Write(writer, shape.rectangles_z);
  writer.WriteCount(shape.rectangles.size());
  for (const Rectangle& r : shape.rectangles) Write(writer, r);
  // Their sides, without those that two rectangles have in common.
  const std::vector<Polygon> loops = OutlineOf(shape.rectangles);
  writer.WriteCount(loops.size());
  for (const Polygon& loop : loops) Write(writer, loop);
  writer.WriteFlag(shape.area.has_value());
  if (shape.area) WritePixels(writer, *shape.area);
}

void Write(PageWriter& writer, const ModelDescription& model) {
  writer.WriteText(model.name);
  writer.WriteText(model.type);
  writer.WriteId(model.parent);
  writer.WritePose(model.X_PM);
  writer.WriteCount(model.shape.index());
  writer.WriteFloat(model.color.r);
  writer.WriteFloat(model.color.g);
  writer.WriteFloat(model.color.b);
  writer.WriteFloat(model.color.a);
  writer.WriteFlag(model.removed);
}

void Write(PageWriter& writer, const SensorDescription& sensor) {
  writer.WriteText(sensor.name);
  writer.WriteText(TypeOf(sensor.parameters));
}

void Write(PageWriter& writer, const WorldDescription& world, RobotId id) {
  const RobotDescription& robot = world.robot(id);
  writer.WriteText(robot.name);
  writer.WriteCount(robot.root.index());
  writer.WriteFlag(RobotExists(world, id));
  writer.WriteText(robot.controller.name);
  writer.WriteCount(robot.sensors.size());
  for (const SensorDescription& sensor : robot.sensors) Write(writer, sensor);
  // How fast a user can drive it; bounds without meaning are those of a world that states none.
  const TwistBounds& bounds = robot.drive.velocity;
  writer.WriteFlag(robot.drive.type == DriveType::kOmni);
  writer.WriteFloat(bounds.x.max);
  writer.WriteFloat(robot.drive.type == DriveType::kCar ? bounds.x.max / robot.drive.wheelbase : bounds.heading.max);
}

void Write(PageWriter& writer, const JointDescription& joint) {
  writer.WriteText(joint.name);
  writer.WriteCount(joint.robot.index());
  writer.WriteCount(joint.model.index());
  writer.WriteFlag(joint.type == JointType::kRevolute);
  writer.WriteFloat(joint.axis_xy.x());
  writer.WriteFloat(joint.axis_xy.y());
  writer.WriteFloat(joint.axis_z);
  writer.Write(joint.position.min);
  writer.Write(joint.position.max);
}

void Write(PageWriter& writer, const GripperDescription& gripper) {
  writer.WriteText(gripper.name);
  writer.WriteCount(gripper.robot.index());
  writer.WriteId(gripper.lift);
}

void WriteStores(PageWriter& writer, const WorldDescription& world) {
  const std::vector<ModelId> stores = FindStores(world);
  writer.WriteCount(stores.size());
  for (const ModelId model : stores) {
    const PowerDescription& power = world.model(model).power;
    writer.WriteCount(model.index());
    writer.Write(power.capacity);
    writer.WriteFlag(power.endless);
  }
}

// All lights: those of robots have a row in states, the others are always switched as at load.
void WriteLights(PageWriter& writer, const WorldDescription& world) {
  std::vector<std::int32_t> rows(world.models.size(), -1);
  std::int32_t count = 0;
  for (const LightPlace& light : FindLights(world)) rows[light.model.index()] = count++;
  const std::size_t place = writer.ReserveCount();
  std::size_t lights = 0;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const Blinking& blinking = world.models[i].blinking;
    if (!blinking.is_light()) continue;
    writer.WriteCount(i);
    writer.Write(rows[i]);
    writer.Write(blinking.period_ns);
    writer.Write(blinking.on_ns);
    writer.WriteFlag(blinking.is_switched_on);
    ++lights;
  }
  writer.FillCount(place, lights);
}

void Write(PageWriter& writer, const DoorDescription& door) {
  writer.WriteCount(door.model.index());
  writer.WriteCount(door.leaves.size());
  for (const DoorLeaf& leaf : door.leaves) writer.WriteCount(leaf.object.index());
  writer.WriteFlag(door.is_operated);
}

void Write(PageWriter& writer, const LiftDescription& lift) {
  writer.WriteCount(lift.model.index());
  writer.WriteCount(lift.cabin.index());
  writer.WriteCount(lift.floors.size());
  for (const LiftFloor& floor : lift.floors) writer.WriteText(floor.name);
  writer.WriteCount(lift.floors.size());
  for (const LiftFloor& floor : lift.floors) writer.Write(floor.z);
}

}  // namespace

void StateRows::Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh) {
  if (state == state_ && !fresh) return;
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    std::vector<std::uint64_t>& changed = changed_[table_number++];
    if (!kIsOnPage<Row>) return;
    const std::vector<Row>& before = table.Of(*state_);
    const std::vector<Row>& now = table.Of(*state);
    changed.resize(now.size(), number);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (fresh || i >= before.size() || !(before[i] == now[i])) changed[i] = number;
    }
  });
  state_ = std::move(state);
}

void StateRows::Write(PageWriter& writer, std::uint64_t since) const {
  std::size_t table_number = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<std::uint64_t>& changed = changed_[table_number++];
    if constexpr (kIsOnPage<Row>) {
      const std::vector<Row>& rows = table.Of(*state_);
      const std::size_t place = writer.ReserveCount();
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (changed[i] <= since) continue;
        writer.WriteCount(i);
        ForEachField<Row>(
            [&]<typename Part>(const Field<Row, Part>& field) { PageValue<Part>::Write(writer, field.Of(rows[i])); });
        ++count;
      }
      writer.FillCount(place, count);
    }
  });
}

std::string EncodeWorld(const SessionMessage& session, std::uint32_t number) {
  const WorldDescription& world = session.world;
  std::string bytes;
  PageWriter writer(bytes);
  writer.Write(static_cast<std::uint8_t>(PageMessage::kWorld));
  writer.Write(kPageProtocol);
  writer.Write(number);
  writer.Write(session.run);
  writer.WriteText(world.name);
  writer.WriteText(session.host);
  writer.Write(world.interval_seconds());
  writer.WriteCount(world.shapes.size());
  for (const Shape& shape : world.shapes) Write(writer, shape);
  writer.WriteCount(world.models.size());
  for (const ModelDescription& model : world.models) Write(writer, model);
  writer.WriteCount(world.robots.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) Write(writer, world, RobotId(i));
  writer.WriteCount(world.joints.size());
  for (const JointDescription& joint : world.joints) Write(writer, joint);
  writer.WriteCount(world.grippers.size());
  for (const GripperDescription& gripper : world.grippers) Write(writer, gripper);
  writer.WriteCount(world.objects.size());
  for (const ModelId object : world.objects) writer.WriteCount(object.index());
  WriteStores(writer, world);
  WriteLights(writer, world);
  writer.WriteCount(world.doors.size());
  for (const DoorDescription& door : world.doors) Write(writer, door);
  writer.WriteCount(world.lifts.size());
  for (const LiftDescription& lift : world.lifts) Write(writer, lift);
  writer.WriteCount(world.people.size());
  for (const PersonDescription& person : world.people) writer.WriteCount(person.root.index());
  writer.WriteCount(world.levels.size());
  for (const LevelDescription& level : world.levels) {
    writer.WriteText(level.name);
    writer.Write(level.z);
  }
  return bytes;
}

}  // namespace troupe
