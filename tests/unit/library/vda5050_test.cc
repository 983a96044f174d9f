// The controller `vda5050` in whole simulations: orders and instant actions as a fleet control sends them, in
// worlds/fleet_hall.world. Each message of both sides goes through the checker of fleet/checker.h, too.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fleet/checker.h"
#include "fleet/codec.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

using fleet::ActionStatus;
using testing::HasSubstr;
using testing::IsEmpty;

// A node of an order with a place and the actions there.
struct Stop {
  std::string id;
  double x = 0.0;
  double y = 0.0;
  std::vector<fleet::Action> actions = {};
  std::optional<double> theta = {};
};

fleet::Action ActionOf(const std::string& type, const std::string& id,
                       const std::vector<std::pair<std::string, std::string>>& parameters = {},
                       fleet::BlockingType blocking = fleet::BlockingType::kHard) {
  fleet::Action action;
  action.type = type;
  action.id = id;
  action.blocking_type = blocking;
  if (!parameters.empty()) action.parameters.emplace();
  for (const auto& [key, value] : parameters) {
    action.parameters->push_back({key, fleet::ParameterValue::Of(value)});
  }
  return action;
}

std::string WorldsPath(const std::string& name) {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/" + name;
}

class FleetOfHall {
 public:
  explicit FleetOfHall(const std::string& robot = "cart_1", fleet::Version version = fleet::Version::k2_1,
                       const std::string& file = WorldsPath("scenarios/vda5050.json"))
      : version_(version), robot_name_(robot), simulation_(Load(file)) {
    robot_ = *simulation_.FindRobot(robot);
  }

  Simulation& simulation() { return simulation_; }
  RobotId robot() const { return robot_; }
  const fleet::State& state() const { return *state_; }
  const std::vector<std::string>& verdicts() const { return verdicts_; }
  std::size_t states() const { return states_; }
  Pose pose() const { return simulation_.pose(robot_); }

  Vec2 PlaceOf(const std::string& entity) const { return simulation_.FindPose(entity).value().translation(); }

  void Step(Tick ticks = 1) {
    for (Tick i = 0; i < ticks; ++i) {
      simulation_.Step();
      for (const Simulation::FleetOutput& output : simulation_.fleet_outputs()) {
        if (output.robot != robot_) continue;
        if (states_ == 0) Check("connection", OnlineText());
        Check(std::string(NameOf(output.message.topic)), output.message.text);
        if (output.message.topic != FleetTopic::kState) continue;
        const fleet::Decoded<fleet::State> decoded = fleet::Decode<fleet::State>(output.message.text, version_);
        EXPECT_THAT(decoded.faults, IsEmpty()) << output.message.text;
        EXPECT_THAT(decoded.lenient, IsEmpty()) << output.message.text;
        state_ = decoded.message;
        ++states_;
      }
    }
  }

  // Steps until it is true; false after `seconds` of simulated time.
  bool StepUntil(const std::function<bool()>& is_true, double seconds = 60.0) {
    const double end = simulation_.time() + seconds;
    while (!(state_ && is_true())) {
      if (simulation_.time() > end) return false;
      Step();
    }
    return true;
  }

  // With the newest order.
  bool IsDone() const {
    return state_->order_id == order_id_ && state_->order_update_id == order_update_id_ &&
           state_->node_states.empty() && !HasOpenAction();
  }
  bool HasOpenAction() const {
    for (const fleet::ActionState& action : state_->action_states) {
      if (!fleet::IsFinal(action.status)) return true;
    }
    return false;
  }
  ActionStatus StatusOf(const std::string& id) const {
    for (const auto* const list : {&state_->action_states, &state_->instant_action_states}) {
      for (const fleet::ActionState& action : *list) {
        if (action.action_id == id) return action.status;
      }
    }
    for (const fleet::ActionState& action : ZoneActions()) {
      if (action.action_id == id) return action.status;
    }
    ADD_FAILURE() << "no action " << id;
    return ActionStatus::kWaiting;
  }
  std::vector<fleet::ActionState> ZoneActions() const {
    return state_->zone_action_states.value_or(std::vector<fleet::ActionState>());
  }
  bool HasError(const std::string& type) const {
    for (const fleet::VehicleError& error : state_->errors) {
      if (error.type == type) return true;
    }
    return false;
  }

