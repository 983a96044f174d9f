// NaiveEvaluator: robustness by the definitions of docs/testing.md, with a loop for each quantifier and operator.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/states.h"
#include "common/sensing/sensor_suite.h"
#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/scene.h"
#include "testing/expectations/syntax.h"
#include "troupe/event.h"
#include "troupe/expectation.h"

namespace troupe::test {

inline constexpr double kNothing = std::numeric_limits<double>::infinity();

inline bool IsFalse(double robustness) {
  return std::signbit(robustness);
}

// A state with all that signals read.
struct RunTick {
  WorldState state;
  std::vector<Event> events;  // of the step to the state
  BodyIndex bodies;           // at the state
};

class NaiveEvaluator {
 public:
  // REQUIRES: there are at least one tick, one region, and it is the only one that formulas name.
  NaiveEvaluator(const Scene& scene, const NamedRegion& region, const std::vector<RunTick>& run)
      : scene_(scene), region_(region), run_(run), last_(static_cast<int>(run.size()) - 1) {
    for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
      names_.push_back(scene.world().robots[i].name);
      sensors_.push_back(MakeSensors(scene, RobotId(i)));
    }
    for (const ModelId object : scene.world().objects) names_.push_back(scene.world().model(object).name);
  }

  double Truth(const Syntax& f, int t) {
    if (f.kind == SyntaxKind::kName) return OfTruth(f.name == "true");
    if (f.kind == SyntaxKind::kCall) return Condition(f, t);
    if (f.kind == SyntaxKind::kBound) {
      const bool all = f.name == "forall";
      double result = all ? kNothing : -kNothing;
      ForEachBinding(f, 0, [&] {
        const double value = Truth(f.children[0], t);
        result = all ? Lesser(result, value) : Greater(result, value);
      });
      return result;
    }
    if (f.kind == SyntaxKind::kTemporal) return Temporal(f, t);
    if (f.name == "not") return -Truth(f.children[0], t);
    if (f.name == "->") return Greater(-Truth(f.children[0], t), Truth(f.children[1], t));
    if (f.name == "and" || f.name == "or") {
      double result = Truth(f.children[0], t);
      for (const Syntax& child : f.children) {
        result = f.name == "and" ? Lesser(result, Truth(child, t)) : Greater(result, Truth(child, t));
      }
      return result;
    }
    if (f.children[0].Is(SyntaxKind::kName, "hash")) {
      char digits[17];
      std::snprintf(digits, sizeof(digits), "%016llx", static_cast<unsigned long long>(StateHash(At(t).state)));
      return OfTruth((f.children[1].name == digits) == (f.name == "=="));
    }
    const double a = Number(f.children[0], t);
    const double b = Number(f.children[1], t);
    if (f.name == ">") return a == b ? -0.0 : a - b;
    if (f.name == ">=") return a == b ? 0.0 : a - b;
    if (f.name == "<") return a == b ? -0.0 : b - a;
    if (f.name == "<=") return a == b ? 0.0 : b - a;
    if (f.name == "==") return a == b ? 0.0 : -std::abs(a - b);
    return a == b ? -0.0 : std::abs(a - b);
  }

 private:
  static double OfTruth(bool value) { return value ? kNothing : -kNothing; }
  static double Lesser(double a, double b) { return a < b || (a == b && IsFalse(a)) ? a : b; }
  static double Greater(double a, double b) { return -Lesser(-a, -b); }

  const RunTick& At(int t) const { return run_[static_cast<std::size_t>(t)]; }
  const WorldDescription& world() const { return scene_.world(); }
  std::size_t robots() const { return world().robots.size(); }

  template <typename Visit>
  void ForEachBinding(const Syntax& f, std::size_t next, const Visit& visit) {
    if (next == f.variables.size()) return visit();
    const bool is_of_robots = f.domain == "robots";
    for (std::size_t body = is_of_robots ? 0 : robots(); body < (is_of_robots ? robots() : names_.size()); ++body) {
      bool used = false;
      for (std::size_t i = 0; i < next; ++i) used = used || bindings_[f.variables[i]] == body;
      if (used || (f.pattern && !Matches(*f.pattern, names_[body]))) continue;
      bindings_[f.variables[next]] = body;
      ForEachBinding(f, next + 1, visit);
    }
  }

