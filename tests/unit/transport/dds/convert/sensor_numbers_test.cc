#include "transport/dds/convert/sensor_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace troupe::dds {
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

TEST(SensorNumbers, EveryKindSurvivesItsFields) {
  const std::vector<SensorParameters> kinds = AllKinds();
  ASSERT_EQ(kinds.size(), std::variant_size_v<SensorParameters>);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const SensorParameters& parameters = kinds[i];
    ASSERT_EQ(parameters.index(), i);
    const Result<SensorParameters> read = ParametersFrom(TypeOf(parameters), NumbersOf(parameters));
    ASSERT_TRUE(read.ok()) << TypeOf(parameters) << ": " << read.error().message;
    EXPECT_EQ(read.value(), parameters) << TypeOf(parameters);
  }
}

TEST(SensorNumbers, DamagedFieldsAreRefused) {
  for (const SensorParameters& parameters : AllKinds()) {
    const std::vector<NamedNumbers> fields = NumbersOf(parameters);
    EXPECT_FALSE(ParametersFrom("scent", fields).ok());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::vector<NamedNumbers> damaged = fields;
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
    std::vector<NamedNumbers> more = fields;
    more.push_back({"more", {}});
    EXPECT_FALSE(ParametersFrom(TypeOf(parameters), more).ok());
  }
}

TEST(SensorNumbers, WholeNumbersAreWholeAndListsEnd) {
  std::vector<NamedNumbers> fields = NumbersOf(BlobfinderParameters{});
  for (const double width : {1.5, -1.0, 1e12, std::nan(""), std::numeric_limits<double>::infinity()}) {
    fields[1].numbers = {width};
    EXPECT_FALSE(ParametersFrom("blobfinder", fields).ok()) << width;
  }
  fields = NumbersOf(BumperParameters{});
  fields[0].numbers = {4e9};  // the length of a list without elements
  EXPECT_FALSE(ParametersFrom("bumper", fields).ok());
}

}  // namespace
}  // namespace troupe::dds
