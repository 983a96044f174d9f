// The energy of random yards of robots and chargers against a ledger of its own: contacts by the distances of corners
// and edges, sums in plain order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/support/random_world.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"

namespace troupe::test {
namespace {

constexpr int kWorlds = 40;
constexpr int kTicks = 150;
constexpr double kReach = 1e-3;    // m: nearer bodies touch
constexpr double kTooNear = 1e-9;  // m: distances nearer to kReach decide nothing

using Corners = std::array<Vec2, 4>;

// A model of the yard: a box, alone or as the body of a robot.
struct Thing {
  ModelId model;
  std::optional<RobotId> robot;
};

double DistanceToEdge(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 edge = to - from;
  const double along = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (point - from - along * edge).norm();
}

bool IsInside(const Vec2& point, const Corners& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (Cross(corners[(i + 1) % 4] - corners[i], point - corners[i]) < 0.0) return false;
  }
  return true;
}

bool AreCrossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (Cross(b - a, c - a) > 0.0) != (Cross(b - a, d - a) > 0.0) &&
         (Cross(d - c, a - c) > 0.0) != (Cross(d - c, b - c) > 0.0);
}

double Distance(const Corners& a, const Corners& b) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    if (IsInside(a[i], b) || IsInside(b[i], a)) return 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (AreCrossing(a[i], a[(i + 1) % 4], b[k], b[(k + 1) % 4])) return 0.0;
      nearest =
          std::min({nearest, DistanceToEdge(a[i], b[k], b[(k + 1) % 4]), DistanceToEdge(b[i], a[k], a[(k + 1) % 4])});
    }
  }
  return nearest;
}

// A yard with its ledger.
class PoweredYard {
 public:
  explicit PoweredYard(std::uint64_t seed) : random_(seed) {
    for (int i = 0; i < 6; ++i) {
      ModelDescription& charger =
          small_.AddBox("charger" + std::to_string(i), random_.Uniform(-3.0, 3.0), random_.Uniform(-3.0, 3.0),
                        random_.Uniform(0.3, 1.0), random_.Uniform(0.3, 1.0), {0.0, random_.Uniform(0.02, 0.5)});
      charger.X_PM.heading = random_.Angle();
      charger.obstacle_return = false;
      charger.power = {.has_store = true,
                       .endless = random_.Chance(0.3),
                       .joules = random_.Uniform(0.0, 60.0),
                       .capacity = 60.0,
                       .watts = random_.Chance(0.3) ? random_.Uniform(0.0, 3.0) : 0.0,
                       .give_watts = random_.Uniform(5.0, 60.0)};
      things_.push_back({ModelId(small_.world().models.size() - 1), std::nullopt});
    }
    for (int i = 0; i < 7; ++i) {
      const RobotId robot =
          small_.AddRobot("r" + std::to_string(i),
                          {-3.0 + i + random_.Uniform(-0.2, 0.2), random_.Uniform(-3.0, 3.0), 0.0, random_.Angle()});
      ModelDescription& body = small_.world().models[small_.robot(robot).root.index()];
      body.power = {.has_store = true,
                    .endless = random_.Chance(0.1),
                    .joules = random_.Uniform(0.0, 20.0),
                    .capacity = 40.0,
                    .watts = random_.Uniform(0.0, 10.0),
                    .mass = random_.Uniform(0.0, 3.0),
                    .give_watts = random_.Chance(0.3) ? random_.Uniform(0.0, 40.0) : 0.0,
                    .take_watts = random_.Uniform(0.0, 60.0)};
      things_.push_back({small_.robot(robot).root, robot});
      twists_.emplace_back();
    }
    for (const Thing& thing : things_) ledger_.push_back(PowerOf(thing).joules);
  }

  const WorldDescription& world() { return small_.world(); }

  std::vector<Proposal> Drive() {
    std::vector<Proposal> proposals;
    for (std::size_t i = 0; i < twists_.size(); ++i) {
      if (random_.Chance(0.1)) twists_[i] = {random_.Uniform(-1.0, 1.0), 0.0, random_.Uniform(-2.0, 2.0)};
      proposals.push_back({RobotId(i), random_.Chance(0.5) ? twists_[i] : Twist{}});
    }
    return proposals;
  }

