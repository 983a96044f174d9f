#include "viewer/gateway/signals.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace troupe {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kJointPrefix = "joint/";
constexpr std::string_view kRangePrefix = "range/";

}  // namespace

std::vector<std::vector<std::size_t>> StoresOfRobots(const WorldDescription& world) {
  std::map<ModelId, std::size_t> roots;
  for (std::size_t i = 0; i < world.robots.size(); ++i) roots.emplace(world.robots[i].root, i);
  std::vector<std::vector<std::size_t>> stores(world.robots.size());
  const std::vector<ModelId> models = FindStores(world);
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (world.model(models[i]).power.endless) continue;
    for (std::optional<ModelId> at = models[i]; at; at = world.model(*at).parent) {
      if (const auto root = roots.find(*at); root != roots.end()) stores[root->second].push_back(i);
    }
  }
  return stores;
}

void SignalReader::SetState(const std::shared_ptr<const ViewedState>& state) {
  if (state == state_) return;
  if (state_ == nullptr || state->world != state_->world) {
    sources_.clear();
    suites_.clear();
    stores_ = StoresOfRobots(state->world->description());
    bodies_.emplace(*state->world->scene);
  }
  state_ = state;
  bodies_fresh_ = false;
}

SensorSuite& SignalReader::SuiteOf(RobotId robot) {
  return suites_.try_emplace(robot, *state_->world->scene, robot).first->second;
}

SignalReader::Source SignalReader::Find(const SignalName& name) {
  static const std::map<std::string_view, Kind> kKinds = {{"x", Kind::kX},
                                                          {"y", Kind::kY},
                                                          {"z", Kind::kZ},
                                                          {"heading", Kind::kHeading},
                                                          {"vx", Kind::kVx},
                                                          {"vy", Kind::kVy},
                                                          {"wz", Kind::kWz},
                                                          {"speed", Kind::kSpeed},
                                                          {"energy", Kind::kEnergy},
                                                          {"charge", Kind::kCharge},
                                                          {"stalled", Kind::kStalled}};
  const WorldDescription& world = state_->world->description();
  const std::optional<RobotId> robot = FindRobot(world, name.robot);
  if (!robot) return {};
  if (const auto known = kKinds.find(name.signal); known != kKinds.end()) {
    const bool is_energy = known->second == Kind::kEnergy || known->second == Kind::kCharge;
    if (is_energy && stores_[robot->index()].empty()) return {};
    return {known->second, *robot};
  }
  if (name.signal.starts_with(kJointPrefix)) {
    const std::string_view joint = std::string_view(name.signal).substr(kJointPrefix.size());
    for (std::size_t i = 0; i < world.joints.size(); ++i) {
      if (world.joints[i].robot == *robot && world.joints[i].name == joint) return {Kind::kJoint, *robot, i};
    }
  }
  if (!name.signal.starts_with(kRangePrefix)) return {};
  const std::string_view sensor = std::string_view(name.signal).substr(kRangePrefix.size());
  SensorSuite& suite = SuiteOf(*robot);
  for (std::size_t i = 0; i < suite.size(); ++i) {
    const std::string& known = suite.sensor(i).description().name;
    if (sensor == known) return {Kind::kRange, *robot, i};
    if (!sensor.starts_with(known + "/")) continue;
    const std::string_view number = sensor.substr(known.size() + 1);
    std::size_t ray = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), ray);
    if (error == std::errc() && end == number.data() + number.size()) return {Kind::kRange, *robot, i, ray};
  }
  return {};
}

double SignalReader::Range(const Source& source) {
  const WorldState& state = *state_->state;
  if (!bodies_fresh_) bodies_->Assign(state);
  bodies_fresh_ = true;
  const SensorReading& reading =
      SuiteOf(source.robot).Measure(source.part, {*state_->world->scene, *bodies_, &state}, state.tick);
  const RangerReading* const ranger = reading.ranger();
  if (ranger == nullptr || ranger->geometry->empty()) return kNone;
  if (source.ray) return *source.ray < ranger->geometry->front().rays() ? ranger->ranges[*source.ray] : kNone;
  double nearest = std::numeric_limits<double>::infinity();
  for (const double range : ranger->ranges) nearest = std::min(nearest, range);
  return nearest;
}

double SignalReader::Value(const SignalName& name) {
  const auto [known, is_new] = sources_.try_emplace(name);
  if (is_new) known->second = Find(name);
  const Source& source = known->second;
  if (source.kind == Kind::kNone) return kNone;
  const WorldState& state = *state_->state;
  const RobotState& robot = state.robots[source.robot.index()];
  switch (source.kind) {
    case Kind::kNone:
      return kNone;
    case Kind::kX:
      return robot.X_WR.x;
    case Kind::kY:
      return robot.X_WR.y;
    case Kind::kZ:
      return robot.X_WR.z;
    case Kind::kHeading:
      return robot.X_WR.heading;
    case Kind::kVx:
      return robot.twist.vx;
    case Kind::kVy:
      return robot.twist.vy;
    case Kind::kWz:
      return robot.twist.wz;
    case Kind::kSpeed:
      return std::hypot(robot.twist.vx, robot.twist.vy);
    case Kind::kStalled:
      return robot.stalled ? 1.0 : 0.0;
    case Kind::kJoint:
      return state.joints[source.part].position;
    case Kind::kRange:
      return Range(source);
    case Kind::kEnergy:
    case Kind::kCharge:
      break;
  }
  double sum = 0.0;
  for (const std::size_t store : stores_[source.robot.index()]) {
    sum += source.kind == Kind::kEnergy ? state.stores[store].joules : state.stores[store].charge_watts;
  }
  return sum;
}

}  // namespace troupe
