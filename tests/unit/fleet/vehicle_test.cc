// The vehicle's side: every row of the decision table in each version, and the life of actions by examples.
// reference.py judges random sequences.
#include "fleet/vehicle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {
namespace {

using enum ActionStatus;
using enum BlockingType;
using testing::ElementsAre;
using testing::IsEmpty;

// A vehicle at A that gets inputs.
struct TestVehicle {
  explicit TestVehicle(Version its_version) : version(its_version), profile(SampleProfile(its_version)) {
    memory.maps = {{"L1", "1", {}, StoredStatus::kEnabled}, {"L1", "2", {}, StoredStatus::kDisabled}};
  }

  VehicleOutcome Give(const VehicleInput& input) { return Apply(memory, input, profile, readings); }
  // The row that decides.
  std::string Send(Order order) { return std::string(Give(OrderReceived{std::move(order), {}}).row->name); }
  std::string SendPlaces(const std::string& id, std::uint32_t update, const std::string& places, std::size_t released,
                         std::uint32_t first = 0) {
    return Send(SampleOrder(version, id, update, places, released, first));
  }
  ActionStatus Instant(const std::string& type, std::vector<ActionParameter> parameters = {}) {
    Action action = SampleActionOf(type, type + std::to_string(++instants), kNone);
    if (!parameters.empty()) action.parameters = std::move(parameters);
    Give(InstantActionsReceived{{SampleHeader(version), {action}}, {}});
    return StatusOf(action.id);
  }
  void Reach(std::uint32_t sequence_id) {
    Give(DrivingChanged{true});
    Give(NodeReached{sequence_id});
    if (!MayDrive(memory, profile)) Give(DrivingChanged{false});
  }
  void Report(const std::string& id, ActionStatus status) { Give(ActionProgress{id, status, {}, {}}); }

  ActionStatus StatusOf(const std::string& id) const {
    const State state = MakeState(memory, profile, readings);
    for (const auto* const list : {&state.action_states, &state.instant_action_states}) {
      for (const ActionState& each : *list) {
        if (each.action_id == id) return each.status;
      }
    }
    ADD_FAILURE() << "no state of " << id;
    return kWaiting;
  }
  std::vector<std::string> Errors() const {
    std::vector<std::string> types;
    for (const ReportedError& reported : memory.errors) types.push_back(reported.error.type);
    return types;
  }
  std::string Nodes() const {
    std::string text;
    for (const Node& node : memory.nodes)
      text += node.id + std::to_string(node.sequence_id) + (node.released ? "+" : "-");
    return text;
  }
  bool may_drive() const { return MayDrive(memory, profile); }

