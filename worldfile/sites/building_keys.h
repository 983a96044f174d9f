// The parameters of a vertex in a building file, by their keys.
//
// One table for the reader and the writer, so that neither can forget a key of the other.
#pragma once

#include <string>
#include <utility>

#include "worldfile/sites/site.h"

namespace troupe {

inline constexpr std::pair<const char*, bool SiteVertex::*> kVertexFlags[] = {
    {"is_charger", &SiteVertex::is_charger},
    {"is_parking_spot", &SiteVertex::is_parking_spot},
    {"is_holding_point", &SiteVertex::is_holding_point},
    {"is_cleaning_zone", &SiteVertex::is_cleaning_zone},
    {"is_passthrough_point", &SiteVertex::is_passthrough_point},
};
inline constexpr std::pair<const char*, std::string SiteVertex::*> kVertexTexts[] = {
    {"dock_name", &SiteVertex::dock},
    {"lift_cabin", &SiteVertex::lift_cabin},
    {"pickup_dispenser", &SiteVertex::pickup_dispenser},
    {"dropoff_ingestor", &SiteVertex::dropoff_ingestor},
    {"mutex", &SiteVertex::mutex},
    {"human_goal_set_name", &SiteVertex::human_goal_set},
    {"spawn_robot_type", &SiteVertex::robot_type},
    {"spawn_robot_name", &SiteVertex::robot_name},
};

// The models of Open-RMF's demo sites that are workcells.
inline constexpr const char* kDispenserModel = "TeleportDispenser";
inline constexpr const char* kIngestorModel = "TeleportIngestor";

}  // namespace troupe
