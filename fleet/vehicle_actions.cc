#include "fleet/vehicle_actions.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "fleet/order_check.h"
#include "fleet/vehicle_zones.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kMostErrors = 8;             // of one type, of those that peers cause
constexpr std::size_t kMostInstantActions = 1000;  // if the factsheet says none

bool IsPosition(std::string_view type) {
  return type == "initPosition" || type == "initializePosition";
}

TrackedAction* FindAction(VehicleMemory& memory, std::string_view id) {
  for (std::vector<TrackedAction>* const list : {&memory.actions, &memory.instant_actions, &memory.zone_actions}) {
    const auto found =
        std::find_if(list->begin(), list->end(), [&](const TrackedAction& tracked) { return tracked.action.id == id; });
    if (found != list->end()) return &*found;
  }
  return nullptr;
}

// Pauses and cancels wait for the vehicle, not for other actions, and stop none.
bool IsAboutOrder(const TrackedAction& tracked) {
  return tracked.scope == ActionScope::kInstant &&
         (tracked.action.type == "startPause" || tracked.action.type == "cancelOrder");
}

// Calls visit for the actions that are started, but for pauses and cancels.
template <typename Memory, typename Visit>
void ForEachStarted(Memory& memory, const Visit& visit) {
  for (auto* const list : {&memory.actions, &memory.instant_actions, &memory.zone_actions}) {
    for (auto& tracked : *list) {
      if (IsStarted(tracked.status) && !IsAboutOrder(tracked)) visit(tracked);
    }
  }
}

// An error that stops the order.
bool IsHalted(const VehicleMemory& memory) {
  return std::any_of(memory.errors.begin(), memory.errors.end(), [](const ReportedError& reported) {
    return reported.error.level == ErrorLevel::kCritical || reported.error.level == ErrorLevel::kFatal;
  });
}

bool MayCancel(const TrackedAction& tracked, const VehicleProfile& profile) {
  if (tracked.action.type == "waitForTrigger" || tracked.status == ActionStatus::kRetriable) return true;
  const ActionSpecification* const known = profile.factsheet.FindAction(tracked.action.type);
  return known == nullptr || known->cancel_allowed;
}

bool MayPause(const TrackedAction& tracked, const VehicleProfile& profile) {
  const ActionSpecification* const known = profile.factsheet.FindAction(tracked.action.type);
  return known != nullptr && known->pause_allowed &&
         (tracked.status == ActionStatus::kInitializing || tracked.status == ActionStatus::kRunning);
}

void End(TrackedAction& tracked, ActionStatus status, std::string_view result = "") {
  tracked.status = status;
  if (!result.empty()) tracked.result = std::string(result);
}

// An error about one action.
void ReportActionError(VehicleMemory& memory, VehicleError error, const TrackedAction& tracked, ErrorEnd end) {
  std::vector<Reference> references = {{"actionId", tracked.action.id}, {"actionType", tracked.action.type}};
  if (tracked.scope == ActionScope::kInstant) {
    references.push_back({"topic", "instantActions"});
  } else if (tracked.scope == ActionScope::kZone) {
    references.push_back({"topic", "zoneSet"});
  } else {
    references.push_back({"orderId", memory.order_id});
    references.push_back({"orderUpdateId", std::to_string(memory.order_update_id)});
  }
  if (error.references) references.insert(references.end(), error.references->begin(), error.references->end());
  error.references = std::move(references);
  ReportError(memory, {std::move(error), end});
}

// Maps. The actions about them take no time but for downloads.

std::vector<MapState>::iterator FindMap(VehicleMemory& memory, const Action& action) {
  return std::find_if(memory.maps.begin(), memory.maps.end(), [&](const MapState& map) {
    return map.map_id == action.TextOf("mapId") && map.version == action.TextOf("mapVersion");
  });
}

void EnableMap(VehicleMemory& memory, TrackedAction& tracked) {
  const auto found = FindMap(memory, tracked.action);
  if (found == memory.maps.end()) return End(tracked, ActionStatus::kFailed, "no such map");
  for (MapState& map : memory.maps) {
    if (map.map_id == found->map_id) map.status = StoredStatus::kDisabled;
  }
  found->status = StoredStatus::kEnabled;
  End(tracked, ActionStatus::kFinished);
}

