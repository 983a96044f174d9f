// The keys "flows" and "events" of a scenario: what an operator of its site has, beside its zones (zone_entries.h).
//
// Two steps, as for people: entries are read with the scenario, and their names of doors, lifts, lanes and places are
// found when the world is built. Each error has the place of the text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/json_tree.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/scenario/zone_entries.h"

namespace troupe {

struct FlowEntry {
  GoodsFlow flow;
  SourceLocation from;
  SourceLocation to;
};

// An action whose door, lift, lane or zone is still a name.
struct EventEntry {
  TimedAction action;
  std::string name;
  std::string other;  // the other end of a lane, or the floor of a lift
  SourceLocation where;
  SourceLocation other_where;
};

struct SiteEntries {
  std::vector<ZoneEntry> zones;
  std::vector<FlowEntry> flows;
  std::vector<EventEntry> events;
};

// REQUIRES: the tree is valid by the schema.
Result<SiteEntries> ReadSiteEntries(const JsonTree& tree, const JsonNode& root);

// The world with these; its doors, lifts and lanes are complete. `path`: of the scenario.
Status AddSiteEntries(const SiteEntries& entries, const std::string& path, const AllowedPaths& allowed,
                      LoadedWorld& loaded);

}  // namespace troupe
