#include "fleet/vehicle.h"

#include <algorithm>
#include <set>

#include "fleet/order_check.h"
#include "fleet/vehicle_actions.h"
#include "fleet/vehicle_zones.h"
#include "troupe/deterministic_math.h"

namespace troupe::fleet {
namespace {

constexpr std::size_t kMostActions = 10'000;  // if the factsheet says none
constexpr std::size_t kMostNodes = 100'000;

bool IsModeForOrders(const VehicleMemory& memory) {
  if (memory.wanted_mode) return false;
  return memory.mode == OperatingMode::kAutomatic || memory.mode == OperatingMode::kSemiautomatic ||
         memory.mode == OperatingMode::kIntervened;
}

// The modes that clear the order.
bool ClearsOrder(OperatingMode mode) {
  return mode != OperatingMode::kAutomatic && mode != OperatingMode::kSemiautomatic &&
         mode != OperatingMode::kIntervened;
}

// The end of the base: its last node, or the last node that was traversed.
std::pair<std::string, std::uint32_t> BaseEnd(const VehicleMemory& memory) {
  const auto last =
      std::find_if(memory.nodes.rbegin(), memory.nodes.rend(), [](const Node& node) { return node.released; });
  if (last != memory.nodes.rend()) return {last->id, last->sequence_id};
  return {memory.last_node_id, memory.last_node_sequence_id};
}

// Within a deviation around a node, an ellipse whose axes are turned by theta.
bool IsWithin(const RobotPosition& position, const NodePosition& node, double tolerance) {
  if (!node.map_id.empty() && !position.map_id.empty() && node.map_id != position.map_id) return false;
  const double dx = position.x - node.x;
  const double dy = position.y - node.y;
  const AllowedDeviation deviation = node.allowed_deviation_xy.value_or(AllowedDeviation());
  if (dx * dx + dy * dy <= tolerance * tolerance) return true;
  // A rotation is left out for circles, so that they need no trigonometry.
  if (deviation.a == deviation.b) return dx * dx + dy * dy <= deviation.a * deviation.a;
  if (!(deviation.a > 0.0 && deviation.b > 0.0)) return false;
  const SinCosResult turn = SinCos(deviation.theta);
  const double along = (turn.cos * dx + turn.sin * dy) / deviation.a;
  const double across = (turn.cos * dy - turn.sin * dx) / deviation.b;
  return along * along + across * across <= 1.0;
}

bool IsNear(const VehicleMemory& memory, const Node& node, const VehicleProfile& profile,
            const VehicleReadings& readings) {
  if (memory.is_at_last_node && node.id == memory.last_node_id) return true;
  if (!node.position || !readings.position || !readings.position->localized) return false;
  return IsWithin(*readings.position, *node.position, profile.node_tolerance);
}

bool KnowsMaps(const VehicleMemory& memory, const Order& order) {
  if (memory.maps.empty()) return true;  // it has no list of its maps
  return std::all_of(order.nodes.begin(), order.nodes.end(), [&](const Node& node) {
    return !node.position || node.position->map_id.empty() ||
           std::any_of(memory.maps.begin(), memory.maps.end(),
                       [&](const MapState& map) { return map.map_id == node.position->map_id; });
  });
}

// Calls visit(actions, scope, sequence id, released) for the nodes and edges of an order in their sequence; those of
// the first node only if it is new.
template <typename Visit>
void ForEachActionList(const Order& order, bool has_first, const Visit& visit) {
  for (std::size_t i = 0; i < order.nodes.size(); ++i) {
    const Node& node = order.nodes[i];
    if (i > 0) {
      const Edge& edge = order.edges[i - 1];
      visit(edge.actions, ActionScope::kEdge, edge.sequence_id, edge.released);
    }
    if (i > 0 || has_first) visit(node.actions, ActionScope::kNode, node.sequence_id, node.released);
  }
}

bool ReusesActionId(const VehicleMemory& memory, const Order& order, bool is_update, Version version) {
  std::set<std::string_view> ids;
  if (is_update) {
    for (const TrackedAction& tracked : memory.actions) {
      if (tracked.is_released || IsFinal(tracked.status)) ids.insert(tracked.action.id);
    }
  }
  for (const TrackedAction& tracked : memory.instant_actions) {
    if (IsBefore3(version) && (is_update || !IsFinal(tracked.status))) ids.insert(tracked.action.id);
  }
  for (const TrackedAction& tracked : memory.zone_actions) ids.insert(tracked.action.id);
  bool reuses = false;
  ForEachActionList(order, !is_update, [&](const std::vector<Action>& actions, ActionScope, std::uint32_t, bool) {
    for (const Action& action : actions) reuses = reuses || ids.contains(action.id);
  });
  return reuses;
}

std::size_t CountActions(const Order& order) {
  std::size_t count = 0;
  ForEachActionList(order, true, [&](const std::vector<Action>& actions, ActionScope, std::uint32_t, bool) {
    count += actions.size();
  });
  return count;
}

bool FitsMemory(const VehicleMemory& memory, const Order& order, bool is_update, const VehicleProfile& profile) {
  const std::uint32_t limit = profile.factsheet.limits.arrays.action_states.value_or(0);
  const std::size_t most = limit > 0 ? limit : kMostActions;
  if (order.nodes.size() + (is_update ? memory.nodes.size() : 0) > kMostNodes) return false;
  return CountActions(order) + (is_update ? memory.actions.size() : 0) <= most;
}

// The references of a rejection: the order, and its faulty part.
std::vector<Reference> RejectionReferences(const OrderReceived& received, const OrderRow& row,
                                           const VehicleProfile& profile) {
  std::vector<Reference> references = {{"topic", "order"},
                                       {"headerId", std::to_string(received.order.header.header_id)},
                                       {"orderId", received.order.order_id},
                                       {"orderUpdateId", std::to_string(received.order.order_update_id)}};
  const auto append = [&](const std::vector<Reference>& more) {
    references.insert(references.end(), more.begin(),
                      more.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(more.size(), 16)));
  };
  if (row.name == "invalid") {
    std::vector<MessageFault> faults = received.faults;
    if (faults.empty()) faults = CheckOrder(received.order, profile.version);
    for (const MessageFault& fault : faults) references.push_back({"field", fault.ToString()});
  } else if (row.name == "too_long" || row.name == "unsupported_parameter" || row.name == "unsupported_action") {
    const SupportFaults faults = CheckSupport(received.order, profile.factsheet);
    append(row.name == "too_long"                ? faults.lengths
           : row.name == "unsupported_parameter" ? faults.parameters
                                                 : faults.actions);
  } else if (row.name == "start_too_far" || row.name.starts_with("update_breaks")) {
    references.push_back({"nodeId", received.order.nodes.front().id});
    references.push_back({"sequenceId", std::to_string(received.order.nodes.front().sequence_id)});
  }
  return references;
}

void Reject(VehicleMemory& memory, const OrderReceived& received, const OrderRow& row, const VehicleProfile& profile) {
  VehicleError error;
  error.type = row.ErrorOf(profile.version);
  error.level = row.LevelOf(profile.version);
  error.description = "order rejected: " + std::string(row.condition);
  error.references = RejectionReferences(received, row, profile);
  ReportError(memory, {std::move(error), ErrorEnd::kOrder});
}

void EndErrors(VehicleMemory& memory, bool is_new_order) {
  std::erase_if(memory.errors, [&](const ReportedError& reported) {
    return reported.end == ErrorEnd::kOrder || (is_new_order && reported.end == ErrorEnd::kNewOrder);
  });
}

void TrackActions(VehicleMemory& memory, const Order& order, bool has_first) {
  ForEachActionList(
      order, has_first,
      [&](const std::vector<Action>& actions, ActionScope scope, std::uint32_t sequence_id, bool released) {
        for (const Action& action : actions) {
          memory.actions.push_back({action, scope, sequence_id, released, ActionStatus::kWaiting, {}});
        }
      });
}

// The first of `nodes` is traversed: the edge before it is left, and its actions are triggered.
void Traverse(VehicleMemory& memory) {
  const Node node = std::move(memory.nodes.front());
  memory.nodes.erase(memory.nodes.begin());
  if (!memory.edges.empty() && memory.edges.front().sequence_id < node.sequence_id) {
    LeaveEdge(memory, memory.edges.front().sequence_id);
    memory.edges.erase(memory.edges.begin());
  }
  memory.is_on_edge = false;
  memory.is_at_last_node = true;
  memory.last_node_id = node.id;
  memory.last_node_sequence_id = node.sequence_id;
  TriggerActions(memory, ActionScope::kNode, node.sequence_id);
}

void AcceptNew(VehicleMemory& memory, const Order& order, Version version) {
  EndErrors(memory, true);
  DropOrderFromQueue(memory);
  memory.actions.clear();
  if (IsBefore3(version)) {
    std::erase_if(memory.instant_actions, [](const TrackedAction& tracked) { return IsFinal(tracked.status); });
  }
  memory.is_cancelled = false;
  memory.order_id = order.order_id;
  memory.nodes = order.nodes;
  memory.edges = order.edges;
  memory.is_on_edge = false;
  TrackActions(memory, order, true);
  Traverse(memory);
}

void AcceptUpdate(VehicleMemory& memory, const Order& order) {
  EndErrors(memory, false);
  memory.is_cancelled = false;
  std::erase_if(memory.nodes, [](const Node& node) { return !node.released; });
  std::erase_if(memory.edges, [](const Edge& edge) { return !edge.released; });
  // Those of a horizon that was cancelled stay: they have failed.
  std::erase_if(memory.actions, [](const TrackedAction& tracked) {
    return !tracked.is_released && tracked.status == ActionStatus::kWaiting;
  });
  memory.nodes.insert(memory.nodes.end(), order.nodes.begin() + 1, order.nodes.end());
  memory.edges.insert(memory.edges.end(), order.edges.begin(), order.edges.end());
  TrackActions(memory, order, false);
}

struct Applier {
  VehicleMemory& memory;
  const VehicleProfile& profile;
  const VehicleReadings& readings;
  VehicleOutcome outcome;

