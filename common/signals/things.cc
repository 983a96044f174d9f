#include "common/signals/things.h"

#include <algorithm>

#include "common/model/zones.h"
#include "common/signals/state_tables.h"

namespace troupe {

Things::Things(const WorldDescription& world)
    : ranges_(StateTables().size()), sensors_(FindSensors(world)), lanes_(FindLanes(world)) {
  std::vector<std::vector<ThingName>> names = NameThings(world);
  std::vector<std::size_t> order{RobotKind(), ObjectKind(), PersonKind()};
  for (std::size_t kind = 0; kind < names.size(); ++kind) {
    if (std::find(order.begin(), order.end(), kind) == order.end()) order.push_back(kind);
  }
  for (const std::size_t kind : order) {
    ranges_[kind] = {static_cast<ThingId>(size()), static_cast<std::uint32_t>(names[kind].size())};
    for (ThingName& name : names[kind]) {
      names_.push_back(std::move(name.name));
      models_.push_back(name.model);
      robots_.push_back(name.robot);
      exists_.push_back(!name.model || !world.model(*name.model).removed);
    }
  }
  FindStoresOfRobots(world);
  for (const ZoneDescription& zone : world.zones) cells_.push_back(CountCells(zone));
}

void Things::FindStoresOfRobots(const WorldDescription& world) {
  std::vector<std::optional<std::size_t>> robot_of_root(world.models.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) robot_of_root[world.robots[i].root.index()] = i;
  stores_.resize(world.robots.size());
  const std::vector<ModelId> stores = FindStores(world);
  for (std::size_t i = 0; i < stores.size(); ++i) {
    if (world.model(stores[i]).power.endless) continue;
    for (std::optional<ModelId> at = stores[i]; at; at = world.model(*at).parent) {
      // Stores on parts of a robot belong to it, however deep.
      if (const std::optional<std::size_t> robot = robot_of_root[at->index()]) stores_[*robot].push_back(i);
    }
  }
}

std::size_t Things::kind_of(ThingId thing) const {
  std::size_t kind = 0;
  while (thing - ranges_[kind].first >= ranges_[kind].count) ++kind;  // unsigned: also of one before the first
  return kind;
}

std::optional<ThingId> Things::Find(std::string_view name, std::size_t kind) const {
  for (ThingId thing = first(kind); thing < first(kind) + count(kind); ++thing) {
    if (exists_[thing] && names_[thing] == name) return thing;
  }
  return std::nullopt;
}

}  // namespace troupe