void DeleteMap(VehicleMemory& memory, TrackedAction& tracked) {
  const auto found = FindMap(memory, tracked.action);
  if (found == memory.maps.end()) return End(tracked, ActionStatus::kFailed, "no such map");
  if (found->status == StoredStatus::kEnabled) return End(tracked, ActionStatus::kFailed, "the map is enabled");
  memory.maps.erase(found);
  End(tracked, ActionStatus::kFinished);
}

// Starts an action of an order, or an instant action of those that a factsheet lists.
void Start(VehicleMemory& memory, TrackedAction& tracked) {
  const std::string& type = tracked.action.type;
  if (type == "clearInstantActions" && tracked.scope != ActionScope::kInstant) {
    std::erase_if(memory.instant_actions, [](const TrackedAction& other) { return IsFinal(other.status); });
    End(tracked, ActionStatus::kFinished);
  } else if (type == "clearZoneActions") {
    std::erase_if(memory.zone_actions, [](const TrackedAction& other) { return IsFinal(other.status); });
    End(tracked, ActionStatus::kFinished);
  } else if (type == "enableMap") {
    EnableMap(memory, tracked);
  } else if (type == "deleteMap") {
    DeleteMap(memory, tracked);
  } else if (type == "enableZoneSet" || type == "deleteZoneSet") {
    const std::string id = tracked.action.TextOf("zoneSetId");
    const std::string reason = type == "enableZoneSet" ? EnableZoneSet(memory, id) : DeleteZoneSet(memory, id);
    End(tracked, reason.empty() ? ActionStatus::kFinished : ActionStatus::kFailed, reason);
  } else if (type == "downloadMap" && FindMap(memory, tracked.action) != memory.maps.end()) {
    Refuse(memory, tracked, "DUPLICATE_MAP", "the map is here already");
  } else {
    tracked.status = type == "waitForTrigger" ? ActionStatus::kRunning : ActionStatus::kInitializing;
  }
}

// Starts queued actions in their sequence, as long as they need not wait for those that run or for the vehicle to stop.
// Whether one has started.
bool StartQueued(VehicleMemory& memory) {
  bool has_started = false;
  while (!memory.queue.empty() && IsAutomatic(memory) && !memory.is_paused && !memory.is_clearing &&
         !IsHalted(memory)) {
    bool is_any_started = false;
    bool is_one_alone = false;
    ForEachStarted(memory, [&](const TrackedAction& tracked) {
      is_any_started = true;
      is_one_alone = is_one_alone || RunsAlone(tracked.action.blocking_type);
    });
    const std::string id = memory.queue.front();
    TrackedAction* const next = FindAction(memory, id);
    const bool is_there = next != nullptr && next->status == ActionStatus::kWaiting;
    if (is_there && (is_one_alone || (is_any_started && RunsAlone(next->action.blocking_type)))) break;
    if (is_there && memory.is_driving && StopsDriving(next->action.blocking_type)) break;
    memory.queue.erase(memory.queue.begin());
    if (!is_there) continue;
    Start(memory, *next);
    has_started = true;
  }
  return has_started;
}

bool EndPauses(VehicleMemory& memory) {
  bool has_ended = false;
  for (TrackedAction& tracked : memory.instant_actions) {
    if (tracked.action.type != "startPause" || IsFinal(tracked.status)) continue;
    if (memory.is_paused && memory.is_driving) continue;
    End(tracked, memory.is_paused ? ActionStatus::kFinished : ActionStatus::kFailed);
    has_ended = true;
  }
  return has_ended;
}