  void operator()(const OrderReceived& received) {
    const OrderRow& row = RowFor(FactsOf(memory, received, profile, readings));
    outcome.row = &row;
    if (row.verdict == OrderVerdict::kReject) Reject(memory, received, row, profile);
    if (!IsAccepted(row.verdict)) return;
    if (row.verdict == OrderVerdict::kAcceptNew) {
      AcceptNew(memory, received.order, profile.version);
    } else {
      AcceptUpdate(memory, received.order);
    }
    memory.order_update_id = received.order.order_update_id;
    memory.zone_set_id = received.order.zone_set_id;
    memory.accepted = received.order;
  }

  void operator()(const InstantActionsReceived& received) {
    const InstantOutcome instant = ApplyInstantActions(memory, received, profile);
    outcome.must_send_state = instant.must_send_state;
    outcome.must_send_factsheet = instant.must_send_factsheet;
  }

  void operator()(const NodeReached& reached) {
    if (memory.nodes.empty() || memory.nodes.front().sequence_id != reached.sequence_id ||
        !memory.nodes.front().released) {
      return;
    }
    Traverse(memory);
  }

  void operator()(const ActionProgress& progress) { ApplyProgress(memory, progress, profile); }

  void operator()(const DrivingChanged& changed) { memory.is_driving = changed.is_driving; }

