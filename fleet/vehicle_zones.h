// The zones of a vehicle of VDA 5050 3.0: the sets that it has, its requests to enter zones, and the actions of ACTION
// zones. The parts of Apply (vehicle.h) that concern them. Where the vehicle is, and which zones it meets, is the
// controller's to say.
//
// Where the standard leaves a choice: a request that is rejected becomes REVOKED in the state, which has no other word
// for it; a response to an unknown request has no effect; requests of a set that is enabled no more end, and so do the
// `duringActions` of its zones, whose `exitActions` are not triggered then. A zone that is entered or left while a
// person has the vehicle triggers nothing. Actions of zones have the ids zone-1, zone-2, ...
#pragma once

#include <string>

#include "fleet/vehicle.h"

namespace troupe::fleet {

// A new set is DISABLED. A known one is ignored, or, with another content, an error.
void StoreZoneSet(VehicleMemory& memory, const ZoneSetReceived& received);
void TakeResponses(VehicleMemory& memory, const ResponsesReceived& received);
void WantAccess(VehicleMemory& memory, const AccessWanted& wanted);
void EndAccess(VehicleMemory& memory, const AccessEnded& ended);
void EndLease(VehicleMemory& memory, const LeaseEnded& ended);
// The actions of an ACTION zone are triggered: on entry `entryActions` and `duringActions`, of which the latter end
// when it is left, and then `exitActions`.
void EnterZone(VehicleMemory& memory, const ZoneEntered& entered, const VehicleProfile& profile);
void LeaveZone(VehicleMemory& memory, const ZoneLeft& left, const VehicleProfile& profile);

// The instant actions about sets; the reason why it failed, or empty.
std::string EnableZoneSet(VehicleMemory& memory, const std::string& id);
std::string DeleteZoneSet(VehicleMemory& memory, const std::string& id);

// The request to enter that zone; null: there is none.
const AccessRequest* FindRequest(const VehicleMemory& memory, const std::string& zone_set_id,
                                 const std::string& zone_id);

}  // namespace troupe::fleet
