#include "fleet/order_check.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace troupe::fleet {
namespace {

// Collects the faults of a message, at most as many as are listed.
class FaultList {
 public:
  void Add(std::string pointer, std::string text) {
    if (faults_.size() < kMaxMessageFaults) faults_.push_back({std::move(pointer), std::move(text)});
  }
  bool is_full() const { return faults_.size() >= kMaxMessageFaults; }
  std::vector<MessageFault> Release() { return std::move(faults_); }

 private:
  std::vector<MessageFault> faults_;
};

std::string At(std::string_view list, std::size_t i, std::string_view member) {
  return "/" + std::string(list) + "/" + std::to_string(i) + "/" + std::string(member);
}

std::string ShortQuoted(std::string_view text) {
  return "'" + std::string(text.substr(0, 60)) + "'";
}

void CheckTrajectory(const Trajectory& trajectory, const std::string& pointer, FaultList& faults) {
  const std::size_t points = trajectory.control_points.size();
  const std::uint32_t degree = DegreeOf(trajectory);
  if (degree < 1) faults.Add(pointer + "/degree", "found 0, expected at least 1");
  if (points < std::size_t{degree} + 1) {
    faults.Add(pointer + "/controlPoints", "found " + std::to_string(points) + " of a curve of degree " +
                                               std::to_string(degree) + ", expected at least one more than the degree");
  }
  for (std::size_t i = 0; i < points; ++i) {
    const std::optional<double>& weight = trajectory.control_points[i].weight;
    if (weight && !(*weight > 0.0)) {
      faults.Add(pointer + "/controlPoints/" + std::to_string(i) + "/weight", "found 0, expected more");
    }
  }
  if (!trajectory.knot_vector) return;
  const std::vector<double>& knots = *trajectory.knot_vector;
  if (knots.size() != points + degree + 1) {
    faults.Add(pointer + "/knotVector", "found " + std::to_string(knots.size()) + " knots, expected " +
                                            std::to_string(points + degree + 1) +
                                            ": control points and degree and one more");
  } else if (!std::is_sorted(knots.begin(), knots.end())) {
    faults.Add(pointer + "/knotVector", "found a knot that is less than the one before it, expected none");
  }
}

void CheckActionIds(const std::vector<Action>& actions, const std::string& pointer, std::set<std::string>& ids,
                    FaultList& faults) {
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const std::string place = pointer + "/" + std::to_string(i) + "/actionId";
    if (actions[i].id.empty()) {
      faults.Add(place, "found an empty id, expected one");
    } else if (!ids.insert(actions[i].id).second) {
      faults.Add(place, "found the id " + ShortQuoted(actions[i].id) + " a second time, expected unique ids");
    }
  }
}

// Member by member, whether an order uses it and which factsheet parameter that is.
struct UsedParameter {
  std::string_view parameter;
  bool is_used = false;
};

std::vector<UsedParameter> ParametersOf(const Edge& edge) {
  return {{"order.edges.maxSpeed", edge.maximum_speed.has_value()},
          {"order.edges.maxHeight", edge.maximum_robot_height.has_value()},
          {"order.edges.minHeight", edge.minimum_device_height.has_value()},
          {"order.edges.orientation", edge.orientation.has_value()},
          {"order.edges.direction", edge.direction.has_value()},
          {"order.edges.rotationAllowed", edge.rotation_allowed.has_value()},
          {"order.edges.reachOrientationBeforeEntering", edge.reach_orientation_before_entering.has_value()},
          {"order.edges.maxRotationSpeed", edge.maximum_rotation_speed.has_value()},
          {"order.edges.trajectory", edge.trajectory.has_value()},
          {"order.edges.corridor", edge.corridor.has_value()}};
}

std::vector<UsedParameter> ParametersOf(const Node& node) {
  return {{"order.nodes.nodePosition", node.position.has_value()},
          {"order.nodes.nodePosition.theta", node.position && node.position->theta},
          {"order.nodes.nodePosition.allowedDeviationXY", node.position && node.position->allowed_deviation_xy},
          {"order.nodes.nodePosition.allowedDeviationTheta", node.position && node.position->allowed_deviation_theta}};
}

// The names of 3.0 for parameters that it has renamed.
std::string_view NewerParameter(std::string_view parameter) {
  constexpr std::pair<std::string_view, std::string_view> kRenamed[] = {
      {"order.edges.maxSpeed", "order.edges.maximumSpeed"},
      {"order.edges.maxHeight", "order.edges.maximumMobileRobotHeight"},
      {"order.edges.minHeight", "order.edges.minimumLoadHandlingDeviceHeight"}};
  for (const auto& [older, newer] : kRenamed) {
    if (older == parameter) return newer;
  }
  return parameter;
}

// Members that mean the same whether or not a vehicle names them: where a node is, and how exactly it has to be
// reached.
bool IsAlwaysSupported(std::string_view parameter) {
  return parameter == "order.nodes.nodePosition" || parameter == "order.nodes.nodePosition.allowedDeviationXY";
}

