// People who come and go: visits at rates and by time tables, recorded ways, and evacuation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "troupe/simulation.h"
#include "world-service/core/find_overlap.h"
#include "worldfile/load_world.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/scenario/track_file.h"

namespace troupe {
namespace {

using test::TemporaryFolder;
using test::ValueOf;

// A corridor of 20 m by 4 m, with walls along x.
constexpr const char* kCorridor = R"("models": [
    {"name": "south", "model": "model", "pose": [10, -2.1, 0], "properties": {"size": [24, 0.2, 2]}},
    {"name": "north", "model": "model", "pose": [10, 2.1, 0], "properties": {"size": [24, 0.2, 2]}}])";

std::string CorridorText(const std::string& people) {
  return std::string("{") + kCorridor + ", \"seed\": 7, " + people + "}";
}

Simulation LoadCorridor(const std::string& people) {
  return ValueOf(Simulation::LoadScenario(CorridorText(people), "scenario.json"));
}

std::string ErrorOfCorridor(const std::string& people) {
  const Result<LoadedWorld> loaded = LoadScenarioText(CorridorText(people), "s.json");
  return loaded.ok() ? "" : loaded.error().ToString();
}

std::size_t CountPresent(const WorldState& state) {
  return static_cast<std::size_t>(
      std::count_if(state.people.begin(), state.people.end(), [](const PersonState& p) { return !IsAway(p); }));
}

// Two people who are at one place overlap; those who are away do not count.
void ExpectApart(const Simulation& run) {
  const std::vector<PersonState>& people = run.state().people;
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (IsAway(people[i]) || IsAway(people[k])) continue;
      const double distance = (people[i].X_WP.translation() - people[k].X_WP.translation()).norm();
      EXPECT_GE(distance, 0.95 * (run.world().people[i].radius + run.world().people[k].radius)) << run.tick();
    }
  }
}

const std::string kGuests = R"("people": [{"count": 40, "region": [0.4, -1.5, 1.6, 1.5], "goals": [[8, 1], [8, -1]],
    "wait": 2, "name_prefix": "guest", "visits": {"exits": [[19, 0]], )";

TEST(Visits, PeopleComeGoToTheirGoalsAndLeave) {
  Simulation run = LoadCorridor(kGuests + R"("per_hour": 900}}])");
  EXPECT_EQ(CountPresent(run.state()), 0U);
  std::size_t entered = 0;
  std::size_t left = 0;
  std::set<std::size_t> at_goal;
  for (int i = 0; i < 3000; ++i) {
    run.Step();
    for (const Event& event : run.events()) {
      entered += event.type == EventType::kPersonEntered ? 1 : 0;
      left += event.type == EventType::kPersonLeft ? 1 : 0;
    }
    for (std::size_t p = 0; p < run.state().people.size(); ++p) {
      const PersonState& person = run.state().people[p];
      if (!IsAway(person) && person.dwell_ticks > 0) at_goal.insert(p);
    }
    EXPECT_EQ(entered - left, CountPresent(run.state()));
    if (i % 10 == 0) ExpectApart(run);
  }
  const VisitorFlowState& flow = run.state().visitor_flows[0];
  // 75 in 300 s, at random.
  EXPECT_GT(flow.came, 50U);
  EXPECT_LT(flow.came, 100U);
  EXPECT_EQ(flow.refused, 0U);
  EXPECT_LE(flow.came - entered, 2U);
  EXPECT_GT(left, entered - 20U);
  EXPECT_GT(at_goal.size(), 5U);
  std::uint32_t visits = 0;
  for (const VisitorState& visitor : run.state().visitors) visits += visitor.visits;
  EXPECT_EQ(visits, entered);
}

