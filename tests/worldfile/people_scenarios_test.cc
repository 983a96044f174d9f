// People of scenarios and buildings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

#include "common/model/states.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "troupe/world_state.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

using test::ValueOf;

std::string Worlds() {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/";
}

LoadedWorld LoadPeople(const std::string& text) {
  return ValueOf(LoadScenarioText(text, Worlds() + "scenarios/text.json"));
}

std::string ErrorOfPeople(const std::string& text) {
  const Result<LoadedWorld> loaded = LoadScenarioText(text, "s.json");
  return loaded.ok() ? "" : loaded.error().ToString();
}

TEST(PeopleScenario, ARuleMakesPeopleWithBodiesGoalsAndGroups) {
  const WorldDescription world = LoadPeople(R"({
    "places": [{"name": "desk", "pose": [3, 4, 90]}],
    "people": [
      {"count": 5, "region": [0, 0, 6, 6], "goals": ["desk", [1, 2]], "wait": [3, 4], "speed": [1, 1.2], "group": 2,
       "reaction": "scared", "radius": 0.3, "height": 1.6, "name_prefix": "guest"},
      {"count": 1, "region": [8, 0, 9, 1], "z": 4, "goals": [[1, 2], [3, 4, 9]], "order": "in turn", "speed": 1,
       "max_speed": 2}
    ]})")
                                     .world;
  ASSERT_TRUE(Validate(world).ok());
  ASSERT_EQ(world.people.size(), 6u);
  ASSERT_EQ(world.goal_sets.size(), 3u);
  EXPECT_THAT(world.goal_sets[0].points, testing::ElementsAre(Vec2(3.0, 4.0), Vec2(1.0, 2.0)));
  EXPECT_THAT(world.goal_sets[0].heights, testing::ElementsAre(0.0, 0.0));
  EXPECT_THAT(world.goal_sets[1].heights, testing::ElementsAre(4.0));
  EXPECT_THAT(world.goal_sets[2].heights, testing::ElementsAre(9.0));
  EXPECT_EQ(world.goal_sets[0].wait, (Interval{3.0, 4.0}));
  EXPECT_EQ(world.goal_sets[0].next.at(0).goals, 0u);
  EXPECT_EQ(world.goal_sets[1].next.at(0).goals, 2u);
  EXPECT_EQ(world.goal_sets[2].next.at(0).goals, 1u);
  const PersonDescription& first = world.people[0];
  EXPECT_EQ(world.model(first.root).name, "guest1");
  EXPECT_EQ(world.model(first.root).type, "person");
  EXPECT_EQ(first.radius, 0.3);
  EXPECT_GE(first.speed, 1.0);
  EXPECT_LE(first.speed, 1.2);
  EXPECT_EQ(first.reaction, PersonReaction::kScared);
  EXPECT_FALSE(first.leader);
  EXPECT_EQ(world.people[1].leader, PersonId(0));
  EXPECT_FALSE(world.people[2].leader);
  EXPECT_EQ(world.people[3].leader, PersonId(2));
  EXPECT_FALSE(world.people[4].leader);
  EXPECT_EQ(world.model(world.people[5].root).X_PM.z, 4.0);
  EXPECT_EQ(world.people[5].max_speed, 2.0);
  const Scene scene(world);
  EXPECT_EQ(scene.body(scene.body_of(PersonId(0))).z, (ZRange{0.0, 1.6}));
  EXPECT_NEAR(scene.body(scene.body_of(PersonId(0))).radius, 0.3, 1e-12);
}

TEST(PeopleScenario, NoPersonStartsInAnythingAndTheSeedDecides) {
  const auto load = [](int seed) {
    return LoadPeople(R"({"world": "../office.world", "seed": )" + std::to_string(seed) + R"(,
      "spawn": [{"model": "scout", "count": 10, "region": [-12, -8, 12, 8]}],
      "people": [{"count": 40, "region": [-12, -8, 12, 8]}]})")
        .world;
  };
  const WorldDescription world = load(1);
  const Scene scene(world);
  const WorldState state = InitialState(scene);
  for (const PersonDescription& person : world.people) EXPECT_FALSE(FindOverlap(scene, state, person.root));
  EXPECT_EQ(Hash(load(1)), Hash(world));
  EXPECT_NE(load(2).model(load(2).people[0].root).X_PM, world.model(world.people[0].root).X_PM);
}