  // Enters the tick that ended in `state` into the ledger. False if a distance is too near to kReach to decide.
  bool Enter(const WorldState& state) {
    const double seconds = small_.world().interval_seconds();
    charged_.assign(things_.size(), 0.0);
    for (std::size_t i = 0; i < things_.size(); ++i) {
      const PowerDescription& power = PowerOf(things_[i]);
      if (power.endless) continue;
      double watts = power.watts;
      if (things_[i].robot) {
        const Twist& twist = state.robots[things_[i].robot->index()].twist;
        watts += 10.0 * power.mass * (std::abs(twist.vx) + std::abs(twist.vy) + std::abs(twist.wz));
      }
      ledger_[i] = std::max(0.0, ledger_[i] - watts * seconds);
    }
    std::vector<double> to_give;
    for (const Thing& thing : things_) to_give.push_back(PowerOf(thing).give_watts * seconds);
    for (std::size_t taker = 0; taker < things_.size(); ++taker) {
      double to_take = PowerOf(things_[taker]).take_watts * seconds;
      if (PowerOf(things_[taker]).endless) to_take = 0.0;
      for (std::size_t giver = 0; giver < things_.size(); ++giver) {
        if (giver == taker || to_give[giver] == 0.0 || to_take == 0.0) continue;
        const double distance = Distance(CornersOf(state, things_[taker]), CornersOf(state, things_[giver]));
        if (std::abs(distance - kReach) < kTooNear) return false;
        if (distance > kReach) continue;
        const double stock = PowerOf(things_[giver]).endless ? std::numeric_limits<double>::infinity() : ledger_[giver];
        const double amount =
            std::min({to_take, to_give[giver], PowerOf(things_[taker]).capacity - ledger_[taker], stock});
        if (amount <= 0.0) continue;
        exchanged_ += amount;
        to_take -= amount;
        to_give[giver] -= amount;
        ledger_[taker] += amount;
        charged_[taker] += amount / seconds;
        if (!PowerOf(things_[giver]).endless) ledger_[giver] -= amount;
      }
    }
    return true;
  }

  void ExpectLedger(const WorldState& state) {
    ASSERT_EQ(state.stores.size(), things_.size());
    for (std::size_t i = 0; i < things_.size(); ++i) {
      ASSERT_NEAR(state.stores[i].joules, ledger_[i], 1e-9) << small_.world().model(things_[i].model).name;
      ASSERT_NEAR(state.stores[i].charge_watts, charged_[i], 1e-9) << small_.world().model(things_[i].model).name;
    }
  }

  double exchanged() const { return exchanged_; }

 private:
  const PowerDescription& PowerOf(const Thing& thing) { return small_.world().model(thing.model).power; }

  Corners CornersOf(const WorldState& state, const Thing& thing) {
    const ModelDescription& model = small_.world().model(thing.model);
    const Pose& pose = thing.robot ? state.robots[thing.robot->index()].X_WR : model.X_PM;
    const double x = 0.5 * model.size_x;
    const double y = 0.5 * model.size_y;
    Corners corners = {Vec2{-x, -y}, Vec2{x, -y}, Vec2{x, y}, Vec2{-x, y}};
    for (Vec2& corner : corners) {
      corner = Vec2{pose.x + std::cos(pose.heading) * corner.x() - std::sin(pose.heading) * corner.y(),
                    pose.y + std::sin(pose.heading) * corner.x() + std::cos(pose.heading) * corner.y()};
    }
    return corners;
  }

  RandomStream random_;
  SmallWorld small_;
  std::vector<Thing> things_;    // in the order of models: that of the stores, too
  std::vector<Twist> twists_;    // by robot
  std::vector<double> ledger_;   // J, by thing
  std::vector<double> charged_;  // W, likewise
  double exchanged_ = 0.0;       // J
};

TEST(EnergyProperty, EveryStoreHasTheEnergyOfTheLedger) {
  double exchanged = 0.0;
  int ticks = 0;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    SCOPED_TRACE(seed);
    PoweredYard yard(seed);
    const Scene scene(yard.world());
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < kTicks; ++tick, ++ticks) {
      state = Step(scene, state, yard.Drive()).state;
      if (!yard.Enter(state)) break;
      yard.ExpectLedger(state);
      if (HasFatalFailure()) return;
    }
    exchanged += yard.exchanged();
  }
  EXPECT_GT(exchanged, 1000.0) << "the yards have too few contacts for a test";
  EXPECT_GT(ticks, kWorlds * kTicks / 2);
}

}  // namespace
}  // namespace troupe::test