  fleet::Order OrderOf(const std::string& id, const std::vector<Stop>& stops) const {
    fleet::Order order;
    order.order_id = id;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const Stop& stop = stops[i];
      fleet::Node node;
      node.id = stop.id;
      node.sequence_id = static_cast<std::uint32_t>(2 * i);
      node.released = true;
      node.position.emplace();
      node.position->x = stop.x;
      node.position->y = stop.y;
      node.position->theta = stop.theta;
      node.position->map_id = "hall";
      node.actions = stop.actions;
      if (i > 0) {
        fleet::Edge edge;
        edge.id = stops[i - 1].id + "-" + stop.id;
        edge.sequence_id = static_cast<std::uint32_t>(2 * i - 1);
        edge.released = true;
        edge.start_node_id = stops[i - 1].id;
        edge.end_node_id = stop.id;
        order.edges.push_back(edge);
      }
      order.nodes.push_back(node);
    }
    return order;
  }

  void Send(fleet::Order order) {
    order.header = Header(orders_);
    order_id_ = order.order_id;
    order_update_id_ = order.order_update_id;
    Give(FleetTopic::kOrder, fleet::Encode(order, version_));
  }
  void Send(const std::vector<fleet::Action>& actions) {
    fleet::InstantActions message;
    message.header = Header(instant_actions_);
    message.actions = actions;
    Give(FleetTopic::kInstantActions, fleet::Encode(message, version_));
  }
  void Send(fleet::ZoneSet set) {
    set.header = Header(zone_sets_);
    Give(FleetTopic::kZoneSet, fleet::Encode(set, version_));
  }
  // To the first request of its state.
  void Respond(fleet::GrantType grant, std::optional<double> lease_seconds = {}) {
    fleet::Responses message;
    message.header = Header(responses_);
    fleet::RequestResponse response{state_->zone_requests.value().front().id, grant, {}};
    if (lease_seconds) {
      response.lease_expiry = fleet::FormatTimestamp(Now() + std::llround(*lease_seconds * 1e3), version_);
    }
    message.responses = {response};
    Give(FleetTopic::kResponses, fleet::Encode(message, version_));
  }
  // Without the checker, which would blame the fleet control.
  void SendText(FleetTopic topic, const std::string& text) {
    EXPECT_TRUE(simulation_.SendMessage(robot_, {topic, text}).ok());
  }

 private:
  static Simulation Load(const std::string& file) {
    Result<Simulation> loaded = Simulation::Load(file);
    if (!loaded.ok()) throw std::runtime_error(loaded.error().ToString());
    return std::move(loaded).value();
  }

  std::int64_t Now() const {
    return *fleet::ParseTimestamp("2026-01-01T00:00:00Z") + std::llround(simulation_.time() * 1e3);
  }
  fleet::Header Header(std::uint32_t& count) const {
    return {count++, fleet::FormatTimestamp(Now(), version_), fleet::VersionText(version_), "Troupe", robot_name_};
  }
  std::string OnlineText() {
    fleet::Connection message;
    message.header = Header(connections_);
    message.state = fleet::ConnectionState::kOnline;
    return fleet::Encode(message, version_);
  }
  void Check(const std::string& topic, const std::string& text) {
    fleet::ObservedMessage message;
    message.manufacturer = "Troupe";
    message.serial_number = robot_name_;
    message.topic = *FindByName<fleet::Topic>(topic);
    message.payload = text;
    message.milliseconds = Now();
    fleet::CheckerOptions options;
    options.version = version_;
    for (const fleet::Verdict& verdict : fleet::CheckMessage(checker_, message, options)) {
      verdicts_.push_back(verdict.ToString());
    }
  }
  void Give(FleetTopic topic, const std::string& text) {
    Check(std::string(NameOf(topic)), text);
    SendText(topic, text);
  }

  fleet::Version version_;
  std::string robot_name_;
  Simulation simulation_;
  RobotId robot_;
  std::optional<fleet::State> state_;
  std::size_t states_ = 0;
  fleet::CheckerMemory checker_;
  std::vector<std::string> verdicts_;
  std::string order_id_;
  std::uint32_t order_update_id_ = 0;
  std::uint32_t orders_ = 0;
  std::uint32_t instant_actions_ = 0;
  std::uint32_t connections_ = 0;
  std::uint32_t zone_sets_ = 0;
  std::uint32_t responses_ = 0;
};

// From where cart_1 stands.
const std::vector<Stop> kToTheEast = {{"w", -3.0, 0.0}, {"m", 0.0, 0.0}, {"e", 3.0, 0.0}};

TEST(Vda5050, DrivesItsBaseAndReportsEachNode) {
  FleetOfHall fleet;
  fleet.Step();
  EXPECT_EQ(fleet.states(), 1U);
  fleet.Send(fleet.OrderOf("o1", kToTheEast));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().last_node_id == "m"; }));
  EXPECT_NEAR(fleet.pose().x, 0.0, 0.2);  // it drives on
  EXPECT_TRUE(fleet.state().driving);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone() && !fleet.state().driving; }));
  EXPECT_EQ(fleet.state().last_node_id, "e");
  EXPECT_NEAR(fleet.pose().x, 3.0, 0.03);
  EXPECT_NEAR(fleet.pose().y, 0.0, 0.03);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
  EXPECT_THAT(fleet.simulation().failures(), IsEmpty());
}

