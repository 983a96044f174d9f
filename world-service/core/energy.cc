#include "world-service/core/energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <vector>

#include "common/spatial/nearest_points.h"

namespace troupe {
namespace {

constexpr double kReach = 1e-3;          // m: bodies so near touch
constexpr double kWattsOfMotion = 10.0;  // per kg and m/s or rad/s

bool IsEmpty(const Scene& scene, const WorldState& state, std::size_t store) {
  return !scene.world().model(scene.stores()[store].model).power.endless && state.stores[store].joules <= 0.0;
}

double Consumption(const Store& store, const WorldState& state) {
  if (!store.robot) return store.watts;
  const Twist& twist = state.robots[store.robot->index()].twist;
  const double motion = std::abs(twist.vx) + std::abs(twist.vy) + std::abs(twist.wz);
  return store.watts + kWattsOfMotion * store.mass * motion;
}

bool AreNear(const ConvexPiece& a, const ConvexPiece& b) {
  return std::min(a.z.max, b.z.max) - std::max(a.z.min, b.z.min) >= -kReach &&
         FindNearestPoints(a.vertices, b.vertices).distance <= kReach;
}

// The exchange of one tick.
class Exchange {
 public:
  explicit Exchange(StepWorkspace& workspace)
      : workspace_(workspace), left_to_give_(workspace.world().models.size(), -1.0) {}

  // Lets a model take from all that touch it.
  void Take(ModelId taker) {
    const std::optional<std::size_t> store = workspace_.scene.store_of(taker);
    if (!store) return;
    double left = workspace_.world().model(taker).power.take_watts * workspace_.seconds();
    for (const ModelId giver : GiversNear(taker)) {
      const std::optional<std::size_t> source = workspace_.scene.store_of(giver);
      if (!source || source == store) continue;
      double& given = left_to_give_[giver.index()];
      if (given < 0.0) given = workspace_.world().model(giver).power.give_watts * workspace_.seconds();
      const double amount = std::min({left, given, RoomIn(*store), StockOf(*source)});
      if (!(amount > 0.0)) continue;
      left -= amount;
      given -= amount;
      Add(*store, amount);
      workspace_.next.stores[*store].charge_watts += amount / workspace_.seconds();
      Add(*source, -amount);
    }
  }

 private:
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

  // In id order. Its own body does not count.
  std::vector<ModelId> GiversNear(ModelId taker) {
    std::vector<ModelId> givers;
    const std::optional<BodyId> own = workspace_.scene.body_of(taker);
    for (const ConvexPiece& piece : PiecesOf(taker)) {
      const Rectangle box = BoundingBox(piece.vertices).Inflated(kReach);
      const auto test = [&](const ConvexPiece& other) {
        if (workspace_.world().model(other.model).power.give_watts > 0.0 && AreNear(piece, other)) {
          givers.push_back(other.model);
        }
      };
      NearPieces near;
      workspace_.scene.static_index().Query(box, near);
      for (const ConvexPiece* other : near) test(*other);
      std::pmr::vector<BodyId> bodies;
      workspace_.bodies.Query(box, bodies);
      for (const BodyId body : bodies) {
        if (body == own) continue;
        for (const ConvexPiece& other : workspace_.bodies.pieces_in_world(body)) test(other);
      }
    }
    std::sort(givers.begin(), givers.end());
    givers.erase(std::unique(givers.begin(), givers.end()), givers.end());
    return givers;
  }

  // Of the model and the models below it, in W. Of a static model none: it cannot move to a giver.
  std::vector<ConvexPiece> PiecesOf(ModelId model) const {
    std::vector<ConvexPiece> pieces;
    const std::optional<BodyId> body = workspace_.scene.body_of(model);
    if (!body) return pieces;
    for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(*body)) {
      if (IsInTree(workspace_.world(), piece.model, model)) pieces.push_back(piece);
    }
    return pieces;
  }

  StepWorkspace& workspace_;
  std::vector<double> left_to_give_;  // J, by model; below 0: nothing was given yet
};

}  // namespace

bool IsOutOfEnergy(const Scene& scene, const WorldState& state, RobotId robot) {
  if (scene.stores().empty()) return false;
  const std::optional<std::size_t> store = scene.store_of(scene.world().robot(robot).root);
  return store && IsEmpty(scene, state, *store);
}

void ExchangeEnergy(StepWorkspace& workspace) {
  const Scene& scene = workspace.scene;
  if (scene.stores().empty()) return;
  const std::vector<StoreState> before = workspace.next.stores;
  for (std::size_t i = 0; i < scene.stores().size(); ++i) {
    StoreState& store = workspace.next.stores[i];
    store.charge_watts = 0.0;
    if (workspace.world().model(scene.stores()[i].model).power.endless) continue;
    const double consumed = Consumption(scene.stores()[i], workspace.next) * workspace.seconds();
    store.joules = std::max(0.0, store.joules - consumed);
  }
  Exchange exchange(workspace);
  for (std::size_t i = 0; i < workspace.world().models.size(); ++i) {
    const ModelDescription& model = workspace.world().models[i];
    if (model.power.take_watts > 0.0 && !model.removed) exchange.Take(ModelId(i));
  }
  for (std::size_t i = 0; i < scene.stores().size(); ++i) {
    const std::optional<RobotId>& robot = scene.stores()[i].robot;
    if (!robot || before[i].joules <= 0.0 || !IsEmpty(scene, workspace.next, i)) continue;
    workspace.robot_events.push_back({.tick = workspace.next.tick, .type = EventType::kOutOfEnergy, .robot = *robot});
  }
}

}  // namespace troupe
