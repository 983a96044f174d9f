#include "common/model/states.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "common/model/field_check.h"
#include "common/model/field_hasher.h"
#include "common/model/lane_rules.h"
#include "common/model/zones.h"
#include "troupe/check.h"
#include "troupe/radio_limits.h"

namespace troupe {
namespace {

// The rows that a state of the world has; nothing: any number.
template <typename Row>
std::optional<std::size_t> CountRows(const WorldDescription& world, const DeviceCounts& devices) {
  if constexpr (std::is_same_v<Row, RobotState>) return world.robots.size();
  if constexpr (std::is_same_v<Row, JointState>) return world.joints.size();
  if constexpr (std::is_same_v<Row, GripperState>) return world.grippers.size();
  if constexpr (std::is_same_v<Row, ObjectState>) return world.objects.size();
  if constexpr (std::is_same_v<Row, StoreState>) return devices.stores;
  if constexpr (std::is_same_v<Row, ImuState>) return devices.imus;
  if constexpr (std::is_same_v<Row, LightState>) return devices.lights;
  if constexpr (std::is_same_v<Row, CameraState>) return devices.cameras;
  if constexpr (std::is_same_v<Row, DoorState>) return world.doors.size();
  if constexpr (std::is_same_v<Row, LiftState>) return world.lifts.size();
  if constexpr (std::is_same_v<Row, PersonState>) return world.people.size();
  if constexpr (std::is_same_v<Row, ZoneState>) return world.zones.size();
  if constexpr (std::is_same_v<Row, CoverageState>) return CountCoverage(world);
  if constexpr (std::is_same_v<Row, FlowState>) return world.flows.size();
  if constexpr (std::is_same_v<Row, VisitorState>) return world.visitors.size();
  if constexpr (std::is_same_v<Row, VisitorFlowState>) return world.visitor_flows.size();
  return std::nullopt;
}

// At tick 0 the poses determine the supports: a state has the same hash before and after they are found.
std::vector<ObjectState> WithoutSupports(std::vector<ObjectState> objects) {
  for (ObjectState& object : objects) {
    if (object.mode != ObjectMode::kResting) continue;
    object.mode = ObjectMode::kPlaced;
    object.support.reset();
  }
  return objects;
}

// The rows of what an operator and robots change in a site.
Status CheckSiteRows(const WorldDescription& world, const WorldState& state) {
  const std::size_t lanes = CountLanes(world.lane_graphs);
  const std::size_t vertices = CountVertices(world.lane_graphs);
  for (std::size_t i = 0; i < state.lane_rules.size(); ++i) {
    if (state.lane_rules[i].lane >= lanes) return BadInput("found a rule of a lane that does not exist");
    if (i > 0 && state.lane_rules[i - 1].lane >= state.lane_rules[i].lane) {
      return BadInput("found rules of lanes that do not ascend");
    }
  }
  for (std::size_t i = 0; i < state.charging_robots.size(); ++i) {
    const ChargingRobot& robot = state.charging_robots[i];
    if (robot.vertex && *robot.vertex >= vertices) return BadInput("found a charger that does not exist");
    if (i > 0 && !(state.charging_robots[i - 1].robot < robot.robot)) {
      return BadInput("found robots at chargers that do not ascend");
    }
  }
  for (const Job& job : state.jobs) {
    if (job.flow >= world.flows.size()) return BadInput("found goods of a flow that does not exist");
  }
  return {};
}

}  // namespace

DeviceCounts CountDevices(const WorldDescription& world) {
  return {.stores = FindStores(world).size(),
          .imus = FindImus(world).size(),
          .lights = FindLights(world).size(),
          .cameras = FindCameras(world).size()};
}

Status CheckState(const WorldDescription& world, const WorldState& state) {
  return CheckState(world, CountDevices(world), state);
}

Status CheckState(const WorldDescription& world, const DeviceCounts& devices, const WorldState& state) {
  Status problem;
  // Finite numbers only: the largest magnitude of descriptions does not hold for states.
  FieldCheck check(&world, std::numeric_limits<double>::max());
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<Row>& rows = table.Of(state);
    const std::size_t expected = CountRows<Row>(world, devices).value_or(rows.size());
    // ForEachTable cannot be left early.
    if (!problem.ok()) return;
    if (rows.size() != expected) {
      problem = BadInput("found a state of " + std::to_string(rows.size()) + " " + std::string(table.name) +
                         ", expected " + std::to_string(expected));
    }
    for (std::size_t i = 0; i < rows.size() && problem.ok(); ++i) {
      if (check.Check(rows[i])) continue;
      problem = BadInput("state: " + std::string(table.name) + "." + std::to_string(i) + "." + check.problem());
    }
  });
  if (!problem.ok()) return problem;
  for (const ObjectState& object : state.objects) {
    if ((object.mode == ObjectMode::kHeld) != object.holder.has_value()) {
      return BadInput("found an object that is held without a holder, or has a holder without being held");
    }
  }
  for (std::size_t i = 0; i < state.lifts.size(); ++i) {
    if (state.lifts[i].floor >= world.lifts[i].floors.size()) return BadInput("found a lift at an unknown floor");
  }
  for (const PersonState& person : state.people) {
    if (person.goals >= world.goal_sets.size()) return BadInput("found a person with a goal set that does not exist");
    const std::size_t points = world.goal_sets[person.goals].points.size();
    if (person.goal != 0 && person.goal >= points) return BadInput("found a person with a goal that does not exist");
    if (person.door > world.doors.size()) return BadInput("found a person at a door that does not exist");
    const std::size_t floors = person.lift == 0                   ? 1
                               : person.lift > world.lifts.size() ? 0
                                                                  : world.lifts[person.lift - 1].floors.size();
    if (person.floor >= floors) return BadInput("found a person with a lift or a floor that does not exist");
  }
  for (std::size_t i = 1; i < state.traffic_robots.size(); ++i) {
    if (!(state.traffic_robots[i - 1].robot < state.traffic_robots[i].robot)) {
      return BadInput("found robots of the traffic that do not ascend");
    }
  }
  if (Status unfit = CheckSiteRows(world, state); !unfit.ok()) return unfit;
  for (std::size_t i = 0; i < state.waits.size(); ++i) {
    if (i > 0 && !(state.waits[i - 1].robot < state.waits[i].robot)) {
      return BadInput("found waits of robots that do not ascend");
    }
    if (state.waits[i].since > state.tick) return BadInput("found a wait that begins later");
  }
  for (const RadioTransmission& transmission : state.transmissions) {
    if (FindRadio(world.robot(transmission.from), transmission.message.radio) == nullptr) {
      return BadInput("found a radio message of a sensor that is no radio");
    }
    if (transmission.due < state.tick || transmission.sent > state.tick) {
      return BadInput("found a radio message outside the ticks from its sending to its arrival");
    }
  }
  return {};
}