TEST(Vda5050, StopsAtTheEndOfItsBase) {
  FleetOfHall fleet;
  fleet.Step();
  fleet::Order order = fleet.OrderOf("o1", kToTheEast);
  order.nodes[2].released = order.edges[1].released = false;
  fleet.Send(order);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().last_node_id == "m" && !fleet.state().driving; }));
  fleet.Step(100);
  EXPECT_NEAR(fleet.pose().x, 0.0, 0.03);
  EXPECT_TRUE(fleet.state().new_base_request.value_or(false));
  // The update begins with the end of the base.
  fleet::Order update = fleet.OrderOf("o1", {kToTheEast[1], kToTheEast[2]});
  update.order_update_id = 1;
  update.nodes[0].sequence_id = 2;
  update.edges[0].sequence_id = 3;
  update.nodes[1].sequence_id = 4;
  fleet.Send(update);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone() && fleet.state().last_node_id == "e"; }));
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, CarriesAPalletFromRackToRack) {
  for (const fleet::Version version : {fleet::Version::k2_1, fleet::Version::k3_0}) {
    FleetOfHall fleet(version == fleet::Version::k2_1 ? "cart_1" : "cart_2", version);
    // The other one makes room.
    const char* const other = version == fleet::Version::k2_1 ? "cart_2" : "cart_1";
    ASSERT_TRUE(fleet.simulation().SetPose(other, {-6.0, -3.0, 0.0, 0.0}).ok());
    fleet.Step();
    const Stop start = {"s", fleet.pose().x, fleet.pose().y};
    fleet.Send(fleet.OrderOf("o1", {start,
                                    {"a", -5.0, 1.0, {ActionOf("pick", "p1", {{"loadId", "pallet_1"}})}, 0.0},
                                    {"b", 5.0, 1.0, {ActionOf("drop", "d1", {{"stationName", "rack_b"}})}}}));
    ASSERT_TRUE(fleet.StepUntil([&] { return !fleet.state().loads->empty(); }));
    EXPECT_EQ(fleet.state().loads->front().id, "pallet_1");
    EXPECT_EQ(fleet.StatusOf("p1"), ActionStatus::kFinished);
    ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); })) << fleet.pose().x;
    EXPECT_EQ(fleet.StatusOf("d1"), ActionStatus::kFinished);
    EXPECT_THAT(*fleet.state().loads, IsEmpty());
    EXPECT_LT((fleet.PlaceOf("pallet_1") - Vec2(5.0, 2.2)).norm(), 0.01);
    fleet.Step(20);
    EXPECT_NEAR(fleet.simulation().FindPose("pallet_1").value().z, 0.25, 1e-6);  // on the rack
    EXPECT_THAT(fleet.verdicts(), IsEmpty());
  }
}

