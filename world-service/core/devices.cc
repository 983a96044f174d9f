// The devices of a step (step_workspace.h): energy, lights, cameras, radio messages and inertial measurement units.
// They act after all motion of the tick, so that they see the poses in which the tick ends.
//
// The exchange of energy has two parts. SupplyFinder finds each pair of a taking and a giving model that touch, by the
// pieces of their bodies; Exchange moves energy between their stores in the order of the pairs. Pairs are sorted by
// model ids, not by the order in which the indices of space list their pieces: when a giver cannot feed all takers, the
// one with the lower id comes first on every machine and by any number of threads.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "troupe/radio_limits.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr double kReach = 1e-3;          // m: bodies so near touch
constexpr double kWattsOfMotion = 10.0;  // per kg and m/s or rad/s

bool IsEmpty(const Scene& scene, const WorldState& state, std::size_t store) {
  return !scene.world().model(scene.stores()[store].model).power.endless && state.stores[store].joules <= 0.0;
}

// A constant part for the models that the store feeds, and, for a robot, one in proportion to its mass and speed:
// motion that a contact has cut short costs nothing, because the twist is zero then.
double Consumption(const Store& store, const WorldState& state) {
  if (!store.robot) return store.watts;
  const Twist& twist = state.robots[store.robot->index()].twist;
  const double motion = std::abs(twist.vx) + std::abs(twist.vy) + std::abs(twist.wz);
  return store.watts + kWattsOfMotion * store.mass * motion;
}

// Heights are compared first: they are cheap, and most pairs fail there.
bool AreNear(const ConvexPiece& a, const ConvexPiece& b) {
  return std::min(a.z.max, b.z.max) - std::max(a.z.min, b.z.min) >= -kReach &&
         FindNearestPoints(a.vertices, b.vertices).distance <= kReach;
}

// A model that takes, and one that gives and touches it.
struct Supply {
  ModelId taker;
  ModelId giver;
  auto operator<=>(const Supply&) const = default;
};

// Finds who can give to whom in a state. A model touches with its children; models of one body do not touch each other.
class SupplyFinder {
 public:
  explicit SupplyFinder(const StepWorkspace& workspace) : workspace_(workspace) {}

  // In the order of the takers, then of the givers.
  std::vector<Supply> Find() {
    for (const BodyId body : BodiesThatExchange()) {
      for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(body)) FindNear(piece, body);
    }
    // Two models touch by several pieces, and a pair of moving bodies may be found from both sides.
    std::sort(supplies_.begin(), supplies_.end());
    supplies_.erase(std::unique(supplies_.begin(), supplies_.end()), supplies_.end());
    return std::move(supplies_);
  }

 private:
  const WorldDescription& world() const { return workspace_.world(); }

  std::vector<BodyId> BodiesThatExchange() const {
    std::vector<BodyId> bodies;
    for (std::size_t i = 0; i < world().models.size(); ++i) {
      const PowerDescription& power = world().models[i].power;
      const std::optional<BodyId> body = workspace_.scene.body_of(ModelId(i));
      if (body && (power.take_watts > 0.0 || power.give_watts > 0.0)) bodies.push_back(*body);
    }
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    return bodies;
  }

  // The body of the taker finds that of the giver.
  // Static models that give or take are found by the moving bodies: two static models do not feed each other.
  void FindNear(const ConvexPiece& piece, BodyId body) {
    const bool takes = IsPartOf(piece.model, &PowerDescription::take_watts);
    const bool gives = IsPartOf(piece.model, &PowerDescription::give_watts);
    if (!takes && !gives) return;
    const Rectangle box = BoundingBox(piece.vertices).Inflated(kReach);
    NearPieces near;
    workspace_.scene.static_index().Query(box, near);
    for (const ConvexPiece* other : near) {
      if (takes) Connect(piece, *other);
      if (gives) Connect(*other, piece);
    }
    // A piece that only gives ends here: a taker on another moving body finds it from its own side.
    if (!takes) return;
    std::pmr::vector<BodyId> bodies;
    workspace_.bodies.Query(box, bodies);
    for (const BodyId near_body : bodies) {
      if (near_body == body) continue;
      for (const ConvexPiece& other : workspace_.bodies.pieces_in_world(near_body)) Connect(piece, other);
    }
  }

  // Whether the model or an ancestor takes or gives.
  bool IsPartOf(ModelId part, double PowerDescription::*rate) const {
    for (std::optional<ModelId> model = part; model; model = world().model(*model).parent) {
      if (world().model(*model).power.*rate > 0.0) return true;
    }
    return false;
  }

  void Connect(const ConvexPiece& taker, const ConvexPiece& giver) {
    if (!IsPartOf(taker.model, &PowerDescription::take_watts) ||
        !IsPartOf(giver.model, &PowerDescription::give_watts) || !AreNear(taker, giver)) {
      return;
    }
    // A model touches with all of its children: a charging contact may be a child of the model with the rate. So each
    // ancestor with a rate is a taker, and each ancestor of the other with a rate is a giver.
    for (std::optional<ModelId> to = taker.model; to; to = world().model(*to).parent) {
      if (!(world().model(*to).power.take_watts > 0.0)) continue;
      for (std::optional<ModelId> from = giver.model; from; from = world().model(*from).parent) {
        if (world().model(*from).power.give_watts > 0.0) supplies_.push_back({*to, *from});
      }
    }
  }

  const StepWorkspace& workspace_;
  std::vector<Supply> supplies_;
};