template <typename Part>
void CheckParameters(const Part& part, const Factsheet& factsheet, const Reference& where, SupportFaults& faults) {
  for (const UsedParameter& used : ParametersOf(part)) {
    const ParameterUse use = UseOf(factsheet, used.parameter);
    const bool is_wrong = used.is_used ? use == ParameterUse::kIgnored && !IsAlwaysSupported(used.parameter)
                                       : use == ParameterUse::kRequired;
    if (!is_wrong) continue;
    faults.parameters.push_back({"parameter", std::string(used.parameter)});
    faults.parameters.push_back(where);
  }
}

void CheckLength(std::size_t length, const std::optional<std::uint32_t>& limit, std::string_view name,
                 SupportFaults& faults) {
  if (limit && *limit > 0 && length > *limit) {
    faults.lengths.push_back({std::string(name), std::to_string(length) + " of at most " + std::to_string(*limit)});
  }
}

void CheckActions(const std::vector<Action>& actions, ActionScope scope, const Factsheet& factsheet,
                  SupportFaults& faults) {
  for (const Action& action : actions) {
    if (const std::string reason = WhyUnsupported(action, scope, factsheet); !reason.empty()) {
      faults.actions.push_back({"actionId", action.id});
      faults.actions.push_back({"reason", reason});
    }
    CheckLength(action.parameters ? action.parameters->size() : 0, factsheet.limits.arrays.action_parameters,
                "actions.actionsParameters", faults);
    CheckLength(action.id.size(), factsheet.limits.strings.id, "idLen", faults);
  }
}

// Whether a value is of a type of factsheets, strings that say a number or a flag included.
bool IsOfType(const ParameterValue& value, std::string_view type) {
  using Kind = ParameterValue::Kind;
  if (type == "BOOL") return value.Boolean().has_value();
  if (type == "NUMBER" || type == "FLOAT") return value.Number().has_value();
  if (type == "INTEGER") {
    const std::optional<double> number = value.Number();
    return number && *number == std::trunc(*number);
  }
  if (type == "STRING") return value.kind == Kind::kString || value.kind == Kind::kNumber;
  if (type == "OBJECT") return value.kind == Kind::kJson && value.text.starts_with('{');
  if (type == "ARRAY") return value.kind == Kind::kJson && value.text.starts_with('[');
  return true;
}

}  // namespace

bool ActionSpecification::IsFor(ActionScope scope) const {
  return std::find(scopes.begin(), scopes.end(), scope) != scopes.end();
}

const ActionSpecification* Factsheet::FindAction(std::string_view action_type) const {
  const std::vector<ActionSpecification>& actions = features.actions;
  const auto found = std::find_if(actions.begin(), actions.end(),
                                  [&](const ActionSpecification& action) { return action.type == action_type; });
  return found != actions.end() ? &*found : nullptr;
}

std::uint32_t DegreeOf(const Trajectory& trajectory) {
  return trajectory.degree.value_or(1);
}

std::vector<double> KnotsOf(const Trajectory& trajectory) {
  if (trajectory.knot_vector) return *trajectory.knot_vector;
  const std::size_t degree = DegreeOf(trajectory);
  const std::size_t points = trajectory.control_points.size();
  std::vector<double> knots(points + degree + 1, 0.0);
  const std::size_t spans = points > degree ? points - degree : 1;
  for (std::size_t i = degree + 1; i < knots.size(); ++i) {
    knots[i] = std::min(1.0, static_cast<double>(i - degree) / static_cast<double>(spans));
  }
  return knots;
}

std::vector<MessageFault> CheckOrder(const Order& order, Version version) {
  FaultList faults;
  if (order.order_id.empty()) faults.Add("/orderId", "found an empty id, expected one");
  const std::vector<Node>& nodes = order.nodes;
  const std::vector<Edge>& edges = order.edges;
  if (nodes.empty()) {
    faults.Add("/nodes", "found no node, expected at least one");
    return faults.Release();
  }
  if (edges.size() + 1 != nodes.size()) {
    faults.Add("/edges", "found " + std::to_string(edges.size()) + " edges and " + std::to_string(nodes.size()) +
                             " nodes, expected one edge less than nodes");
    return faults.Release();
  }
  if (!nodes.front().released) faults.Add("/nodes/0/released", "found false, expected a released first node");
  const std::uint64_t first = nodes.front().sequence_id;
  bool is_base = true;
  std::set<std::string> action_ids;
  for (std::size_t i = 0; i < nodes.size() && !faults.is_full(); ++i) {
    const Node& node = nodes[i];
    if (i > 0) {
      const Edge& edge = edges[i - 1];
      if (edge.sequence_id != first + 2 * i - 1) {
        faults.Add(At("edges", i - 1, "sequenceId"), "found " + std::to_string(edge.sequence_id) + ", expected " +
                                                         std::to_string(first + 2 * i - 1) +
                                                         ": one more than the node before it");
      }
      if (edge.id.empty()) faults.Add(At("edges", i - 1, "edgeId"), "found an empty id, expected one");
      if (edge.released && !is_base) {
        faults.Add(At("edges", i - 1, "released"), "found true behind an unreleased part, expected false");
      }
      if (edge.released && !node.released) {
        faults.Add(At("edges", i - 1, "released"), "found true before an unreleased node, expected false");
      }
      is_base = is_base && edge.released;
      if (IsBefore3(version) && edge.start_node_id != nodes[i - 1].id) {
        faults.Add(At("edges", i - 1, "startNodeId"), "found " + ShortQuoted(edge.start_node_id) + ", expected " +
                                                          ShortQuoted(nodes[i - 1].id) + ": the node before it");
      }
      if (IsBefore3(version) && edge.end_node_id != node.id) {
        faults.Add(At("edges", i - 1, "endNodeId"), "found " + ShortQuoted(edge.end_node_id) + ", expected " +
                                                        ShortQuoted(node.id) + ": the node behind it");
      }
      if (edge.trajectory) CheckTrajectory(*edge.trajectory, At("edges", i - 1, "trajectory"), faults);
      CheckActionIds(edge.actions, At("edges", i - 1, "actions"), action_ids, faults);
    }
    if (node.sequence_id != first + 2 * i) {
      faults.Add(At("nodes", i, "sequenceId"), "found " + std::to_string(node.sequence_id) + ", expected " +
                                                   std::to_string(first + 2 * i) +
                                                   ": two more than the node before it");
    }
    if (node.id.empty()) faults.Add(At("nodes", i, "nodeId"), "found an empty id, expected one");
    if (node.released && !is_base) {
      faults.Add(At("nodes", i, "released"), "found true behind an unreleased part, expected false");
    }
    is_base = is_base && node.released;
    CheckActionIds(node.actions, At("nodes", i, "actions"), action_ids, faults);
  }
  return faults.Release();
}