TEST(Vda5050, AGripperTakesWhatIsBetweenItsFingers) {
  const std::string file = testing::TempDir() + "vda5050_test.world";
  std::ofstream(file) << "include \"" << WorldsPath("include/grippers.inc") << R"("
    stacker( name "s1" pose [0 0 0 0] ctrl "vda5050 map=hall" )
    cube( name "cube" pose [1.4 0 0 0] ))";
  FleetOfHall fleet("s1", fleet::Version::k2_1, file);
  fleet.Step();
  fleet.Send(
      fleet.OrderOf("o1", {{"a", 0.0, 0.0, {ActionOf("pick", "p0")}}, {"b", 1.0, 0.0, {ActionOf("pick", "p1")}}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("p0"), ActionStatus::kFailed);  // nothing is there
  EXPECT_TRUE(fleet.HasError("loadNotFound"));
  EXPECT_EQ(fleet.StatusOf("p1"), ActionStatus::kFinished);
  ASSERT_EQ(fleet.state().loads->size(), 1U);
  EXPECT_EQ(fleet.state().loads->front().id, "cube");
  EXPECT_GT(fleet.simulation().FindPose("cube").value().z, 0.5);
  fleet.Send(fleet.OrderOf("o2", {{"b", 1.0, 0.0}, {"c", 0.5, 0.0, {ActionOf("drop", "d1")}}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("d1"), ActionStatus::kFinished);
  EXPECT_THAT(*fleet.state().loads, IsEmpty());
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, FailsWithoutALoadOrRoomForIt) {
  FleetOfHall fleet;
  fleet.Step();
  const Stop start = {"s", -3.0, 0.0};
  fleet.Send(fleet.OrderOf("o1", {start, {"m", 0.0, 0.0, {ActionOf("pick", "p1")}}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("p1"), ActionStatus::kFailed);
  EXPECT_TRUE(fleet.HasError("loadNotFound"));
  fleet.Send(fleet.OrderOf("o2", {{"m", 0.0, 0.0},
                                  {"a", -5.0, 1.0, {ActionOf("pick", "p2", {{"loadId", "pallet_1"}})}},
                                  {"a2", -4.6, 1.0, {ActionOf("drop", "d2", {{"stationName", "pallet_2"}})}}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("p2"), ActionStatus::kFinished);
  EXPECT_EQ(fleet.StatusOf("d2"), ActionStatus::kFailed);
  EXPECT_TRUE(fleet.HasError("noRoomForLoad"));
  EXPECT_EQ(fleet.state().loads->size(), 1U);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, StandsBeforeAnObstacleAndReportsIt) {
  FleetOfHall fleet;
  ASSERT_TRUE(fleet.simulation().SetPose("pallet_2", {1.0, 0.0, 0.0, 0.0}).ok());
  fleet.Step();
  fleet.Send(fleet.OrderOf("o1", kToTheEast));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("pathBlocked"); }));
  EXPECT_THAT(*fleet.state().errors.front().description, HasSubstr("pallet_2"));
  EXPECT_LT(fleet.pose().x, 0.4);
  EXPECT_FALSE(fleet.simulation().state().robots[fleet.robot().index()].stalled);
  ASSERT_TRUE(fleet.simulation().SetPose("pallet_2", {1.0, 3.0, 0.0, 0.0}).ok());
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_FALSE(fleet.HasError("pathBlocked"));
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, ChargesAtAChargerOnly) {
  FleetOfHall fleet;
  fleet.Step();
  fleet.Send({ActionOf("startCharging", "c0")});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().action_states.size() == 1 && !fleet.HasOpenAction(); }));
  EXPECT_EQ(fleet.StatusOf("c0"), ActionStatus::kFailed);
  EXPECT_TRUE(fleet.HasError("notAtCharger"));
  fleet.Send(fleet.OrderOf("o1", {kToTheEast[0], kToTheEast[1], {"c", 0.0, -2.8, {ActionOf("startCharging", "c1")}}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("c1"), ActionStatus::kFinished);
  EXPECT_TRUE(fleet.state().power_supply.charging);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, StandsWithAnEmptyBattery) {
  const std::string file = testing::TempDir() + "vda5050_test.world";
  std::ofstream(file) << R"(position( name "s1" pose [0 0 0 0] size [0.5 0.5 0.3] drive "diff" kjoules 0.05 watts 5
    ctrl "vda5050 map=hall" ))";
  FleetOfHall fleet("s1", fleet::Version::k2_1, file);
  fleet.Step();
  fleet.Send(fleet.OrderOf("o1", {{"a", 0.0, 0.0}, {"b", 50.0, 0.0}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("batteryEmpty"); }));
  EXPECT_EQ(fleet.state().errors.front().level, fleet::ErrorLevel::kFatal);
  EXPECT_EQ(fleet.state().power_supply.state_of_charge, 0.0);
  fleet.Step(10);
  EXPECT_FALSE(fleet.state().driving);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, PausesGoesOnAndCancels) {
  FleetOfHall fleet;
  fleet.Step();
  fleet.Send(fleet.OrderOf("o1", kToTheEast));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.pose().x > -2.0; }));
  fleet.Send({ActionOf("startPause", "i1")});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().paused.value_or(false) && !fleet.state().driving; }));
  const double x = fleet.pose().x;
  fleet.Step(50);
  EXPECT_EQ(fleet.pose().x, x);
  EXPECT_EQ(fleet.StatusOf("i1"), ActionStatus::kFinished);
  fleet.Send({ActionOf("stopPause", "i2")});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.pose().x > x + 0.5; }));
  fleet.Send({ActionOf("cancelOrder", "i3")});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().node_states.empty(); }));
  EXPECT_EQ(fleet.StatusOf("i3"), ActionStatus::kFinished);
  EXPECT_EQ(fleet.state().order_id, "o1");
  EXPECT_LT(fleet.pose().x, 0.0);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, IsManualWhileAUserDrivesIt) {
  FleetOfHall fleet;
  fleet.Step();
  fleet.Send(fleet.OrderOf("o1", kToTheEast));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.pose().x > -2.5; }));
  ASSERT_TRUE(fleet.simulation().DriveBy(fleet.robot(), {-0.2, 0.0, 0.0}).ok());
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().operating_mode == fleet::OperatingMode::kManual; }));
  EXPECT_THAT(fleet.state().node_states, IsEmpty());
  fleet.simulation().Release(fleet.robot());
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().operating_mode == fleet::OperatingMode::kAutomatic; }));
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, FollowsACurveWithTheSpeedOfTheEdge) {
  FleetOfHall fleet;
  fleet.Step();
  fleet::Order order = fleet.OrderOf("o1", {{"w", -3.0, 0.0}, {"n", 0.0, 2.0}});
  // A quarter of an ellipse, as a rational curve of degree 2.
  fleet::Trajectory& curve = order.edges[0].trajectory.emplace();
  curve.degree = 2;
  curve.knot_vector = {{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}};
  curve.control_points = {{-3.0, 0.0, 1.0}, {0.0, 0.0, std::sqrt(0.5)}, {0.0, 2.0, 1.0}};
  order.edges[0].maximum_speed = 0.4;
  fleet.Send(order);
  double worst = 0.0;
  double fastest = 0.0;
  ASSERT_TRUE(fleet.StepUntil([&] {
    const Pose pose = fleet.pose();
    const double dx = (pose.x + 3.0) / 3.0;
    const double dy = (pose.y - 2.0) / 2.0;
    worst = std::max(worst, std::fabs(std::sqrt(dx * dx + dy * dy) - 1.0));
    fastest = std::max(fastest, fleet.simulation().state().robots[fleet.robot().index()].twist.vx);
    return fleet.state().last_node_id == "n";
  }));
  EXPECT_LT(worst, 0.05);
  EXPECT_NEAR(fastest, 0.4, 0.01);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

// A zone between x = -0.5 and 0.5, which crosses the way of cart_2 along y = -1.5.
fleet::ZoneSet ZoneOf(const std::string& id, fleet::ZoneType type) {
  fleet::ZoneSet set;
  set.map_id = "hall";
  set.zone_set_id = id;
  fleet::Zone zone;
  zone.id = "z";
  zone.type = type;
  zone.vertices = {{-0.5, -3.0}, {0.5, -3.0}, {0.5, 0.0}, {-0.5, 0.0}};
  if (type == fleet::ZoneType::kRelease) zone.release_loss_behavior = fleet::ZoneLoss::kStop;
  if (type == fleet::ZoneType::kSpeedLimit) zone.maximum_speed = 0.3;
  if (type == fleet::ZoneType::kAction) {
    zone.entry_actions = {{{"waitForTrigger", {}, fleet::BlockingType::kHard, {}, {}}}};
    zone.during_actions = {{{"waitForTrigger", {}, fleet::BlockingType::kNone, {}, {}}}};
    zone.exit_actions = {{{"detectObject", {}, fleet::BlockingType::kNone, {}, {}}}};
  }
  if (type == fleet::ZoneType::kDirected) zone.directed_limitation = fleet::DirectionLimit::kStrict;
  if (type == fleet::ZoneType::kBidirected) zone.bidirected_limitation = fleet::DirectionLimit::kRestricted;
  if (type == fleet::ZoneType::kDirected || type == fleet::ZoneType::kBidirected) zone.direction = 0.0;  // east
  set.zones = {zone};
  return set;
}

// With an enabled zone, and an order through it.
struct FleetWithZone : FleetOfHall {
  explicit FleetWithZone(fleet::ZoneType type) : FleetOfHall("cart_2", fleet::Version::k3_0) {
    Step();
    Send(ZoneOf("set", type));
    Send({ActionOf("enableZoneSet", "e1", {{"zoneSetId", "set"}}, fleet::BlockingType::kNone)});
    Step(2);
    EXPECT_EQ(StatusOf("e1"), ActionStatus::kFinished);
    EXPECT_EQ(state().zone_sets->front().status, fleet::StoredStatus::kEnabled);
    fleet::Order order = OrderOf("o1", {{"e", 3.0, -1.5}, {"w", -3.0, -1.5}});
    FleetOfHall::Send(order);
  }
  // Of the circle around its box.
  bool IsInZone() const { return std::fabs(pose().x) < 0.5 + 0.5; }
};

TEST(Vda5050, EntersAZoneOfReleaseOnlyWhenThatIsGranted) {
  FleetWithZone fleet(fleet::ZoneType::kRelease);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().zone_requests.has_value(); }));
  EXPECT_EQ(fleet.state().zone_requests->front().zone_id, "z");
  EXPECT_EQ(fleet.state().zone_requests->front().status, fleet::RequestStatus::kRequested);
  fleet.Step(100);
  EXPECT_FALSE(fleet.state().driving);
  EXPECT_NEAR(fleet.pose().x, 1.1, 0.1);  // before the zone
  fleet.Respond(fleet::GrantType::kQueued);
  fleet.Step(50);
  EXPECT_FALSE(fleet.IsInZone());
  fleet.Respond(fleet::GrantType::kGranted);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsInZone(); }));
  EXPECT_EQ(fleet.state().zone_requests->front().status, fleet::RequestStatus::kGranted);
  // Without its release it stops, until it has it again.
  fleet.Respond(fleet::GrantType::kRevoked);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("RELEASE_LOST") && !fleet.state().driving; }));
  EXPECT_TRUE(fleet.IsInZone());
  EXPECT_EQ(fleet.state().zone_requests->front().status, fleet::RequestStatus::kRevoked);
  fleet.Respond(fleet::GrantType::kGranted);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_FALSE(fleet.HasError("RELEASE_LOST"));
  EXPECT_FALSE(fleet.state().zone_requests.has_value());  // it has left
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, AsksAgainWhenALeaseIsOver) {
  FleetWithZone fleet(fleet::ZoneType::kRelease);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().zone_requests && !fleet.state().driving; }));
  const std::string first = fleet.state().zone_requests->front().id;
  fleet.Respond(fleet::GrantType::kGranted, 0.05);  // over before it is in the zone
  ASSERT_TRUE(
      fleet.StepUntil([&] { return fleet.state().zone_requests && fleet.state().zone_requests->front().id != first; }));
  EXPECT_FALSE(fleet.IsInZone());
  fleet.Respond(fleet::GrantType::kGranted, 600.0);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, KeepsOutOfABlockedZone) {
  FleetWithZone fleet(fleet::ZoneType::kBlocked);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("NODE_UNREACHABLE"); }));
  fleet.Step(100);
  EXPECT_FALSE(fleet.IsInZone());
  EXPECT_FALSE(fleet.state().driving);
  // Another set of this map is enabled in its place.
  fleet::ZoneSet none = ZoneOf("none", fleet::ZoneType::kSpeedLimit);
  none.zones.clear();
  fleet.FleetOfHall::Send(none);
  fleet.FleetOfHall::Send({ActionOf("enableZoneSet", "e2", {{"zoneSetId", "none"}}, fleet::BlockingType::kNone),
                           ActionOf("deleteZoneSet", "x1", {{"zoneSetId", "none"}}, fleet::BlockingType::kNone)});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("x1"), ActionStatus::kFailed);  // it is enabled
  EXPECT_FALSE(fleet.HasError("NODE_UNREACHABLE"));
  // Within a zone that becomes blocked it stands.
  fleet.FleetOfHall::Send(fleet.OrderOf("o2", {{"w", -3.0, -1.5}, {"e", 3.0, -1.5}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return std::fabs(fleet.pose().x) < 0.3; }));
  fleet.FleetOfHall::Send({ActionOf("enableZoneSet", "e3", {{"zoneSetId", "set"}}, fleet::BlockingType::kNone)});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("BLOCKED_ZONE_VIOLATION") && !fleet.state().driving; }));
  EXPECT_TRUE(fleet.IsInZone());
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, IsSlowInAZoneWithASpeedLimit) {
  FleetWithZone fleet(fleet::ZoneType::kSpeedLimit);
  double fastest = 0.0;
  double fastest_inside = 0.0;
  ASSERT_TRUE(fleet.StepUntil([&] {
    const double speed = std::fabs(fleet.simulation().state().robots[fleet.robot().index()].twist.vx);
    fastest = std::max(fastest, speed);
    if (fleet.IsInZone()) fastest_inside = std::max(fastest_inside, speed);
    return fleet.IsDone();
  }));
  EXPECT_NEAR(fastest, 1.0, 0.01);
  EXPECT_NEAR(fastest_inside, 0.3, 0.01);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, ExecutesTheActionsOfAZone) {
  FleetWithZone fleet(fleet::ZoneType::kAction);
  EXPECT_THAT(fleet.ZoneActions(), IsEmpty());
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.ZoneActions().size() == 2; }));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.StatusOf("zone-1") == ActionStatus::kRunning; }));
  EXPECT_TRUE(fleet.IsInZone());
  EXPECT_NEAR(fleet.pose().x, 0.3, 0.1);  // as far behind its border as it brakes
  fleet.Step(50);
  EXPECT_FALSE(fleet.state().driving);
  EXPECT_EQ(fleet.StatusOf("zone-2"), ActionStatus::kWaiting);
  fleet.FleetOfHall::Send({ActionOf("trigger", "t1", {}, fleet::BlockingType::kNone)});
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.StatusOf("zone-2") == ActionStatus::kRunning; }));
  EXPECT_EQ(fleet.StatusOf("zone-1"), ActionStatus::kFinished);
  EXPECT_EQ(fleet.StatusOf("t1"), ActionStatus::kFinished);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.ZoneActions().size() == 3; }));
  EXPECT_FALSE(fleet.IsInZone());
  EXPECT_EQ(fleet.StatusOf("zone-2"), ActionStatus::kFinished);  // with the zone
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_EQ(fleet.StatusOf("zone-3"), ActionStatus::kFailed);  // nothing is there
  EXPECT_TRUE(fleet.HasError("LOAD_NOT_FOUND"));
  fleet.FleetOfHall::Send({ActionOf("clearZoneActions", "c1", {}, fleet::BlockingType::kNone)});
  fleet.Step(2);
  EXPECT_THAT(fleet.ZoneActions(), IsEmpty());
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, DrivesOnlyAGrantedPathThroughAZoneOfCoordinatedReplanning) {
  FleetWithZone fleet(fleet::ZoneType::kCoordinatedReplanning);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().zone_requests && !fleet.state().driving; }));
  const fleet::ZoneRequest request = fleet.state().zone_requests->front();
  EXPECT_EQ(request.type, fleet::ZoneRequestType::kReplanning);
  ASSERT_TRUE(request.trajectory.has_value());
  EXPECT_NEAR(request.trajectory->control_points.back().x, -3.0, 1e-6);
  EXPECT_FALSE(fleet.IsInZone());
  fleet.Respond(fleet::GrantType::kGranted);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsInZone() && fleet.pose().x < 0.5; }));
  // Without its grant it stands, and asks again.
  fleet.Respond(fleet::GrantType::kRevoked);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("PATH_GRANT_LOST") && !fleet.state().driving; }));
  EXPECT_TRUE(fleet.IsInZone());
  ASSERT_TRUE(fleet.StepUntil(
      [&] { return fleet.state().zone_requests && fleet.state().zone_requests->front().id != request.id; }));
  fleet.Respond(fleet::GrantType::kGranted);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_FALSE(fleet.HasError("PATH_GRANT_LOST"));
  EXPECT_FALSE(fleet.state().zone_requests.has_value());
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, DrivesInTheDirectionsOfAZone) {
  // Westward, against the zone.
  FleetWithZone fleet(fleet::ZoneType::kDirected);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError("NODE_UNREACHABLE"); }));
  fleet.Step(100);
  EXPECT_FALSE(fleet.state().driving);
  EXPECT_NEAR(fleet.pose().x, 0.6, 0.1);  // its centre is before the zone
  EXPECT_EQ(fleet.state().errors.front().level, fleet::ErrorLevel::kCritical);
  fleet.FleetOfHall::Send({ActionOf("cancelOrder", "c1", {}, fleet::BlockingType::kNone)});
  ASSERT_TRUE(
      fleet.StepUntil([&] { return fleet.state().node_states.empty() && !fleet.HasError("NODE_UNREACHABLE"); }));
  // A trajectory of the order comes before the zone.
  const Pose at = fleet.pose();
  fleet::Order order = fleet.OrderOf("o2", {{"here", at.x, at.y}, {"w", -3.0, -1.5}});
  fleet::Trajectory& line = order.edges[0].trajectory.emplace();
  line.degree = 1;
  line.control_points = {{at.x, at.y, {}}, {-3.0, -1.5, {}}};
  fleet.FleetOfHall::Send(order);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  // Eastward.
  fleet.FleetOfHall::Send(fleet.OrderOf("o3", {{"w", -3.0, -1.5}, {"e", 3.0, -1.5}}));
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone(); }));
  EXPECT_NEAR(fleet.pose().x, 3.0, 0.1);
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
  // Both ways, and not across.
  FleetWithZone both(fleet::ZoneType::kBidirected);
  ASSERT_TRUE(both.StepUntil([&] { return both.IsDone(); }));
  both.FleetOfHall::Send(both.OrderOf("o2", {{"w", -3.0, -1.5}, {"n", 0.0, 0.6}, {"s", 0.0, -2.0}}));
  ASSERT_TRUE(both.StepUntil([&] { return both.HasError("NODE_UNREACHABLE"); }));
  EXPECT_EQ(both.state().last_node_id, "n");
  EXPECT_THAT(both.verdicts(), IsEmpty());
}