  void operator()(const ModeChanged& changed) {
    OperatingMode mode = changed.mode;
    if (IsBefore3(profile.version)) {
      if (mode == OperatingMode::kIntervened) mode = OperatingMode::kManual;
      if (mode == OperatingMode::kStartup) mode = OperatingMode::kService;
    }
    if (memory.wanted_mode) {
      if (ClearsOrder(mode)) memory.wanted_mode = mode;
    } else if (ClearsOrder(mode) && IsBusy(memory)) {
      memory.wanted_mode = mode;
      BeginClearing(memory, profile);
    } else {
      EnterMode(memory, mode, profile.version);
    }
  }

  void operator()(const PauseChanged& changed) { SetPaused(memory, changed.is_paused, profile); }

  void operator()(const LastNodeLost& /*lost*/) {
    if (IsBusy(memory)) return;
    memory.last_node_id.clear();
    memory.last_node_sequence_id = 0;
    memory.is_at_last_node = false;
  }

  void operator()(const ZoneSetReceived& received) { StoreZoneSet(memory, received); }
  void operator()(const ResponsesReceived& received) { TakeResponses(memory, received); }
  void operator()(const AccessWanted& wanted) { WantAccess(memory, wanted); }
  void operator()(const AccessEnded& ended) { EndAccess(memory, ended); }
  void operator()(const LeaseEnded& ended) { EndLease(memory, ended); }
  void operator()(const ZoneEntered& entered) { EnterZone(memory, entered, profile); }
  void operator()(const ZoneLeft& left) { LeaveZone(memory, left, profile); }

