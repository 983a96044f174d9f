#include "fleet/vehicle_zones.h"

#include <algorithm>
#include <utility>

#include "fleet/order_check.h"
#include "fleet/vehicle_actions.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kMostZoneSets = 100;
constexpr std::size_t kMostZoneActions = 1000;  // if the factsheet says none
constexpr char kZoneSetTopic[] = "zoneSet";

bool IsOfZoneSet(const ReportedError& reported) {
  return reported.error.references && !reported.error.references->empty() &&
         reported.error.references->front() == Reference{"topic", kZoneSetTopic};
}

// Ends with the next set that is accepted.
void RefuseSet(VehicleMemory& memory, const ZoneSetReceived& received, const std::string& type,
               const std::string& description, ErrorLevel level = ErrorLevel::kWarning) {
  VehicleError error;
  error.type = type;
  error.level = level;
  error.description = description;
  error.references = {{{"zoneSetId", received.set.zone_set_id}}};
  ReportRefusal(memory, kZoneSetTopic, received.set.header, std::move(error), received.faults);
}

bool SaysTheSame(ZoneSet a, const ZoneSet& b) {
  a.header = b.header;
  return a == b;
}

std::vector<StoredZoneSet>::iterator FindSet(VehicleMemory& memory, const std::string& id) {
  return std::find_if(memory.zone_sets.begin(), memory.zone_sets.end(),
                      [&](const StoredZoneSet& stored) { return stored.set.zone_set_id == id; });
}

std::vector<AccessRequest>::iterator FindById(VehicleMemory& memory, const std::string& id) {
  return std::find_if(memory.requests.begin(), memory.requests.end(),
                      [&](const AccessRequest& each) { return each.request.id == id; });
}

bool IsEnabled(VehicleMemory& memory, const std::string& id) {
  const auto found = FindSet(memory, id);
  return found != memory.zone_sets.end() && found->status == StoredStatus::kEnabled;
}

// Of an enabled set; null: there is none.
const Zone* FindZone(VehicleMemory& memory, const std::string& zone_set_id, const std::string& zone_id) {
  if (!IsEnabled(memory, zone_set_id)) return nullptr;
  const std::vector<Zone>& zones = FindSet(memory, zone_set_id)->set.zones;
  const auto found = std::find_if(zones.begin(), zones.end(), [&](const Zone& zone) { return zone.id == zone_id; });
  return found != zones.end() ? &*found : nullptr;
}

std::vector<EnteredZone>::iterator FindInside(VehicleMemory& memory, const std::string& zone_set_id,
                                              const std::string& zone_id) {
  return std::find_if(memory.zones_inside.begin(), memory.zones_inside.end(), [&](const EnteredZone& each) {
    return each.zone_set_id == zone_set_id && each.zone_id == zone_id;
  });
}

void EndDuring(VehicleMemory& memory, const EnteredZone& zone) {
  for (TrackedAction& tracked : memory.zone_actions) {
    const bool is_during = std::find(zone.during.begin(), zone.during.end(), tracked.action.id) != zone.during.end();
    if (is_during) EndWithPlace(memory, tracked, "zone");
  }
}

// What belongs to sets that are enabled no more ends.
void LeaveOtherSets(VehicleMemory& memory) {
  std::erase_if(memory.requests,
                [&](const AccessRequest& each) { return !IsEnabled(memory, each.request.zone_set_id); });
  for (const EnteredZone& zone : memory.zones_inside) {
    if (!IsEnabled(memory, zone.zone_set_id)) EndDuring(memory, zone);
  }
  std::erase_if(memory.zones_inside, [&](const EnteredZone& zone) { return !IsEnabled(memory, zone.zone_set_id); });
}

bool IsIdOfAction(const VehicleMemory& memory, const std::string& id) {
  const auto is_it = [&](const TrackedAction& tracked) { return tracked.action.id == id; };
  for (const auto* const list : {&memory.actions, &memory.instant_actions, &memory.zone_actions}) {
    if (std::any_of(list->begin(), list->end(), is_it)) return true;
  }
  return false;
}

std::string NextActionId(VehicleMemory& memory) {
  std::string id;
  do {
    id = "zone-" + std::to_string(++memory.zone_actions_made);
  } while (IsIdOfAction(memory, id));
  return id;
}

// Their ids.
std::vector<std::string> TriggerZoneActions(VehicleMemory& memory, const Zone& zone,
                                            const std::optional<std::vector<ZoneAction>>& actions,
                                            const VehicleProfile& profile) {
  std::vector<std::string> ids;
  if (!actions) return ids;
  const std::uint32_t limit = profile.factsheet.limits.arrays.zone_action_states.value_or(0);
  for (const ZoneAction& each : *actions) {
    if (memory.zone_actions.size() >= (limit > 0 ? limit : kMostZoneActions)) {
      VehicleError error;
      error.type = "ZONE_ACTION_STATES_FULL";
      error.level = ErrorLevel::kUrgent;
      error.description = "no more actions of zones can be reported";
      error.references = {{{"zoneId", zone.id}}};
      ReportError(memory, {std::move(error), ErrorEnd::kInstantAction});
      break;
    }
    Action action;
    action.type = each.type;
    action.id = NextActionId(memory);
    action.descriptor = each.descriptor;
    action.blocking_type = each.blocking_type;
    action.parameters = each.parameters;
    action.retriable = each.retriable;
    ids.push_back(action.id);
    const std::string reason = WhyUnsupported(action, ActionScope::kZone, profile.factsheet);
    memory.zone_actions.push_back({std::move(action), ActionScope::kZone, 0, true, ActionStatus::kWaiting, {}});
    if (reason.empty()) {
      memory.queue.push_back(ids.back());
    } else {
      Refuse(memory, memory.zone_actions.back(), "INVALID_ZONE_ACTION", "zone " + zone.id + ": " + reason,
             ErrorEnd::kNewOrder);
    }
  }
  return ids;
}

}  // namespace