TEST(Vda5050, ItsFactsheetHasTheZonesThatItHeeds) {
  FleetOfHall fleet("cart_2", fleet::Version::k3_0);
  fleet.Step();
  for (const Simulation::FleetOutput& output : fleet.simulation().fleet_outputs()) {
    if (output.robot != fleet.robot() || output.message.topic != FleetTopic::kFactsheet) continue;
    const fleet::Decoded<fleet::Factsheet> sheet =
        fleet::Decode<fleet::Factsheet>(output.message.text, fleet::Version::k3_0);
    ASSERT_TRUE(sheet.ok());
    EXPECT_THAT(*sheet.message.type.supported_zones,
                testing::ElementsAre("BLOCKED", "LINE_GUIDED", "RELEASE", "COORDINATED_REPLANNING", "SPEED_LIMIT",
                                     "ACTION", "DIRECTED", "BIDIRECTED"));
    EXPECT_TRUE(sheet.message.FindAction("detectObject")->IsFor(fleet::ActionScope::kZone));
    return;
  }
  FAIL() << "no factsheet";
}

TEST(Vda5050, ShowsItsPaths) {
  FleetOfHall fleet("cart_2", fleet::Version::k3_0);
  fleet.Step();
  EXPECT_FALSE(fleet.state().planned_path.has_value());
  fleet::Order order = fleet.OrderOf("o1", {{"e", 3.0, -1.5}, {"m", 0.0, -1.5}, {"w", -3.0, -1.5}});
  order.nodes[2].released = order.edges[1].released = false;
  fleet.Send(order);
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().planned_path.has_value(); }));
  const fleet::PlannedPath& planned = *fleet.state().planned_path;
  EXPECT_THAT(*planned.traversed_nodes, testing::ElementsAre("m"));  // of the base
  ASSERT_GE(planned.trajectory.control_points.size(), 2U);
  EXPECT_NEAR(planned.trajectory.control_points.front().x, fleet.state().position->x, 0.2);
  EXPECT_DOUBLE_EQ(planned.trajectory.control_points.back().x, 0.0);
  const std::vector<fleet::Waypoint>& line = fleet.state().intermediate_path->polyline;
  ASSERT_EQ(line.size(), planned.trajectory.control_points.size());
  EXPECT_NEAR(static_cast<double>(*fleet::ParseTimestamp(line.back().eta) - *fleet::ParseTimestamp(line.front().eta)),
              3000.0, 200.0);  // 3 m at 1 m/s
  ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().last_node_id == "m" && !fleet.state().driving; }));
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
}

