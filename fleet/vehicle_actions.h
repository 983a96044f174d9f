// The life of a vehicle's actions: triggered, queued, started, paused, ended; instant actions; pause, cancel and modes.
// The parts of Apply (vehicle.h) that concern them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "fleet/vehicle.h"

namespace troupe::fleet {

// Adds an error, in place of an equal one of its type and references.
void ReportError(VehicleMemory& memory, ReportedError reported);

// The error about a message as a whole, which is refused. Its references name the topic and the header before those of
// `error`, and the places of the faults behind them. It ends with the next instant action that is accepted.
void ReportRefusal(VehicleMemory& memory, const std::string& topic, const Header& header, VehicleError error,
                   const std::vector<MessageFault>& faults);

// The fleet control is in control: a mode that executes orders.
bool IsAutomatic(const VehicleMemory& memory);

// The action has failed for this reason, which becomes an error of that type.
void Refuse(VehicleMemory& memory, TrackedAction& tracked, std::string_view type, const std::string& reason,
            ErrorEnd end = ErrorEnd::kInstantAction);
// The edge or zone (`place`) of an action is left: a started one is finished, a waiting one has failed.
void EndWithPlace(VehicleMemory& memory, TrackedAction& tracked, std::string_view place);
// The queue keeps the actions of zones only.
void DropOrderFromQueue(VehicleMemory& memory);

// The waiting actions of a node or an edge wait for their turn from now on.
void TriggerActions(VehicleMemory& memory, ActionScope scope, std::uint32_t sequence_id);
// The actions of an edge end.
void LeaveEdge(VehicleMemory& memory, std::uint32_t sequence_id);

// The order will be cleared: waiting actions fail, started ones that may be cancelled, too.
void BeginClearing(VehicleMemory& memory, const VehicleProfile& profile);
void EnterMode(VehicleMemory& memory, OperatingMode mode, Version version);
void SetPaused(VehicleMemory& memory, bool is_paused, const VehicleProfile& profile);

struct InstantOutcome {
  bool must_send_state = false;
  bool must_send_factsheet = false;
};
InstantOutcome ApplyInstantActions(VehicleMemory& memory, const InstantActionsReceived& received,
                                   const VehicleProfile& profile);
void ApplyProgress(VehicleMemory& memory, const ActionProgress& progress, const VehicleProfile& profile);

// All that follows without a further input: the end of a pause, a cancel or a change of the mode, the start of queued
// actions, the entry of the next edge.
void Settle(VehicleMemory& memory, const VehicleProfile& profile);

}  // namespace troupe::fleet