  Version version;
  VehicleProfile profile;
  VehicleMemory memory;
  VehicleReadings readings = SampleReadings();
  int instants = 0;
};

class EachVersion : public testing::TestWithParam<Version> {
 protected:
  bool is_3() const { return !IsBefore3(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Versions, EachVersion, testing::Values(Version::k2_0, Version::k2_1, Version::k3_0),
                         [](const auto& info) {
                           return std::string("V") + NameOf(info.param)[0] + NameOf(info.param)[2];
                         });

// A situation for each row, and the order that the row is for.
struct RowCase {
  std::string row;
  std::function<Order(TestVehicle&)> prepare;
};

std::vector<RowCase> RowCases(Version version) {
  const bool is_3 = !IsBefore3(version);
  const auto order = [version](const std::string& id, std::uint32_t update, const std::string& places,
                               std::size_t released, std::uint32_t first = 0) {
    return SampleOrder(version, id, update, places, released, first);
  };
  std::vector<RowCase> cases = {
      {"invalid", [=](TestVehicle&) { return order("o1", 0, "", 0); }},
      {"outdated_update",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 1);
         v.SendPlaces("o1", 2, "AB", 2);
         return order("o1", 1, "AB", 2);
       }},
      {"after_cancel",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 2);
         v.Give(DrivingChanged{true});
         v.Instant("cancelOrder");
         return order("o1", 1, "BC", 2, 2);
       }},
      {"resend",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 2);
         return order("o1", 0, "AB", 2);
       }},
      {"mode_without_orders",
       [=](TestVehicle& v) {
         v.Give(ModeChanged{OperatingMode::kManual});
         return order("o1", 0, "AB", 2);
       }},
      {"fatal_error",
       [=](TestVehicle& v) {
         v.Give(ErrorRaised{{"broken", {}, {}, {}, {}, {}, ErrorLevel::kFatal}});
         return order("o1", 0, "AB", 2);
       }},
      {"too_long",
       [=](TestVehicle& v) {
         v.profile.factsheet.limits.arrays.order_nodes = 2;
         return order("o1", 0, "ABC", 2);
       }},
      {"unsupported_parameter",
       [=](TestVehicle&) {
         Order wrong = order("o1", 0, "AB", 2);
         wrong.edges[0].orientation = 1.0;
         return wrong;
       }},
      {"unsupported_action",
       [=](TestVehicle&) {
         Order wrong = order("o1", 0, "AB", 2);
         wrong.nodes[1].actions = {SampleActionOf("fly", "a1")};
         return wrong;
       }},
      {"reused_action_id",
       [=](TestVehicle& v) {
         Order first = order("o1", 0, "AB", 2);
         first.nodes[1].actions = {SampleActionOf("pick", "a1")};
         v.Send(first);
         Order wrong = order("o1", 1, "BC", 2, 2);
         wrong.nodes[1].actions = {SampleActionOf("drop", "a1")};
         return wrong;
       }},
      {"unknown_map",
       [=](TestVehicle&) {
         Order wrong = order("o1", 0, "AB", 2);
         wrong.nodes[1].position->map_id = "L7";
         return wrong;
       }},
      {"other_order_active",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 1);
         return order("o2", 0, "AB", 2);
       }},
      {"start_too_far", [=](TestVehicle&) { return order("o1", 0, "BA", 2); }},
      {"new_order", [=](TestVehicle&) { return order("o1", 0, "AB", 2); }},
      {"update_of_base",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "ABC", 2);
         return order("o1", 1, "BD", 2, 2);
       }},
      {"update_breaks_base",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "ABC", 2);
         return order("o1", 1, "CD", 2, 4);
       }},
      {"update_of_finished",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 2);
         v.Reach(2);
         return order("o1", 1, "BC", 2, 2);
       }},
      {"update_breaks_finished",
       [=](TestVehicle& v) {
         v.SendPlaces("o1", 0, "AB", 2);
         v.Reach(2);
         return order("o1", 1, "BC", 2, 4);
       }},
  };
  if (is_3) {
    cases.push_back({"changed_resend", [=](TestVehicle& v) {
                       v.SendPlaces("o1", 0, "AB", 2);
                       return order("o1", 0, "AC", 2);
                     }});
    cases.push_back({"update_without_order", [=](TestVehicle&) { return order("o1", 1, "AB", 2); }});
  }
  return cases;
}

TEST_P(EachVersion, EveryRowOfTheTableDecides) {
  std::set<std::string> seen;
  for (const RowCase& each : RowCases(GetParam())) {
    TestVehicle vehicle(GetParam());
    const Order order = each.prepare(vehicle);
    const VehicleMemory before = vehicle.memory;
    EXPECT_EQ(vehicle.Send(order), each.row);
    seen.insert(each.row);
    const auto table = OrderTable();
    const auto row = std::find_if(table.begin(), table.end(), [&](const OrderRow& r) { return r.name == each.row; });
    ASSERT_NE(row, table.end());
    if (row->verdict == OrderVerdict::kReject) {
      // It is reported with the order's id, and changes nothing else.
      ASSERT_FALSE(vehicle.memory.errors.empty()) << each.row;
      const VehicleError error = vehicle.memory.errors.back().error;
      EXPECT_EQ(error.type, row->ErrorOf(GetParam()));
      EXPECT_EQ(error.level, row->LevelOf(GetParam()));
      EXPECT_THAT(*error.references, testing::Contains(Reference{"orderId", order.order_id})) << each.row;
      vehicle.memory.errors = before.errors;
      EXPECT_TRUE(vehicle.memory == before) << each.row;
    } else if (row->verdict == OrderVerdict::kDiscard) {
      EXPECT_TRUE(vehicle.memory == before) << each.row;
    } else {
      EXPECT_EQ(vehicle.memory.order_update_id, order.order_update_id);
      EXPECT_EQ(vehicle.memory.order_id, order.order_id);
    }
  }
  EXPECT_EQ(seen.size(), OrderTable().size() - (is_3() ? 0 : 2));
}