TEST(Vda5050, StandsBeforeAnEdgeThatIsTooLowForItsLoad) {
  for (const fleet::Version version : {fleet::Version::k2_1, fleet::Version::k3_0}) {
    const bool is_3 = version == fleet::Version::k3_0;
    FleetOfHall fleet(is_3 ? "cart_2" : "cart_1", version);
    ASSERT_TRUE(fleet.simulation().SetPose(is_3 ? "cart_1" : "cart_2", {-6.0, -3.0, 0.0, 0.0}).ok());
    fleet.Step();
    const Stop start = {"s", fleet.pose().x, fleet.pose().y};
    fleet::Order order = fleet.OrderOf(
        "o1", {start, {"a", -5.0, 1.0, {ActionOf("pick", "p1", {{"loadId", "pallet_1"}})}, 0.0}, {"b", 0.0, 1.0}});
    order.edges[0].maximum_robot_height = 0.4;  // the cart is 0.3 m high, the pallet, too
    order.edges[1].maximum_robot_height = 0.4;
    fleet.Send(order);
    const std::string type = is_3 ? "VEHICLE_TOO_HIGH" : "vehicleTooHigh";
    ASSERT_TRUE(fleet.StepUntil([&] { return fleet.HasError(type); }));
    EXPECT_EQ(fleet.StatusOf("p1"), ActionStatus::kFinished);
    fleet.Step(50);
    EXPECT_EQ(fleet.state().last_node_id, "a");
    EXPECT_NEAR(fleet.pose().x, -5.0, 0.1);
    fleet.Send({ActionOf("cancelOrder", "c1", {}, is_3 ? fleet::BlockingType::kNone : fleet::BlockingType::kHard)});
    ASSERT_TRUE(fleet.StepUntil([&] { return fleet.IsDone() && !fleet.HasError(type); }));
    EXPECT_THAT(fleet.verdicts(), IsEmpty());
  }
}

