#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "launcher/hosts/connect_hosts.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kRobots = {"a0", "b0", "a1", "b1", "c0"};

HostSettings Host(const std::string& name) {
  HostSettings host;
  host.name = name;
  return host;
}

HostSettings Counting(const std::string& name, std::uint32_t count) {
  HostSettings host = Host(name);
  host.robot_count = count;
  return host;
}

HostSettings Naming(const std::string& name, std::vector<std::string> robots) {
  HostSettings host = Host(name);
  host.robot_names = std::move(robots);
  return host;
}

TEST(PlaceRobots, DividesRobotsIntoEqualBlocks) {
  EXPECT_THAT(PlaceRobots(kRobots, {Host("x"), Host("y")}).value(), ElementsAre(0u, 0u, 0u, 1u, 1u));
}

TEST(PlaceRobots, PlacesNamedRobotsFirstThenCountedOnesThenTheRest) {
  const auto places = PlaceRobots(kRobots, {Host("rest"), Counting("two", 2), Naming("as", {"a*"})});
  EXPECT_THAT(places.value(), ElementsAre(2u, 1u, 2u, 1u, 0u));
}

TEST(PlaceRobots, LeavesAHostWithCountZeroIdle) {
  EXPECT_THAT(PlaceRobots(kRobots, {Counting("service", 0), Host("x")}).value(), ElementsAre(1u, 1u, 1u, 1u, 1u));
}

TEST(PlaceRobots, NamesUnknownRobotsAndMissingHosts) {
  EXPECT_THAT(PlaceRobots(kRobots, {Counting("x", 3)}).error().message, HasSubstr("hosts for 3 of 5 robots"));
  EXPECT_THAT(PlaceRobots(kRobots, {Naming("x", {"a7"}), Host("y")}).error().message,
              HasSubstr("host x: found no robot named 'a7'"));
}

}  // namespace
}  // namespace troupe
