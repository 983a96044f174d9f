// Inertial measurement units.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "common/model/states.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/test_world.h"
#include "tests/support/values.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"

namespace troupe::test {
namespace {

constexpr double kSeconds = 0.1;  // of a tick
constexpr double kGravity = 9.81;

using Complex = std::complex<double>;

// A pose with an infinitesimal motion as its imaginary part: f(a + b e i) = f(a) + f'(a) b e i + O(e^2).
struct ComplexPose {
  Complex x;
  Complex y;
  Complex z;
  Complex heading;

  ComplexPose operator*(const ComplexPose& next) const {
    return {x + std::cos(heading) * next.x - std::sin(heading) * next.y,
            y + std::sin(heading) * next.x + std::cos(heading) * next.y, z + next.z, heading + next.heading};
  }
};

ComplexPose Fixed(const Pose& pose) {
  return {pose.x, pose.y, pose.z, pose.heading};
}

// A robot whose mast shifts upwards and to the side, with a turret on it that turns, and an IMU on the turret.
class ImuTest : public testing::Test {
 protected:
  static constexpr double kTinyStep = 1e-150;  // of the derivatives
  static constexpr Pose kMast{0.1, 0.05, 0.4, 0.3};
  static constexpr Pose kTurret{-0.2, 0.1, 0.1, -0.8};
  static constexpr Pose kMount{0.3, 0.2, 0.05, 1.1};
  static constexpr Pose kUnit{0.02, -0.03, 0.01, 0.4};

  ImuTest() : robot_(worlds_.AddRobot(Square(0.4), {0.0, 0.3}, {0.3, -0.2, 0.0, 0.7})) {
    const ModelId mast = worlds_.AddModel(Square(0.1), {0.0, 0.1}, kMast, worlds_.world.robot(robot_).root);
    const ModelId turret = worlds_.AddModel(Square(0.1), {0.0, 0.1}, kTurret, mast);
    AddJoint(mast, JointType::kPrismatic, {0.0, 0.6}, 0.8);
    AddJoint(turret, JointType::kRevolute, {0.0, 0.0}, 1.0);
    unit_ = AddSensor(worlds_.world, robot_, kMount, ImuParameters{.X_MS = kUnit});
    worlds_.world.models.back().parent = turret;
  }

  void AddJoint(ModelId model, JointType type, const Vec2& axis_xy, double axis_z) {
    worlds_.world.joints.push_back(JointDescription{.name = worlds_.model(model).name,
                                                    .robot = robot_,
                                                    .model = model,
                                                    .type = type,
                                                    .axis_xy = axis_xy,
                                                    .axis_z = axis_z,
                                                    .position = {-1e3, 1e3},
                                                    .max_speed = 10.0});
  }

  // The pose of the unit in a state, with its velocity as the imaginary part.
  static ComplexPose UnitIn(const WorldState& state) {
    const RobotState& robot = state.robots[0];
    const double c = std::cos(robot.X_WR.heading);
    const double s = std::sin(robot.X_WR.heading);
    const auto moving = [](double value, double rate) { return Complex(value, kTinyStep * rate); };
    const ComplexPose X_WR{moving(robot.X_WR.x, c * robot.twist.vx - s * robot.twist.vy),
                           moving(robot.X_WR.y, s * robot.twist.vx + c * robot.twist.vy), robot.X_WR.z,
                           moving(robot.X_WR.heading, robot.twist.wz)};
    const Complex shift = moving(state.joints[0].position, state.joints[0].velocity);
    const Complex turn = moving(state.joints[1].position, state.joints[1].velocity);
    return X_WR * Fixed(kMast) * ComplexPose{0.0, 0.6 * shift, 0.8 * shift, 0.0} * Fixed(kTurret) *
           ComplexPose{0.0, 0.0, 0.0, turn} * Fixed(kMount) * Fixed(kUnit);
  }

  ImuReading Measure(const WorldState& state) const {
    return SensedScene(worlds_.world, state).MeasureAs<ImuReading>(robot_, unit_);
  }

  // Random velocities of the drive and the joints in every tick.
  static Proposal RandomProposal(std::mt19937& engine) {
    std::uniform_real_distribution<double> number(-2.0, 2.0);
    return {RobotId(0), {number(engine), number(engine), number(engine)}, {number(engine), number(engine)}};
  }

