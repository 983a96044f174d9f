// The usual experiments with crowds, against what has been measured with people (docs/people.md).
#include "benchmarks/people_experiments.h"

#include <gtest/gtest.h>

#include <iostream>

namespace troupe {
namespace {

constexpr double kRounding = 1e-6;  // m

// 1.2 to 1.9 persons per metre and second (Seyfried et al. 2009, Kretz et al. 2006).
TEST(PeopleExperiments, TheFlowThroughAnOpeningIsThatOfMeasurements) {
  for (const double width : {0.8, 1.0, 2.0}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      if (seed == 2 && width != 1.0) continue;
      const bench::OpeningFlow result = bench::MeasureOpening(width, 100, seed);
      std::cout << width << " m: " << result.flow << " persons per metre and second\n";
      EXPECT_GE(result.flow, 1.2) << width << " m, seed " << seed;
      EXPECT_LE(result.flow, 1.9) << width << " m, seed " << seed;
      EXPECT_GE(result.least_gap, -kRounding);
    }
  }
}

TEST(PeopleExperiments, TheSpeedFallsWithTheDensityAsWeidmannFound) {
  double before = 10.0;
  for (const double density : {0.5, 1.0, 2.0, 2.5, 3.0, 3.9}) {
    const bench::CorridorFlow result = bench::MeasureCorridor(density, 1);
    std::cout << result.density << " persons/m2: " << result.speed << " m/s\n";
    EXPECT_NEAR(result.density, density, 0.1);
    EXPECT_NEAR(result.speed, bench::WeidmannSpeed(result.density), density < 2.7 ? 0.12 : 0.2);
    EXPECT_LT(result.speed, before);
    before = result.speed;
    EXPECT_GE(result.least_gap, -kRounding);
  }
}

TEST(PeopleExperiments, PeopleWhoMeetInACorridorFormLanes) {
  for (const double density : {0.5, 1.0}) {
    const bench::RingFlow result = bench::MeasureRing(2.4, density, 2, 1);
    EXPECT_GT(result.speed, 0.65 * bench::WeidmannSpeed(density));
    EXPECT_GT(result.order, 0.9);  // of people at random places it is 0.5 or less
    EXPECT_LT(result.jammed, 0.02);
    EXPECT_GE(result.least_gap, -kRounding);
  }
}

TEST(PeopleExperiments, StreamsThatCrossDoNotJam) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const bench::Passage result = bench::RunToGoals(bench::CrossingWorld(4.0, 100, seed), 120.0, 12.0);
    EXPECT_GT(result.seconds, 20.0);
    EXPECT_LT(result.seconds, 70.0) << "seed " << seed;
    EXPECT_GE(result.least_gap, -kRounding);
  }
}

TEST(PeopleExperiments, PeopleOnACircleChangePlaces) {
  for (const std::size_t people : {16U, 32U}) {
    const bench::Passage result = bench::RunToGoals(bench::CircleWorld(8.0, people, 1), 100.0);
    EXPECT_GT(result.mean_speed, 1.0) << people;
    EXPECT_GT(result.seconds, 10.0);
    EXPECT_LT(result.seconds, 30.0);
    EXPECT_GE(result.least_gap, -kRounding);
  }
}

}  // namespace
}  // namespace troupe
