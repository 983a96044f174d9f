#include "testing/expectations/signals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <tuple>

#include "common/base/glob.h"
#include "common/geometry/point_distance.h"
#include "common/model/states.h"
#include "common/sensing/sensor_suite.h"

namespace troupe {
namespace {

constexpr Dimension kMetre{1, 0, 0, 0};
constexpr Dimension kSecond{0, 1, 0, 0};
constexpr Dimension kRatio{};

constexpr std::array<const char*, 5> kFunctions{"abs", "sqrt", "min", "max", "count"};

constexpr std::array kRunSignals{
    SignalInfo{
        SignalKind::kDistance, "distance", "bd", ValueType::kNumber, kMetre, "distance(r, WHAT)",
        "Exact shortest distance in the plane between the solid parts of two robots, objects, people or static models "
        "that share a height, infinite if none do; to a place from the parts at any height, infinite from another "
        "level of a building."},
    SignalInfo{
        SignalKind::kAt, "at", "bp?l", ValueType::kTruth, kRatio, "at(r, PLACE[, RADIUS])",
        "The origin of the robot, object or person is within RADIUS of the place, 0.2 m if none is given, on its "
        "level. Robustness: m."},
    SignalInfo{SignalKind::kIn, "in", "bg", ValueType::kTruth, kRatio, "in(r, REGION)",
               "Its origin is in the region or on its edge, on its level if it has one. Robustness: distance from the "
               "edge, m."},
    SignalInfo{SignalKind::kHolds, "holds", "r?o", ValueType::kTruth, kRatio, "holds(r[, o])",
               "A gripper of the robot holds the object, or any object."},
    SignalInfo{SignalKind::kAlive, "alive", "r", ValueType::kTruth, kRatio, "alive(r)",
               "The robot's agent has not left or been lost, or has rejoined, and its store of energy is not empty."},
    SignalInfo{SignalKind::kRange, "range", "m?s", ValueType::kNumber, kMetre, "range(sensor), range(r[, \"SENSOR\"])",
               "Least range that a ranger reads, with its noise; the robot's first ranger if none is named."},
    SignalInfo{SignalKind::kMeanRange, "mean_range", "m?s", ValueType::kNumber, kMetre,
               "mean_range(sensor), mean_range(r[, \"SENSOR\"])", "Mean of the ranges that it reads."},
    SignalInfo{SignalKind::kPressed, "pressed", "m?s", ValueType::kTruth, kRatio,
               "pressed(sensor), pressed(r[, \"SENSOR\"])", "A segment of a bumper is pressed."},
    SignalInfo{SignalKind::kHeard, "heard", "m?s", ValueType::kNumber, kRatio, "heard(sensor), heard(r[, \"SENSOR\"])",
               "Number of messages that a radio receives at this tick."},
    SignalInfo{SignalKind::kPersonDistance, "person_distance", "r", ValueType::kNumber, kMetre, "person_distance(r)",
               "Exact shortest distance in the plane between the solid parts of the robot and of a person that share a "
               "height, infinite if none do."},
    SignalInfo{SignalKind::kPeopleNear, "people_near", "rl", ValueType::kNumber, kRatio, "people_near(r, REACH)",
               "Number of people at most that far from the robot."},
    SignalInfo{SignalKind::kIntrusionTime, "intrusion_time", "rl", ValueType::kNumber, kSecond,
               "intrusion_time(r, REACH)", "Time so far at which a person was at most that far from the robot."},
    SignalInfo{SignalKind::kIntrusions, "intrusions", "rl", ValueType::kNumber, kRatio, "intrusions(r, REACH)",
               "Number of times so far at which the first person came that near."},
    SignalInfo{SignalKind::kTick, "tick", "", ValueType::kNumber, kRatio, "tick", "Number of the tick."},
    SignalInfo{SignalKind::kTime, "time", "", ValueType::kNumber, kSecond, "time", "Simulated time, 0 at tick 0."},
    SignalInfo{SignalKind::kHash, "hash", "", ValueType::kText, kRatio, "hash",
               "State hash, for == and != with a text of 16 hexadecimal digits."},
    SignalInfo{SignalKind::kEvent, "event", "e?tx", ValueType::kTruth, kRatio, "event(TYPE[, r[, \"DETAIL\"]])",
               "An event of this type has happened at this tick, with this robot, object, door, lift or person, with a "
               "detail that matches the pattern."},
};

double Truth(bool value) {
  return value ? kInfinity : -kInfinity;
}

// Of a body: a robot, an object or a person.
const Pose& PoseOf(const WorldState& state, ThingId body) {
  const std::size_t robots = state.robots.size();
  const std::size_t objects = state.objects.size();
  if (body < robots) return state.robots[body].X_WR;
  return body < robots + objects ? state.objects[body - robots].X_WO : state.people[body - robots - objects].X_WP;
}

double Norm(double x, double y) {
  return std::sqrt(x * x + y * y);
}

double DistanceOf(std::span<const ConvexPiece> a, std::span<const ConvexPiece> b) {
  double least = kInfinity;
  for (const ConvexPiece& one : a) {
    // Pieces without obstacle, which bodies pass through, have no distance.
    if (!one.obstacle) continue;
    for (const ConvexPiece& other : b) {
      if (!other.obstacle || !one.z.Overlaps(other.z)) continue;
      least = std::min(least, FindNearestPoints(one.vertices, other.vertices).distance);
    }
  }
  return least;
}

// How far the level of a height is above or below that of the signal's place or region, m; 0 without levels.
double LevelsAway(const SignalUse& signal, const TickView& tick, double z) {
  if (!signal.floor) return 0.0;
  const std::vector<LevelDescription>& levels = tick.scene.world().levels;
  return std::fabs(levels[LevelNumberAt(levels, z)].z - *signal.floor);
}

// A robustness in the plane, of a body at height z.
double OnLevel(const SignalUse& signal, const TickView& tick, double z, double robustness) {
  const double away = LevelsAway(signal, tick, z);
  return away > 0.0 ? std::min(robustness, -away) : robustness;
}

double DistanceOf(std::span<const ConvexPiece> pieces, const Vec2& point) {
  double least = kInfinity;
  for (const ConvexPiece& piece : pieces) {
    if (piece.obstacle) least = std::min(least, FindNearestPoints(piece.vertices, std::span(&point, 1)).distance);
  }
  return least;
}

// Positive inside; m.
double DepthIn(const Polygon& region, const Vec2& point) {
  const double distance = DistanceToEdges(region, point);
  return Contains(region, point) ? distance : -distance;
}

// By lane: the first one with the same two bodies. A distance is the same from both sides, bit by bit.
std::vector<std::uint32_t> FirstLanes(const SignalUse& signal) {
  std::vector<std::tuple<ThingId, ThingId, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < signal.subjects.size(); ++i) {
    const auto [less, greater] = std::minmax(signal.subjects[i], signal.others[i]);
    pairs.emplace_back(less, greater, static_cast<std::uint32_t>(i));
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::uint32_t> first(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [less, greater, lane] = pairs[i];
    const bool is_again = i > 0 && std::get<0>(pairs[i - 1]) == less && std::get<1>(pairs[i - 1]) == greater;
    first[lane] = is_again ? first[std::get<2>(pairs[i - 1])] : lane;
  }
  return first;
}

void ReadDistances(const SignalUse& signal, const TickView& tick, SignalMemory& memory, std::span<double> values) {
  if (signal.model && memory.pieces.empty()) {
    const WorldDescription& world = tick.scene.world();
    for (std::size_t i = 0; i < world.models.size(); ++i) {
      if (world.models[i].removed || !IsInTree(world, ModelId(i), *signal.model)) continue;
      std::vector<ConvexPiece> pieces = MakePieces(world, ModelId(i), tick.scene.X_LM(ModelId(i)));
      for (ConvexPiece& piece : pieces) memory.pieces.push_back(std::move(piece));
    }
  }
  if (!signal.others.empty()) {
    if (!memory.first_lanes) {
      memory.first_lanes = std::make_shared<const std::vector<std::uint32_t>>(FirstLanes(signal));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t first = (*memory.first_lanes)[i];
      if (first < i) {
        values[i] = values[first];
      } else {
        values[i] = signal.others[i] == signal.subjects[i]
                        ? 0.0
                        : DistanceOf(tick.bodies.pieces_in_world(BodyId(signal.subjects[i])),
                                     tick.bodies.pieces_in_world(BodyId(signal.others[i])));
      }
    }
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::vector<ConvexPiece>& pieces = tick.bodies.pieces_in_world(BodyId(signal.subjects[i]));
    if (signal.model) {
      values[i] = DistanceOf(pieces, memory.pieces);
    } else {
      const bool is_on_level = LevelsAway(signal, tick, PoseOf(tick.state, signal.subjects[i]).z) == 0.0;
      values[i] = is_on_level ? DistanceOf(pieces, signal.point) : kInfinity;
    }
  }
}

// Calls visit(distance) for the people within `reach` of a robot, m; `reach` may become less meanwhile.
template <typename Visit>
void ForEachPersonNear(const TickView& tick, std::uint32_t robot, const double& reach, Visit visit) {
  const WorldState& state = tick.state;
  const std::vector<ConvexPiece>& mine = tick.bodies.pieces_in_world(BodyId(robot));
  const Vec2 here = state.robots[robot].X_WR.translation();
  const double radius = tick.scene.body(BodyId(robot)).radius;
  for (std::size_t i = 0; i < state.people.size(); ++i) {
    const BodyId person = tick.scene.body_of(PersonId(i));
    // Circles around both bodies first: the distance of polygons is needed for few people.
    const double least = (state.people[i].X_WP.translation() - here).norm() - radius - tick.scene.body(person).radius;
    if (least > reach || IsAway(state.people[i])) continue;
    const double distance = DistanceOf(mine, tick.bodies.pieces_in_world(person));
    if (distance <= reach) visit(distance);
  }
}

void ReadPersonDistances(const SignalUse& signal, const TickView& tick, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    double least = kInfinity;
    ForEachPersonNear(tick, signal.subjects[i], least, [&](double distance) { least = std::min(least, distance); });
    values[i] = least;
  }
}

double CountPeopleNear(const SignalUse& signal, const TickView& tick, std::uint32_t robot) {
  double count = 0.0;
  ForEachPersonNear(tick, robot, signal.number, [&](double) { count += 1.0; });
  return count;
}

// Seconds, or times at which people came near. What holds at tick 0 has lasted for no time.
void ReadIntrusions(const SignalUse& signal, const TickView& tick, SignalMemory& memory, std::span<double> values) {
  if (memory.numbers.empty()) {
    memory.numbers.assign(values.size(), 0.0);
    memory.before.assign(values.size(), false);
  }
  // A time is the sum of steps with people near at their ends. Tick 0 ends no step.
  const double seconds = tick.state.tick > 0 ? tick.scene.world().interval_seconds() : 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_near = CountPeopleNear(signal, tick, signal.subjects[i]) > 0.0;
    const bool begins = is_near && !memory.before[i];
    memory.before[i] = is_near;
    if (signal.kind == SignalKind::kIntrusionTime) memory.numbers[i] += is_near ? seconds : 0.0;
    if (signal.kind == SignalKind::kIntrusions) memory.numbers[i] += begins ? 1.0 : 0.0;
    values[i] = memory.numbers[i];
  }
}