TEST_P(EachVersion, ARejectionIsReportedUntilAnOrderIsAccepted) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "BA", 2);
  EXPECT_EQ(vehicle.Errors().size(), 1u);
  vehicle.Instant("stateRequest");
  EXPECT_EQ(vehicle.Errors().size(), 1u);
  vehicle.SendPlaces("o2", 0, "AB", 2);
  EXPECT_THAT(vehicle.Errors(), IsEmpty());
  // However many there are, a state stays short.
  for (std::uint32_t i = 0; i < 100; ++i) vehicle.SendPlaces("x" + std::to_string(i), 0, "AB", 2);
  EXPECT_LE(vehicle.Errors().size(), 8u);
}

TEST_P(EachVersion, OnlyTheFourNamesThatFleetsKnowAreRejectionsBefore3) {
  const std::set<std::string_view> names = {"validationError", "orderError", "orderUpdateError", "noRouteError", ""};
  for (const OrderRow& row : OrderTable()) {
    EXPECT_TRUE(names.contains(row.older_error)) << row.name;
    EXPECT_EQ(row.verdict == OrderVerdict::kReject, !row.newer_error.empty()) << row.name;
  }
}

TEST_P(EachVersion, AnUpdateReplacesTheHorizonOnly) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "ABCD", 2);
  EXPECT_EQ(vehicle.Nodes(), "B2+C4-D6-");
  EXPECT_EQ(vehicle.memory.last_node_id, "A");
  EXPECT_EQ(vehicle.SendPlaces("o1", 1, "BE", 2, 2), "update_of_base");
  EXPECT_EQ(vehicle.Nodes(), "B2+E4+");
  EXPECT_EQ(vehicle.SendPlaces("o1", 2, "E", 1, 4), "update_of_base");
  EXPECT_EQ(vehicle.Nodes(), "B2+E4+");
}

TEST_P(EachVersion, ALoopIsFollowedBySequenceIds) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "ABABA", 3);
  EXPECT_EQ(vehicle.Nodes(), "B2+A4+B6-A8-");
  vehicle.Reach(4);  // not the next one
  EXPECT_EQ(vehicle.memory.last_node_sequence_id, 0u);
  vehicle.Reach(2);
  vehicle.Reach(4);
  EXPECT_EQ(vehicle.memory.last_node_id, "A");
  EXPECT_EQ(vehicle.memory.last_node_sequence_id, 4u);
  vehicle.Reach(6);  // of the horizon
  EXPECT_EQ(vehicle.memory.last_node_sequence_id, 4u);
  EXPECT_EQ(vehicle.SendPlaces("o1", 1, "AB", 2, 0), "update_breaks_base");
  EXPECT_EQ(vehicle.SendPlaces("o1", 1, "AB", 2, 4), "update_of_base");
}

TEST_P(EachVersion, TheHorizonIsNeverDriven) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "ABC", 2);
  EXPECT_TRUE(vehicle.may_drive());
  vehicle.Reach(2);
  EXPECT_FALSE(vehicle.may_drive());
  EXPECT_TRUE(MakeState(vehicle.memory, vehicle.profile, vehicle.readings).new_base_request);
  EXPECT_EQ(vehicle.SendPlaces("o1", 1, "BC", 2, 2), "update_of_base");
  EXPECT_TRUE(vehicle.may_drive());
}

