// Invariants of the step on random worlds with random twists.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/sweep.h"
#include "tests/support/distance_to_edge.h"
#include "tests/support/random_world.h"
#include "tests/support/small_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::RandomStream;

// The deepest overlap of the robots' obstacles with anything of another tree.
double DeepestOfAllPairs(const Scene& scene, const WorldState& state) {
  std::vector<std::vector<ConvexPiece>> bodies(state.robots.size());
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    for (const ConvexPiece& piece : scene.body(BodyId(i)).pieces) {
      bodies[i].push_back(Transformed(piece, state.robots[i].X_WR));
    }
  }
  double deepest = -1.0;
  const auto compare = [&](const std::vector<ConvexPiece>& left, const std::vector<ConvexPiece>& right) {
    for (const ConvexPiece& a : left) {
      for (const ConvexPiece& b : right) {
        if (!a.obstacle || !b.obstacle || !a.z.Overlaps(b.z)) continue;
        if (!BoundingBox(a.vertices).Overlaps(BoundingBox(b.vertices))) continue;
        deepest = std::max(deepest, PenetrationDepth(a.vertices, b.vertices));
      }
    }
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    compare(bodies[i], scene.static_index().kept_pieces());
    for (std::size_t j = i + 1; j < bodies.size(); ++j) compare(bodies[i], bodies[j]);
  }
  return deepest;
}

std::vector<Proposal> RandomProposals(RandomStream& random, std::size_t robots, double speed) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < robots; ++i) {
    if (random.Chance(0.05)) continue;
    Twist twist{random.Uniform(-0.3, 1.0) * speed, random.Uniform(-0.2, 0.2) * speed,
                random.Uniform(-1.0, 1.0) * speed};
    if (random.Chance(0.3)) twist.wz = 0.0;
    if (random.Chance(0.3)) twist.vy = 0.0;
    if (random.Chance(0.05)) twist = {};
    proposals.push_back({RobotId(i), twist});
  }
  return proposals;
}

TEST(StepProperty, NeverMakesTreesOverlap) {
  int stalls = 0;
  int robots = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    RandomStream random(seed + 7'000'000);
    const Scene scene(test::RandomWorld(seed, random.Uniform(3.0, 6.0), random.Index(8), 1 + random.Index(8)));
    WorldState state = InitialState(scene);
    robots += static_cast<int>(state.robots.size());
    ASSERT_LE(DeepestOfAllPairs(scene, state), 0.0) << "seed " << seed;
    for (int tick = 0; tick < 30; ++tick) {
      const double speed = random.Chance(0.1) ? 300.0 : random.Uniform(0.5, 10.0);
      state = Step(scene, state, RandomProposals(random, state.robots.size(), speed)).state;
      for (const RobotState& robot : state.robots) stalls += robot.stalled;
      ASSERT_LE(DeepestOfAllPairs(scene, state), 1.001 * kTouchTolerance) << "seed " << seed << " tick " << tick;
    }
  }
  EXPECT_GT(robots, 1500);
  EXPECT_GT(stalls, 2000);
}

TEST(StepProperty, GivesTheSameStateAndEventsTwice) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomStream random(seed + 8'000'000);
    const WorldDescription world = test::RandomWorld(seed, 4.0, 4, 8);
    const Scene scene(world);
    const Scene again(world);
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < 20; ++tick) {
      const std::vector<Proposal> proposals = RandomProposals(random, state.robots.size(), 5.0);
      const StepResult first = Step(scene, state, proposals);
      const StepResult second = Step(again, state, proposals);
      ASSERT_EQ(first.state, second.state);
      ASSERT_EQ(first.events, second.events);
      ASSERT_EQ(StateHash(first.state), StateHash(second.state));
      state = first.state;
    }
  }
}

TEST(StepProperty, LeavesEveryBitOfAnIdleWorldAlone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Scene scene(test::RandomWorld(seed, 5.0, 5, 8));
    const WorldState start = InitialState(scene);
    WorldState state = start;
    std::vector<Proposal> standing;
    for (std::size_t i = 0; i < start.robots.size(); ++i) standing.push_back({RobotId(i), {}});
    for (int tick = 0; tick < 200; ++tick)
      state = Step(scene, state, tick % 2 == 0 ? standing : std::vector<Proposal>{}).state;
    ASSERT_EQ(state.tick, 200u);
    ASSERT_EQ(state.robots, start.robots);
  }
}