void StoreZoneSet(VehicleMemory& memory, const ZoneSetReceived& received) {
  if (!received.faults.empty()) {
    return RefuseSet(memory, received, "VALIDATION_FAILURE", "zone set rejected: wrong JSON or types");
  }
  const auto known = FindSet(memory, received.set.zone_set_id);
  if (known != memory.zone_sets.end()) {
    if (SaysTheSame(received.set, known->set)) return;  // a resend
    return RefuseSet(memory, received, "DUPLICATE_ZONE_SET", "another zone set has this id");
  }
  if (memory.zone_sets.size() >= kMostZoneSets) {
    return RefuseSet(memory, received, "INSUFFICIENT_MEMORY", "no more zone sets can be stored", ErrorLevel::kUrgent);
  }
  memory.zone_sets.push_back({received.set, StoredStatus::kDisabled});
  std::erase_if(memory.errors, IsOfZoneSet);
}

std::string EnableZoneSet(VehicleMemory& memory, const std::string& id) {
  const auto found = FindSet(memory, id);
  if (found == memory.zone_sets.end()) return "no such zone set";
  for (StoredZoneSet& other : memory.zone_sets) {
    if (other.set.map_id == found->set.map_id) other.status = StoredStatus::kDisabled;
  }
  found->status = StoredStatus::kEnabled;
  LeaveOtherSets(memory);
  return "";
}

std::string DeleteZoneSet(VehicleMemory& memory, const std::string& id) {
  const auto found = FindSet(memory, id);
  if (found == memory.zone_sets.end()) return "no such zone set";
  if (found->status == StoredStatus::kEnabled) return "the zone set is enabled";
  memory.zone_sets.erase(found);
  return "";
}

void TakeResponses(VehicleMemory& memory, const ResponsesReceived& received) {
  if (!received.faults.empty()) {
    VehicleError error;
    error.type = "VALIDATION_FAILURE";
    error.description = "responses rejected: wrong JSON or types";
    return ReportRefusal(memory, "responses", received.message.header, std::move(error), received.faults);
  }
  for (const RequestResponse& response : received.message.responses) {
    const auto found = FindById(memory, response.request_id);
    if (found == memory.requests.end()) continue;
    found->lease_expiry.reset();
    switch (response.grant_type) {
      case GrantType::kGranted:
        found->request.status = RequestStatus::kGranted;
        found->lease_expiry = response.lease_expiry;
        break;
      case GrantType::kQueued:
        found->request.status = RequestStatus::kQueued;
        break;
      case GrantType::kRevoked:
      case GrantType::kRejected:
        found->request.status = RequestStatus::kRevoked;
        break;
    }
  }
}

void WantAccess(VehicleMemory& memory, const AccessWanted& wanted) {
  const auto set = FindSet(memory, wanted.zone_set_id);
  if (set == memory.zone_sets.end() || set->status != StoredStatus::kEnabled || !IsAutomatic(memory)) return;
  if (FindRequest(memory, wanted.zone_set_id, wanted.zone_id) != nullptr) return;
  AccessRequest request;
  request.request.id = "access-" + std::to_string(++memory.requests_made);
  if (wanted.path) request.request.type = ZoneRequestType::kReplanning;
  request.request.trajectory = wanted.path;
  request.request.zone_id = wanted.zone_id;
  request.request.zone_set_id = wanted.zone_set_id;
  memory.requests.push_back(std::move(request));
}

void EndAccess(VehicleMemory& memory, const AccessEnded& ended) {
  std::erase_if(memory.requests, [&](const AccessRequest& each) { return each.request.id == ended.request_id; });
}

void EndLease(VehicleMemory& memory, const LeaseEnded& ended) {
  const auto found = FindById(memory, ended.request_id);
  if (found == memory.requests.end() || found->request.status != RequestStatus::kGranted) return;
  found->request.status = RequestStatus::kExpired;
  found->lease_expiry.reset();
}

void EnterZone(VehicleMemory& memory, const ZoneEntered& entered, const VehicleProfile& profile) {
  const Zone* const zone = FindZone(memory, entered.zone_set_id, entered.zone_id);
  if (zone == nullptr || FindInside(memory, entered.zone_set_id, entered.zone_id) != memory.zones_inside.end()) return;
  EnteredZone inside{entered.zone_set_id, entered.zone_id, {}};
  if (IsAutomatic(memory)) {
    TriggerZoneActions(memory, *zone, zone->entry_actions, profile);
    inside.during = TriggerZoneActions(memory, *zone, zone->during_actions, profile);
  }
  memory.zones_inside.push_back(std::move(inside));
}

void LeaveZone(VehicleMemory& memory, const ZoneLeft& left, const VehicleProfile& profile) {
  const auto inside = FindInside(memory, left.zone_set_id, left.zone_id);
  if (inside == memory.zones_inside.end()) return;
  EndDuring(memory, *inside);
  memory.zones_inside.erase(inside);
  const Zone* const zone = FindZone(memory, left.zone_set_id, left.zone_id);
  if (zone != nullptr && IsAutomatic(memory)) TriggerZoneActions(memory, *zone, zone->exit_actions, profile);
}

const AccessRequest* FindRequest(const VehicleMemory& memory, const std::string& zone_set_id,
                                 const std::string& zone_id) {
  const auto found = std::find_if(memory.requests.begin(), memory.requests.end(), [&](const AccessRequest& each) {
    return each.request.zone_set_id == zone_set_id && each.request.zone_id == zone_id;
  });
  return found != memory.requests.end() ? &*found : nullptr;
}

}  // namespace troupe::fleet