TEST_P(EachVersion, AfterACancelTheNextOrderStartsHereOrFromALastNodeWithEnoughDeviation) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "AB", 2);
  vehicle.Give(DrivingChanged{true});
  vehicle.readings = SampleReadings(2.0);
  EXPECT_EQ(vehicle.Instant("cancelOrder"), kRunning);
  EXPECT_EQ(vehicle.Nodes(), "B2+");
  vehicle.Give(DrivingChanged{false});
  EXPECT_EQ(vehicle.StatusOf("cancelOrder1"), kFinished);
  EXPECT_EQ(vehicle.Nodes(), "");
  EXPECT_EQ(vehicle.memory.order_id, "o1");
  EXPECT_EQ(vehicle.Instant("cancelOrder"), kFailed);
  EXPECT_THAT(vehicle.Errors(), ElementsAre(is_3() ? "NO_ORDER_TO_CANCEL" : "noOrderToCancel"));
  EXPECT_EQ(vehicle.SendPlaces("o2", 0, "AB", 2), "start_too_far");
  Order wide = SampleOrder(GetParam(), "o3", 0, "AB", 2);
  wide.nodes[0].position->allowed_deviation_xy = AllowedDeviation{2.5, 2.5, 0.0};
  TestVehicle other = vehicle;
  EXPECT_EQ(vehicle.Send(wide), "new_order");
  Order here = SampleOrder(GetParam(), "o4", 0, "XB", 2);
  here.nodes[0].position->x = 2.0;
  EXPECT_EQ(other.Send(here), "new_order");
}

TEST_P(EachVersion, AVehicleThatStopsAtNodesOnlyGoesOnToTheNext) {
  TestVehicle vehicle(GetParam());
  vehicle.profile.stops_between_nodes = false;
  vehicle.SendPlaces("o1", 0, "ABC", 3);
  vehicle.Give(DrivingChanged{true});
  vehicle.Instant("cancelOrder");
  EXPECT_EQ(vehicle.Nodes(), "B2+");
  EXPECT_TRUE(vehicle.may_drive());
  vehicle.Give(NodeReached{2});
  vehicle.Give(DrivingChanged{false});
  EXPECT_EQ(vehicle.StatusOf("cancelOrder1"), kFinished);
  EXPECT_EQ(vehicle.memory.last_node_id, "B");
}

// Actions.

// The ids of actions that are started.
std::string Started(const TestVehicle& vehicle) {
  std::string ids;
  for (const TrackedAction& tracked : vehicle.memory.actions) {
    if (IsStarted(tracked.status)) ids += tracked.action.id;
  }
  return ids;
}

// Actions a, b, c, ... of the given types at B, which the vehicle reaches; what is started after each end.
std::vector<std::string> Schedule(Version version, const std::vector<BlockingType>& types) {
  TestVehicle vehicle(version);
  Order order = SampleOrder(version, "o1", 0, "ABC", 3);
  for (std::size_t i = 0; i < types.size(); ++i) {
    order.nodes[1].actions.push_back(SampleActionOf("pick", std::string(1, static_cast<char>('a' + i)), types[i]));
  }
  EXPECT_EQ(vehicle.Send(order), "new_order");
  vehicle.Reach(2);
  std::vector<std::string> steps;
  for (std::string ids = Started(vehicle); !ids.empty(); ids = Started(vehicle)) {
    steps.push_back(ids + (vehicle.may_drive() ? " drives" : ""));
    vehicle.Report(ids.substr(0, 1), kFinished);
  }
  EXPECT_TRUE(vehicle.may_drive());
  EXPECT_TRUE(vehicle.memory.queue.empty());
  return steps;
}

TEST_P(EachVersion, BlockingTypesDecideWhatRunsTogether) {
  const Version version = GetParam();
  EXPECT_THAT(Schedule(version, {kNone, kNone}), ElementsAre("ab drives", "b drives"));
  EXPECT_THAT(Schedule(version, {kNone, kSoft}), ElementsAre("ab", "b"));
  EXPECT_THAT(Schedule(version, {kSoft, kNone}), ElementsAre("ab", "b drives"));
  EXPECT_THAT(Schedule(version, {kNone, kHard, kNone}), ElementsAre("a", "b", "c drives"));
  EXPECT_THAT(Schedule(version, {kHard, kHard}), ElementsAre("a", "b"));
  EXPECT_THAT(Schedule(version, {kSoft, kSoft, kHard, kSoft}), ElementsAre("ab", "b", "c", "d"));
  if (is_3()) {
    EXPECT_THAT(Schedule(version, {kNone, kSingle, kNone}), ElementsAre("a drives", "b drives", "c drives"));
    EXPECT_THAT(Schedule(version, {kSingle, kSoft}), ElementsAre("a", "b"));
  }
}

