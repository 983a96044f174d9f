// The descriptions of sensors other than rangers, and of scanners with several planes.
#include "tests/support/small_world.h"
#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDegree = kPi / 180.0;

// The only sensor of a robot with this model on it.
SensorDescription SensorOf(const std::string& model, const std::string& before = "") {
  const LoadedWorld loaded = WorldFolder().LoadText(before + "position( name \"r\" " + model + " )");
  if (loaded.world.robots.size() != 1 || loaded.world.robots[0].sensors.size() != 1) {
    ADD_FAILURE() << "expected one robot with one sensor";
    return {};
  }
  EXPECT_TRUE(Validate(loaded.world).ok()) << Validate(loaded.world).error().message;
  return loaded.world.robots[0].sensors[0];
}

template <typename Parameters>
Parameters ParametersOf(const std::string& model, const std::string& before = "") {
  return std::get<Parameters>(SensorOf(model, before).parameters);
}

std::string ErrorOf(const std::string& model) {
  WorldFolder folder;
  folder.Write("w.world", "position( " + model + " )");
  return folder.ErrorOf("w.world");
}

TEST(Sensors, AFiducialFinderHasStagesDefaults) {
  const SensorDescription sensor = SensorOf("fiducial( )");
  EXPECT_EQ(sensor.name, "fiducial:0");
  EXPECT_EQ(sensor.period_ticks, 1u);
  EXPECT_EQ(std::get<FiducialParameters>(sensor.parameters),
            (FiducialParameters{.X_MS = {}, .range = {0.0, 8.0}, .id_range = 5.0, .fov = kPi}));
}

TEST(Sensors, AFiducialFinderIsRead) {
  const SensorDescription sensor = SensorOf(
      "fiducial( name \"eye\" update_interval 250 range_min 0.5 range_max 300 range_max_id 200 fov 90 "
      "fiducial_key 4 ignore_zloc 1 origin [10 0 0 90] )",
      "unit_length \"cm\"\n");
  EXPECT_EQ(sensor.name, "eye");
  EXPECT_EQ(sensor.period_ticks, 3u);
  const auto& finder = std::get<FiducialParameters>(sensor.parameters);
  EXPECT_EQ(finder.X_MS, (Pose{0.1, 0.0, 0.0, 0.5 * kPi}));
  EXPECT_NEAR(finder.range.min, 0.005, 1e-15);
  EXPECT_NEAR(finder.range.max, 3.0, 1e-15);
  EXPECT_NEAR(finder.id_range, 2.0, 1e-15);
  EXPECT_EQ(finder.fov, 0.5 * kPi);
  EXPECT_EQ(finder.key, 4);
  EXPECT_TRUE(finder.ignores_height);
}

TEST(Sensors, AModelHasAFiducialKey) {
  const LoadedWorld loaded = WorldFolder().LoadText("model( fiducial_return 3 fiducial_key -2 )");
  EXPECT_EQ(loaded.world.models[0].fiducial_return, 3);
  EXPECT_EQ(loaded.world.models[0].fiducial_key, -2);
}

TEST(Sensors, ABumperIsRead) {
  const auto bumper = ParametersOf<BumperParameters>(
      "bumper( size [0.4 0.4 0.1] bcount 2 blength 0.2 bpose[0] [0.2 0 0.01 0] bpose[1] [0 0.2 0 90] blength[1] 0.3 )");
  EXPECT_EQ(bumper.height, 0.1);
  ASSERT_EQ(bumper.segments.size(), 2u);
  EXPECT_EQ(bumper.segments[0], (BumperSegment{{0.2, 0.0, 0.01, 0.0}, 0.2}));
  EXPECT_EQ(bumper.segments[1], (BumperSegment{{0.0, 0.2, 0.0, 0.5 * kPi}, 0.3}));
}

TEST(Sensors, AnImuIsRead) {
  EXPECT_EQ(SensorOf("imu( )").name, "imu:0");
  EXPECT_EQ(ParametersOf<ImuParameters>("imu( )"), ImuParameters{});
  EXPECT_EQ(ParametersOf<ImuParameters>("imu( origin [0.1 0 0 0] heading_noise 90 gyro_noise 180 gyro_bias 45 "
                                        "acceleration_noise 0.2 acceleration_bias 0.3 )"),
            (ImuParameters{{0.1, 0.0, 0.0, 0.0}, 0.5 * kPi, kPi, 0.25 * kPi, 0.2, 0.3}));
}

TEST(Sensors, AContactSensorHasNoBody) {
  const LoadedWorld loaded = WorldFolder().LoadText("position( contact( ) )");
  EXPECT_TRUE(loaded.world.shape(loaded.world.models[1].shape).empty());
  EXPECT_EQ(TypeOf(loaded.world.robots[0].sensors[0].parameters), "contact");
}