bool EndClearing(VehicleMemory& memory, const VehicleProfile& profile) {
  if (!memory.is_clearing) return false;
  const bool are_final = std::all_of(memory.actions.begin(), memory.actions.end(),
                                     [](const TrackedAction& tracked) { return IsFinal(tracked.status); });
  // A person who takes the vehicle over moves it.
  const bool has_stopped =
      memory.wanted_mode || (!memory.is_driving && (profile.stops_between_nodes || !memory.is_on_edge));
  if (!are_final || !has_stopped) return false;
  memory.nodes.clear();
  memory.edges.clear();
  memory.is_on_edge = false;
  memory.is_clearing = false;
  memory.is_cancelled = true;
  for (TrackedAction& tracked : memory.instant_actions) {
    if (tracked.action.type == "cancelOrder" && !IsFinal(tracked.status)) End(tracked, ActionStatus::kFinished);
  }
  if (memory.wanted_mode) EnterMode(memory, *memory.wanted_mode, profile.version);
  return true;
}

bool EnterEdge(VehicleMemory& memory, const VehicleProfile& profile) {
  if (memory.is_on_edge || memory.edges.empty() || !MayDrive(memory, profile)) return false;
  memory.is_on_edge = true;
  memory.is_at_last_node = false;
  TriggerActions(memory, ActionScope::kEdge, memory.edges.front().sequence_id);
  return true;
}

// Instant actions that every vehicle executes here; the others are those of the factsheet.

void CancelOrder(VehicleMemory& memory, TrackedAction& tracked, const VehicleProfile& profile) {
  const std::string order_id = tracked.action.TextOf("orderId");
  const bool is_other = !order_id.empty() && order_id != memory.order_id;
  if (!IsBusy(memory) || is_other) {
    return Refuse(memory, tracked, IsBefore3(profile.version) ? "noOrderToCancel" : "NO_ORDER_TO_CANCEL",
                  is_other ? "another order is active" : "no order is active", ErrorEnd::kOrder);
  }
  tracked.status = ActionStatus::kRunning;
  if (!memory.is_clearing) BeginClearing(memory, profile);
}

void Trigger(VehicleMemory& memory, TrackedAction& tracked) {
  bool is_any = false;
  ForEachStarted(memory, [&](TrackedAction& waiting) {
    if (waiting.action.type != "waitForTrigger" || waiting.status != ActionStatus::kRunning) return;
    End(waiting, ActionStatus::kFinished);
    is_any = true;
  });
  End(tracked, is_any ? ActionStatus::kFinished : ActionStatus::kFailed, is_any ? "" : "no action waits for a trigger");
}

void Retry(VehicleMemory& memory, TrackedAction& tracked, bool is_skipped) {
  TrackedAction* const failed = FindAction(memory, tracked.action.TextOf("actionId"));
  if (failed == nullptr || failed->status != ActionStatus::kRetriable) {
    return End(tracked, ActionStatus::kFailed, "no such action can be tried again");
  }
  if (is_skipped) {
    End(*failed, ActionStatus::kFailed);
  } else {
    failed->status = ActionStatus::kRunning;
    std::erase_if(memory.errors, [&](const ReportedError& reported) {
      return reported.end == ErrorEnd::kNewOrder && reported.error.references &&
             std::find(reported.error.references->begin(), reported.error.references->end(),
                       Reference{"actionId", failed->action.id}) != reported.error.references->end();
    });
  }
  End(tracked, ActionStatus::kFinished);
}

// Whether the mode lets a fleet control order this.
bool IsInstantAllowed(const VehicleMemory& memory, std::string_view type) {
  if (type == "stateRequest" || type == "factsheetRequest") return true;
  if (memory.mode == OperatingMode::kIntervened && !memory.wanted_mode) return type == "cancelOrder";
  return IsAutomatic(memory);
}