bool HaveSameRows(const WorldState& a, const WorldState& b) {
  bool same = true;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    if constexpr (!kIsVaryingTable<Row>) same = same && table.Of(a).size() == table.Of(b).size();
  });
  return same;
}

std::optional<ModelId> CarrierOf(const WorldDescription& world, const ObjectState& object) {
  return object.holder ? world.gripper(*object.holder).model : object.support;
}

std::uint64_t StateHash(const WorldState& state) {
  FieldHasher hasher;
  hasher.Add(state.tick);
  // Rows without their number: worlds without any of a kind keep their hashes when states have a new kind.
  const auto add_rows = [&](const auto& rows) {
    for (const auto& row : rows) hasher.Add(row);
  };
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    if constexpr (std::is_same_v<Row, ObjectState>) {
      if (state.tick == 0) return add_rows(WithoutSupports(state.objects));
    }
    add_rows(table.Of(state));
  });
  return hasher.value();
}

WorldState PlacedState(const WorldDescription& world) {
  WorldState state;
  state.robots.reserve(world.robots.size());
  for (const RobotDescription& robot : world.robots) {
    state.robots.push_back({.X_WR = world.model(robot.root).X_PM, .twist = {}, .stalled = false});
  }
  for (const JointDescription& joint : world.joints) state.joints.push_back({.position = joint.start});
  state.grippers.resize(world.grippers.size());
  for (ModelId object : world.objects) state.objects.push_back({.X_WO = world.model(object).X_PM});
  for (ModelId store : FindStores(world)) state.stores.push_back({.joules = world.model(store).power.joules});
  state.imus.resize(FindImus(world).size());
  for (const LightPlace& light : FindLights(world)) {
    state.lights.push_back({world.model(light.model).blinking.is_switched_on});
  }
  state.cameras.resize(FindCameras(world).size());
  // After the objects: leaves and cabins are objects, whose rows are replaced here.
  for (const DoorDescription& door : world.doors) {
    state.doors.push_back({.opening = door.opening, .target = door.opening});
    for (const DoorLeaf& leaf : door.leaves) {
      state.objects[leaf.object.index()] = {.X_WO = leaf.X_WH_at(door.opening), .mode = ObjectMode::kMounted};
    }
  }
  for (const LiftDescription& lift : world.lifts) {
    state.lifts.push_back({.z = lift.floors[lift.floor].z, .floor = lift.floor});
    state.objects[lift.cabin.index()].mode = ObjectMode::kMounted;
  }
  for (const PersonDescription& person : world.people) {
    state.people.push_back({.X_WP = world.model(person.root).X_PM, .goals = person.goals});
  }
  state.visitors.resize(world.visitors.size());
  state.visitor_flows.resize(world.visitor_flows.size());
  for (const VisitorDescription& visitor : world.visitors) state.people[visitor.person.index()].X_WP.z = kAwayZ;
  for (const ZoneDescription& zone : world.zones) state.zones.push_back({.is_on = zone.is_on});
  state.coverage.resize(CountCoverage(world));
  for (std::size_t i = 0; i < world.flows.size(); ++i) {
    const GoodsFlow& flow = world.flows[i];
    const Tick due = TicksIn(world, flow.due);
    state.flows.push_back({.arrived = flow.stock});
    for (std::uint32_t number = 0; number < flow.stock; ++number) {
      state.jobs.push_back({.flow = static_cast<std::uint32_t>(i), .number = number, .since = 0, .due = due});
    }
  }
  return state;
}