// The least distance of a body of `subjects` and another one of `others`, both ascending. Of several such pairs the one
// with the least numbers.
double ReadClosestPair(const SignalUse& signal, const TickView& tick, SignalMemory& memory) {
  const std::vector<std::uint32_t>& subjects = signal.subjects;
  const std::vector<std::uint32_t>& others = signal.others;
  const bool symmetric = subjects == others;
  double least = kInfinity;
  const auto consider = [&](std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    const Pose& X_WA = PoseOf(tick.state, a);
    const Pose& X_WB = PoseOf(tick.state, b);
    const double reach =
        least + tick.scene.body(BodyId(a)).radius + tick.scene.body(BodyId(b)).radius;  // of the origins
    const double dx = X_WA.x - X_WB.x;
    const double dy = X_WA.y - X_WB.y;
    // Too far to be nearer, by circles. The margin is above the rounding of squares, so that no nearest pair is lost
    // and the result does not depend on the order of visits.
    if (dx * dx + dy * dy > reach * reach * (1.0 + 1e-9) + 1e-9) return;
    const double distance = DistanceOf(tick.bodies.pieces_in_world(BodyId(a)), tick.bodies.pieces_in_world(BodyId(b)));
    const std::pair pair{a, b};
    // Ties go to the least numbers: the pair in the report is a function of the state, not of the pair before.
    if (distance < least || (distance == least && distance < kInfinity && pair < memory.pair)) {
      least = distance;
      memory.pair = pair;
    }
  };
  // The pair of the tick before is most often still near: then few others are.
  consider(memory.pair.first, memory.pair.second);
  if (least == kInfinity) {
    // No bound from the tick before: neighbours in the list stand near each other in most worlds, and any bound is good
    // enough to make the search with the index pay.
    for (std::size_t i = 0; i < subjects.size(); ++i) consider(subjects[i], others[(i + 1) % others.size()]);
  }
  for (const std::uint32_t a : subjects) {
    const Pose& X_WA = PoseOf(tick.state, a);
    if (least == kInfinity) {
      for (const std::uint32_t b : others) consider(a, b);
      continue;
    }
    const double reach = least + tick.scene.body(BodyId(a)).radius;
    // The index finds bodies by their own boxes, so the reach needs the radius of a alone.
    const Rectangle box{X_WA.x - reach, X_WA.y - reach, X_WA.x + reach, X_WA.y + reach};
    tick.bodies.ForEachNear(box, [&](BodyId near) {
      const auto b = static_cast<std::uint32_t>(near.index());
      if (symmetric ? b <= a : b == a) return;
      if (std::binary_search(others.begin(), others.end(), b)) consider(a, b);
    });
  }
  return least;
}

