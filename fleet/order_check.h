// What is wrong with an order or with instant actions as such (CheckOrder, CheckInstantActions), and what of it a
// vehicle cannot do (CheckSupport). Pure functions of a message and a factsheet; the vehicle and the checker both use
// them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fleet/codec.h"
#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"

namespace troupe::fleet {

// The rules of an order's form: at least one node, one edge less than nodes, one count of sequence ids over both, a
// released first node, no released part behind an unreleased one, edges between their nodes (before 3.0), unique ids of
// actions, proper curves.
std::vector<MessageFault> CheckOrder(const Order& order, Version version);
std::vector<MessageFault> CheckInstantActions(const InstantActions& actions);

// The degree of a curve, and its knots; those of a uniform clamped curve if it has none. Sizes as CheckOrder wants
// them.
std::uint32_t DegreeOf(const Trajectory& trajectory);
std::vector<double> KnotsOf(const Trajectory& trajectory);

// Whether a vehicle with this factsheet may use an optional member of an order, or needs it.
enum class ParameterUse : std::uint8_t { kIgnored, kSupported, kRequired };
ParameterUse UseOf(const Factsheet& factsheet, std::string_view parameter);

struct SupportFaults {
  std::vector<Reference> parameters;  // optional members that the vehicle cannot use, or needs and has not got
  std::vector<Reference> actions;     // actions that it cannot execute, with the reason
  std::vector<Reference> lengths;     // lists and texts longer than its limits

  bool empty() const { return parameters.empty() && actions.empty() && lengths.empty(); }
};

// Only members that change what the vehicle does are looked at: trajectories, corridors, orientations, speeds, heights,
// turns; descriptions are not.
SupportFaults CheckSupport(const Order& order, const Factsheet& factsheet);

// Why the vehicle cannot execute an action in a scope; empty: it can. Parameters have to be there and of their types,
// with the leniencies of ParameterValue; those that the factsheet does not have are ignored.
std::string WhyUnsupported(const Action& action, ActionScope scope, const Factsheet& factsheet);

}  // namespace troupe::fleet