TEST(PeopleScenario, PeopleStayWhenARobotIsLeftOut) {
  const auto load = [](const std::string& without) {
    return LoadPeople(R"({"include": ["../include/robots.inc"], "without": [)" + without + R"(],
      "places": [{"name": "desk", "pose": [1, 1, 0]}],
      "robots": [{"name": "a", "model": "scout", "pose": [0, 0, 0]}, {"name": "b", "model": "porter", "pose": [1, 0, 0]},
                 {"name": "c", "model": "scout", "pose": [0, 1, 0]}],
      "people": [{"count": 6, "region": [-1, -1, 2, 2], "goals": ["desk", [2, 2]], "group": 2},
                 {"count": 2, "region": [-1, -1, 2, 2], "height": 1.6}]})")
        .world;
  };
  const WorldDescription whole = load("");
  const WorldDescription reduced = load(R"("b", "a")");
  ASSERT_TRUE(Validate(reduced).ok());
  EXPECT_EQ(reduced.robots.size(), 1u);
  EXPECT_EQ(reduced.goal_sets, whole.goal_sets);
  ASSERT_EQ(reduced.people.size(), whole.people.size());
  for (std::size_t i = 0; i < whole.people.size(); ++i) {
    const PersonDescription& person = reduced.people[i];
    const std::size_t before = whole.people[i].root.index();
    for (std::size_t part = 0; part < 2; ++part) {  // trunk and head
      const ModelDescription& model = reduced.model(ModelId(person.root.index() + part));
      const ModelDescription& same = whole.model(ModelId(before + part));
      EXPECT_EQ(model.name, same.name);
      EXPECT_EQ(model.X_PM, same.X_PM);
      EXPECT_EQ(model.color, same.color);
      EXPECT_EQ(reduced.shape(model.shape), whole.shape(same.shape));
    }
    EXPECT_EQ(reduced.model(ModelId(person.root.index() + 1)).parent, person.root);
    EXPECT_EQ(person.leader, whole.people[i].leader);
    EXPECT_EQ(person.goals, whole.people[i].goals);
    EXPECT_EQ(person.speed, whole.people[i].speed);
  }
}

TEST(PeopleScenario, PeopleOfTheShowsWalk) {
  for (const char* name : {"people.json", "hall.json"}) {
    SCOPED_TRACE(name);
    const Scene scene(ValueOf(LoadScenario(Worlds() + "scenarios/" + name)).world);
    ASSERT_FALSE(scene.world().people.empty());
    WorldState state = InitialState(scene);
    const WorldState start = state;
    BodyIndex bodies(scene);
    for (int i = 0; i < 100; ++i) state = Step(scene, state, {}, bodies).state;
    std::size_t walked = 0;
    for (std::size_t i = 0; i < state.people.size(); ++i) {
      walked += (state.people[i].X_WP.translation() - start.people[i].X_WP.translation()).norm() > 1.0 ? 1 : 0;
      EXPECT_FALSE(FindOverlap(scene, state, scene.world().people[i].root)) << i;
    }
    EXPECT_GT(walked, state.people.size() / 2);
  }
}

TEST(PeopleScenario, ErrorsNameThePlace) {
  EXPECT_EQ(ErrorOfPeople(R"({"people": [{"count": 1, "region": [0, 0, 1, 1], "goals": ["desk"]}]})"),
            "s.json:1:60: error: found no place 'desk', expected the name of one, or a point [x, y] or [x, y, z]");
  EXPECT_EQ(ErrorOfPeople(R"({"people": [{"count": 9, "region": [0, 0, 1, 1]}]})").substr(0, 30),
            "s.json:1:13: error: found room");
  EXPECT_EQ(ErrorOfPeople(R"({"people": [{"count": 1, "region": [0, 0, 1, 1], "speed": [2, 1]}]})"),
            "s.json:1:63: error: found a greatest value below the least, expected one that is not");
  EXPECT_THAT(ErrorOfPeople(R"({"people": [{"count": 1, "region": [0, 0, 1, 1], "reaction": "angry"}]})"),
              testing::HasSubstr("expected 'regular', 'curious', 'scared' or 'careless'"));
}