bool Matches(const Event& event, const SignalUse& signal, std::size_t lane, const Things& things) {
  if (event.type != signal.event) return false;
  if (!signal.text.empty() && !MatchesGlob(signal.text, event.detail)) return false;
  if (signal.subjects.empty()) return true;
  const ThingId thing = signal.subjects[lane];
  if (things.kind_of(thing) == RobotKind()) return event.robot == RobotId(thing);
  return things.model(thing) && event.object == things.model(thing);
}

void ReadEvents(const SignalUse& signal, const Things& things, const TickView& tick, SignalMemory& memory,
                std::span<double> values) {
  const bool counts = signal.kind == SignalKind::kEventCount;
  if (counts && memory.numbers.empty()) memory.numbers.assign(values.size(), 0.0);
  if (!counts) std::fill(values.begin(), values.end(), -kInfinity);
  for (const Event& event : tick.events) {
    // Before the loop over lanes: most ticks have no event of the type, and a world has thousands of robots.
    if (event.type != signal.event) continue;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!Matches(event, signal, i, things)) continue;
      if (counts) {
        memory.numbers[i] += 1.0;
      } else {
        values[i] = kInfinity;
      }
    }
  }
  if (counts) std::copy(memory.numbers.begin(), memory.numbers.end(), values.begin());
}