Tick TicksIn(const WorldDescription& world, double seconds) {
  return static_cast<Tick>(std::llround(seconds * 1e9 / static_cast<double>(world.interval_ns)));
}

std::size_t MemoryOf(const WorldState& state) {
  std::size_t size = sizeof state;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    size += table.Of(state).size() * sizeof(Row);
  });
  for (const RadioTransmission& transmission : state.transmissions) size += transmission.message.bytes.size();
  return size;
}

Pose JointMotion(const JointDescription& joint, double q) {
  if (joint.type == JointType::kRevolute) return {0.0, 0.0, 0.0, q};
  return {q * joint.axis_xy.x(), q * joint.axis_xy.y(), q * joint.axis_z, 0.0};
}

std::vector<Pose> ModelPoses(const WorldDescription& world, const WorldState& state) {
  TROUPE_CHECK(state.robots.size() == world.robots.size() && state.joints.size() == world.joints.size() &&
               state.objects.size() == world.objects.size() && state.people.size() == world.people.size());
  std::vector<Pose> X_PM;
  X_PM.reserve(world.models.size());
  for (const ModelDescription& model : world.models) X_PM.push_back(model.X_PM);
  for (std::size_t i = 0; i < world.robots.size(); ++i) X_PM[world.robots[i].root.index()] = state.robots[i].X_WR;
  for (std::size_t i = 0; i < world.objects.size(); ++i) X_PM[world.objects[i].index()] = state.objects[i].X_WO;
  for (std::size_t i = 0; i < world.people.size(); ++i) X_PM[world.people[i].root.index()] = state.people[i].X_WP;
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    Pose& X = X_PM[world.joints[i].model.index()];
    X = X * JointMotion(world.joints[i], state.joints[i].position);
  }
  // Now from poses in parents to poses in W, parents first.
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const std::optional<ModelId>& parent = world.models[i].parent;
    if (parent) X_PM[i] = X_PM[parent->index()] * X_PM[i];
  }
  return X_PM;
}

}  // namespace troupe
