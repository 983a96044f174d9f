// Zones of 3.0 in the memory of a vehicle: the actions of ACTION zones, and requests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fleet/vehicle.h"
#include "fleet/vehicle_zones.h"
#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {
namespace {

using enum ActionStatus;
using enum BlockingType;
using testing::ElementsAre;
using testing::IsEmpty;

struct ZoneVehicle {
  ZoneVehicle() {
    profile.factsheet.type.supported_zones = {"ACTION", "RELEASE"};
    profile.factsheet.features.actions.push_back(
        {.type = "look", .scopes = {ActionScope::kZone}, .pause_allowed = true, .cancel_allowed = true});
    profile.factsheet.features.actions.push_back(
        {.type = "clearZoneActions", .scopes = {ActionScope::kInstant, ActionScope::kNode}});
    ZoneSet set;
    set.map_id = "L1";
    set.zone_set_id = "set";
    set.zones = {{.id = "z", .type = ZoneType::kAction, .vertices = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}}};
    set.zones[0].entry_actions = {{Of("look", kHard)}};
    set.zones[0].during_actions = {{Of("look", kNone)}};
    set.zones[0].exit_actions = {{Of("look", kNone), Of("dance", kNone)}};
    Give(ZoneSetReceived{set, {}});
    EXPECT_EQ(EnableZoneSet(memory, "set"), "");
  }

  static ZoneAction Of(const std::string& type, BlockingType blocking) { return {type, {}, blocking, {}, {}}; }

  void Give(const VehicleInput& input) { Apply(memory, input, profile, readings); }
  void Enter() { Give(ZoneEntered{"set", "z"}); }
  void Leave() { Give(ZoneLeft{"set", "z"}); }
  void Report(const std::string& id, ActionStatus status) { Give(ActionProgress{id, status, {}, {}}); }
  void Instant(const std::string& type) {
    const Action action = SampleActionOf(type, type + std::to_string(++instants), kNone);
    Give(InstantActionsReceived{{SampleHeader(Version::k3_0), {action}}, {}});
  }
  std::vector<ActionStatus> Statuses() const {
    std::vector<ActionStatus> statuses;
    const State state = MakeState(memory, profile, readings);
    for (const ActionState& each : state.zone_action_states.value()) statuses.push_back(each.status);
    return statuses;
  }

  VehicleProfile profile = SampleProfile(Version::k3_0);
  VehicleReadings readings = SampleReadings();
  VehicleMemory memory;
  int instants = 0;
};

TEST(ZonesOfVehicle, ActionsBeginOnEntryAndEndWithTheZone) {
  ZoneVehicle vehicle;
  EXPECT_THAT(vehicle.Statuses(), IsEmpty());  // a list is there all the same
  vehicle.Enter();
  vehicle.Enter();                                                        // it is there already
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kInitializing, kWaiting));  // the first one runs alone
  vehicle.Report("zone-1", kFinished);
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kFinished, kInitializing));
  vehicle.Leave();
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kFinished, kFinished, kInitializing, kFailed));
  ASSERT_EQ(vehicle.memory.errors.size(), 1U);  // it cannot dance
  EXPECT_EQ(vehicle.memory.errors[0].error.type, "INVALID_ZONE_ACTION");
  vehicle.Leave();
  vehicle.Report("zone-3", kFinished);
  vehicle.Instant("clearZoneActions");
  EXPECT_THAT(vehicle.Statuses(), IsEmpty());
  vehicle.Enter();
  EXPECT_EQ(vehicle.memory.zone_actions[0].action.id, "zone-5");
}

TEST(ZonesOfVehicle, ActionsThatNeverBeganFailWithTheZone) {
  ZoneVehicle vehicle;
  vehicle.Give(DrivingChanged{true});  // the first action waits until it stands
  vehicle.Enter();
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kWaiting, kWaiting));
  vehicle.Leave();
  EXPECT_EQ(vehicle.Statuses()[0], kWaiting);  // not one of those that belong to the way through
  EXPECT_EQ(vehicle.Statuses()[1], kFailed);
  vehicle.Give(DrivingChanged{false});
  EXPECT_EQ(vehicle.Statuses()[0], kInitializing);
}