std::vector<MessageFault> CheckInstantActions(const InstantActions& actions) {
  FaultList faults;
  std::set<std::string> ids;
  CheckActionIds(actions.actions, "/actions", ids, faults);
  return faults.Release();
}

ParameterUse UseOf(const Factsheet& factsheet, std::string_view parameter) {
  for (const OptionalParameter& known : factsheet.features.optional_parameters) {
    if (known.parameter != parameter && known.parameter != NewerParameter(parameter)) continue;
    return known.support == Support::kRequired ? ParameterUse::kRequired : ParameterUse::kSupported;
  }
  return ParameterUse::kIgnored;
}

SupportFaults CheckSupport(const Order& order, const Factsheet& factsheet) {
  SupportFaults faults;
  const ArrayLimits& limits = factsheet.limits.arrays;
  CheckLength(order.nodes.size(), limits.order_nodes, "order.nodes", faults);
  CheckLength(order.edges.size(), limits.order_edges, "order.edges", faults);
  CheckLength(order.order_id.size(), factsheet.limits.strings.id, "idLen", faults);
  for (const Node& node : order.nodes) {
    CheckParameters(node, factsheet, {"nodeId", node.id}, faults);
    CheckActions(node.actions, ActionScope::kNode, factsheet, faults);
    CheckLength(node.actions.size(), limits.node_actions, "node.actions", faults);
    CheckLength(node.id.size(), factsheet.limits.strings.id, "idLen", faults);
  }
  for (const Edge& edge : order.edges) {
    CheckParameters(edge, factsheet, {"edgeId", edge.id}, faults);
    CheckActions(edge.actions, ActionScope::kEdge, factsheet, faults);
    CheckLength(edge.actions.size(), limits.edge_actions, "edge.actions", faults);
    CheckLength(edge.id.size(), factsheet.limits.strings.id, "idLen", faults);
    if (!edge.trajectory) continue;
    CheckLength(edge.trajectory->control_points.size(), limits.control_points, "trajectory.controlPoints", faults);
    CheckLength(edge.trajectory->knot_vector ? edge.trajectory->knot_vector->size() : 0, limits.knot_vector,
                "trajectory.knotVector", faults);
  }
  return faults;
}

std::string WhyUnsupported(const Action& action, ActionScope scope, const Factsheet& factsheet) {
  const ActionSpecification* const known = factsheet.FindAction(action.type);
  if (known == nullptr) return "unknown action " + ShortQuoted(action.type);
  if (!known->IsFor(scope)) return "no action of the scope " + std::string(NameOf(scope));
  // Fleets send instant actions with any blocking type; what they stop is the business of the vehicle.
  if (scope != ActionScope::kInstant && known->blocking_types &&
      std::find(known->blocking_types->begin(), known->blocking_types->end(), action.blocking_type) ==
          known->blocking_types->end()) {
    return "not with the blocking type " + std::string(NameOf(action.blocking_type));
  }
  if (!known->parameters) return "";
  for (const ParameterSpecification& parameter : *known->parameters) {
    const ParameterValue* const value = action.FindParameter(parameter.key);
    if (value == nullptr) {
      if (!parameter.is_optional.value_or(false)) return "no parameter " + ShortQuoted(parameter.key);
    } else if (!IsOfType(*value, parameter.value_type)) {
      return "the parameter " + ShortQuoted(parameter.key) + " is not of the type " + parameter.value_type;
    }
  }
  return "";
}

}  // namespace troupe::fleet
