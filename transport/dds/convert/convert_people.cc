// People and their goals.
#include <algorithm>
#include <string>

#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {

troupe_wire_GoalSet ToWire(const GoalSet& set, WireArena& arena) {
  troupe_wire_GoalSet wire{};
  wire.name = arena.Copy(set.name);
  double* x = arena.Fill(wire.x, set.points.size());
  double* y = arena.Fill(wire.y, set.points.size());
  for (const Vec2& point : set.points) {
    *x++ = point.x();
    *y++ = point.y();
  }
  wire.reach = set.reach;
  wire.wait_min = set.wait.min;
  wire.wait_max = set.wait.max;
  std::uint32_t* next = arena.Fill(wire.next, set.next.size());
  double* weight = arena.Fill(wire.weight, set.next.size());
  for (const NextGoals& choice : set.next) {
    *next++ = choice.goals;
    *weight++ = choice.weight;
  }
  std::copy(set.heights.begin(), set.heights.end(), arena.Fill(wire.z, set.heights.size()));
  return wire;
}
Status FromWire(const troupe_wire_GoalSet& wire, GoalSet& set) {
  set.name = Text(wire.name);
  const auto x = Elements(wire.x);
  const auto y = Elements(wire.y);
  const auto next = Elements(wire.next);
  const auto weight = Elements(wire.weight);
  if (x.size() != y.size() || next.size() != weight.size()) {
    return Error{{}, "goal set '" + set.name + "' with columns of different lengths"};
  }
  for (std::size_t i = 0; i < x.size(); ++i) set.points.emplace_back(x[i], y[i]);
  set.reach = wire.reach;
  set.wait = {wire.wait_min, wire.wait_max};
  for (std::size_t i = 0; i < next.size(); ++i) set.next.push_back({next[i], weight[i]});
  const auto z = Elements(wire.z);
  set.heights.assign(z.begin(), z.end());
  return {};
}

troupe_wire_Person ToWire(const PersonDescription& person, WireArena&) {
  troupe_wire_Person wire{};
  wire.root = static_cast<std::uint32_t>(person.root.index());
  wire.radius = person.radius;
  wire.speed = person.speed;
  wire.max_speed = person.max_speed;
  wire.reaction = static_cast<std::uint8_t>(person.reaction);
  wire.goals = person.goals;
  wire.leader = person.leader ? static_cast<std::int32_t>(person.leader->index()) : kNoIndex;
  return wire;
}
Status FromWire(const troupe_wire_Person& wire, PersonDescription& person) {
  person.root = ModelId(wire.root);
  person.radius = wire.radius;
  person.speed = wire.speed;
  person.max_speed = wire.max_speed;
  person.reaction = static_cast<PersonReaction>(wire.reaction);
  person.goals = wire.goals;
  if (wire.leader < kNoIndex) return Error{{}, "person with leader " + std::to_string(wire.leader)};
  if (wire.leader != kNoIndex) person.leader = PersonId(static_cast<std::size_t>(wire.leader));
  return {};
}

}  // namespace troupe::dds
