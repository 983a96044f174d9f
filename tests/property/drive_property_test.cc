// The bounds of drives hold in whole simulations: random drives, random bounds, driven by controllers and from outside,
// with obstacles in their way.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "troupe/random.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

constexpr double kRounding = 1e-9;

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  double Between(double least, double most) { return least + (most - least) * RandomUniform({seed_, ++drawn_}); }
  bool Chance(double share) { return Between(0.0, 1.0) < share; }

 private:
  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
};

std::string RandomBounds(Draws& draws, double least, double most) {
  std::string text = "[";
  for (int axis = 0; axis < 4; ++axis) {
    const double scale = axis == 3 ? 60.0 : 1.0;  // degrees
    text += " " + std::to_string(-draws.Between(least, most) * scale);
    text += " " + std::to_string(draws.Between(least, most) * scale);
  }
  return text + " ]";
}

// Robots of all drives between walls and posts.
std::string RandomWorld(Draws& draws) {
  std::string text = "interval_sim " + std::to_string(draws.Chance(0.5) ? 100 : 37) + "\n";
  text += "define wall model( )\nwall( size [20 0.2 1] pose [0 8 0 0] )\nwall( size [20 0.2 1] pose [0 -8 0 0] )\n";
  text += "wall( size [0.2 20 1] pose [9 0 0 0] )\nwall( size [0.2 20 1] pose [-9 0 0 0] )\n";
  const char* const drives[] = {"diff", "omni", "car"};
  const char* const controllers[] = {"wander", "go_to waypoints=[[3,3],[-3,-3]]", "patrol waypoints=[[4,0],[0,4]]",
                                     "dynamic 3 2", "idle"};
  for (int i = 0; i < 12; ++i) {
    const auto pick = static_cast<std::size_t>(draws.Between(0.0, 4.999));
    text += "position( size [0.4 0.4 0.3] pose [" + std::to_string(-6.0 + 4.0 * (i % 4)) + " " +
            std::to_string(-4.0 + 4.0 * (i / 4)) + " 0 " + std::to_string(draws.Between(-180.0, 180.0)) +
            "]\n drive \"" + drives[i % 3] + "\" wheelbase 0.4 velocity_bounds " + RandomBounds(draws, 0.1, 2.0) +
            "\n acceleration_bounds " + RandomBounds(draws, 0.05, 3.0) + "\n ctrl \"" + controllers[pick] + "\"" +
            " ranger( sensor( range [0 4] fov 180 samples 19 ) ) )\n";
  }
  return text;
}

// The speed of the steered wheel, with its sign.
double WheelSpeed(const Twist& twist, double wheelbase) {
  const double speed = std::hypot(twist.vx, twist.wz * wheelbase);
  return twist.vx < 0.0 ? -speed : speed;
}

void ExpectWithin(const Interval& velocity, const Interval& acceleration, double before, double after, double seconds,
                  const std::string& what) {
  EXPECT_GE(after, velocity.min - kRounding) << what;
  EXPECT_LE(after, velocity.max + kRounding) << what;
  EXPECT_GE((after - before) / seconds, acceleration.min - kRounding / seconds) << what;
  EXPECT_LE((after - before) / seconds, acceleration.max + kRounding / seconds) << what;
}

void ExpectWithinBounds(const DriveDescription& drive, const Twist& before, const Twist& after, double seconds,
                        const std::string& what) {
  const TwistBounds& v = drive.velocity;
  const TwistBounds& a = drive.acceleration;
  if (drive.type == DriveType::kCar) {
    EXPECT_EQ(after.vy, 0.0) << what;
    ExpectWithin(v.x, a.x, WheelSpeed(before, drive.wheelbase), WheelSpeed(after, drive.wheelbase), seconds, what);
    return;
  }
  ExpectWithin(v.x, a.x, before.vx, after.vx, seconds, what + " ahead");
  ExpectWithin(v.heading, a.heading, before.wz, after.wz, seconds, what + " turn");
  if (drive.type == DriveType::kOmni) {
    ExpectWithin(v.y, a.y, before.vy, after.vy, seconds, what + " left");
  } else {
    EXPECT_EQ(after.vy, 0.0) << what;
  }
}

TEST(DriveProperty, NoMotionExceedsTheBoundsOfItsDrive) {
  int stalls = 0;
  int at_bounds = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Draws draws(seed);
    const std::string path = testing::TempDir() + "drive_property_test.world";
    std::ofstream(path) << RandomWorld(draws);
    Result<Simulation> loaded = Simulation::Load(path);
    ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
    Simulation& simulation = loaded.value();
    const WorldDescription& world = simulation.world();
    for (int tick = 0; tick < 300 && !testing::Test::HasFailure(); ++tick) {
      for (std::size_t i = 0; i < world.robots.size(); ++i) {
        if (!draws.Chance(0.1)) continue;
        Command command{.twist = {draws.Between(-3.0, 3.0), draws.Between(-3.0, 3.0), draws.Between(-3.0, 3.0)},
                        .speed = draws.Between(-3.0, 3.0),
                        .steering = draws.Between(-2.0, 2.0)};
        if (draws.Chance(0.5)) {
          ASSERT_TRUE(simulation.Drive(RobotId(i), command).ok());
        } else {
          simulation.Release(RobotId(i));
        }
      }
      const WorldState before = simulation.state();
      simulation.Step();
      for (std::size_t i = 0; i < world.robots.size(); ++i) {
        const RobotState& after = simulation.state().robots[i];
        const Twist& twist = after.twist;
        if (after.stalled) {  // a contact stops a robot at once
          EXPECT_TRUE(twist.IsZero());
          ++stalls;
          continue;
        }
        ExpectWithinBounds(
            world.robots[i].drive, before.robots[i].twist, twist, world.interval_seconds(),
            "seed " + std::to_string(seed) + " tick " + std::to_string(tick) + " robot " + std::to_string(i));
        if (twist.vx == world.robots[i].drive.velocity.x.max) ++at_bounds;
      }
    }
  }
  EXPECT_GT(stalls, 100);
  EXPECT_GT(at_bounds, 100);
}

}  // namespace
}  // namespace troupe