// All sequences of three types: each action runs once, those that run alone do so, and the sequence is kept.
TEST_P(EachVersion, AllSequencesOfBlockingTypes) {
  const std::vector<BlockingType> all =
      is_3() ? std::vector{kNone, kSoft, kSingle, kHard} : std::vector{kNone, kSoft, kHard};
  for (const BlockingType a : all) {
    for (const BlockingType b : all) {
      for (const BlockingType c : all) {
        const std::vector<BlockingType> types = {a, b, c};
        std::string begun;
        for (const std::string& step : Schedule(GetParam(), types)) {
          const std::string ids = step.substr(0, step.find(' '));
          for (const char id : ids) {
            const BlockingType type = types[static_cast<std::size_t>(id - 'a')];
            if (RunsAlone(type)) EXPECT_EQ(ids.size(), 1u) << step;
            if (StopsDriving(type)) EXPECT_EQ(step, ids);
            if (begun.find(id) == std::string::npos) begun += id;
          }
        }
        EXPECT_EQ(begun, "abc");
      }
    }
  }
}

TEST_P(EachVersion, AnActionThatStopsTheVehicleWaitsUntilItStands) {
  TestVehicle vehicle(GetParam());
  Order order = SampleOrder(GetParam(), "o1", 0, "ABC", 3);
  order.nodes[1].actions = {SampleActionOf("pick", "a", kHard)};
  vehicle.Send(order);
  vehicle.Give(DrivingChanged{true});
  vehicle.Give(NodeReached{2});
  EXPECT_EQ(vehicle.StatusOf("a"), kWaiting);
  EXPECT_FALSE(vehicle.may_drive());
  vehicle.Give(DrivingChanged{false});
  EXPECT_EQ(vehicle.StatusOf("a"), kInitializing);
}

TEST_P(EachVersion, ActionsOfAnEdgeBeginWhenItIsEnteredAndEndWithIt) {
  TestVehicle vehicle(GetParam());
  Order order = SampleOrder(GetParam(), "o1", 0, "ABC", 3);
  order.nodes[0].actions = {SampleActionOf("pick", "first", kHard)};
  order.edges[0].actions = {SampleActionOf("blink", "a", kNone), SampleActionOf("blink", "b", kNone)};
  vehicle.Send(order);
  EXPECT_EQ(Started(vehicle), "first");
  vehicle.Report("first", kFinished);
  EXPECT_EQ(Started(vehicle), "ab");
  vehicle.Report("b", kFinished);
  vehicle.Reach(2);
  EXPECT_EQ(vehicle.StatusOf("a"), kFinished);
}

