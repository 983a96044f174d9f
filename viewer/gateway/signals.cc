#include "viewer/gateway/signals.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

namespace troupe {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kRangePrefix = "range/";
constexpr const char* kCount = "count";

}  // namespace

// Everything that is found by name belongs to a world.
void SignalReader::SetState(const SharedState& state) {
  if (state == state_) return;
  if (state_ == nullptr || state->world != state_->world) {
    sources_.clear();
    suites_.clear();
    things_.emplace(state->world->description());
    bodies_.emplace(*state->world->scene);
  }
  state_ = state;
  bodies_fresh_ = false;
}

SensorSuite& SignalReader::SuiteOf(RobotId robot) {
  return suites_.try_emplace(robot, *state_->world->scene, robot).first->second;
}

// Tables first: a robot's signal of the state has precedence over a range.
SignalReader::Source SignalReader::Find(const SignalName& name) {
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    const StateTable& table = StateTables()[kind];
    if (name.thing == table.name && name.signal == kCount) return {&table};
    const Signal* const signal = table.Find(name.signal);
    const std::optional<ThingId> thing = signal != nullptr ? things_->Find(name.thing, kind) : std::nullopt;
    if (thing) return {&table, signal, *thing - things_->first(kind)};
  }
  Source source;
  source.range = FindRange(name);
  return source;
}

std::optional<SignalReader::Ray> SignalReader::FindRange(const SignalName& name) {
  const std::optional<RobotId> robot = FindRobot(state_->world->description(), name.thing);
  if (!robot || !name.signal.starts_with(kRangePrefix)) return std::nullopt;
  const std::string_view sensor = std::string_view(name.signal).substr(kRangePrefix.size());
  SensorSuite& suite = SuiteOf(*robot);
  for (std::size_t i = 0; i < suite.size(); ++i) {
    const std::string& known = suite.sensor(i).description().name;
    if (sensor == known) return Ray{*robot, i};
    if (!sensor.starts_with(known + "/")) continue;
    const std::string_view number = sensor.substr(known.size() + 1);
    std::size_t ray = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), ray);
    if (error == std::errc() && end == number.data() + number.size()) return Ray{*robot, i, ray};
  }
  return std::nullopt;
}

double SignalReader::Range(const Ray& source) {
  const WorldState& state = *state_->state;
  if (!bodies_fresh_) bodies_->Assign(state);
  bodies_fresh_ = true;
  const SensorReading& reading =
      SuiteOf(source.robot).Measure(source.sensor, {*state_->world->scene, *bodies_, &state}, state.tick);
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
  if (source.range) return Range(*source.range);
  if (source.table == nullptr) return kNone;
  const WorldState& state = *state_->state;
  if (source.signal == nullptr) return static_cast<double>(source.table->rows(state_->world->description(), state));
  return source.signal->number({*things_, state_->world->description(), state}, source.row);
}

nlohmann::json SignalReader::Describe() const {
  nlohmann::json tables = nlohmann::json::array();
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    const StateTable& table = StateTables()[kind];
    nlohmann::json things = nlohmann::json::array();
    nlohmann::json signals = nlohmann::json::array();
    if (table.varies) {
      things.push_back(table.name);
      signals.push_back({{"name", kCount}, {"unit", ""}, {"documentation", "number of " + table.name}});
    } else {
      const ThingId end = things_->first(kind) + things_->count(kind);
      for (ThingId thing = things_->first(kind); thing < end && things.size() < kMaxThings; ++thing) {
        if (things_->exists(thing)) things.push_back(things_->name(thing));
      }
      for (const Signal& signal : table.signals) {
        signals.push_back({{"name", signal.name}, {"unit", signal.unit}, {"documentation", signal.documentation}});
      }
    }
    tables.push_back({{"name", table.name},
                      {"singular", table.singular},
                      {"things", std::move(things)},
                      {"signals", std::move(signals)}});
  }
  return tables;
}

}  // namespace troupe
