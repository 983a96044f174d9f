// The moves of Open-RMF's dispensers and ingestors: pure functions of a world and its state. As with the plugins
// TeleportDispenser and TeleportIngestor of rmf_simulation, an item is put onto the nearest robot at once, and taken
// from it in the same way. Then gravity decides: an item on a robot rests there, and moves with it.
//
// Distances are in the plane, in metres; heights decide whether robot and workcell are on the same storey. Candidates
// are visited in id order, and a later one must be strictly nearer, so ties have one outcome.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "troupe/enum_names.h"
#include "troupe/result.h"
#include "troupe/world_state.h"

namespace troupe {

enum class WorkcellKind : std::uint8_t { kDispenser, kIngestor };
constexpr auto NamesOf(WorkcellKind) {
  return std::array{"dispenser", "ingestor"};
}

// A dispenser or an ingestor: a place with the tag "dispenser:NAME" or "ingestor:NAME". Items are at the entity of that
// name, which may move, or at the place.
struct Workcell {
  std::string name;
  WorkcellKind kind = WorkcellKind::kDispenser;
  Pose X_WN;                         // of the place
  std::optional<ModelId> root = {};  // of the entity, if there is one
};

// In the order of their places; a name once for each kind: of several places the one with the workcell's name counts,
// else the first.
std::vector<Workcell> FindWorkcells(const WorldDescription& world);

// What a request asks for.
struct WorkcellOrder {
  std::string fleet;  // of the robot; empty: any
  std::string item;   // the item's name begins with it; without such an item any
};

struct ItemMove {
  std::string item;
  Pose X_WO;
};

// The move of the nearest item within reach onto the nearest robot, or from that robot into the workcell. `moving`:
// items with a move that is not executed yet. The error says what is missing.
Result<ItemMove> PlanMove(const std::shared_ptr<const Scene>& scene, const WorldState& state, const Workcell& workcell,
                          const WorkcellOrder& order, const std::set<std::string>& moving);

}  // namespace troupe