// Each action of an order in each status, when it is paused, cancelled, taken over or reported about.
TEST_P(EachVersion, EveryStatusMeetsEveryInput) {
  const auto prepared = [&](ActionStatus status, const std::string& type) {
    TestVehicle vehicle(GetParam());
    Order order = SampleOrder(GetParam(), "o1", 0, "AB", 2);
    order.nodes[0].actions = {SampleActionOf(type, "a", kHard)};
    if (is_3()) order.nodes[0].actions[0].retriable = true;
    if (status == kWaiting) std::swap(order.nodes[0].actions, order.nodes[1].actions);
    vehicle.Send(order);
    if (status == kRunning || IsFinal(status)) vehicle.Report("a", kRunning);
    if (status == kPaused) vehicle.Report("a", kPaused);
    if (status == kFinished) vehicle.Report("a", kFinished);
    if (status == kFailed || status == kRetriable) vehicle.Report("a", kFailed);
    if (status == kFailed && is_3()) vehicle.Instant("skipRetry", {{"actionId", ParameterValue::Of("a")}});
    EXPECT_EQ(vehicle.StatusOf("a"), status);
    return vehicle;
  };
  std::vector<ActionStatus> statuses = {kWaiting, kInitializing, kRunning, kPaused, kFinished, kFailed};
  if (is_3()) statuses.push_back(kRetriable);
  for (const ActionStatus status : statuses) {
    for (const std::string type : {"pick", "blink"}) {
      const bool may = type == "pick";  // be paused and cancelled
      TestVehicle vehicle = prepared(status, type);
      EXPECT_EQ(vehicle.Instant("startPause"), kFinished);
      const bool pauses = may && (status == kInitializing || status == kRunning);
      EXPECT_EQ(vehicle.StatusOf("a"), pauses ? kPaused : status) << NameOf(status) << type;
      EXPECT_FALSE(vehicle.may_drive());
      EXPECT_EQ(vehicle.Instant("stopPause"), kFinished);
      EXPECT_EQ(vehicle.StatusOf("a"), pauses || status == kPaused ? kRunning : status);

      vehicle = prepared(status, type);
      const bool goes_on = !may && (status == kInitializing || status == kRunning || status == kPaused);
      EXPECT_EQ(vehicle.Instant("cancelOrder"), goes_on ? kRunning : kFinished) << NameOf(status) << type;
      EXPECT_EQ(vehicle.StatusOf("a"), goes_on || status == kFinished ? status : kFailed);
      if (goes_on) {
        EXPECT_EQ(vehicle.SendPlaces("o2", 0, "AB", 2), "other_order_active");
        vehicle.Report("a", kFinished);
        EXPECT_EQ(vehicle.StatusOf("a"), kFinished);
        EXPECT_EQ(vehicle.StatusOf("cancelOrder1"), kFinished);
      }
      EXPECT_EQ(vehicle.SendPlaces("o3", 0, "AB", 2), "new_order");

      vehicle = prepared(status, type);
      vehicle.Give(DrivingChanged{true});  // by a person
      vehicle.Give(ModeChanged{OperatingMode::kManual});
      EXPECT_EQ(vehicle.memory.mode, goes_on ? OperatingMode::kAutomatic : OperatingMode::kManual);
      EXPECT_EQ(vehicle.Nodes(), goes_on ? "B2+" : "");
      vehicle.Report("a", kFinished);
      EXPECT_EQ(vehicle.memory.mode, OperatingMode::kManual);
      EXPECT_EQ(vehicle.Nodes(), "");

      for (const ActionStatus report : {kWaiting, kInitializing, kRunning, kPaused, kRetriable, kFinished, kFailed}) {
        vehicle = prepared(status, type);
        vehicle.Report("a", report);
        const ActionStatus now = vehicle.StatusOf("a");
        if (IsFinal(status) || status == kWaiting) EXPECT_EQ(now, status);
        if (now == kWaiting) EXPECT_EQ(status, kWaiting);
        if (report == kFinished && IsStarted(status)) EXPECT_EQ(now, kFinished);
        if (report == kFailed && IsStarted(status)) EXPECT_EQ(now, is_3() ? kRetriable : kFailed);
      }
    }
  }
}

TEST_P(EachVersion, APauseIsFinishedWhenTheVehicleStands) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "AB", 2);
  vehicle.Give(DrivingChanged{true});
  EXPECT_EQ(vehicle.Instant("startPause"), kRunning);
  EXPECT_FALSE(vehicle.may_drive());
  vehicle.Give(DrivingChanged{false});
  EXPECT_EQ(vehicle.StatusOf("startPause1"), kFinished);
  vehicle.Give(PauseChanged{false});
  EXPECT_TRUE(vehicle.may_drive());
  vehicle.Give(PauseChanged{true});
  EXPECT_FALSE(vehicle.may_drive());
  EXPECT_TRUE(*MakeState(vehicle.memory, vehicle.profile, vehicle.readings).paused);
}