void Execute(VehicleMemory& memory, TrackedAction& tracked, const VehicleProfile& profile, InstantOutcome& outcome) {
  const std::string type = tracked.action.type;
  const bool is_3 = !IsBefore3(profile.version);
  if (!IsInstantAllowed(memory, type)) {
    Refuse(memory, tracked, "INVALID_INSTANT_ACTION", "not in this operating mode");
  } else if (type == "startPause") {
    tracked.status = ActionStatus::kRunning;
    SetPaused(memory, true, profile);
  } else if (type == "stopPause") {
    SetPaused(memory, false, profile);
    End(tracked, ActionStatus::kFinished);
  } else if (type == "cancelOrder") {
    CancelOrder(memory, tracked, profile);
  } else if (type == "stateRequest") {
    outcome.must_send_state = true;
    End(tracked, ActionStatus::kFinished);
  } else if (type == "factsheetRequest") {
    outcome.must_send_factsheet = true;
    End(tracked, ActionStatus::kFinished);
  } else if (is_3 && type == "trigger") {
    Trigger(memory, tracked);
  } else if (is_3 && (type == "retry" || type == "skipRetry")) {
    Retry(memory, tracked, type == "skipRetry");
  } else if (const std::string reason = WhyUnsupported(tracked.action, ActionScope::kInstant, profile.factsheet);
             !reason.empty()) {
    Refuse(memory, tracked, "INVALID_INSTANT_ACTION", reason);
  } else {
    Start(memory, tracked);
  }
}

// An error about the message as a whole.
void RefuseMessage(VehicleMemory& memory, const InstantActionsReceived& received, std::string_view type,
                   const std::string& description, ErrorLevel level, const std::vector<MessageFault>& faults) {
  VehicleError error;
  error.type = type;
  error.level = level;
  error.description = description;
  ReportRefusal(memory, "instantActions", received.message.header, std::move(error), faults);
}

}  // namespace

bool IsAutomatic(const VehicleMemory& memory) {
  return !memory.wanted_mode &&
         (memory.mode == OperatingMode::kAutomatic || memory.mode == OperatingMode::kSemiautomatic);
}

void ReportRefusal(VehicleMemory& memory, const std::string& topic, const Header& header, VehicleError error,
                   const std::vector<MessageFault>& faults) {
  std::vector<Reference> references = {{"topic", topic}, {"headerId", std::to_string(header.header_id)}};
  if (error.references) references.insert(references.end(), error.references->begin(), error.references->end());
  for (const MessageFault& fault : faults) references.push_back({"field", fault.ToString()});
  error.references = std::move(references);
  ReportError(memory, {std::move(error), ErrorEnd::kInstantAction});
}

void ReportError(VehicleMemory& memory, ReportedError reported) {
  std::erase_if(memory.errors, [&](const ReportedError& other) {
    return other.end == reported.end && other.error.type == reported.error.type &&
           other.error.references == reported.error.references;
  });
  // A peer that sends wrong messages on and on must not fill the state.
  const auto is_alike = [&](const ReportedError& other) {
    return other.end == reported.end && other.error.type == reported.error.type;
  };
  if (reported.end != ErrorEnd::kCause &&
      static_cast<std::size_t>(std::count_if(memory.errors.begin(), memory.errors.end(), is_alike)) >= kMostErrors) {
    memory.errors.erase(std::find_if(memory.errors.begin(), memory.errors.end(), is_alike));
  }
  memory.errors.push_back(std::move(reported));
}

void Refuse(VehicleMemory& memory, TrackedAction& tracked, std::string_view type, const std::string& reason,
            ErrorEnd end) {
  End(tracked, ActionStatus::kFailed, reason);
  VehicleError error;
  error.type = type;
  error.description = reason;
  ReportActionError(memory, std::move(error), tracked, end);
}

void EndWithPlace(VehicleMemory& memory, TrackedAction& tracked, std::string_view place) {
  if (IsFinal(tracked.status)) return;
  if (IsStarted(tracked.status)) return End(tracked, ActionStatus::kFinished);
  End(tracked, ActionStatus::kFailed, "the " + std::string(place) + " was left before the action could begin");
  std::erase(memory.queue, tracked.action.id);
}

void DropOrderFromQueue(VehicleMemory& memory) {
  std::erase_if(memory.queue, [&](const std::string& id) {
    return std::none_of(memory.zone_actions.begin(), memory.zone_actions.end(),
                        [&](const TrackedAction& tracked) { return tracked.action.id == id; });
  });
}

void TriggerActions(VehicleMemory& memory, ActionScope scope, std::uint32_t sequence_id) {
  for (const TrackedAction& tracked : memory.actions) {
    if (tracked.scope == scope && tracked.sequence_id == sequence_id && tracked.status == ActionStatus::kWaiting) {
      memory.queue.push_back(tracked.action.id);
    }
  }
}