  void operator()(const ErrorRaised& raised) { ReportError(memory, {raised.error, ErrorEnd::kCause}); }

  void operator()(const ErrorCleared& cleared) {
    std::erase_if(memory.errors, [&](const ReportedError& reported) {
      return reported.end == ErrorEnd::kCause && reported.error.type == cleared.type;
    });
  }
};

}  // namespace

bool IsBusy(const VehicleMemory& memory) {
  return memory.is_clearing || !memory.nodes.empty() || !memory.edges.empty() ||
         std::any_of(memory.actions.begin(), memory.actions.end(),
                     [](const TrackedAction& tracked) { return !IsFinal(tracked.status); });
}

OrderFacts FactsOf(const VehicleMemory& memory, const OrderReceived& received, const VehicleProfile& profile,
                   const VehicleReadings& readings) {
  const Order& order = received.order;
  OrderFacts facts;
  facts.version = profile.version;
  facts.is_valid = received.faults.empty() && CheckOrder(order, profile.version).empty();
  if (!facts.is_valid) return facts;
  facts.is_same_order = order.order_id == memory.order_id;
  facts.update_id = order.order_update_id;
  facts.present_id = memory.order_update_id;
  facts.is_cancelled = memory.is_cancelled;
  facts.is_clearing = memory.is_clearing;
  facts.has_same_content = HaveSameContent(order, memory.accepted);
  facts.is_mode_for_orders = IsModeForOrders(memory);
  facts.has_fatal_error = std::any_of(memory.errors.begin(), memory.errors.end(), [](const ReportedError& reported) {
    return reported.error.level == ErrorLevel::kFatal;
  });
  const SupportFaults support = CheckSupport(order, profile.factsheet);
  facts.fits_limits = support.lengths.empty() && FitsMemory(memory, order, facts.is_same_order, profile);
  facts.parameters_supported = support.parameters.empty();
  facts.actions_supported = support.actions.empty();
  facts.reuses_action_id = ReusesActionId(memory, order, facts.is_same_order, profile.version);
  facts.maps_known = KnowsMaps(memory, order);
  facts.is_busy = IsBusy(memory);
  const Node& first = order.nodes.front();
  facts.is_start_near = IsNear(memory, first, profile, readings);
  const auto [end_id, end_sequence_id] =
      facts.is_busy ? BaseEnd(memory) : std::pair(memory.last_node_id, memory.last_node_sequence_id);
  facts.continues = first.id == end_id && first.sequence_id == end_sequence_id;
  return facts;
}

VehicleOutcome Apply(VehicleMemory& memory, const VehicleInput& input, const VehicleProfile& profile,
                     const VehicleReadings& readings) {
  Applier applier{memory, profile, readings, {}};
  std::visit(applier, input);
  Settle(memory, profile);
  return applier.outcome;
}

}  // namespace troupe::fleet