// The exchange of one tick.
class Exchange {
 public:
  explicit Exchange(StepWorkspace& workspace) : workspace_(workspace) {}

  void Run() {
    const std::vector<Supply> supplies = SupplyFinder(workspace_).Find();
    if (supplies.empty()) return;
    // A rate is that of the model, however many partners it has: what one pair has used up is not there for the next.
    std::vector<double> to_take;  // J, by model, like the next
    std::vector<double> to_give;
    for (const ModelDescription& model : workspace_.world().models) {
      to_take.push_back(model.power.take_watts * workspace_.seconds());
      to_give.push_back(model.power.give_watts * workspace_.seconds());
    }
    for (const Supply& supply : supplies) {
      Transfer(supply, to_take[supply.taker.index()], to_give[supply.giver.index()]);
    }
  }

 private:
  void Transfer(const Supply& supply, double& to_take, double& to_give) {
    const std::optional<std::size_t> store = workspace_.scene.store_of(supply.taker);
    const std::optional<std::size_t> source = workspace_.scene.store_of(supply.giver);
    // A robot that gives and takes does not feed itself.
    if (!store || !source || source == store) return;
    const double amount = std::min({to_take, to_give, RoomIn(*store), StockOf(*source)});
    // Also a full store, an empty source and a rate that is used up.
    if (!(amount > 0.0)) return;
    to_take -= amount;
    to_give -= amount;
    Add(*store, amount);
    workspace_.next.stores[*store].charge_watts += amount / workspace_.seconds();
    Add(*source, -amount);
  }

  const PowerDescription& PowerOf(std::size_t store) const {
    return workspace_.world().model(workspace_.scene.stores()[store].model).power;
  }
  double RoomIn(std::size_t store) const {
    return PowerOf(store).endless ? 0.0 : PowerOf(store).capacity - workspace_.next.stores[store].joules;
  }
  double StockOf(std::size_t store) const {
    return PowerOf(store).endless ? std::numeric_limits<double>::infinity() : workspace_.next.stores[store].joules;
  }
  void Add(std::size_t store, double joules) {
    if (!PowerOf(store).endless) workspace_.next.stores[store].joules += joules;
  }

  StepWorkspace& workspace_;
};

}  // namespace

void OperateDevices(const TickOrders& orders, StepWorkspace& workspace) {
  const auto switch_light = [&](const std::optional<RobotId>& robot, const LightOrder& order) {
    workspace.next.lights[workspace.scene.first_light_of(*robot) + order.light].is_switched_on = order.on;
  };
  const auto turn_camera = [&](const std::optional<RobotId>& robot, const CameraOrder& order) {
    const std::span<const SensorPlace> cameras = workspace.scene.cameras();
    // Exists: orders are checked (check_order.h), and the cameras of the scene are ascending.
    const auto place = std::lower_bound(cameras.begin(), cameras.end(), SensorPlace{*robot, order.sensor});
    workspace.next.cameras[static_cast<std::size_t>(place - cameras.begin())] = {order.pan, order.tilt};
  };
  // Robots after tools: in one tick a robot's own order wins.
  orders.ForEachInput<LightOrder>(switch_light);
  orders.ForEachInput<CameraOrder>(turn_camera);
  orders.ForEachOfRobots<LightOrder>(switch_light);
  orders.ForEachOfRobots<CameraOrder>(turn_camera);
  // Texts of robots that are out of energy are left out, as all of their proposal is.
  for (const Proposal* const proposal : orders.proposals) {
    if (proposal == nullptr || proposal->say.empty()) continue;
    workspace.robot_events.push_back({.tick = workspace.next.tick,
                                      .type = EventType::kSaid,
                                      .robot = proposal->robot,
                                      .other = {},
                                      .detail = proposal->say});
  }
}