void ReadAlive(const SignalUse& signal, const TickView& tick, SignalMemory& memory, std::span<double> values) {
  if (memory.numbers.empty()) memory.numbers.assign(values.size(), 0.0);
  for (const Event& event : tick.events) {
    if (!event.robot || (event.type != EventType::kLeft && event.type != EventType::kJoined)) continue;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (signal.subjects[i] == event.robot->index()) memory.numbers[i] = event.type == EventType::kLeft ? 1.0 : 0.0;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t store = signal.parts[i];
    const bool has_energy = store == SignalUse::kNone || tick.state.stores[store].joules > 0.0;
    values[i] = Truth(memory.numbers[i] == 0.0 && has_energy);
  }
}

constexpr std::size_t kAnyObject = std::numeric_limits<std::size_t>::max();

double ReadHeld(const TickView& tick, std::uint32_t robot, std::size_t object) {
  for (const GripperId gripper : tick.scene.grippers_of(RobotId(robot))) {
    const std::optional<ObjectId> clamped = tick.state.grippers[gripper.index()].clamped;
    if (!clamped || tick.state.objects[clamped->index()].holder != gripper) continue;
    if (object == kAnyObject || clamped->index() == object) return kInfinity;
  }
  return -kInfinity;
}

double ValueOf(const SensorReading& reading, SignalKind kind) {
  if (const auto* const ranger = reading.As<RangerReading>()) {
    double least = kInfinity;
    double sum = 0.0;
    for (const double range : ranger->ranges) {
      least = std::min(least, range);
      sum += range;
    }
    return kind == SignalKind::kRange ? least : sum / static_cast<double>(ranger->ranges.size());
  }
  if (const auto* const bumper = reading.As<BumperReading>()) {
    return Truth(std::any_of(bumper->segments.begin(), bumper->segments.end(),
                             [](const BumperReading::Segment& segment) { return segment.pressed_by.has_value(); }));
  }
  if (const auto* const radio = reading.As<RadioReading>()) return static_cast<double>(radio->receptions.size());
  return kInfinity;
}