TEST(Visits, ComeByATimeTableAndAreRefusedWithoutAFreeBody) {
  Simulation run =
      LoadCorridor(R"("people": [{"count": 3, "region": [0.4, -1.5, 1.6, 1.5], "goals": [[8, 0]], "wait": 1000,
      "visits": {"exits": [[19, 0]], "per_hour": [[0, 0], [20, 3600], [40, 0]], "arrive": "evenly"}}])");
  run.Step(195);
  EXPECT_EQ(run.state().visitor_flows[0].came, 0U);
  run.Step(305);
  EXPECT_EQ(run.state().visitor_flows[0], (VisitorFlowState{.came = 3, .refused = 17}));
  EXPECT_EQ(CountPresent(run.state()), 3U);
}

TEST(Visits, GroupsComeTogetherAndLeave) {
  Simulation run = LoadCorridor(
      R"("people": [{"count": 12, "region": [0.4, -1.5, 1.9, 1.5], "group": 3, "goals": [[8, 0]], "wait": 1,
      "visits": {"exits": [[19, 0]], "per_hour": 360, "arrive": "evenly"}}])");
  run.Step(102);
  EXPECT_EQ(run.state().visitor_flows[0].came, 3U);
  run.Step(95);
  EXPECT_EQ(CountPresent(run.state()), 3U);
  run.Step(900);
  EXPECT_EQ(run.state().visitor_flows[0].refused, 0U);
  std::uint32_t visits = 0;
  for (const VisitorState& visitor : run.state().visitors) visits += visitor.visits;
  EXPECT_GE(visits, 30U);
  // No more than those of the last minute: the others have left, the followers, too.
  run.Step(9000);
  EXPECT_EQ(run.state().visitor_flows[0].refused, 0U);
  EXPECT_LE(CountPresent(run.state()), 12U);
}

TEST(Visits, AnEntranceThatIsBlockedDelaysPeopleAndLosesNone) {
  Simulation run = LoadCorridor(R"("robots": [{"name": "box", "model": "position", "pose": [1, 0, 0],
        "properties": {"size": [1.6, 3, 1], "drive": "omni"}}],
      "people": [{"count": 4, "region": [2.2, -1.2, 2.6, 1.2], "goals": [], "name_prefix": "guest",
        "visits": {"exits": [[19, 0]], "per_hour": 36000, "arrive": "evenly"}}])");
  // The body stands in the region.
  ASSERT_TRUE(run.SetPose("box", {2.4, 0.0, 0.0, 0.0}).ok());
  run.Step(20);
  EXPECT_EQ(CountPresent(run.state()), 0U);
  EXPECT_EQ(run.state().visitor_flows[0].came, 4U);
  ASSERT_TRUE(run.SetPose("box", {6.0, 5.0, 0.0, 0.0}).ok());
  run.Step(60);
  std::uint32_t visits = 0;
  for (const VisitorState& visitor : run.state().visitors) visits += visitor.visits;
  EXPECT_GE(visits, 4U);
}

TEST(Visits, ARunGoesOnFromASnapshotAndRepeats) {
  const std::string text = kGuests + R"("per_hour": 1800}}])";
  Simulation run = LoadCorridor(text);
  run.Step(400);
  const Snapshot snapshot = ValueOf(run.Save());
  run.Step(400);
  const std::uint64_t hash = StateHash(run.state());
  Simulation again = LoadCorridor(text);
  again.Step(800);
  EXPECT_EQ(StateHash(again.state()), hash);
  ASSERT_TRUE(run.Restore(snapshot).ok());
  run.Step(400);
  EXPECT_EQ(StateHash(run.state()), hash);
}