TEST(ZonesOfVehicle, AnActionStopsTheOrderUntilItHasEnded) {
  ZoneVehicle vehicle;
  vehicle.Give(OrderReceived{SampleOrder(Version::k3_0, "o1", 0, "ABC", 3), {}});
  EXPECT_TRUE(MayDrive(vehicle.memory, vehicle.profile));
  vehicle.Give(DrivingChanged{true});
  vehicle.Enter();
  EXPECT_FALSE(MayDrive(vehicle.memory, vehicle.profile));
  vehicle.Give(DrivingChanged{false});
  vehicle.Instant("cancelOrder");  // it is not an action of the order
  EXPECT_THAT(vehicle.memory.nodes, IsEmpty());
  EXPECT_EQ(vehicle.Statuses()[0], kInitializing);
  vehicle.Give(OrderReceived{SampleOrder(Version::k3_0, "o2", 0, "AB", 2), {}});
  EXPECT_EQ(vehicle.memory.order_id, "o2");
  EXPECT_FALSE(MayDrive(vehicle.memory, vehicle.profile));
  vehicle.Report("zone-1", kFinished);
  EXPECT_EQ(vehicle.Statuses()[1], kInitializing);
  EXPECT_TRUE(MayDrive(vehicle.memory, vehicle.profile));
}

TEST(ZonesOfVehicle, APersonWhoTakesOverEndsThem) {
  ZoneVehicle vehicle;
  vehicle.Enter();
  vehicle.Give(ModeChanged{OperatingMode::kManual});
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kFailed, kFailed));
  EXPECT_THAT(vehicle.memory.queue, IsEmpty());
  vehicle.Leave();
  vehicle.Enter();
  EXPECT_EQ(vehicle.Statuses().size(), 2U);  // nothing is triggered
  vehicle.Give(AccessWanted{"set", "z"});
  EXPECT_THAT(vehicle.memory.requests, IsEmpty());
  vehicle.Give(ModeChanged{OperatingMode::kAutomatic});
  vehicle.Leave();
  EXPECT_EQ(vehicle.Statuses().size(), 4U);
}

TEST(ZonesOfVehicle, AnotherSetEndsWhatBelongsToTheOneBefore) {
  ZoneVehicle vehicle;
  vehicle.Enter();
  vehicle.Report("zone-1", kFinished);
  vehicle.Give(AccessWanted{"set", "z", Trajectory()});
  ASSERT_EQ(vehicle.memory.requests.size(), 1U);
  EXPECT_EQ(vehicle.memory.requests[0].request.type, ZoneRequestType::kReplanning);
  ZoneSet other;
  other.map_id = "L1";
  other.zone_set_id = "other";
  vehicle.Give(ZoneSetReceived{other, {}});
  EXPECT_EQ(EnableZoneSet(vehicle.memory, "other"), "");
  EXPECT_THAT(vehicle.Statuses(), ElementsAre(kFinished, kFinished));
  EXPECT_THAT(vehicle.memory.zones_inside, IsEmpty());
  EXPECT_THAT(vehicle.memory.requests, IsEmpty());
  vehicle.Enter();
  EXPECT_THAT(vehicle.memory.zones_inside, IsEmpty());
}

TEST(ZonesOfVehicle, ActionsFillTheStateOnlyToItsLimit) {
  ZoneVehicle vehicle;
  vehicle.profile.factsheet.limits.arrays.zone_action_states = 3;
  vehicle.Enter();
  vehicle.Leave();
  EXPECT_EQ(vehicle.Statuses().size(), 3U);
  ASSERT_EQ(vehicle.memory.errors.size(), 1U);
  EXPECT_EQ(vehicle.memory.errors[0].error.type, "ZONE_ACTION_STATES_FULL");
  EXPECT_EQ(vehicle.memory.errors[0].error.level, ErrorLevel::kUrgent);
}

TEST(ZonesOfVehicle, AreKeptAsText) {
  ZoneVehicle vehicle;
  vehicle.Enter();
  vehicle.Give(AccessWanted{"set", "z", Trajectory()});
  const Result<VehicleMemory> restored = RestoreMemory(SaveMemory(vehicle.memory));
  ASSERT_TRUE(restored.ok()) << restored.error().ToString();
  EXPECT_EQ(restored.value(), vehicle.memory);
}

}  // namespace
}  // namespace troupe::fleet