  // * is any characters, ? one.
  static bool Matches(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern[0] == '*')
      return Matches(pattern.substr(1), name) || (!name.empty() && Matches(pattern, name.substr(1)));
    return !name.empty() && (pattern[0] == '?' || pattern[0] == name[0]) && Matches(pattern.substr(1), name.substr(1));
  }

  // Signals.

  // The robot or object of an argument; none for a place or a static model.
  std::optional<std::size_t> FindBody(const Syntax& argument) const {
    if (const auto bound = bindings_.find(argument.name);
        bound != bindings_.end() && argument.kind == SyntaxKind::kName) {
      return bound->second;
    }
    const auto named = std::find(names_.begin(), names_.end(), argument.name);
    if (named == names_.end()) return std::nullopt;
    return static_cast<std::size_t>(named - names_.begin());
  }
  const Pose& PoseOf(std::size_t body, int t) const {
    const WorldState& state = At(t).state;
    return body < robots() ? state.robots[body].X_WR : state.objects[body - robots()].X_WO;
  }
  std::size_t JointOf(std::size_t robot, const std::string& name) const {
    std::size_t joint = 0;
    while (world().joints[joint].robot != RobotId(robot) || world().joints[joint].name != name) ++joint;
    return joint;
  }
  std::size_t StoreOf(std::size_t robot) const { return scene_.store_of(world().robots[robot].root).value(); }
  // The sensor of `type` with the name of the second argument, the first one without it.
  SensorReading Measure(const Syntax& f, std::string_view type, int t) const {
    const std::size_t robot = FindBody(f.children[0]).value();
    const std::vector<SensorDescription>& sensors = world().robots[robot].sensors;
    std::size_t sensor = 0;
    while (TypeOf(sensors[sensor].parameters) != type ||
           (f.children.size() > 1 && sensors[sensor].name != f.children[1].name)) {
      ++sensor;
    }
    return sensors_[robot][sensor]->Measure({scene_, At(t).bodies, &At(t).state}, At(t).state.tick);
  }
  bool IsOf(const Event& event, const Syntax& f) const {
    if (f.children[0].name != NameOf(event.type)) return false;
    if (f.children.size() > 2 && !Matches(f.children[2].name, event.detail)) return false;
    if (f.children.size() == 1) return true;
    const std::size_t body = FindBody(f.children[1]).value();
    return body < robots() ? event.robot == RobotId(body) : event.object == world().objects[body - robots()];
  }
  double EventsAt(const Syntax& f, int t) const {
    return static_cast<double>(
        std::count_if(At(t).events.begin(), At(t).events.end(), [&](const Event& event) { return IsOf(event, f); }));
  }

  double Condition(const Syntax& f, int t) const {
    const WorldState& state = At(t).state;
    if (f.name == "event") return OfTruth(EventsAt(f, t) > 0.0);
    const std::size_t body = FindBody(f.children[0]).value();
    const Pose& X_WB = PoseOf(body, t);
    if (f.name == "stalled") return OfTruth(state.robots[body].stalled);
    if (f.name == "at") {
      const double radius = f.children.size() > 2 ? f.children[2].number.value : 0.2;
      const Pose& X_WN = world().places.front().X_WN;
      const double dx = X_WB.x - X_WN.x;
      const double dy = X_WB.y - X_WN.y;
      return radius - std::sqrt(dx * dx + dy * dy);
    }
    if (f.name == "in") {  // the region is a rectangle that is parallel to the axes
      const Vec2& least = region_.outline[0];
      const Vec2& most = region_.outline[2];
      const double dx = std::max({least.x() - X_WB.x, 0.0, X_WB.x - most.x()});
      const double dy = std::max({least.y() - X_WB.y, 0.0, X_WB.y - most.y()});
      if (dx > 0.0 || dy > 0.0) return -std::sqrt(dx * dx + dy * dy);
      return std::min({X_WB.x - least.x(), most.x() - X_WB.x, X_WB.y - least.y(), most.y() - X_WB.y});
    }
    if (f.name == "holds") {
      bool holds = false;
      for (std::size_t object = 0; object < state.objects.size(); ++object) {
        const bool is_meant = f.children.size() == 1 || FindBody(f.children[1]).value() == robots() + object;
        const std::optional<GripperId> holder = state.objects[object].holder;
        if (!is_meant || !holder || world().grippers[holder->index()].robot != RobotId(body)) continue;
        holds = holds || state.grippers[holder->index()].clamped == ObjectId(object);
      }
      return OfTruth(holds);
    }
    if (f.name == "falling") return OfTruth(state.objects[body - robots()].mode == ObjectMode::kFalling);
    if (f.name == "resting") return OfTruth(state.objects[body - robots()].mode == ObjectMode::kResting);
    if (f.name == "alive") {
      bool alive = true;
      for (int s = 0; s <= t; ++s) {
        for (const Event& event : At(s).events) {
          if (event.robot != RobotId(body)) continue;
          if (event.type == EventType::kLeft) alive = false;
          if (event.type == EventType::kJoined) alive = true;
        }
      }
      return OfTruth(alive && state.stores[StoreOf(body)].joules > 0.0);
    }
    if (f.name == "blocked") return OfTruth(state.joints[JointOf(body, f.children[1].name)].blocked);
    bool pressed = false;
    const SensorReading reading = Measure(f, "bumper", t);
    for (const BumperReading::Segment& segment : reading.As<BumperReading>()->segments) {
      pressed = pressed || segment.pressed_by;
    }
    return OfTruth(pressed);
  }

  double Signal(const Syntax& f, int t) const {
    const WorldState& state = At(t).state;
    if (f.name == "tick") return static_cast<double>(state.tick);
    if (f.name == "time") return static_cast<double>(state.tick) * static_cast<double>(world().interval_ns) / 1e9;
    if (f.name == "count") {
      double count = 0.0;
      for (int s = 0; s <= t; ++s) count += EventsAt(f.children[0], s);
      return count;
    }
    const std::size_t body = FindBody(f.children[0]).value();
    if (f.name == "x") return PoseOf(body, t).x;
    if (f.name == "y") return PoseOf(body, t).y;
    if (f.name == "z") return PoseOf(body, t).z;
    if (f.name == "heading") return PoseOf(body, t).heading;
    if (f.name == "distance") return Distance(body, f.children[1], t);
    if (f.name == "position") return state.joints[JointOf(body, f.children[1].name)].position;
    if (f.name == "velocity") return state.joints[JointOf(body, f.children[1].name)].velocity;
    if (f.name == "energy") return state.stores[StoreOf(body)].joules;
    if (f.name == "capacity") return world().model(world().robots[body].root).power.capacity;
    if (f.name == "charging") return state.stores[StoreOf(body)].charge_watts;
    if (f.name == "wz") return state.robots[body].twist.wz;
    if (f.name == "speed") {
      const Twist& twist = state.robots[body].twist;
      return std::sqrt(twist.vx * twist.vx + twist.vy * twist.vy);
    }
    if (f.name == "heard") {
      const SensorReading reading = Measure(f, "radio", t);
      return static_cast<double>(reading.As<RadioReading>()->receptions.size());
    }
    if (f.name == "person_distance") return DistanceToPeople(body, t, nullptr);
    if (f.name == "people_near" || f.name == "intrusions" || f.name == "intrusion_time") {
      const double reach = f.children[1].number.value;
      const auto near = [&](int at) {
        int count = 0;
        DistanceToPeople(body, at, [&](double distance) { count += distance <= reach ? 1 : 0; });
        return count;
      };
      if (f.name == "people_near") return near(t);
      double sum = 0.0;
      for (int s = 0; s <= t; ++s) {
        if (f.name == "intrusion_time") sum += At(s).state.tick > 0 && near(s) > 0 ? world().interval_seconds() : 0.0;
        if (f.name == "intrusions") sum += near(s) > 0 && (s == 0 || near(s - 1) == 0) ? 1.0 : 0.0;
      }
      return sum;
    }
    const SensorReading reading = Measure(f, "ranger", t);
    const std::vector<double>& ranges = reading.As<RangerReading>()->ranges;
    if (f.name == "range") return *std::min_element(ranges.begin(), ranges.end());
    double sum = 0.0;
    for (const double range : ranges) sum += range;
    return sum / static_cast<double>(ranges.size());
  }

  // To the nearest one; `visit` is called with the distance to each.
  double DistanceToPeople(std::size_t body, int t, const std::function<void(double)>& visit) const {
    double least = kNothing;
    for (std::size_t person = 0; person < world().people.size(); ++person) {
      double distance = kNothing;
      for (const ConvexPiece& piece : At(t).bodies.pieces_in_world(BodyId(body))) {
        for (const ConvexPiece& against : At(t).bodies.pieces_in_world(scene_.body_of(PersonId(person)))) {
          if (!piece.obstacle || !against.obstacle || !piece.z.Overlaps(against.z)) continue;
          distance = std::min(distance, FindNearestPoints(piece.vertices, against.vertices).distance);
        }
      }
      if (visit) visit(distance);
      least = std::min(least, distance);
    }
    return least;
  }

  double Distance(std::size_t body, const Syntax& to, int t) const {
    const std::optional<std::size_t> other = FindBody(to);
    if (other == body) return 0.0;
    const auto pieces_of = [&](std::size_t its) { return At(t).bodies.pieces_in_world(BodyId(its)); };
    double least = kNothing;
    const auto consider = [&](const ConvexPiece& piece, const ConvexPiece& against) {
      if (!piece.obstacle || !against.obstacle || !piece.z.Overlaps(against.z)) return;
      least = std::min(least, FindNearestPoints(piece.vertices, against.vertices).distance);
    };
    for (const ConvexPiece& piece : pieces_of(body)) {
      if (other) {
        for (const ConvexPiece& against : pieces_of(*other)) consider(piece, against);
      } else if (to.name == world().places.front().name) {
        const Vec2 point = world().places.front().X_WN.translation();
        if (piece.obstacle) least = std::min(least, FindNearestPoints(piece.vertices, std::span(&point, 1)).distance);
      } else {
        for (std::size_t model = 0; model < world().models.size(); ++model) {
          if (world().models[model].name != to.name) continue;
          for (const ConvexPiece& against : MakePieces(world(), ModelId(model), scene_.X_LM(ModelId(model)))) {
            consider(piece, against);
          }
        }
      }
    }
    return least;
  }

  double Number(const Syntax& f, int t) {
    if (f.kind == SyntaxKind::kNumber) return f.number.value;
    if (f.kind == SyntaxKind::kName) return Signal(f, t);
    if (f.kind == SyntaxKind::kCall && f.name == "sqrt") return std::sqrt(Number(f.children[0], t));
    if (f.kind == SyntaxKind::kCall && f.name == "abs") return std::abs(Number(f.children[0], t));
    if (f.kind == SyntaxKind::kCall && (f.name == "min" || f.name == "max")) {
      const double a = Number(f.children[0], t);
      const double b = Number(f.children[1], t);
      return f.name == "min" ? std::min(a, b) : std::max(a, b);
    }
    if (f.kind == SyntaxKind::kCall) return Signal(f, t);
    if (f.kind == SyntaxKind::kBound) {
      double result = f.name == "min" ? kNothing : f.name == "max" ? -kNothing : 0.0;
      int count = 0;
      ForEachBinding(f, 0, [&] {
        ++count;
        if (f.name == "count") {
          result += IsFalse(Truth(f.children[0], t)) ? 0.0 : 1.0;
          return;
        }
        const double value = Number(f.children[0], t);
        result = f.name == "min" ? std::min(result, value) : f.name == "max" ? std::max(result, value) : result + value;
      });
      return f.name == "mean" ? result / count : result;
    }
    if (f.children.size() == 1) return -Number(f.children[0], t);
    const double a = Number(f.children[0], t);
    const double b = Number(f.children[1], t);
    return f.name == "+" ? a + b : f.name == "-" ? a - b : f.name == "*" ? a * b : a / b;
  }

  double Temporal(const Syntax& f, int t) {
    const int from = f.interval ? static_cast<int>(f.interval->from.value) : 0;
    const int to = f.interval && f.interval->to ? static_cast<int>(f.interval->to->value) : 1000;
    double result = f.name == "always" || f.name == "historically" ? kNothing : -kNothing;
    if (f.name == "finally") return Truth(f.children[0], last_);
    if (f.name == "since") {
      for (int s = t; s >= 0; --s) {
        double value = Truth(f.children[1], s);
        for (int u = s + 1; u <= t; ++u) value = Lesser(value, Truth(f.children[0], u));
        result = Greater(result, value);
      }
      return result;
    }
    if (f.name == "until") {
      for (int s = t + from; s <= std::min(t + to, last_); ++s) {
        double value = Truth(f.children[1], s);
        for (int u = t; u < s; ++u) value = Lesser(value, Truth(f.children[0], u));
        result = Greater(result, value);
      }
      return result;
    }
    const bool past = f.name == "historically" || f.name == "once";
    const bool all = f.name == "always" || f.name == "historically";
    const int begin = past ? std::max(t - to, 0) : t + from;
    const int end = past ? t - from : std::min(t + to, last_);
    for (int s = begin; s <= end; ++s) {
      const double value = Truth(f.children[0], s);
      result = all ? Lesser(result, value) : Greater(result, value);
    }
    return result;
  }

  const Scene& scene_;
  const NamedRegion& region_;
  const std::vector<RunTick>& run_;
  const int last_;
  std::vector<std::string> names_;                                   // of the robots, then of the objects
  std::vector<std::vector<std::unique_ptr<const Sensor>>> sensors_;  // by robot
  std::map<std::string, std::size_t> bindings_;
};

}  // namespace troupe::test