TEST(Sensors, ABlobfinderIsRead) {
  const auto finder = ParametersOf<BlobfinderParameters>(
      "blobfinder( image [100 50] range 6 fov 90 pan 30 colors_count 2 colors [\"red\" \"blue\"] )");
  EXPECT_EQ(finder.width, 100u);
  EXPECT_EQ(finder.height, 50u);
  EXPECT_EQ(finder.range, 6.0);
  EXPECT_EQ(finder.fov, 0.5 * kPi);
  EXPECT_NEAR(finder.X_MS.heading, 30.0 * kDegree, 1e-15);
  EXPECT_THAT(finder.colors, ElementsAre(Color{1.0, 0.0, 0.0, 1.0}, Color{0.0, 0.0, 1.0, 1.0}));
  EXPECT_THAT(ParametersOf<BlobfinderParameters>("blobfinder( )").colors, IsEmpty());
  EXPECT_NEAR(ParametersOf<BlobfinderParameters>("blobfinder( fov 180 )").fov, kPi, 1e-12);
  EXPECT_NEAR(ParametersOf<BlobfinderParameters>("blobfinder( fov 360 )").fov, 2.0 * kPi, 1e-12);
}

TEST(Sensors, ACameraIsRead) {
  const auto camera = ParametersOf<CameraParameters>(
      "camera( size [0.1 0.1 0.06] resolution [320 240] range [0.1 20] fov [80 60] pantilt [90 -10] )");
  EXPECT_EQ(camera.width, 320u);
  EXPECT_EQ(camera.height, 240u);
  EXPECT_EQ(camera.range, (Interval{0.1, 20.0}));
  EXPECT_NEAR(camera.fov, 80.0 * kDegree, 1e-15);
  EXPECT_NEAR(camera.elevation.min, -40.0 * kDegree, 1e-15);
  EXPECT_NEAR(camera.elevation.max, 20.0 * kDegree, 1e-15);
  EXPECT_NEAR(camera.X_MS.heading, 0.5 * kPi, 1e-15);
  EXPECT_NEAR(camera.X_MS.z, 0.03, 1e-15);
  const auto plain = ParametersOf<CameraParameters>("camera( )");
  EXPECT_EQ(plain.width, 32u);
  EXPECT_EQ(plain.range, (Interval{0.2, 8.0}));
}

std::vector<double> ElevationsOf(const std::string& sensor) {
  return ParametersOf<RangerParameters>("ranger( sensor( " + sensor + " ) )").ray_sensors->at(0).elevations;
}

TEST(Sensors, AScannerHasPlanes) {
  EXPECT_THAT(ElevationsOf("samples 4"), IsEmpty());
  EXPECT_THAT(ElevationsOf("planes 1 vertical_fov 40"), IsEmpty());
  const std::vector<double> three = ElevationsOf("planes 3 vertical_fov 40");
  ASSERT_EQ(three.size(), 3u);
  EXPECT_NEAR(three[0], -20.0 * kDegree, 1e-15);
  EXPECT_EQ(three[1], 0.0);
  EXPECT_NEAR(three[2], 20.0 * kDegree, 1e-15);
  const std::vector<double> listed = ElevationsOf("elevations [10 -5]");
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_NEAR(listed[0], -5.0 * kDegree, 1e-15);
  EXPECT_NEAR(listed[1], 10.0 * kDegree, 1e-15);
}

TEST(Sensors, ALightIndicatorIsDarkUntilItIsSwitchedOn) {
  const ModelDescription light = WorldFolder().LoadText("lightindicator( )").world.models[0];
  EXPECT_FALSE(light.blinking.is_switched_on);
  EXPECT_NE(ColorAt(light, 0, false), light.color);
  for (const std::int64_t time_ns : {0L, 999'999'999L, 1'000'000'000L})
    EXPECT_EQ(ColorAt(light, time_ns, true), light.color);
}

TEST(Sensors, ABlinkenlightIsOnForItsDutyCycle) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "blinkenlight( period 200 dutycycle 0.25 )\nblinkenlight( pose [1 0 0 0] enabled 0 )\n"
      "blinkenlight( pose [2 0 0 0] )\n");
  EXPECT_EQ(loaded.world.models[0].blinking, (Blinking{200'000'000, 50'000'000}));
  EXPECT_EQ(loaded.world.models[1].blinking, (Blinking{1'000'000'000, 1'000'000'000, false}));
  EXPECT_EQ(loaded.world.models[2].blinking, (Blinking{1'000'000'000, 1'000'000'000}));
  EXPECT_EQ(ColorAt(loaded.world.models[0], 249'999'999, true), loaded.world.models[0].color);
  EXPECT_NE(ColorAt(loaded.world.models[0], 250'000'000, true), loaded.world.models[0].color);
  EXPECT_NE(ColorAt(loaded.world.models[1], 0, false), loaded.world.models[1].color);
  EXPECT_EQ(ColorAt(loaded.world.models[2], 999'999'999, true), loaded.world.models[2].color);
}