void ReadSensors(const SignalUse& signal, const TickView& tick, SignalMemory& memory, std::span<double> values) {
  if (!memory.sensors) {
    // The robot's own sensors, on the same state: a range in a test is the number that the controller saw.
    auto sensors = std::make_shared<std::vector<std::unique_ptr<const Sensor>>>();
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::vector<std::unique_ptr<const Sensor>> all = MakeSensors(tick.scene, RobotId(signal.subjects[i]));
      sensors->push_back(std::move(all[signal.parts[i]]));
    }
    memory.sensors = std::move(sensors);
  }
  const SensedWorld world{tick.scene, tick.bodies, &tick.state};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = ValueOf((*memory.sensors)[i]->Measure(world, tick.state.tick), signal.kind);
  }
}

// A signal of the state's tables.
void ReadTable(const SignalUse& signal, const Things& things, const TickView& tick, std::span<double> values) {
  const SignalView view{things, tick.scene.world(), tick.state};
  const Signal& column = *signal.column;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t row = signal.subjects[i] - signal.first;
    switch (column.type) {
      case ValueType::kNumber:
        values[i] = column.number(view, row);
        break;
      case ValueType::kTruth:
        values[i] = Truth(column.number(view, row) != 0.0);
        break;
      case ValueType::kText:
        values[i] = Truth((column.text(view, row) == signal.text) != signal.negated);
        break;
    }
  }
}

double ReadHash(const SignalUse& signal, const TickView& tick) {
  std::array<char, 17> digits{};
  // As troupe prints hashes. Computed only for formulas that name it: it reads the whole state.
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(StateHash(tick.state)));
  return Truth((signal.text == digits.data()) != signal.negated);
}

}  // namespace

std::size_t SignalInfo::least() const {
  return std::min(std::string_view(parameters).find('?'), most());
}

std::size_t SignalInfo::most() const {
  const std::string_view letters = parameters;
  return letters.size() - (letters.find('?') == std::string_view::npos ? 0 : 1);
}

std::span<const SignalInfo> RunSignals() {
  return kRunSignals;
}

const SignalInfo* FindRunSignal(std::string_view name) {
  const auto* const found =
      std::find_if(kRunSignals.begin(), kRunSignals.end(), [&](const SignalInfo& info) { return name == info.name; });
  return found == kRunSignals.end() ? nullptr : found;
}

