#include "fleet/vehicle_zones.h"

#include <algorithm>
#include <utility>

#include "fleet/vehicle_actions.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kMostZoneSets = 100;
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

void DropRequestsOfOtherSets(VehicleMemory& memory) {
  std::erase_if(memory.requests, [&](const AccessRequest& each) {
    const auto found = FindSet(memory, each.request.zone_set_id);
    return found == memory.zone_sets.end() || found->status != StoredStatus::kEnabled;
  });
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
  DropRequestsOfOtherSets(memory);
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
  if (set == memory.zone_sets.end() || set->status != StoredStatus::kEnabled) return;
  if (FindRequest(memory, wanted.zone_set_id, wanted.zone_id) != nullptr) return;
  AccessRequest request;
  request.request.id = "access-" + std::to_string(++memory.requests_made);
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

const AccessRequest* FindRequest(const VehicleMemory& memory, const std::string& zone_set_id,
                                 const std::string& zone_id) {
  const auto found = std::find_if(memory.requests.begin(), memory.requests.end(), [&](const AccessRequest& each) {
    return each.request.zone_set_id == zone_set_id && each.request.zone_id == zone_id;
  });
  return found != memory.requests.end() ? &*found : nullptr;
}

}  // namespace troupe::fleet