  TestWorld worlds_;
  RobotId robot_;
  std::size_t unit_ = 0;
};

TEST_F(ImuTest, MeasuresTheMotionOfItsPlaceExactly) {
  ASSERT_TRUE(Validate(worlds_.world).ok()) << Validate(worlds_.world).error().message;
  const Scene scene(worlds_.world);
  WorldState state = InitialState(scene);
  std::mt19937 engine(7);
  for (int tick = 0; tick < 200; ++tick) {
    const ComplexPose before = UnitIn(state);
    const Proposal proposal = RandomProposal(engine);
    state = Step(scene, state, std::span(&proposal, 1)).state;
    ASSERT_TRUE(CheckState(scene.world(), state).ok());
    const ComplexPose now = UnitIn(state);
    const ImuReading reading = Measure(state);
    EXPECT_NEAR(WrapAngle(reading.heading - now.heading.real()), 0.0, 1e-9);
    EXPECT_NEAR(reading.turn, now.heading.imag() / kTinyStep, 1e-9);
    const double ax = (now.x.imag() - before.x.imag()) / kTinyStep / kSeconds;
    const double ay = (now.y.imag() - before.y.imag()) / kTinyStep / kSeconds;
    const double c = std::cos(now.heading.real());
    const double s = std::sin(now.heading.real());
    EXPECT_NEAR(reading.force_xy.x(), c * ax + s * ay, 1e-9);
    EXPECT_NEAR(reading.force_xy.y(), c * ay - s * ax, 1e-9);
    EXPECT_NEAR(reading.force_z, kGravity + (now.z.imag() - before.z.imag()) / kTinyStep / kSeconds, 1e-9);
  }
}

TEST_F(ImuTest, MeasuresGravityAloneAtRestAndWithAConstantVelocity) {
  const Scene scene(worlds_.world);
  WorldState state = InitialState(scene);
  const auto expect_no_acceleration = [&] {
    const ImuReading reading = Measure(state);
    EXPECT_NEAR(reading.force_xy.norm(), 0.0, 1e-9);
    EXPECT_NEAR(reading.force_z, kGravity, 1e-9);
    EXPECT_EQ(reading.turn, 0.0);
  };
  expect_no_acceleration();
  const Proposal ahead{robot_, {0.5, 0.2, 0.0}, {0.3, 0.0}};
  state = Step(scene, state, std::span(&ahead, 1)).state;
  EXPECT_GT(Measure(state).force_xy.norm(), 1.0) << "it has started";
  for (int tick = 0; tick < 10; ++tick) {
    state = Step(scene, state, std::span(&ahead, 1)).state;
    expect_no_acceleration();
  }
}

TEST_F(ImuTest, AWallStopsItHard) {
  worlds_.AddModel(Box(1.0, -5.0, 1.2, 5.0));
  worlds_.model(worlds_.world.robot(robot_).root).X_PM = {};
  const Scene scene(worlds_.world);
  WorldState state = InitialState(scene);
  const Proposal ahead{robot_, {0.5, 0.0, 0.0}, {0.0, 0.0}};
  Vec2 hardest{0.0, 0.0};
  for (int tick = 0; tick < 40; ++tick) {
    state = Step(scene, state, std::span(&ahead, 1)).state;
    if (state.robots[0].stalled) hardest = Measure(state).force_xy;
    if (state.robots[0].stalled) break;
  }
  ASSERT_TRUE(state.robots[0].stalled);
  EXPECT_NEAR(hardest.norm(), 0.5 / kSeconds, 1e-9);
}

TEST_F(ImuTest, AnEditIsNoAcceleration) {
  const auto scene = std::make_shared<const Scene>(worlds_.world);
  WorldState state = InitialState(*scene);
  const Proposal ahead{robot_, {0.5, 0.2, 1.0}, {0.3, 0.4}};
  for (int tick = 0; tick < 3; ++tick) state = Step(*scene, state, std::span(&ahead, 1)).state;
  const std::string name = worlds_.world.robot(robot_).name;
  EXPECT_NEAR(Measure(ValueOf(SetPose(scene, state, name, {5.0, 5.0, 0.0, 2.0})).state).force_xy.norm(), 0.0, 1e-9);
  const Input turn{robot_, TwistOrder{{-1.0, 0.5, 0.0}}};
  EXPECT_NEAR(Measure(Step(*scene, state, {}, std::span(&turn, 1)).state).force_xy.norm(), 0.0, 1e-9);
}

TEST_F(ImuTest, ErrorsHaveTheirDeviationsAndFollowTheSeed) {
  const ImuParameters noisy{
      .heading_noise = 0.01, .gyro_noise = 0.2, .gyro_bias = 0.5, .acceleration_noise = 0.3, .acceleration_bias = 0.7};
  worlds_.world.robots[0].sensors[unit_].parameters = noisy;
  const auto read = [&](std::uint64_t seed, Tick tick) {
    worlds_.world.seed = seed;
    WorldState state = PlacedState(worlds_.world);
    state.tick = tick;
    return Measure(state);
  };
  EXPECT_EQ(read(3, 8), read(3, 8));
  EXPECT_NE(read(3, 8).turn, read(4, 8).turn);
  EXPECT_NE(read(3, 8).turn, read(3, 9).turn);
  constexpr int kSeeds = 300;
  constexpr int kTicks = 20;
  double noise = 0.0;  // sums of squares
  double bias = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    double sum = 0.0;
    double squares = 0.0;
    for (int tick = 1; tick <= kTicks; ++tick) {
      const double turn = read(static_cast<std::uint64_t>(seed), static_cast<Tick>(tick)).turn;
      sum += turn;
      squares += turn * turn;
    }
    const double mean = sum / kTicks;
    bias += mean * mean / kSeeds;
    noise += (squares - kTicks * mean * mean) / (kTicks - 1) / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(noise), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(bias), std::sqrt(0.25 + 0.04 / kTicks), 0.06);
  const ImuReading reading = read(3, 8);
  EXPECT_EQ(reading.heading_noise, 0.01);
  EXPECT_EQ(reading.turn_noise, 0.2);
  EXPECT_EQ(reading.force_noise, 0.3);
}

TEST_F(ImuTest, ItsStateIsPartOfTheHash) {
  WorldState state = PlacedState(worlds_.world);
  ASSERT_EQ(state.imus.size(), 1u);
  const std::uint64_t before = StateHash(state);
  state.imus[0].vy = 0.5;
  EXPECT_NE(StateHash(state), before);
  state.imus.clear();
  EXPECT_FALSE(CheckState(worlds_.world, state).ok());
}

TEST_F(ImuTest, ALineOfTheScanLogHasItsNumbers) {
  EXPECT_EQ(SensedScene(worlds_.world).JsonLines(robot_, unit_).substr(0, 45),
            R"({"tick":0,"robot":"m0","sensor":"imu:0","head)");
}

}  // namespace
}  // namespace troupe::test
