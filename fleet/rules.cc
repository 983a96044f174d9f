#include "fleet/rules.h"

namespace troupe::fleet {
namespace {

constexpr std::array<bool, 3> kAll = {true, true, true};
constexpr std::array<bool, 3> kSince2_1 = {false, true, true};
constexpr std::array<bool, 3> kSince3_0 = {false, false, true};

constexpr RuleInfo kRules[] = {
    {Rule::kMessageForm, Side::kBoth, kAll, "a message is JSON with the members and types of its topic"},
    {Rule::kStrictJson, Side::kBoth, kAll, "numbers, flags, names and lists are written as the version has them"},
    {Rule::kHeaderIdCounts, Side::kBoth, kAll, "headerId counts up by one with each message of a topic and sender"},
    {Rule::kTimestampGrows, Side::kBoth, kAll, "the timestamps of a topic and sender do not go back"},
    {Rule::kSenderInTopic, Side::kBoth, kAll, "manufacturer and serialNumber are those of the topic"},
    {Rule::kVersionOfTopic, Side::kBoth, kAll, "the major number of version is that of the topic"},

    {Rule::kOrderForm, Side::kFleet, kAll,
     "an order has one edge less than nodes, one count of sequence ids, and a base before its horizon"},
    {Rule::kOrderBeginsAtZero, Side::kFleet, kAll, "the first node of a new order has the sequenceId 0"},
    {Rule::kNewOrderUpdateZero, Side::kFleet, kSince3_0, "a new order has the orderUpdateId 0"},
    {Rule::kUpdateIdGrows, Side::kFleet, kAll, "the orderUpdateId of an order does not decrease"},
    {Rule::kResendUnchanged, Side::kFleet, kAll, "an order that is sent again with its orderUpdateId is the same"},
    {Rule::kUpdateContinuesBase, Side::kFleet, kAll, "an update begins with the last node of the base"},
    {Rule::kStitchingNodeUnchanged, Side::kFleet, kSince3_0, "an update repeats the last node of the base unchanged"},
    {Rule::kNewOrderWhenIdle, Side::kFleet, kAll, "a new order is sent to an idle vehicle only"},
    {Rule::kNoUpdateAfterCancel, Side::kFleet, kSince3_0, "a cancelled order gets no update"},
    {Rule::kOrdersInModes, Side::kFleet, kAll,
     "orders are sent in the modes AUTOMATIC and SEMIAUTOMATIC only (3.0: INTERVENED, too)"},
    {Rule::kOrderWithinFactsheet, Side::kFleet, kAll, "an order needs what the factsheet lists only"},
    {Rule::kInstantActionKnown, Side::kFleet, kAll, "an instant action is one of the factsheet, or one that all have"},
    {Rule::kInstantActionsInModes, Side::kFleet, kAll,
     "instant actions are sent in the modes AUTOMATIC and SEMIAUTOMATIC only (3.0, INTERVENED: cancelOrder)"},
    {Rule::kActionIdsUnique, Side::kFleet, kAll, "an actionId names one action"},
    {Rule::kZoneSetUnchanged, Side::kFleet, kSince3_0, "the content of a zone set does not change"},

    {Rule::kOnlineBeforeState, Side::kVehicle, kAll, "a vehicle that sends states has said that it is ONLINE"},
    {Rule::kStateInterval, Side::kVehicle, kAll, "a state is sent at the latest 30 s after the one before"},
    {Rule::kOrderAnswered, Side::kVehicle, kAll, "a state shows that an order was accepted or rejected"},
    {Rule::kRejectionKept, Side::kVehicle, kAll, "a rejection is reported until an order is accepted"},
    {Rule::kInstantActionReported, Side::kVehicle, kAll, "a state shows each instant action"},
    {Rule::kOrderWasSent, Side::kVehicle, kAll, "orderId and orderUpdateId are those of an order that was sent"},
    {Rule::kUpdateIdKept, Side::kVehicle, kAll, "the orderUpdateId of an order does not decrease"},
    {Rule::kStateSequence, Side::kVehicle, kAll,
     "nodeStates and edgeStates go on in their sequence, the base before the horizon"},
    {Rule::kNodesOfOrder, Side::kVehicle, kAll, "nodeStates are nodes of the order"},
    {Rule::kReleasedByFleet, Side::kVehicle, kAll, "released nodes were released by the fleet control"},
    {Rule::kHorizonComplete, Side::kVehicle, kAll, "nodeStates have all nodes behind the last one"},
    {Rule::kTraversalInSequence, Side::kVehicle, kAll, "nodes are traversed in the sequence of the order"},
    {Rule::kOnlyBaseTraversed, Side::kVehicle, kAll, "only released nodes are traversed"},
    {Rule::kActionStatesComplete, Side::kVehicle, kAll, "actionStates have all actions of the order"},
    {Rule::kActionStatesKept, Side::kVehicle, kAll, "action states stay until another order is accepted"},
    {Rule::kActionStatusSequence, Side::kVehicle, kAll,
     "no action waits again after it began, and none changes after its end"},
    {Rule::kActionRunsAlone, Side::kVehicle, kAll,
     "beside a HARD (3.0: or SINGLE) action no other action of the order or of a zone runs"},
    {Rule::kStandsForAction, Side::kVehicle, kAll, "the vehicle stands while a SOFT or HARD action runs"},
    {Rule::kPauseStands, Side::kVehicle, kAll, "when startPause is FINISHED, the vehicle is paused and stands"},
    {Rule::kPauseEnds, Side::kVehicle, kAll, "when stopPause is FINISHED, the vehicle is not paused"},
    {Rule::kCancelClears, Side::kVehicle, kAll,
     "when cancelOrder is FINISHED, the vehicle stands without nodes, edges and unfinished actions of the order"},
    {Rule::kCancelWithoutOrder, Side::kVehicle, kAll,
     "a failed cancelOrder is explained by an error that there was no order to cancel, with its actionId"},
    {Rule::kModeClearsOrder, Side::kVehicle, kAll,
     "in the mode MANUAL (3.0: also SERVICE, TEACH_IN) there is no order"},
    {Rule::kOneEnabledMap, Side::kVehicle, kSince2_1, "of the versions of a map at most one is ENABLED"},
    {Rule::kZoneSetAnswered, Side::kVehicle, kSince3_0, "a state shows that a zone set was stored or refused"},
    {Rule::kOneEnabledZoneSet, Side::kVehicle, kSince3_0, "of the zone sets of a map at most one is ENABLED"},
    {Rule::kRequestsOfEnabledSets, Side::kVehicle, kSince3_0, "zoneRequests are for zones of ENABLED sets"},
    {Rule::kZoneActionsReported, Side::kVehicle, kSince3_0,
     "a vehicle with ACTION zones in its factsheet has zoneActionStates"},
};

static_assert(std::size(kRules) == NamesOf(Rule()).size());

}  // namespace

std::span<const RuleInfo> Rules() {
  return kRules;
}

const RuleInfo& InfoOf(Rule rule) {
  return kRules[static_cast<std::size_t>(rule)];
}

}  // namespace troupe::fleet