TEST_P(EachVersion, InstantActionsInEveryMode) {
  for (int i = 0; i < 7; ++i) {
    const OperatingMode mode = static_cast<OperatingMode>(i);
    TestVehicle vehicle(GetParam());
    vehicle.SendPlaces("o1", 0, "AB", 2);
    vehicle.Give(ModeChanged{mode});
    const bool is_automatic = mode == OperatingMode::kAutomatic || mode == OperatingMode::kSemiautomatic;
    const bool keeps = is_automatic || (is_3() && mode == OperatingMode::kIntervened);
    EXPECT_EQ(vehicle.Nodes(), keeps ? "B2+" : "") << NameOf(mode);
    EXPECT_EQ(vehicle.may_drive(), is_automatic);
    EXPECT_EQ(vehicle.Instant("stateRequest"), kFinished);
    EXPECT_EQ(vehicle.Instant("stopPause"), is_automatic ? kFinished : kFailed) << NameOf(mode);
    EXPECT_EQ(vehicle.Instant("fly"), kFailed);
    EXPECT_THAT(vehicle.Errors(), testing::Contains("INVALID_INSTANT_ACTION"));
    EXPECT_EQ(vehicle.Instant("cancelOrder"), keeps ? kFinished : kFailed) << NameOf(mode);
    const bool forgets = is_3() && (mode == OperatingMode::kService || mode == OperatingMode::kTeachIn ||
                                    mode == OperatingMode::kStartup);
    EXPECT_EQ(vehicle.memory.last_node_id, forgets ? "" : "A") << NameOf(mode);
    vehicle.Give(ModeChanged{OperatingMode::kAutomatic});
    EXPECT_EQ(vehicle.SendPlaces("o2", 0, "AB", 2), "new_order") << NameOf(mode);
  }
}

TEST_P(EachVersion, AResentInstantActionHasNoEffect) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "AB", 2);
  const InstantActionsReceived cancel = {{SampleHeader(GetParam()), {SampleActionOf("cancelOrder", "c", kNone)}}, {}};
  vehicle.Give(cancel);
  vehicle.SendPlaces("o2", 0, "AB", 2);
  const VehicleMemory before = vehicle.memory;
  if (is_3()) {
    vehicle.Give(cancel);
    EXPECT_TRUE(vehicle.memory == before);
  }
}

