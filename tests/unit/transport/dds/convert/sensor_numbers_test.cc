#include "transport/dds/convert/sensor_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "tests/support/random_rows.h"

namespace troupe::dds {
namespace {

// Of each kind, with values at random.
std::vector<SensorParameters> AllKinds() {
  test::RandomRows random(1);
  std::vector<SensorParameters> kinds(std::variant_size_v<SensorParameters>);
  for (std::size_t i = 0; i < kinds.size(); ++i) random.FillKind(kinds[i], i);
  return kinds;
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