void LeaveEdge(VehicleMemory& memory, std::uint32_t sequence_id) {
  for (TrackedAction& tracked : memory.actions) {
    const bool is_of_edge = tracked.scope == ActionScope::kEdge && tracked.sequence_id == sequence_id;
    if (is_of_edge) EndWithPlace(memory, tracked, "edge");
  }
}

void BeginClearing(VehicleMemory& memory, const VehicleProfile& profile) {
  memory.is_clearing = true;
  DropOrderFromQueue(memory);
  for (TrackedAction& tracked : memory.actions) {
    if (IsFinal(tracked.status)) continue;
    if (tracked.status == ActionStatus::kWaiting || MayCancel(tracked, profile)) {
      End(tracked, ActionStatus::kFailed, "the order was cancelled");
    }
  }
  if (profile.stops_between_nodes || memory.wanted_mode) return;
  // It goes on to the next node.
  const std::size_t kept = memory.is_on_edge ? 1 : 0;
  memory.nodes.resize(std::min(memory.nodes.size(), kept));
  memory.edges.resize(std::min(memory.edges.size(), kept));
}

void EnterMode(VehicleMemory& memory, OperatingMode mode, Version version) {
  memory.wanted_mode.reset();
  memory.mode = mode;
  if (mode != OperatingMode::kAutomatic && mode != OperatingMode::kSemiautomatic) memory.requests.clear();
  if (mode == OperatingMode::kAutomatic || mode == OperatingMode::kSemiautomatic ||
      mode == OperatingMode::kIntervened) {
    return;
  }
  for (TrackedAction& tracked : memory.zone_actions) {
    if (IsFinal(tracked.status)) continue;
    End(tracked, ActionStatus::kFailed, "the vehicle was taken over");
    std::erase(memory.queue, tracked.action.id);
  }
  memory.is_at_last_node = false;  // a person may move it
  if (!IsBefore3(version) && mode != OperatingMode::kManual) {
    memory.last_node_id.clear();
    memory.last_node_sequence_id = 0;
  }
}

void SetPaused(VehicleMemory& memory, bool is_paused, const VehicleProfile& profile) {
  if (memory.is_paused == is_paused) return;
  memory.is_paused = is_paused;
  ForEachStarted(memory, [&](TrackedAction& tracked) {
    if (is_paused && MayPause(tracked, profile)) {
      tracked.status = ActionStatus::kPaused;
    } else if (!is_paused && tracked.status == ActionStatus::kPaused) {
      tracked.status = ActionStatus::kRunning;
    }
  });
}

InstantOutcome ApplyInstantActions(VehicleMemory& memory, const InstantActionsReceived& received,
                                   const VehicleProfile& profile) {
  InstantOutcome outcome;
  std::vector<MessageFault> faults = received.faults;
  if (faults.empty()) faults = CheckInstantActions(received.message);
  if (!faults.empty()) {
    RefuseMessage(memory, received, "INVALID_INSTANT_ACTION", "instant actions rejected: wrong JSON or types",
                  ErrorLevel::kWarning, faults);
    return outcome;
  }
  std::vector<ReportedError> earlier;  // that end with an action that is accepted
  std::copy_if(memory.errors.begin(), memory.errors.end(), std::back_inserter(earlier),
               [](const ReportedError& reported) { return reported.end == ErrorEnd::kInstantAction; });
  bool is_one_accepted = false;
  const ArrayLimits& limits = profile.factsheet.limits.arrays;
  const std::uint32_t limit =
      (IsBefore3(profile.version) ? limits.action_states : limits.instant_action_states).value_or(0);
  for (const Action& action : received.message.actions) {
    const auto is_known = [&](const TrackedAction& tracked) { return tracked.action.id == action.id; };
    if (std::any_of(memory.instant_actions.begin(), memory.instant_actions.end(), is_known)) continue;
    // Before 3.0 one list has the actions of both.
    if (IsBefore3(profile.version) && std::any_of(memory.actions.begin(), memory.actions.end(), is_known)) continue;
    const bool clears = !IsBefore3(profile.version) && action.type == "clearInstantActions" && IsAutomatic(memory);
    if (clears) std::erase_if(memory.instant_actions, [](const TrackedAction& other) { return IsFinal(other.status); });
    if (memory.instant_actions.size() >= (limit > 0 ? limit : kMostInstantActions)) {
      RefuseMessage(memory, received, "INSTANT_ACTION_STATES_FULL", "no more instant actions can be reported",
                    ErrorLevel::kUrgent, {});
      break;
    }
    memory.instant_actions.push_back({action, ActionScope::kInstant, 0, true, ActionStatus::kWaiting, {}});
    TrackedAction& tracked = memory.instant_actions.back();
    if (clears) {
      End(tracked, ActionStatus::kFinished);
    } else {
      Execute(memory, tracked, profile, outcome);
    }
    is_one_accepted = is_one_accepted || tracked.status != ActionStatus::kFailed;
  }
  if (is_one_accepted) {
    std::erase_if(memory.errors, [&](const ReportedError& reported) {
      return std::find(earlier.begin(), earlier.end(), reported) != earlier.end();
    });
  }
  return outcome;
}