void SetTwists(std::span<const Input> inputs, StepWorkspace& workspace) {
  for (const Input& input : inputs) {
    const auto* const order = std::get_if<TwistOrder>(&input.order);
    if (order == nullptr) continue;
    // After the motion of the tick: the drive accelerates from this velocity in the next one. The velocities of units
    // are set with it, so that they do not measure the jump as an acceleration.
    workspace.next.robots[input.robot->index()].twist = order->twist;
    KeepVelocities(workspace.scene, workspace.bodies, workspace.next, *input.robot);
  }
}

bool IsOutOfEnergy(const Scene& scene, const WorldState& state, RobotId robot) {
  if (scene.stores().empty()) return false;
  const std::optional<std::size_t> store = scene.store_of(scene.world().robot(robot).root);
  return store && IsEmpty(scene, state, *store);
}

void ExchangeEnergy(StepWorkspace& workspace) {
  const Scene& scene = workspace.scene;
  if (scene.stores().empty()) return;
  // Consumption comes before the exchange: a robot that is on a charger when its store runs empty goes on. An event is
  // told only for a store that still had energy before the tick.
  const std::vector<StoreState> before = workspace.next.stores;
  for (std::size_t i = 0; i < scene.stores().size(); ++i) {
    StoreState& store = workspace.next.stores[i];
    store.charge_watts = 0.0;
    if (workspace.world().model(scene.stores()[i].model).power.endless) continue;
    const double consumed = Consumption(scene.stores()[i], workspace.next) * workspace.seconds();
    store.joules = std::max(0.0, store.joules - consumed);
  }
  Exchange(workspace).Run();
  for (std::size_t i = 0; i < scene.stores().size(); ++i) {
    const std::optional<RobotId>& robot = scene.stores()[i].robot;
    if (!robot || before[i].joules <= 0.0 || !IsEmpty(scene, workspace.next, i)) continue;
    workspace.robot_events.push_back({.tick = workspace.next.tick, .type = EventType::kOutOfEnergy, .robot = *robot});
  }
}

void Transmit(const WorldDescription& world, std::span<const Proposal* const> by_robot, WorldState& state) {
  // A message that is due at this tick stays until the next one: the radios that receive it are sensors, which are
  // measured in this state.
  std::erase_if(state.transmissions,
                [&](const RadioTransmission& transmission) { return transmission.due < state.tick; });
  // In the order of robots, and after all older messages: this keeps the order that WorldState::transmissions promises.
  for (const Proposal* const proposal : by_robot) {
    if (proposal == nullptr) continue;
    std::size_t number = 0;
    for (const RadioMessage& message : proposal->messages) {
      // Not null: the proposal is valid.
      const RadioParameters* const radio = FindRadio(world.robot(proposal->robot), message.radio);
      state.transmissions.push_back({.from = proposal->robot,
                                     .sent = state.tick,
                                     .due = state.tick + DelayTicks(*radio, world.interval_seconds()),
                                     .number = number++,
                                     .message = message});
    }
  }
}

void KeepVelocities(const Scene& scene, const BodyIndex& bodies, WorldState& state, std::optional<RobotId> robot) {
  for (std::size_t i = 0; i < scene.imus().size(); ++i) {
    const SensorPlace& place = scene.imus()[i];
    if (robot && place.robot != *robot) continue;
    const SensorDescription& sensor = scene.world().robot(place.robot).sensors[place.sensor];
    const Pose& X_MS = std::get<ImuParameters>(sensor.parameters).X_MS;
    const PointVelocity velocity = VelocityOf(scene, bodies, state, sensor.model, X_MS);
    state.imus[i] = {velocity.xy.x(), velocity.xy.y(), velocity.z};
  }
}

void KeepVelocities(const Scene& scene, RobotId robot, WorldState& state) {
  if (state.imus.empty()) return;
  // A new index for one robot: edits are rare.
  BodyIndex bodies(scene);
  bodies.Assign(state);
  KeepVelocities(scene, bodies, state, robot);
}

}  // namespace troupe
