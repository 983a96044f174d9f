#include "troupe/sensor_description.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace troupe {
namespace {

// One of each kind, with values that are no defaults.
std::vector<SensorParameters> AllKinds() {
  RaySensorDescription ray{{1, 2, 3, 0.5}, {0.5, 9.0}, 2.0, 7, 0.1, 0.2, 0.3, {-0.5, 0.25}};
  return {
      RangerParameters{{ray, RaySensorDescription{}}},
      BreakBeamParameters{{{{1, 2}, {3, 4}, 5}}},
      FiducialParameters{{1, 2, 3, 0.5}, {0.5, 9.0}, 3.0, 2.0, -1'000'000'000, true},
      BumperParameters{{{{1, 2, 3, 0.5}, 0.25}, {{}, 1.0}}, 0.1},
      ContactParameters{},
      BlobfinderParameters{{1, 2, 3, 0.5}, 10, 20, 3.0, 1.0, {{0.1, 0.2, 0.3, 0.4}, {}}},
      CameraParameters{{1, 2, 3, 0.5}, 10, 20, {0.5, 9.0}, 1.0, {-0.2, 0.4}},
      RadioParameters{{1, 2, 3, 0.5}, 4, 20.0, 5e3, 0.2, 0.1, 0.2, 15.0, 2.5, 9.0, 4.0, true, 0.1, 0.05},
      ImuParameters{{1, 2, 3, 0.5}, 0.01, 0.02, 0.03, 0.04, 0.05},
  };
}

TEST(SensorDescription, EveryKindSurvivesItsFields) {
  const std::vector<SensorParameters> kinds = AllKinds();
  ASSERT_EQ(kinds.size(), std::variant_size_v<SensorParameters>);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const SensorParameters& parameters = kinds[i];
    ASSERT_EQ(parameters.index(), i);
    const Result<SensorParameters> read = ParametersFrom(TypeOf(parameters), FieldsOf(parameters));
    ASSERT_TRUE(read.ok()) << TypeOf(parameters) << ": " << read.error().message;
    EXPECT_EQ(read.value(), parameters) << TypeOf(parameters);
    if (TypeOf(parameters) == "break_beam") continue;  // they belong to grippers
    EXPECT_TRUE(CheckParameters(parameters).ok()) << CheckParameters(parameters).error().message;
  }
}

TEST(SensorDescription, DamagedFieldsAreRefused) {
  for (const SensorParameters& parameters : AllKinds()) {
    const std::vector<SensorField> fields = FieldsOf(parameters);
    EXPECT_FALSE(ParametersFrom("scent", fields).ok());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::vector<SensorField> damaged = fields;
      damaged[i].name += "x";
      EXPECT_FALSE(ParametersFrom(TypeOf(parameters), damaged).ok());
      damaged = fields;
      damaged[i].numbers.pop_back();
      EXPECT_FALSE(ParametersFrom(TypeOf(parameters), damaged).ok());
      damaged = fields;
      damaged[i].numbers.push_back(0.0);
      EXPECT_FALSE(ParametersFrom(TypeOf(parameters), damaged).ok());
      damaged = fields;
      damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_FALSE(ParametersFrom(TypeOf(parameters), damaged).ok());
    }
    std::vector<SensorField> more = fields;
    more.push_back({"more", {}});
    EXPECT_FALSE(ParametersFrom(TypeOf(parameters), more).ok());
  }
}

TEST(SensorDescription, WholeNumbersAreWholeAndListsEnd) {
  std::vector<SensorField> fields = FieldsOf(BlobfinderParameters{});
  for (const double width : {1.5, -1.0, 1e12, std::nan(""), std::numeric_limits<double>::infinity()}) {
    fields[1].numbers = {width};
    EXPECT_FALSE(ParametersFrom("blobfinder", fields).ok()) << width;
  }
  fields = FieldsOf(BumperParameters{});
  fields[0].numbers = {4e9};  // the length of a list without elements
  EXPECT_FALSE(ParametersFrom("bumper", fields).ok());
}

TEST(SensorDescription, ValuesThatCannotBeAreRefused) {
  const SensorParameters cases[] = {
      FiducialParameters{.range = {2.0, 1.0}},
      FiducialParameters{.range = {-1.0, 1.0}},
      FiducialParameters{.id_range = std::nan("")},
      FiducialParameters{.fov = 7.0},
      BumperParameters{.segments = {{{}, -1.0}}},
      BumperParameters{.height = -0.1},
      BlobfinderParameters{.width = 0},
      BlobfinderParameters{.height = 5000},
      BlobfinderParameters{.fov = 6.4},
      CameraParameters{.fov = 0.0},
      CameraParameters{.elevation = {0.3, 0.3}},
      CameraParameters{.elevation = {0.0, 1.55}},
      CameraParameters{.X_MS = {2e6, 0, 0, 0}},
      RangerParameters{{{.X_MS = {}, .elevations = {0.2, 0.1}}}},
      RangerParameters{{{.X_MS = {}, .elevations = {1.5}}}},
      RangerParameters{{{.X_MS = {}, .samples = 100'000, .elevations = std::vector<double>(41, 0.0)}}},
      BreakBeamParameters{},
  };
  for (const SensorParameters& parameters : cases) EXPECT_FALSE(CheckParameters(parameters).ok());
}

TEST(SensorDescription, SummariesCount) {
  EXPECT_EQ(SummaryOf(AllKinds()[0]), "2 sensors, 15 rays");
  EXPECT_EQ(SummaryOf(AllKinds()[2]), "up to 9 m");
  EXPECT_EQ(SummaryOf(AllKinds()[3]), "2 segments");
  EXPECT_EQ(SummaryOf(AllKinds()[4]), "");
  EXPECT_EQ(SummaryOf(AllKinds()[5]), "10 x 20 pixels, 2 colors");
  EXPECT_EQ(SummaryOf(AllKinds()[6]), "10 x 20 pixels");
}

}  // namespace
}  // namespace troupe