// The way to each present goal of people takes a grid of the whole ground.
TEST(PeopleScenario, MoreWaysThanMemoryAreAnError) {
  const auto with_goals = [](int people, int goals) {
    std::string text = "[4000, 4000]";
    for (int i = 1; i < goals; ++i) text += ", [" + std::to_string(i) + ", 0]";
    return R"({"people": [{"count": )" + std::to_string(people) + R"(, "region": [0, 0, 20, 20], "goals": [)" + text +
           "]}]}";
  };
  EXPECT_EQ(ErrorOfPeople(with_goals(1, 900)), "");
  EXPECT_EQ(ErrorOfPeople(with_goals(100, 50)), "");
  EXPECT_EQ(ErrorOfPeople(with_goals(100, 900)),
            "s.json:1:13: error: found people whose ways may take 12 GiB of memory, expected at most 8: each person "
            "takes a grid of the whole ground for its present goal");
}

TEST(PeopleScenario, EachPersonMayHaveGoalsOfItsOwn) {
  std::string rules;
  for (int i = 0; i < 1200; ++i) {
    rules += std::string(i > 0 ? ", " : "") + R"({"count": 1, "region": [0, 0, 40, 40], "goals": [)";
    for (int k = 0; k < 12; ++k) {
      rules += std::string(k > 0 ? ", [" : "[") + std::to_string(0.03 * i) + ", " + std::to_string(3 * k) + "]";
    }
    rules += "]}";
  }
  EXPECT_EQ(ErrorOfPeople(R"({"people": [)" + rules + "]}"), "");
}

TEST(Guesthouse, ItsGuestsOpenDoorsAndReachTheOtherLevel) {
  const Scene scene(ValueOf(LoadWorld(Worlds() + "sites/guesthouse_guests.json")).world);
  const WorldDescription& world = scene.world();
  ASSERT_EQ(world.people.size(), 9u);
  EXPECT_THAT(world.goal_sets.back().heights, testing::ElementsAre(4.0, 4.0, 0.0, 0.0));
  WorldState state = InitialState(scene);
  BodyIndex bodies(scene);
  std::set<std::size_t> upstairs;
  bool opened = false;
  const std::size_t door = *FindDoor(world, "room_1_door");
  for (int i = 0; i < 4000; ++i) {
    state = Step(scene, state, {}, bodies).state;
    opened = opened || state.doors[door].opening == 1.0;
    for (std::size_t p = 0; p < state.people.size(); ++p) {
      if (state.people[p].X_WP.z == 4.0) upstairs.insert(p);
    }
  }
  EXPECT_TRUE(opened);
  EXPECT_GE(upstairs.size(), 4u);
}

TEST(Guesthouse, ItsCrowdWalksToTheSeats) {
  const Scene scene(ValueOf(LoadWorld(Worlds() + "sites/guesthouse.building.yaml")).world);
  const WorldDescription& world = scene.world();
  ASSERT_EQ(world.people.size(), 3u);
  ASSERT_EQ(world.goal_sets.size(), 2u);
  EXPECT_EQ(world.goal_sets[1].name, "arriving");
  EXPECT_EQ(world.goal_sets[1].reach, 0.5);
  EXPECT_EQ(world.goal_sets[1].wait, (Interval{20.0, 20.0}));
  EXPECT_EQ(world.people[0].goals, 1u);
  EXPECT_EQ(world.people[0].speed, 1.2);
  EXPECT_EQ(world.people[0].max_speed, 1.6);
  ASSERT_FALSE(world.goal_sets[1].points.empty());
  WorldState state = InitialState(scene);
  BodyIndex bodies(scene);
  for (int i = 0; i < 600; ++i) state = Step(scene, state, {}, bodies).state;
  for (const PersonState& person : state.people) EXPECT_EQ(person.goals, 0u);  // they have arrived, and stand
}

}  // namespace
}  // namespace troupe