TEST(Vda5050, RejectsWhatItCannotRead) {
  FleetOfHall fleet;
  fleet.Step();
  for (const char* const text : {"", "{", "[]", "{\"orderId\":\"x\"}", "\xff\xfe"}) {
    fleet.SendText(FleetTopic::kOrder, text);
    fleet.Step();
    EXPECT_TRUE(fleet.HasError("validationError")) << text;
    fleet.SendText(FleetTopic::kInstantActions, text);
    fleet.Step();
  }
  EXPECT_THAT(fleet.simulation().failures(), IsEmpty());
  // Beyond all worlds.
  fleet::Order far = fleet.OrderOf("o0", {kToTheEast[0], {"far", 1e300, 0.0}});
  far.header = {0, "2026-01-01T00:00:00.00Z", "2.1.0", "Troupe", "cart_1"};
  fleet.SendText(FleetTopic::kOrder, fleet::Encode(far, fleet::Version::k2_1));
  fleet.Step();
  EXPECT_EQ(fleet.state().order_id, "");
  // Of another major version.
  fleet::Order order = fleet.OrderOf("o1", kToTheEast);
  order.header = {0, "2026-01-01T00:00:00.00Z", "1.1.0", "Troupe", "cart_1"};
  fleet.SendText(FleetTopic::kOrder, fleet::Encode(order, fleet::Version::k2_1));
  fleet.Step();
  EXPECT_TRUE(fleet.HasError("validationError"));
  EXPECT_EQ(fleet.state().order_id, "");
}

