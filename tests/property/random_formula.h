// RandomFormula: expectations with all operators, quantifiers and signals, for a world of ExpectationWorld.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/files.h"
#include "troupe/expectation.h"
#include "troupe/simulation.h"

namespace troupe::test {

// Three robots "r0" to "r2" with a gripper, a ranger, a bumper, a radio and a store of energy, which their scripts use
// within 6 s; two objects "can0" and "can1", two people, a static model "wall" and a place "dock".
inline WorldDescription ExpectationWorld() {
  const TemporaryFolder folder;
  folder.Write("expectations.world", R"(
    define can model ( size [0.1 0.1 0.2] gripper_return 1 )
    define worker position
    (
      size [0.4 0.4 0.3]  drive "diff"  kjoules 0.2  watts 5
      gripper( name "gripper" pose [0.3 0 -0.3 0] max_height 0.5 lift_speed 0.4 paddle_speed 0.5 )
      ranger( name "low" pose [0 0 -0.1 0] sensor( range [0 8] fov 180 samples 5 ) )
      ranger( name "scan" pose [0.1 0 0 0] sensor( range [0 4] fov 360 samples 7 ) )
      bumper( name "bumper" size [0.4 0.4 0.1] noblocks 1 pose [0 0 -0.2 0] bcount 1 bpose[0] [-0.2 0 0 180] blength 0.4 )
      radio( name "radio" range 3 loss 0.2 )
    )
    model( name "wall" pose [0 4 0 0] size [8 0.2 1] )
    model( name "charger" pose [-3 -3 0 0] size [2 2 0.02] obstacle_return 0 joules -1 give_watts 40 )
    can( name "can0" pose [0.35 0 0 0] )
    can( name "can1" pose [2 -1 0 0] )
    worker( name "r0" pose [0 0 0 0] )
    worker( name "r1" pose [2 3 0 -90] )
    worker( name "r2" pose [-3 -3 0 0] kjoules 0.01 )
  )");
  const std::string file = folder.Write("expectations.json", R"({"world": "expectations.world", "people": [
      {"count": 2, "region": [3, -4, 4, 0], "goals": [[3, -4], [4, 0]]}]})");
  WorldDescription world = Simulation::Load(file).value().world();
  world.places.push_back({"dock", {}, {}, {1.0, 0.0, 0.0, 0.0}});
  world.robots[0].controller = {"script", R"({"commands": [{"at": 0, "gripper": "close"}, {"at": 0.6, "lift": "up"},
      {"at": 1, "vx": 0.5, "say": "done it"}, {"at": 2.5, "gripper": "open"}, {"at": 4, "vx": 0.5, "wz": 1}]})"};
  world.robots[1].controller = {"script", R"({"repeat": true, "period": 0.4, "commands": [
      {"at": 0, "vx": -0.6, "send": "here"}]})"};
  world.robots[2].controller = {"script", R"({"commands": [{"at": 0, "vx": 0.2, "wz": 0.5}, {"at": 3, "vx": 1}]})"};
  return world;
}
inline const NamedRegion kYard{"yard", {{-2.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {-2.0, 1.0}}};

class RandomFormula {
 public:
  explicit RandomFormula(std::uint32_t seed) : random_(seed) {}

  int Below(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

  // A formula that may name the state hash `hash`, of 16 digits.
  std::string Formula(int depth, const std::string& hash) {
    hash_ = hash;
    return Truth(depth, {});
  }

 private:
  using Names = std::vector<std::string>;  // of variables; those of objects begin with an o

  static bool IsObject(const std::string& variable) { return variable[0] == 'o'; }
  std::string Some(const Names& names) {
    return names[static_cast<std::size_t>(Below(static_cast<int>(names.size())))];
  }

  std::string Truth(int depth, const Names& variables) {
    if (variables.empty() || (depth > 1 && variables.size() < 3 && Below(4) == 0)) return Quantified(depth, variables);
    if (depth <= 0) return Atom(variables);
    switch (Below(11)) {
      case 0:
        return "not (" + Truth(depth - 1, variables) + ")";
      case 1:
        return Joined(depth, variables, "and");
      case 2:
        return Joined(depth, variables, "or");
      case 3:
        return Joined(depth, variables, "->");
      case 4:
        return "always" + Interval() + " (" + Truth(depth - 1, variables) + ")";
      case 5:
        return "eventually" + Interval() + " (" + Truth(depth - 1, variables) + ")";
      case 6:
        return Joined(depth, variables, "until" + Interval());
      case 7:
        return Joined(depth, variables, "since");
      case 8:
        return "historically" + Interval() + " (" + Truth(depth - 1, variables) + ")";
      case 9:
        return "once" + Interval() + " (" + Truth(depth - 1, variables) + ")";
      default:
        return Below(3) == 0 ? "finally (" + Truth(depth - 1, variables) + ")" : Atom(variables);
    }
  }

  std::string Interval() {
    if (Below(3) == 0) return "";
    const int from = Below(4);
    if (Below(5) == 0) return "[" + std::to_string(from) + " ticks, end]";
    return "[" + std::to_string(from) + " ticks, " + std::to_string(from + Below(5)) + " ticks]";
  }

  std::string Joined(int depth, const Names& variables, const std::string& with) {
    return "(" + Truth(depth - 1, variables) + ") " + with + " (" + Truth(depth - 1, variables) + ")";
  }

  // The body mentions each variable, as it must.
  std::string Quantified(int depth, Names variables) {
    const bool of_objects = Below(3) == 0;
    const std::string number = std::to_string(variables.size());
    Names names{(of_objects ? "o" : "v") + number};
    if (Below(3) == 0) names.push_back((of_objects ? "ow" : "w") + number);
    variables.insert(variables.end(), names.begin(), names.end());
    std::string text = Below(2) == 0 ? "forall " : "exists ";
    for (std::size_t i = 0; i < names.size(); ++i) text += (i > 0 ? ", " : "") + names[i];
    text += Domain(of_objects, names.size() == 1) + ": (" + Truth(depth - 1, variables) + ")";
    for (const std::string& name : names) text += (Below(2) == 0 ? " and (" : " or (") + Atom({name}) + ")";
    return "(" + text + ")";
  }

  // Of one body or of all.
  std::string Domain(bool of_objects, bool may_be_one) {
    const std::string pattern = of_objects ? Some({"can1*", "?an0", "*"}) : Some({"r1*", "?2", "*"});
    const bool has_pattern = may_be_one && Below(4) == 0;
    if (of_objects) return " in objects" + (has_pattern ? " \"" + pattern + "\"" : "");
    return has_pattern ? " in \"" + pattern + "\"" : Below(5) == 0 ? " in robots" : "";
  }

  // Two numbers of one unit, the first one with `variable`.
  std::pair<std::string, std::string> Numbers(const std::string& variable, const Names& variables) {
    const auto of = [](const std::string& signal, const std::string& name) { return signal + "(" + name + ")"; };
    if (Below(3) > 0) {
      const Names signals{"x", "y", "z"};
      return {of(Some(signals), variable), of(Some(signals), Some(variables))};
    }
    if (Below(3) == 0) {
      const std::string other = Some(variables);
      return {"distance(" + variable + ", " + Some({"dock", "wall", "can0", "\"r1\"", other}) + ")", of("x", variable)};
    }
    if (IsObject(variable)) {
      if (Below(2) == 0) return {of("heading", variable), of("heading", "can1")};
      return {"count(event(" + Some({"landed", "gripped", "released"}) + ", " + variable + "))", "tick"};
    }
    switch (Below(12)) {
      case 0:
        return {of("heading", variable), of("heading", "r0")};
      case 1:
        return {of("speed", variable), "velocity(" + variable + ", \"gripper.lift\")"};
      case 2:
        return {of("wz", variable), of("wz", "r2")};
      case 3:
        return {of("energy", variable), of("capacity", variable)};
      case 4:
        return {of("charging", variable), of("charging", "r2")};
      case 5:
        return {"position(" + variable + ", \"gripper.lift\")", of("z", Some(variables))};
      case 6:
        return {of("range", variable), Some({of("mean_range", variable), "range(" + variable + ", \"scan\")"})};
      case 7:
        return {of("heard", variable), "count(event(said))"};
      case 8:
        return {of("person_distance", variable), of("x", Some(variables))};
      case 9:
        return {"people_near(" + variable + ", 1 m)", "intrusions(" + variable + ", 1.5 m)"};
      case 10:
        return {"intrusion_time(" + variable + ", 2 m)", "time"};
      default:
        return {"count(event(" + Some({"stall_began", "said", "left"}) + ", " + variable + "))", "tick"};
    }
  }

  std::string Number(const Names& variables) {
    const auto [one, other] = Numbers(Some(variables), variables);
    const std::string domain = Domain(Below(3) == 0, false);
    switch (Below(12)) {
      case 0:
        return one + " - " + other;
      case 1:
        return "abs(" + one + ")";
      case 2:
        return "(min q" + domain + ": x(q) + y(" + Some(variables) + "))";
      case 3:
        return "2 * " + one;
      case 4:
        return "(max q" + domain + ": y(q) - x(" + Some(variables) + "))";
      case 5:
        return "(sum q" + domain + ": x(q) - z(" + Some(variables) + ")) / 2";
      case 6:
        return "(mean q" + Domain(Below(3) == 0, true) + ": x(q) + y(" + Some(variables) + "))";
      case 7:
        return "sqrt(" + one + " * " + one + " + " + other + " * " + other + ")";
      case 8:
        return std::string(Below(2) == 0 ? "min" : "max") + "(" + one + ", -" + other + ")";
      default:
        return one;
    }
  }

  std::string Condition(const std::string& variable) {
    const std::string target = "(" + variable;
    Names conditions{"at" + target + ", dock)", "at" + target + ", dock, 2 m)", "in" + target + ", yard)"};
    if (IsObject(variable)) {
      conditions.insert(conditions.end(), {"falling" + target + ")", "resting" + target + ")",
                                           "event(" + Some({"landed", "gripped", "released"}) + ", " + variable + ")",
                                           "holds(r0, " + variable + ")"});
    } else {
      conditions.insert(
          conditions.end(),
          {"stalled" + target + ")", "stalled" + target + ")", "holds" + target + ")", "holds" + target + ", can0)",
           "alive" + target + ")", "blocked" + target + ", \"gripper.lift\")", "pressed" + target + ")",
           "pressed" + target + ", \"bumper\")",
           "event(" + Some({"stall_began", "said", "left", "out_of_energy"}) + ", " + variable + ")",
           "event(said, " + variable + ", \"d*\")"});
    }
    return Some(conditions);
  }

  std::string Atom(const Names& variables) {
    const std::string variable = Some(variables);
    if (Below(3) == 0) return Condition(variable);
    if (Below(8) == 0) {
      return "(count q" + Domain(Below(3) == 0, false) + ": x(q) > x(" + variable + ")) >= " + std::to_string(Below(3));
    }
    const std::string comparison =
        Number(variables) + " " + Some({"<", "<=", ">", ">=", "==", "!="}) + " " + std::to_string(Below(4));
    if (Below(12) > 0) return comparison;
    const std::string free =
        Some({"time >= 0.2 s", "tick < 3", std::string("hash ") + Some({"==", "!="}) + " '" + hash_ + "'",
              "event(landed)", "false"});
    return "(" + free + Some({" or ", " and ", " -> "}) + comparison + ")";
  }

  std::mt19937 random_;
  std::string hash_;
};

}  // namespace troupe::test
