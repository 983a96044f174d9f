// A vehicle of VDA 5050 for tests: its factsheet, and orders between the places of a small plant.
#pragma once

#include <string>
#include <vector>

#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/vehicle.h"

namespace troupe::fleet {

inline ActionSpecification SampleAction(const std::string& type, std::vector<ActionScope> scopes, bool may_pause,
                                        bool may_cancel) {
  ActionSpecification action;
  action.type = type;
  action.scopes = std::move(scopes);
  action.pause_allowed = may_pause;
  action.cancel_allowed = may_cancel;
  return action;
}

inline Header SampleHeader(Version version, std::uint32_t id = 1, std::int64_t milliseconds = 1'000) {
  return {id, FormatTimestamp(milliseconds, version), VersionText(version), "Troupe", "anna"};
}

// pick, drop and blink are actions of orders; blink may neither be paused nor cancelled.
inline Factsheet SampleFactsheet(Version version) {
  using enum ActionScope;
  Factsheet sheet;
  sheet.header = SampleHeader(version);
  sheet.type.series_name = "Sample";
  sheet.type.kinematics = IsBefore3(version) ? "DIFF" : "DIFFERENTIAL";
  sheet.type.robot_class = "CARRIER";
  sheet.type.localization_types = {"NATURAL"};
  sheet.type.navigation_types = {IsBefore3(version) ? "AUTONOMOUS" : "FREELY_NAVIGATING"};
  sheet.physical.maximum_speed = 1.0;
  sheet.physical.maximum_height = 1.0;
  sheet.physical.width = 0.5;
  sheet.physical.length = 0.8;
  sheet.features.optional_parameters = {{"order.edges.maxSpeed", Support::kSupported, {}},
                                        {"order.edges.trajectory", Support::kSupported, {}}};
  ActionSpecification map = SampleAction("enableMap", {kInstant, kNode}, false, false);
  map.parameters = {{{"mapId", "STRING", {}, {}}, {"mapVersion", "STRING", {}, {}}}};
  ActionSpecification deletion = map;
  deletion.type = "deleteMap";
  deletion.scopes = {kInstant};
  ActionSpecification download = deletion;
  download.type = "downloadMap";
  sheet.features.actions = {SampleAction("pick", {kNode, kEdge}, true, true),
                            SampleAction("drop", {kNode, kEdge}, true, true),
                            SampleAction("blink", {kNode, kEdge}, false, false),
                            SampleAction("waitForTrigger", {kNode}, false, true),
                            SampleAction("startCharging", {kInstant, kNode}, false, true),
                            SampleAction("initPosition", {kInstant, kNode}, false, true),
                            SampleAction("logReport", {kInstant}, false, true),
                            map,
                            deletion,
                            download};
  if (!IsBefore3(version)) {
    sheet.features.actions.push_back(SampleAction("clearInstantActions", {kInstant, kNode}, false, false));
  }
  return sheet;
}

inline VehicleProfile SampleProfile(Version version) {
  VehicleProfile profile;
  profile.version = version;
  profile.factsheet = SampleFactsheet(version);
  return profile;
}

// The places A, B, C, ... are 4 m apart on a line.
inline Node SampleNode(char place, std::uint32_t sequence_id, bool is_released = true,
                       std::vector<Action> actions = {}) {
  Node node;
  node.id = std::string(1, place);
  node.sequence_id = sequence_id;
  node.released = is_released;
  node.position.emplace();
  node.position->x = 4.0 * (place - 'A');
  node.position->map_id = "L1";
  node.actions = std::move(actions);
  return node;
}

inline Action SampleActionOf(const std::string& type, const std::string& id,
                             BlockingType blocking = BlockingType::kHard) {
  Action action;
  action.type = type;
  action.id = id;
  action.blocking_type = blocking;
  return action;
}

// An order along places, of which the first `released` are the base.
inline Order SampleOrder(Version version, const std::string& id, std::uint32_t update_id, const std::string& places,
                         std::size_t released, std::uint32_t first_sequence_id = 0) {
  Order order;
  order.header = SampleHeader(version);
  order.order_id = id;
  order.order_update_id = update_id;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto sequence_id = first_sequence_id + static_cast<std::uint32_t>(2 * i);
    order.nodes.push_back(SampleNode(places[i], sequence_id, i < released));
    if (i == 0) continue;
    Edge edge;
    edge.id = places.substr(i - 1, 2);
    edge.sequence_id = sequence_id - 1;
    edge.released = i < released;
    if (IsBefore3(version)) {
      edge.start_node_id = std::string(1, places[i - 1]);
      edge.end_node_id = std::string(1, places[i]);
    }
    order.edges.push_back(edge);
  }
  return order;
}

inline VehicleReadings SampleReadings(double x = 0.0) {
  VehicleReadings readings;
  readings.position.emplace();
  readings.position->x = x;
  readings.position->map_id = "L1";
  readings.position->localized = true;
  readings.power_supply.state_of_charge = 80.0;
  return readings;
}

}  // namespace troupe::fleet