std::vector<std::size_t> KindsWith(std::string_view signal) {
  std::vector<std::size_t> kinds;
  const std::span<const StateTable> tables = StateTables();
  for (std::size_t kind = 0; kind < tables.size(); ++kind) {
    // Rows of tables that vary have no names that a formula could say.
    if (!tables[kind].varies && tables[kind].Find(signal) != nullptr) kinds.push_back(kind);
  }
  const auto is_body = [](std::size_t kind) {
    return kind == RobotKind() || kind == ObjectKind() || kind == PersonKind();
  };
  std::stable_partition(kinds.begin(), kinds.end(), is_body);
  return kinds;
}

bool IsFunction(std::string_view name) {
  return std::find(kFunctions.begin(), kFunctions.end(), name) != kFunctions.end();
}

bool IsSignalOrFunction(std::string_view name) {
  return IsFunction(name) || FindRunSignal(name) != nullptr || !KindsWith(name).empty();
}

std::vector<std::string> SignalNames() {
  std::vector<std::string> names;
  for (const StateTable& table : StateTables()) {
    for (const Signal& signal : table.signals) {
      if (!table.varies) names.push_back(signal.name);
    }
  }
  for (const SignalInfo& info : kRunSignals) names.emplace_back(info.name);
  for (const char* const function : kFunctions) names.emplace_back(function);
  return names;
}

void ReadSignal(const SignalUse& signal, const Things& things, const TickView& tick, SignalMemory& memory,
                std::span<double> values) {
  const WorldState& state = tick.state;
  const auto for_each = [&](const auto& value) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(signal.subjects[i]);
  };
  switch (signal.kind) {
    case SignalKind::kTable:
      return ReadTable(signal, things, tick, values);
    case SignalKind::kDistance:
      return ReadDistances(signal, tick, memory, values);
    case SignalKind::kPersonDistance:
      return ReadPersonDistances(signal, tick, values);
    case SignalKind::kPeopleNear:
      return for_each([&](ThingId robot) { return CountPeopleNear(signal, tick, robot); });
    case SignalKind::kIntrusionTime:
    case SignalKind::kIntrusions:
      return ReadIntrusions(signal, tick, memory, values);
    case SignalKind::kClosestPair:
      values[0] = ReadClosestPair(signal, tick, memory);
      return;
    case SignalKind::kAt:
      return for_each([&](ThingId body) {
        const Pose& X_WB = PoseOf(state, body);
        const double beyond = Norm(X_WB.x - signal.point.x(), X_WB.y - signal.point.y());
        return OnLevel(signal, tick, X_WB.z, signal.number - beyond);
      });
    case SignalKind::kIn:
      return for_each([&](ThingId body) {
        const Pose& X_WB = PoseOf(state, body);
        return OnLevel(signal, tick, X_WB.z, DepthIn(signal.region, X_WB.translation()));
      });
    case SignalKind::kHolds:
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t held = signal.others.empty() ? kAnyObject : signal.others[i] - state.robots.size();
        values[i] = ReadHeld(tick, signal.subjects[i], held);
      }
      return;
    case SignalKind::kAlive:
      return ReadAlive(signal, tick, memory, values);
    case SignalKind::kRange:
    case SignalKind::kMeanRange:
    case SignalKind::kPressed:
    case SignalKind::kHeard:
      return ReadSensors(signal, tick, memory, values);
    case SignalKind::kTick:
      values[0] = static_cast<double>(state.tick);
      return;
    case SignalKind::kTime:
      values[0] = static_cast<double>(state.tick) * static_cast<double>(tick.scene.world().interval_ns) / 1e9;
      return;
    case SignalKind::kRows:
      values[0] = static_cast<double>(StateTables()[signal.table].rows(tick.scene.world(), state));
      return;
    case SignalKind::kHash:
      values[0] = ReadHash(signal, tick);
      return;
    case SignalKind::kEvent:
    case SignalKind::kEventCount:
      return ReadEvents(signal, things, tick, memory, values);
  }
}

}  // namespace troupe
