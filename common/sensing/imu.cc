// The inertial measurement unit. Acceleration is the difference of the executed velocities of two ticks: motion is
// constant within a tick, so that there is no other. The velocity of the tick before is a part of the state (ImuState),
// because a reading must follow from the state alone. Specific force is acceleration minus gravity: a unit at rest
// reads +g upwards.
#include <algorithm>
#include <array>
#include <span>

#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
#include "common/spatial/body_index.h"
#include "troupe/check.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kNoiseStream = 0x696d75;         // "imu"
constexpr std::uint64_t kBiasStream = 0x696d7562696173;  // "imubias"

enum class ImuDraw : std::uint64_t { kHeading = 0, kTurn = 1, kForceX = 2, kForceY = 3, kForceZ = 4 };

class Imu final : public Sensor {
 public:
  explicit Imu(const SensorMount& mount) : Sensor(mount) {
    const std::span<const SensorPlace> imus = mount.scene.imus();
    const auto place = std::find(imus.begin(), imus.end(), SensorPlace{mount.robot, mount.index});
    TROUPE_CHECK(place != imus.end());
    row_ = static_cast<std::size_t>(place - imus.begin());
  }

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    const ImuReading& imu = std::get<ImuReading>(reading.content);
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Member("heading", imu.heading).Member("turn", imu.turn);
    json.Member("force", std::array{imu.force_xy.x(), imu.force_xy.y(), imu.force_z}).EndObject();
    return line + "\n";
  }

 private:
  const ImuParameters& parameters() const { return std::get<ImuParameters>(description().parameters); }

  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    reading.tick = tick;
    ImuReading& content = ContentOf<ImuReading>(reading);
    content.X_RS = MountAt(world) * parameters().X_MS;
    content.heading_noise = parameters().heading_noise;
    content.turn_noise = parameters().gyro_noise;
    content.force_noise = parameters().acceleration_noise;
    const WorldDescription& description_of_world = world.scene.world();
    const Pose X_WS = world.bodies.X_WM(description().model) * parameters().X_MS;
    PointVelocity velocity;
    Vec2 acceleration_xy{0.0, 0.0};
    double acceleration_z = 0.0;
    // Without a state (a picture of a description) the unit is at rest.
    if (world.state != nullptr) {
      velocity = VelocityOf(world.scene, world.bodies, *world.state, description().model, parameters().X_MS);
      const ImuState& before = world.state->imus[row_];
      const double seconds = description_of_world.interval_seconds();
      acceleration_xy = (velocity.xy - Vec2{before.vx, before.vy}) / seconds;
      acceleration_z = (velocity.z - before.vz) / seconds;
    }
    const auto error = [&](ImuDraw draw, double noise, double bias) {
      // The bias has the key of tick 0 at every tick: it is constant over a run and differs between units.
      return Error(kNoiseStream, world, tick, draw, noise) + Error(kBiasStream, world, 0, draw, bias);
    };
    const double noise = parameters().acceleration_noise;
    const double bias = parameters().acceleration_bias;
    content.heading = WrapAngle(X_WS.heading + error(ImuDraw::kHeading, parameters().heading_noise, 0.0));
    content.turn = velocity.turn + error(ImuDraw::kTurn, parameters().gyro_noise, parameters().gyro_bias);
    content.force_xy = Transform2(X_WS).InverseRotate(acceleration_xy) +
                       Vec2{error(ImuDraw::kForceX, noise, bias), error(ImuDraw::kForceY, noise, bias)};
    content.force_z = acceleration_z + description_of_world.gravity + error(ImuDraw::kForceZ, noise, bias);
  }

  double Error(std::uint64_t stream, const SensedWorld& world, Tick tick, ImuDraw draw, double deviation) const {
    if (deviation == 0.0) return 0.0;
    return deviation * RandomNormal({stream, world.scene.world().seed, robot().index(), index(), tick,
                                     static_cast<std::uint64_t>(draw)});
  }

  std::size_t row_ = 0;  // of ImuState
};

}  // namespace

std::unique_ptr<const Sensor> MakeImu(const SensorMount& mount) {
  return std::make_unique<Imu>(mount);
}

}  // namespace troupe