// Curves, speeds, orientations and actions by chance; what is blocked is cancelled. The checker finds nothing.
TEST(Vda5050, ExecutesRandomOrders) {
  FleetOfHall fleet;
  ASSERT_TRUE(fleet.simulation().SetPose("cart_2", {6.3, -3.4, 0.0, 0.0}).ok());
  fleet.Step();
  std::uint64_t draws = 0;
  const auto random = [&](double min, double max) { return min + (max - min) * RandomUniform({60, draws++}); };
  int done = 0;
  std::string blocks;
  for (int i = 0; i < 25; ++i) {
    const std::string id = "o" + std::to_string(i);
    std::vector<Stop> stops = {{id + "s", fleet.pose().x, fleet.pose().y}};
    for (int k = 0; k < 3; ++k) {
      Stop& stop = stops.emplace_back(Stop{id + "n" + std::to_string(k), random(-5.0, 5.0), random(-2.0, 0.8)});
      if (random(0.0, 1.0) < 0.3) stop.theta = random(-3.0, 3.0);
      for (const char* const type : {"pick", "drop", "detectObject"}) {
        if (random(0.0, 1.0) > 0.2) continue;
        const auto blocking = random(0.0, 1.0) < 0.5 ? fleet::BlockingType::kHard : fleet::BlockingType::kNone;
        stop.actions.push_back(ActionOf(type, stop.id + type, {}, blocking));
      }
    }
    fleet::Order order = fleet.OrderOf(id, stops);
    for (std::size_t k = 0; k < order.edges.size(); ++k) {
      fleet::Edge& edge = order.edges[k];
      if (random(0.0, 1.0) < 0.5) edge.maximum_speed = random(0.2, 1.5);
      if (random(0.0, 1.0) < 0.2) edge.orientation = kPi;
      if (random(0.0, 1.0) > 0.4) continue;
      fleet::Trajectory& curve = edge.trajectory.emplace();
      curve.degree = 2;
      curve.knot_vector = {{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}};
      curve.control_points = {{stops[k].x, stops[k].y, 1.0},
                              {random(-5.0, 5.0), random(-2.0, 0.8), random(0.5, 2.0)},
                              {stops[k + 1].x, stops[k + 1].y, 1.0}};
    }
    fleet.Send(order);
    if (fleet.StepUntil([&] { return fleet.IsDone() && !fleet.state().driving; }, 120.0)) {
      ++done;
      continue;
    }
    EXPECT_TRUE(fleet.HasError("pathBlocked")) << id;
    for (const fleet::VehicleError& error : fleet.state().errors) blocks += *error.description + "; ";
    fleet.Send({ActionOf("cancelOrder", id + "c")});
    ASSERT_TRUE(fleet.StepUntil([&] { return fleet.state().node_states.empty() && !fleet.state().driving; })) << id;
  }
  EXPECT_GT(done, 10) << blocks;
  EXPECT_THAT(fleet.verdicts(), IsEmpty());
  EXPECT_THAT(fleet.simulation().failures(), IsEmpty());
}

TEST(Vda5050, ContinuesFromASnapshotBitForBit) {
  FleetOfHall fleet;
  fleet.Step();
  fleet.Send(fleet.OrderOf("o1", kToTheEast));
  fleet.Step(40);
  Simulation& simulation = fleet.simulation();
  const Snapshot snapshot = simulation.Save().value();
  std::vector<std::string> texts[2];
  std::uint64_t hashes[2] = {0, 0};
  for (int i = 0; i < 2; ++i) {
    if (i == 1) ASSERT_TRUE(simulation.Restore(snapshot).ok());
    for (int k = 0; k < 100; ++k) {
      simulation.Step();
      for (const Simulation::FleetOutput& output : simulation.fleet_outputs()) texts[i].push_back(output.message.text);
    }
    hashes[i] = simulation.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_FALSE(texts[0].empty());
}

}  // namespace
}  // namespace troupe
