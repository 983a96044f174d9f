// Trials of long trips by Open-RMF's messages alone, again and again.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/process/rmf_trips.h"

namespace troupe::test {
namespace {

constexpr const char* kHotel = "../../../worlds/sites/hotel.building.yaml";
constexpr int kRuns = 10;

// A trip by messages alone, twice: run after run has the same hashes.
TEST_F(RmfTrials, ARobotTakesTheLiftOfAGuesthouse) {
  folder_.Write("house.json", R"({"world": ")" + WorldPath(kHouse) + R"(", "people": [],
    "robots": [{"name": "tiny_1", "pose": [4, -3.75, 0], "controller": {"name": "slotcar"}}]})");
  const std::vector<Leg> legs = {
      Close("lobby_door"),  Drive({{4.5, -3.75}}),    Open("lobby_door"),  Drive({{7, -3.75}, {10, -3.75}}),
      Close("lobby_door"),  Call("guest_lift", "L1"), Drive({{10, -1.5}}), Call("guest_lift", "L2"),
      Drive({{10, -3.75}}), Leave("guest_lift")};
  const Outcome outcome = ExpectSame(folder_.Path("house.json"), {{"tiny_1", legs}}, 700, 2);
  EXPECT_EQ(outcome.trips[0].levels, (std::vector<std::string>{"L1", "L2"}));
}

TEST_F(RmfTrials, ARobotCrossesThreeLevelsThroughDoorsAndTwoLifts) {
  folder_.Write("hotel.json", R"({"world": ")" + WorldPath(kHotel) + R"(",
    "robots": [{"name": "tiny_1", "controller": {"name": "slotcar"}}]})");
  const std::vector<Leg> legs = {
      Close("housekeeping_entrance"),
      Close("door_304"),
      Drive({{34.5, 5.7}}),
      Open("housekeeping_entrance"),
      Drive({{31.2, 5.7}, {24, 9}, {20.5, 18.5}}),
      Close("housekeeping_entrance"),
      Call("Lift1", "L1"),
      Drive({{20.5, 22.2}}),
      Call("Lift1", "L2"),
      Drive({{20.5, 18.5}}),
      Leave("Lift1"),
      Drive({{24, 14.5}, {27.5, 18.5}}),
      Call("Lift2", "L2"),
      Drive({{27.5, 22.2}}),
      Call("Lift2", "L3"),
      Drive({{27.5, 18.5}}),
      Leave("Lift2"),
      Drive({{24, 14.5}, {24, 10.7}}),
      Open("door_304"),
      Drive({{21.6, 10.4}, {21.6, 5.4}}),
      Close("door_304"),
  };
  const Outcome outcome = ExpectSame(folder_.Path("hotel.json"), {{"tiny_1", legs}}, 2400, kRuns);
  EXPECT_EQ(outcome.trips[0].levels, (std::vector<std::string>{"L1", "L2", "L3"}));
}

TEST_F(RmfTrials, TwoRobotsAndACrowdContendForOneLift) {
  folder_.Write("crowd.json", R"({"world": ")" + WorldPath(kHotel) + R"(",
    "robots": [{"name": "tiny_1", "pose": [20.5, 14, 90], "controller": {"name": "slotcar"}},
               {"name": "tiny_2", "pose": [27.5, 16, 90], "controller": {"name": "slotcar"}}],
    "people": [{"count": 40, "region": [17, 2, 31, 19], "name_prefix": "guest", "wait": [2, 8],
                "goals": ["lobby", "entrance", "reception", "lift1_lobby_L1", "lift2_lobby_L1"]}]})");
  const auto legs_to = [](double x, double y) {
    return std::vector<Leg>{Call("Lift1", "L1"), Drive({{20.5, 18.5}, {20.5, 22.2}}),
                            Call("Lift1", "L2"), Drive({{20.5, 18.5}}),
                            Drive({{x, y}}),     Leave("Lift1")};
  };
  const Outcome outcome = ExpectSame(folder_.Path("crowd.json"),
                                     {{"tiny_1", legs_to(24, 14.5)}, {"tiny_2", legs_to(20.5, 14.5)}}, 3000, kRuns);
  for (const Trip& trip : outcome.trips) EXPECT_EQ(trip.levels, (std::vector<std::string>{"L1", "L2"})) << trip.robot;
}

}  // namespace
}  // namespace troupe::test