TEST(Evacuation, EmptiesItsZoneByTheNearestExits) {
  Simulation run = LoadCorridor(R"("people": [
        {"count": 30, "region": [0.4, -1.5, 19, 1.5], "goals": [[3, 0], [17, 0]], "name_prefix": "clerk"},
        {"count": 4, "region": [2, -1.5, 4, 1.5], "group": 2, "name_prefix": "pair"}],
      "zones": [{"name": "all", "kind": "evacuation", "region": [-1, -2, 21, 2], "exits": [[0, 0], [20, 0]], "on": false}],
      "events": [{"at": 10, "zone": "all", "on": true}])");
  run.Step(99);
  EXPECT_EQ(CountPresent(run.state()), 34U);
  std::vector<bool> was_west;
  for (const PersonState& person : run.state().people) was_west.push_back(person.X_WP.x < 10.0);
  std::vector<double> last(34, 0.0);
  for (int i = 0; i < 400; ++i) {
    for (std::size_t p = 0; p < last.size(); ++p) {
      if (!IsAway(run.state().people[p])) last[p] = run.state().people[p].X_WP.x;
    }
    run.Step();
    if (i % 10 == 0) ExpectApart(run);
  }
  EXPECT_EQ(CountPresent(run.state()), 0U);
  for (std::size_t p = 0; p < last.size(); ++p) {
    // Those about the middle may have gone over it before the alarm.
    if (std::abs(last[p] - 10.0) > 8.0) EXPECT_TRUE(last[p] < 1.0 || last[p] > 19.0) << p << ": " << last[p];
  }
}

TEST(Evacuation, LetsNoVisitorEnterUntilItIsOver) {
  Simulation run = LoadCorridor(kGuests + R"("per_hour": 3600}}],
      "zones": [{"name": "all", "kind": "evacuation", "region": [-1, -2, 21, 2], "exits": [[0, 0]], "on": true}],
      "events": [{"at": 30, "zone": "all", "on": false}])");
  run.Step(295);
  EXPECT_EQ(CountPresent(run.state()), 0U);
  EXPECT_GT(run.state().visitor_flows[0].came, 10U);
  run.Step(50);
  EXPECT_GT(CountPresent(run.state()), 5U);
}

// Recorded people.

constexpr const char* kTracks =
    "# frame person x y\n"
    "0\t1\t1.0\t0.0\n10\t1\t1.5\t0.0\n20\t1\t2.0\t0.0\n30\t1\t2.5\t0.0\n"
    "20 2 9 0.5\n30 2 8.5 0.5\n40 2 8.0 0.5\n";

TEST(RecordedPeople, AreWhereTheyWereRecorded) {
  const TemporaryFolder folder;
  folder.Write("tracks.txt", kTracks);
  Simulation run = ValueOf(Simulation::LoadScenario(
      R"({"recorded_people": [{"file": "tracks.txt", "start": 1, "pose": [0, 1, 0]}]})", folder.Path("s.json")));
  ASSERT_EQ(run.world().people.size(), 2U);
  EXPECT_EQ(CountPresent(run.state()), 0U);
  run.Step(12);  // 1.2 s: half of the way from the first row to the second
  ASSERT_FALSE(IsAway(run.state().people[0]));
  EXPECT_TRUE(IsAway(run.state().people[1]));
  EXPECT_NEAR(run.state().people[0].X_WP.x, 1.25, 1e-9);
  EXPECT_NEAR(run.state().people[0].X_WP.y, 1.0, 1e-9);
  EXPECT_NEAR(run.state().people[0].vx, 1.25, 1e-9);
  run.Step(8);  // 2 s
  EXPECT_NEAR(run.state().people[0].X_WP.x, 2.25, 1e-9);
  EXPECT_NEAR(run.state().people[1].X_WP.x, 8.75, 1e-9);
  run.Step(20);
  EXPECT_EQ(CountPresent(run.state()), 0U);
  run.Step(100);
  EXPECT_EQ(run.state().visitors[0].visits, 1U);
}

TEST(RecordedPeople, StopAtABodyInTheirWay) {
  const TemporaryFolder folder;
  folder.Write("tracks.txt", kTracks);
  Simulation run = ValueOf(Simulation::LoadScenario(
      R"({"recorded_people": [{"file": "tracks.txt"}], "models": [
            {"name": "post", "model": "model", "pose": [2.1, 0, 0], "properties": {"size": [0.2, 0.2, 1]}}]})",
      folder.Path("s.json")));
  run.Step(11);
  const PersonState& person = run.state().people[0];
  ASSERT_FALSE(IsAway(person));
  EXPECT_LT(person.X_WP.x, 1.76);
  EXPECT_GT(person.X_WP.x, 1.5);
}