void ApplyProgress(VehicleMemory& memory, const ActionProgress& progress, const VehicleProfile& profile) {
  TrackedAction* const tracked = FindAction(memory, progress.action_id);
  if (tracked == nullptr || !IsStarted(tracked->status) || IsAboutOrder(*tracked)) return;
  if (progress.status == ActionStatus::kWaiting || progress.status == ActionStatus::kRetriable) return;
  if (progress.status == ActionStatus::kInitializing && tracked->status != ActionStatus::kInitializing) return;
  tracked->status = progress.status;
  if (progress.result) tracked->result = progress.result;
  if (progress.status == ActionStatus::kFailed) {
    const bool is_retriable = !IsBefore3(profile.version) && tracked->action.retriable.value_or(false) &&
                              tracked->scope != ActionScope::kInstant && !memory.is_clearing;
    if (is_retriable) tracked->status = ActionStatus::kRetriable;
    if (progress.error) ReportActionError(memory, *progress.error, *tracked, ErrorEnd::kNewOrder);
  } else if (progress.status == ActionStatus::kFinished) {
    const Action& action = tracked->action;
    if (IsPosition(action.type) && !IsBusy(memory) && !action.TextOf("lastNodeId").empty()) {
      memory.last_node_id = action.TextOf("lastNodeId");
      memory.last_node_sequence_id = 0;
      memory.is_at_last_node = true;
    } else if (action.type == "downloadMap" && FindMap(memory, action) == memory.maps.end()) {
      memory.maps.push_back({action.TextOf("mapId"), action.TextOf("mapVersion"), {}, StoredStatus::kDisabled});
    }
  }
}

bool MayDrive(const VehicleMemory& memory, const VehicleProfile& profile) {
  if (memory.nodes.empty() || !memory.nodes.front().released) return false;
  if (!IsAutomatic(memory) || memory.is_paused || IsHalted(memory)) return false;
  if (memory.is_clearing && (profile.stops_between_nodes || !memory.is_on_edge)) return false;
  bool stops = false;
  ForEachStarted(memory,
                 [&](const TrackedAction& tracked) { stops = stops || StopsDriving(tracked.action.blocking_type); });
  if (memory.queue.empty()) return !stops;
  const std::set<std::string_view> queued(memory.queue.begin(), memory.queue.end());
  for (const auto* const list : {&memory.actions, &memory.zone_actions}) {
    for (const TrackedAction& tracked : *list) {
      stops = stops || (StopsDriving(tracked.action.blocking_type) && queued.contains(tracked.action.id));
    }
  }
  return !stops;
}

void Settle(VehicleMemory& memory, const VehicleProfile& profile) {
  bool has_changed = true;
  while (has_changed) {
    has_changed = EndPauses(memory);
    has_changed = EndClearing(memory, profile) || has_changed;
    has_changed = StartQueued(memory) || has_changed;
    has_changed = EnterEdge(memory, profile) || has_changed;
  }
}

}  // namespace troupe::fleet