TEST(Sensors, ASensorOnNoRobotIsNamed) {
  EXPECT_THAT(WorldFolder().WarningsOf("fiducial( )\nmodel( camera( ) )\n"),
              ElementsAre("w.world:1:1: warning: this fiducial is on no robot, so it measures nothing",
                          "w.world:2:8: warning: this camera is on no robot, so it measures nothing"));
}

TEST(Sensors, WrongValuesAreRefusedAtTheirPlaces) {
  EXPECT_EQ(ErrorOf("bumper( bcount 1 bpose[0] [1 2] )"),
            "w.world:1:37: error: found 2 values for 'bpose[0]', expected 4");
  EXPECT_EQ(ErrorOf("ranger( sensor( planes 2 vertical_fov 0 ) )"),
            "w.world:1:49: error: found no 'vertical_fov' above 0 for several planes");
  EXPECT_THAT(ErrorOf("ranger( sensor( elevations [5 5] ) )"), HasSubstr("w.world:1:38: error: found elevations"));
  EXPECT_THAT(ErrorOf("imu( gyro_noise -5 )"), HasSubstr("gyro_noise: found -5, expected at least 0 degrees/s"));
}

// Others are read as the nearest sensible ones (odd_values_test has more).
TEST(Sensors, WrongValuesOfSingleNumbersAreWarnings) {
  const auto warnings = [](const std::string& sensor) {
    return WorldFolder().WarningsOf("position( " + sensor + " )");
  };
  EXPECT_THAT(
      warnings("bumper( bcount 2000 blength -2 )"),
      testing::UnorderedElementsAre("w.world:1:26: warning: found 2000 for 'bcount', expected 0 to 1000; 1000 is used",
                                    "w.world:1:39: warning: found a negative 'blength', expected at least 0; 0 is "
                                    "used"));
  EXPECT_THAT(warnings("ranger( sensor( planes 0 ) )"),
              ElementsAre("w.world:1:34: warning: found 0 for 'planes', expected 1 to 1024; 1 is used"));
  EXPECT_THAT(warnings("radio( loss 1.5 range -1 delay 61 bandwidth \"fast\" )"), testing::SizeIs(4));
  const auto radio = ParametersOf<RadioParameters>("radio( loss 1.5 range -1 delay 61 bandwidth \"fast\" )", "");
  EXPECT_EQ(radio.loss, 1.0);
  EXPECT_EQ(radio.range, 0.0);
  EXPECT_EQ(radio.delay, kMaxRadioDelay);
  EXPECT_EQ(radio.bandwidth, RadioParameters().bandwidth);
  const auto camera = ParametersOf<CameraParameters>("camera( pantilt [0 80] )", "");
  EXPECT_EQ(camera.elevation.max, kMaxElevation);
}

TEST(Sensors, ARadioHasDefaults) {
  const SensorDescription sensor = SensorOf("size [0.4 0.4 0.3] radio( )");
  EXPECT_EQ(sensor.name, "radio:0");
  EXPECT_EQ(sensor.period_ticks, 1u);
  EXPECT_EQ(std::get<RadioParameters>(sensor.parameters), RadioParameters{});
}

TEST(Sensors, ARadioIsRead) {
  const auto radio = ParametersOf<RadioParameters>(
      "radio( name \"wifi\" origin [0 0 10 0] channel 6 range 3000 bandwidth 1200 delay 0.25 loss 0.1 range_loss 0.5 "
      "power 15 path_loss_exponent 3 wall_loss 8 body_loss 2 range_and_bearing 1 range_noise 2 bearing_noise 3 )",
      "unit_length \"cm\"\n");
  EXPECT_EQ(radio.X_MS.z, 0.1);
  EXPECT_EQ(radio.channel, 6);
  EXPECT_EQ(radio.range, 30.0);
  EXPECT_EQ(radio.bandwidth, 1200.0);
  EXPECT_EQ(radio.delay, 0.25);
  EXPECT_EQ(radio.loss, 0.1);
  EXPECT_EQ(radio.range_loss, 0.5);
  EXPECT_EQ(radio.power, 15.0);
  EXPECT_EQ(radio.path_loss_exponent, 3.0);
  EXPECT_EQ(radio.wall_loss, 8.0);
  EXPECT_EQ(radio.body_loss, 2.0);
  EXPECT_TRUE(radio.range_and_bearing);
  EXPECT_NEAR(radio.range_noise, 0.02, 1e-15);
  EXPECT_NEAR(radio.bearing_noise, 3.0 * kDegree, 1e-15);
}

TEST(Sensors, ARadioReceivesInEveryTick) {
  EXPECT_EQ(SensorOf("radio( update_interval 1000 )").period_ticks, 1u);
  EXPECT_THAT(WorldFolder().WarningsOf("position( radio( update_interval 1000 ) )"),
              ElementsAre(HasSubstr("a radio receives in every tick")));
}

}  // namespace
}  // namespace troupe