// A single robot among static models, compared with motion in small steps.
TEST(StepProperty, StopsAtTheFirstContactOfTheWholeTree) {
  constexpr int kSteps = 300;
  int stalls = 0;
  int free = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    RandomStream random(seed + 9'000'000);
    const Scene scene(test::RandomWorld(seed, 7.0, 24, 1));
    if (scene.world().robots.empty()) continue;
    const WorldState start = InitialState(scene);
    const Twist twist{random.Uniform(0.0, 80.0), random.Uniform(-5.0, 5.0), random.Uniform(-30.0, 30.0)};
    const WorldState end = Step(scene, start, std::vector<Proposal>{{RobotId(0), twist}}).state;
    WorldState probe = start;
    double contact_at = 1.0;  // s
    for (int step = 0; step <= kSteps; ++step) {
      const double time = 0.1 * step / kSteps;
      probe.robots[0].X_WR = start.robots[0].X_WR * Integrate(twist, time);
      if (DeepestOfAllPairs(scene, probe) <= kTouchTolerance) continue;
      contact_at = time;
      break;
    }
    if (!end.robots[0].stalled) {
      ++free;
      ASSERT_EQ(contact_at, 1.0) << "seed " << seed;
      continue;
    }
    ++stalls;
    BodyIndex index(scene);
    const BodyId own(0);
    index.Assign(start);
    const std::optional<Contact> contact =
        FirstContact(scene, index, MoverOf(scene, own), {start.robots[0].X_WR, twist, 0.0, 0.1});
    ASSERT_TRUE(contact.has_value());
    ASSERT_LE(contact->time, contact_at) << "seed " << seed;
    // A millimetre further there is overlap.
    const double millimetre = 1e-3 / (std::hypot(twist.vx, twist.vy) + std::abs(twist.wz) * scene.max_body_radius());
    bool met = false;
    for (int step = 1; step <= 100 && !met; ++step) {
      probe.robots[0].X_WR = start.robots[0].X_WR * Integrate(twist, contact->time + millimetre * step / 100);
      met = DeepestOfAllPairs(scene, probe) > kTouchTolerance;
    }
    ASSERT_TRUE(met) << "seed " << seed;
  }
  EXPECT_GT(stalls, 60);
  EXPECT_GT(free, 100);
}

// All bodies on a lattice: edges in line, corners that touch corners, contacts at the same instant.
TEST(StepProperty, NeverMakesTreesOverlapOnALattice) {
  constexpr double kCell = 0.1;
  int stalls = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    RandomStream random(seed + 10'000'000);
    test::TestWorld test;
    constexpr int kWidth = 12;
    std::vector<bool> taken(kWidth * kWidth, false);
    const ModelId walls = test.AddModel(std::vector<Block>{});
    for (int i = 0; i < kWidth * kWidth; ++i) {
      if (!random.Chance(0.15)) continue;
      taken[static_cast<std::size_t>(i)] = true;
      const double x = i % kWidth * kCell;
      const double y = i / kWidth * kCell;
      test.world.shapes[walls.index()].rectangles.push_back({x, y, x + kCell, y + kCell});
    }
    test.world.shapes[walls.index()].rectangles_z = {0.0, 1.0};
    for (int i = 0; i < 8; ++i) {
      const auto place = random.Index(kWidth * kWidth);
      if (taken[place]) continue;
      taken[place] = true;
      const double x = (static_cast<double>(place % kWidth) + 0.5) * kCell;
      const double y = (static_cast<double>(place / kWidth) + 0.5) * kCell;
      test.AddRobot(test::Square(kCell), {0.0, 0.5},
                    {x, y, 0.0, 0.5 * kPi * static_cast<double>(random.Index(4)) - 0.5 * kPi});
    }
    const Scene scene(test.world);
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < 40; ++tick) {
      std::vector<Proposal> proposals;
      for (std::size_t i = 0; i < state.robots.size(); ++i) {
        Twist twist;
        const double speed = (static_cast<double>(random.Index(5)) - 2.0) * kCell / 0.1;
        switch (random.Index(3)) {
          case 0:
            twist.vx = speed;
            break;
          case 1:
            twist.vy = speed;
            break;
          default:
            twist = {speed, random.Chance(0.5) ? speed : 0.0, random.Chance(0.5) ? 5.0 * kPi * speed : 0.0};
        }
        proposals.push_back({RobotId(i), twist});
      }
      state = Step(scene, state, proposals).state;
      for (const RobotState& robot : state.robots) stalls += robot.stalled;
      ASSERT_LE(DeepestOfAllPairs(scene, state), 1.001 * kTouchTolerance) << "seed " << seed << " tick " << tick;
    }
  }
  EXPECT_GT(stalls, 1000);
}

}  // namespace

}  // namespace troupe

namespace troupe::test {
namespace {

// The energy of random yards of robots and chargers against a ledger of its own: contacts by the distances of corners
// and edges, sums in plain order.

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