TEST_P(EachVersion, InstantActionsFillTheStateOnlyToItsLimit) {
  TestVehicle vehicle(GetParam());
  for (int i = 0; i < 1'200; ++i) {
    const Action action = SampleActionOf("stateRequest", "x" + std::to_string(i), kNone);
    vehicle.Give(InstantActionsReceived{{SampleHeader(GetParam()), {action}}, {}});
  }
  EXPECT_EQ(vehicle.memory.instant_actions.size(), 1'000u);
  EXPECT_THAT(vehicle.Errors(), ElementsAre("INSTANT_ACTION_STATES_FULL"));
  if (is_3()) {
    // There is room for the one that makes room.
    EXPECT_EQ(vehicle.Instant("clearInstantActions"), kFinished);
    EXPECT_EQ(vehicle.memory.instant_actions.size(), 1u);
  } else {
    vehicle.SendPlaces("o1", 0, "AB", 2);
    EXPECT_EQ(vehicle.memory.instant_actions.size(), 0u);
  }
}

TEST_P(EachVersion, Maps) {
  TestVehicle vehicle(GetParam());
  const auto of = [](const std::string& version) {
    return std::vector<ActionParameter>{{"mapId", ParameterValue::Of("L1")},
                                        {"mapVersion", ParameterValue::Of(version)}};
  };
  EXPECT_EQ(vehicle.Instant("enableMap", of("3")), kFailed);
  EXPECT_EQ(vehicle.Instant("deleteMap", of("1")), kFailed);
  EXPECT_EQ(vehicle.Instant("enableMap", of("2")), kFinished);
  EXPECT_EQ(vehicle.memory.maps[0].status, StoredStatus::kDisabled);
  EXPECT_EQ(vehicle.Instant("deleteMap", of("1")), kFinished);
  EXPECT_EQ(vehicle.memory.maps.size(), 1u);
  EXPECT_EQ(vehicle.Instant("downloadMap", of("2")), kFailed);
  EXPECT_THAT(vehicle.Errors(), ElementsAre("DUPLICATE_MAP"));
  EXPECT_EQ(vehicle.Instant("downloadMap", of("4")), kInitializing);
  vehicle.Report("downloadMap" + std::to_string(vehicle.instants), kFinished);
  EXPECT_EQ(vehicle.memory.maps.back(), (MapState{"L1", "4", {}, StoredStatus::kDisabled}));
  EXPECT_EQ(vehicle.Instant("enableMap"), kFailed);
}

TEST_P(EachVersion, APositionIsSetWhereThereIsNoOrder) {
  TestVehicle vehicle(GetParam());
  EXPECT_EQ(vehicle.Instant("initPosition", {{"lastNodeId", ParameterValue::Of("C")}}), kInitializing);
  vehicle.Report("initPosition1", kFinished);
  EXPECT_EQ(vehicle.memory.last_node_id, "C");
  EXPECT_EQ(vehicle.SendPlaces("o1", 0, "CB", 2), "new_order");
}

TEST(VehicleOf3, ATriggerAndARetry) {
  TestVehicle vehicle(Version::k3_0);
  Order order = SampleOrder(Version::k3_0, "o1", 0, "AB", 2);
  order.nodes[0].actions = {SampleActionOf("waitForTrigger", "w"), SampleActionOf("pick", "p")};
  order.nodes[0].actions[1].retriable = true;
  vehicle.Send(order);
  EXPECT_EQ(vehicle.StatusOf("w"), kRunning);
  EXPECT_EQ(vehicle.Instant("trigger"), kFinished);
  EXPECT_EQ(vehicle.Instant("trigger"), kFailed);
  vehicle.Give(
      ActionProgress{"p", kFailed, "empty", VehicleError{"noLoad", {}, {}, {}, {}, {}, ErrorLevel::kCritical}});
  EXPECT_EQ(vehicle.StatusOf("p"), kRetriable);
  EXPECT_THAT(vehicle.Errors(), ElementsAre("noLoad"));
  EXPECT_EQ(vehicle.Instant("retry", {{"actionId", ParameterValue::Of("p")}}), kFinished);
  EXPECT_EQ(vehicle.StatusOf("p"), kRunning);
  EXPECT_THAT(vehicle.Errors(), IsEmpty());
  vehicle.Report("p", kFailed);
  EXPECT_EQ(vehicle.Instant("skipRetry", {{"actionId", ParameterValue::Of("p")}}), kFinished);
  EXPECT_EQ(vehicle.StatusOf("p"), kFailed);
}

TEST_P(EachVersion, ACriticalErrorHoldsTheOrder) {
  TestVehicle vehicle(GetParam());
  vehicle.SendPlaces("o1", 0, "AB", 2);
  vehicle.Give(ErrorRaised{{"blocked", {}, {}, {}, {}, {}, ErrorLevel::kCritical}});
  EXPECT_FALSE(vehicle.may_drive());
  EXPECT_EQ(vehicle.Nodes(), "B2+");
  vehicle.Give(ErrorCleared{"blocked"});
  EXPECT_TRUE(vehicle.may_drive());
}

TEST_P(EachVersion, TheMemoryIsKeptAsText) {
  TestVehicle vehicle(GetParam());
  for (const RowCase& each : RowCases(GetParam())) {
    TestVehicle other(GetParam());
    other.Send(each.prepare(other));
    const Result<VehicleMemory> restored = RestoreMemory(SaveMemory(other.memory));
    ASSERT_TRUE(restored.ok()) << restored.error().ToString();
    EXPECT_TRUE(restored.value() == other.memory) << each.row;
  }
  EXPECT_FALSE(RestoreMemory("").ok());
  EXPECT_FALSE(RestoreMemory("{\"orderId\": 1}").ok());
}

TEST_P(EachVersion, AStateIsDueOnChangesAndInTime) {
  TestVehicle vehicle(GetParam());
  const State before = MakeState(vehicle.memory, vehicle.profile, vehicle.readings);
  State moved = before;
  moved.position->x = 3.0;
  TimingLimits timing;
  timing.minimum_state_interval = 0.5;
  EXPECT_FALSE(IsStateDue(before, 0, moved, 29'000, timing));
  EXPECT_TRUE(IsStateDue(before, 0, moved, 30'000, timing));
  timing.default_state_interval = 10.0;
  EXPECT_TRUE(IsStateDue(before, 0, moved, 10'000, timing));
  vehicle.SendPlaces("o1", 0, "AB", 2);
  const State now = MakeState(vehicle.memory, vehicle.profile, vehicle.readings);
  EXPECT_FALSE(IsStateDue(before, 0, now, 400, timing));
  EXPECT_TRUE(IsStateDue(before, 0, now, 500, timing));
  EXPECT_THAT(ReasonsToSend(before, now), ElementsAre("orderId", "lastNodeId", "nodeStates", "edgeStates"));
}

}  // namespace
}  // namespace troupe::fleet