TEST(RecordedPeople, ReactOnTheirWayIfTheyAreTo) {
  const TemporaryFolder folder;
  folder.Write("tracks.txt", "0 1 0 0\n200 1 9.6 0\n0 2 9.6 0.1\n200 2 0 0.1\n");
  Simulation run = ValueOf(Simulation::LoadScenario(R"({"recorded_people": [{"file": "tracks.txt", "react": true}]})",
                                                    folder.Path("s.json")));
  double least = 10.0;
  for (int i = 0; i < 150; ++i) {
    run.Step();
    if (CountPresent(run.state()) < 2) continue;
    const std::vector<PersonState>& people = run.state().people;
    least = std::min(least, (people[0].X_WP.translation() - people[1].X_WP.translation()).norm());
  }
  EXPECT_GE(least, 0.5);
  EXPECT_EQ(CountPresent(run.state()), 0U);
}

TEST(RecordedPeople, TheFormsOfDataSets) {
  const std::vector<RecordedPerson> people =
      ValueOf(ReadTracks("7.8e+02 3 1.5 0 2.5 0.1 0 0.1\n7.86e+02 3 1.6 0 2.7 0.1 0 0.1\n", "obsmat.txt", 15.0));
  ASSERT_EQ(people.size(), 1U);
  EXPECT_THAT(people[0].positions, testing::ElementsAre(Vec2(1.5, 2.5), Vec2(1.6, 2.7)));
  EXPECT_THAT(people[0].times, testing::ElementsAre(0.0, 0.4));
  const auto error = [](const char* text) { return ReadTracks(text, "t.txt", 25.0).error().ToString(); };
  EXPECT_EQ(error(""), "t.txt:1:1: error: found no row, expected recorded positions: frame, person, x and y");
  EXPECT_EQ(error("1 2 3\n"),
            "t.txt:1:1: error: found 3 fields, expected frame, person, x and y, or the 8 fields of an obsmat.txt");
  EXPECT_EQ(error("0 1 2 3\n1 1 nan 3\n"), "t.txt:2:5: error: found 'nan', expected a coordinate in m, within 1e6");
  EXPECT_EQ(error("0,1.5,2,3\n"), "t.txt:1:3: error: found '1.5', expected a whole number of a person");
  EXPECT_EQ(
      error("0 1 2 3\n0 1 2 3\n"),
      "t.txt:2:1: error: found person 1 in one frame a second time, expected one position of it (the first one is "
      "in line 1)");
  EXPECT_EQ(error("0 1 2 3\n0 2 2 3\n"),
            "t.txt:1:1: error: found no person with two positions, expected ways of people");
}

TEST(VisitorsScenario, ErrorsSayWhatIsWrong) {
  const std::string rule = R"("people": [{"count": 1, "region": [0, 0, 1, 1], "visits": )";
  EXPECT_THAT(ErrorOfCorridor(rule + R"({"per_hour": 1, "exits": []}}])"),
              testing::HasSubstr("found no exit, expected places"));
  EXPECT_THAT(ErrorOfCorridor(rule + R"({"per_hour": [[5, 1]], "exits": [[1, 1]]}}])"),
              testing::HasSubstr("found a time table that begins later, expected the first time to be 0"));
  EXPECT_THAT(ErrorOfCorridor(rule + R"({"per_hour": [[0, 1], [0, 2]], "exits": [[1, 1]]}}])"),
              testing::HasSubstr("found a time that is not after the one before it"));
  EXPECT_THAT(ErrorOfCorridor(rule + R"({"per_hour": 1, "exits": ["nowhere"]}}])"),
              testing::HasSubstr("found no place 'nowhere'"));
  EXPECT_THAT(ErrorOfCorridor(R"("zones": [{"name": "z", "kind": "evacuation", "region": [0, 0, 1, 1]}])"),
              testing::HasSubstr("found an evacuation zone without an exit"));
  EXPECT_THAT(ErrorOfCorridor(R"("recorded_people": [{"file": "none.txt"}])"), testing::HasSubstr("none.txt"));
}

}  // namespace
}  // namespace troupe
