// People at doors and in lifts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/model/states.h"
#include "common/spatial/walk_routes.h"
#include "tests/support/house_world.h"
#include "tests/support/people_run.h"
#include "tests/support/values.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::HouseWorld;
using test::PeopleRun;

constexpr std::size_t kDoor = 0;  // of the hall on the ground

// The room (m) between a person and the sweep of the door.
double RoomAtDoor(const PeopleRun& run, PersonId person) {
  const WalkPortals& portals = run.scene->walk_routes().portals();
  return portals.doors[kDoor]->ClearanceOf(run.Place(person)).distance - 0.25;
}

class DoorKinds : public testing::TestWithParam<HouseWorld::Leaf> {};

TEST_P(DoorKinds, APersonAsksForADoorWaitsBesideItsSweepPassesAndLetsItGo) {
  for (const bool to_east : {true, false}) {
    SCOPED_TRACE(to_east ? "to the east" : "to the west");
    HouseWorld house(1, GetParam(), 4.0);
    const double from = to_east ? 3.0 : 12.5;
    const double to = to_east ? 12.5 : 3.0;
    const PersonId anna = house.AddPersonOn(0, {from, 6.0}, house.AddTour({{{to, 5.0}, 0}}));
    PeopleRun run(house.world);
    bool asked_before = false;
    const auto is_there = [&] { return std::fabs(run.Place(anna).x() - to) < 0.6; };
    for (int tick = 0; tick < 400 && !is_there(); ++tick) {
      run.Step();
      const DoorState& door = run.state.doors[kDoor];
      const bool is_beyond = to_east ? run.Place(anna).x() > 8.4 : run.Place(anna).x() < 7.6;
      if (door.opening > 0.0 && door.opening < 0.9 && !is_beyond) {
        EXPECT_GT(RoomAtDoor(run, anna), 0.0) << "at an opening of " << door.opening;
      }
      EXPECT_FALSE(door.blocked);
      EXPECT_EQ(door.target, 0.0);
      asked_before = asked_before || (run.state.people[0].door == kDoor + 1 && !is_beyond);
      ASSERT_FALSE(FindOverlap(*run.scene, run.state, run.scene->world().person(anna).root));
    }
    EXPECT_TRUE(asked_before);
    EXPECT_TRUE(is_there());
    EXPECT_TRUE(run.StepUntil(60, [&] { return run.state.doors[kDoor].opening == 0.0; }));
    EXPECT_FALSE(run.state.doors[kDoor].held);
    EXPECT_EQ(run.state.people[0].door, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(People, DoorKinds,
                         testing::Values(HouseWorld::Leaf::kHinged, HouseWorld::Leaf::kHingedBack,
                                         HouseWorld::Leaf::kSliding, HouseWorld::Leaf::kDouble));

TEST(PeopleAtDoors, ADoorThatIsNotOperatedIsAWallAndAnOpenOneStaysOpen) {
  HouseWorld closed(1);
  closed.world.doors[kDoor].is_operated = false;
  const PersonId bob = closed.AddPersonOn(0, {6.0, 5.0}, closed.AddTour({{{12.0, 5.0}, 0}}));
  PeopleRun locked(closed.world);
  for (int i = 0; i < 100; ++i) locked.Step();
  EXPECT_LT((locked.Place(bob) - Vec2(6.0, 5.0)).norm(), 0.1);
  EXPECT_EQ(locked.state.doors[kDoor].opening, 0.0);

  HouseWorld house(1);
  house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{12.0, 5.0}, 0}}));
  PeopleRun run(house.world);
  run.state.doors[kDoor].target = 1.0;  // as a robot has requested
  ASSERT_TRUE(run.StepUntil(300, [&] { return run.Place(PersonId(0)).x() > 11.0; }));
  EXPECT_EQ(run.state.doors[kDoor].opening, 1.0);
}

TEST(PeopleAtDoors, OneWhoStandsInTheSweepMakesRoomForAnother) {
  HouseWorld house(1, HouseWorld::Leaf::kHinged);
  const PersonId anna = house.AddPersonOn(0, {12.0, 5.0}, house.AddTour({{{4.0, 5.0}, 0}}));
  const PersonId bob = house.AddPersonOn(0, {7.5, 5.1}, house.AddTour({{{7.5, 5.1}, 0}}));
  PeopleRun run(house.world);
  EXPECT_LT(RoomAtDoor(run, bob), 0.0);
  EXPECT_TRUE(run.StepUntil(500, [&] { return run.Place(anna).x() < 4.6; }));
}

// Lifts.

constexpr std::size_t kLift = 0;

std::size_t Level(const PeopleRun& run, PersonId person) {
  return run.scene->walk_routes().LevelAt(run.state.people[person.index()].X_WP.z);
}

// A lift of two, or of the mass of two, is never fuller, and all get up in the end.
TEST(PeopleInLifts, ACrowdRidesInPartsOfWhatTheLiftCarries) {
  for (const bool by_mass : {false, true}) {
    HouseWorld house(2);
    if (by_mass) {
      house.world.lifts[kLift].max_load = 160.0;
    } else {
      house.world.lifts[kLift].capacity = 2;
    }
    std::vector<PersonId> crowd;
    for (int i = 0; i < 5; ++i) {
      const double y = 2.0 + 1.0 * i;
      crowd.push_back(house.AddPersonOn(0, {4.0, y}, house.AddTour({{{12.0, y}, 1}})));
    }
    PeopleRun run(house.world);
    std::size_t most = 0;
    const auto all_up = [&] {
      std::size_t inside = 0;
      for (const PersonId person : crowd) {
        const PersonState& row = run.state.people[person.index()];
        const LiftPortal& portal = run.scene->walk_routes().portals().lifts[kLift];
        inside += portal.IsInside(run.Place(person), row.X_WP.z - run.state.lifts[kLift].z) ? 1 : 0;
      }
      most = std::max(most, inside);
      return std::all_of(crowd.begin(), crowd.end(), [&](PersonId person) { return Level(run, person) == 1; });
    };
    EXPECT_TRUE(run.StepUntil(4000, all_up)) << by_mass;
    EXPECT_EQ(most, 2U) << by_mass;
  }
}

// Three in the cabin of a lift for two: the last one gets out, the others ride.
TEST(PeopleInLifts, OfTooManyInTheCabinOneGetsOut) {
  HouseWorld house(2);
  house.world.lifts[kLift].capacity = 2;
  const std::uint32_t up = house.AddTour({{{12.0, 5.0}, 1}});
  std::vector<PersonId> crowd;
  for (int i = 0; i < 3; ++i) crowd.push_back(house.AddPersonOn(0, {4.0, 3.0 + i}, up));
  PeopleRun run(house.world);
  const LiftPortal& portal = run.scene->walk_routes().portals().lifts[kLift];
  ASSERT_GE(portal.places.size(), 3U);
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    Pose& X_WP = run.state.people[crowd[i].index()].X_WP;
    X_WP.x = portal.places[i].x();
    X_WP.y = portal.places[i].y();
    X_WP.z = run.state.lifts[kLift].z;
  }
  bool was_overloaded = false;
  EXPECT_TRUE(run.StepUntil(1500, [&] {
    was_overloaded = was_overloaded || run.state.lifts[kLift].overloaded;
    std::size_t upstairs = 0;
    for (const PersonId person : crowd) upstairs += Level(run, person) == 1 ? 1 : 0;
    return upstairs == crowd.size();
  }));
  EXPECT_TRUE(was_overloaded);
}

TEST(PeopleInLifts, APersonRidesToAGoalOnAnotherLevelAndBack) {
  HouseWorld house(3);
  const std::uint32_t tour = house.AddTour({{{12.0, 7.0}, 2}, {{4.0, 2.0}, 0}});
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, tour);
  PeopleRun run(house.world);
  const auto is_at = [&](const Vec2& at, std::size_t level) {
    return (run.Place(anna) - at).norm() < 0.7 && run.state.people[0].X_WP.z == HouseWorld::LevelZ(level);
  };
  EXPECT_TRUE(run.StepUntil(900, [&] { return is_at({12.0, 7.0}, 2); }));
  EXPECT_EQ(run.state.people[0].lift, 0u);
  EXPECT_EQ(run.state.people[0].place, 0u);
  EXPECT_TRUE(run.StepUntil(900, [&] { return is_at({4.0, 2.0}, 0); }));
}

TEST(PeopleInLifts, MorePeopleThanPlacesRideInTurnsAndThoseWhoGetOffAreNotBlocked) {
  HouseWorld house(2);
  const std::uint32_t up = house.AddTour({{{10.0, 5.0}, 1}});
  const std::uint32_t down = house.AddTour({{{10.0, 5.0}, 0}});
  for (int i = 0; i < 20; ++i) {
    house.AddPersonOn(i % 2 == 0 ? 0 : 1, {2.0 + 0.8 * (i / 4), 3.0 + 1.2 * (i / 2 % 2)}, i % 2 == 0 ? up : down);
  }
  PeopleRun run(house.world);
  const std::size_t places = run.scene->walk_routes().portals().lifts[kLift].places.size();
  EXPECT_GE(places, 4u);
  std::size_t most = 0;
  const auto have_all_arrived = [&] {
    std::size_t arrived = 0;
    std::size_t aboard = 0;
    for (std::size_t i = 0; i < run.state.people.size(); ++i) {
      const PersonState& person = run.state.people[i];
      arrived += person.lift == 0 && Level(run, PersonId(i)) == (i % 2 == 0 ? 1u : 0u) ? 1 : 0;
      aboard += person.place != 0 ? 1 : 0;
    }
    most = std::max(most, aboard);
    return arrived == run.state.people.size();
  };
  EXPECT_TRUE(run.StepUntil(4000, have_all_arrived));
  EXPECT_GT(most, 2u);
  EXPECT_LE(most, places);
}

TEST(PeopleInLifts, PeopleLeaveTheLiftToARobotUntilItsSessionEnds) {
  HouseWorld house(2);
  house.AddRobot(test::Square(0.6), {0.0, 0.6}, {12.0, 1.0, 0.0, 0.0});
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  PeopleRun run(house.world);
  ASSERT_TRUE(run.StepUntil(400, [&] { return run.state.people[0].place != 0; }));
  Proposal call{RobotId(0), {}};
  call.orders.push_back(LiftOrder{kLift, 0});
  run.Step({call});
  EXPECT_EQ(run.state.lifts[kLift].session, RobotId(0));
  for (int i = 0; i < 200; ++i) {
    run.Step({Proposal{RobotId(0), {}}});
    EXPECT_EQ(run.state.lifts[kLift].floor, 0u);
  }
  EXPECT_EQ(run.state.people[0].place, 0u);
  EXPECT_GT(run.state.people[0].call_tick, 0u);
  EXPECT_GT(run.Place(anna).x(), 0.2);
  call.orders = {LiftOrder{kLift, 0, true}};
  run.Step({call});
  EXPECT_TRUE(run.StepUntil(600, [&] { return (run.Place(anna) - Vec2(10.0, 5.0)).norm() < 0.7; }));
  EXPECT_EQ(Level(run, anna), 1u);
}

TEST(PeopleInLifts, APersonThatIsMovedForgetsItsRideAndOneWithoutALiftGivesUp) {
  HouseWorld house(2);
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  PeopleRun run(house.world);
  ASSERT_TRUE(run.StepUntil(400, [&] { return run.state.people[0].call_tick != 0; }));
  const std::string name = house.world.model(house.world.person(anna).root).name;
  const EditedWorld moved = test::ValueOf(SetPose(run.scene, run.state, name, {6.0, 5.0, 0.0, 0.0}));
  EXPECT_EQ(moved.state.people[0].lift, 0u);
  EXPECT_EQ(moved.state.people[0].call_tick, 0u);

  house.AddPersonOn(1, {12.0, 5.0}, house.AddTour({{{12.0, 5.0}, 1}}));  // so that the level is known
  for (LiftFloor& floor : house.world.lifts[kLift].floors) floor.doors.clear();
  PeopleRun without(house.world);
  for (int i = 0; i < 50; ++i) without.Step();
  EXPECT_LT((without.Place(anna) - Vec2(4.0, 5.0)).norm(), 0.1);
}

// The lift that goes there directly is too narrow.
TEST(PeopleInLifts, AWidePersonTakesTheLongerWayWithWiderLifts) {
  HouseWorld house(3);
  for (LiftFloor& floor : house.world.lifts[kLift].floors) floor.doors.clear();
  house.AddLift({0, 2}, 0.9, {2.6, 1.4}, 0.35);
  house.AddLift({0, 1}, 2.3, {2.6, 4.0});
  house.AddLift({1, 2}, 2.3, {2.6, 7.5});
  const PersonId anna = house.AddPersonOn(0, {5.0, 5.0}, house.AddTour({{{6.0, 5.0}, 2}}), 0.4);
  const PersonId bob = house.AddPersonOn(0, {6.0, 7.0}, house.AddTour({{{6.0, 3.0}, 2}}), 0.2);
  PeopleRun run(house.world);
  const WalkRoutes& routes = run.scene->walk_routes();
  EXPECT_NEAR(routes.portals().lifts[1].radius, 0.2, 1e-9);
  const auto longer = routes.FindRide(anna, 0, {0, 0}, {5.0, 5.0});
  ASSERT_TRUE(longer.has_value());
  EXPECT_EQ(longer->lift, 2u);
  EXPECT_EQ(routes.FindRide(bob, 0, {1, 0}, {5.0, 5.0})->lift, 1u);
  EXPECT_TRUE(run.StepUntil(1500, [&] { return Level(run, anna) == 2 && run.state.people[0].lift == 0; }));
}

TEST(PeopleInLifts, APersonThatTriesAgainAndAgainToGetOnGivesUpAfterItsPatience) {
  HouseWorld house(2);
  house.AddRobot(test::Box(-0.2, -0.58, 0.2, 0.58), {0.0, 0.6}, {0.3, 5.0, 0.0, 0.0});  // in the doorway
  house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  PeopleRun run(house.world);
  ASSERT_TRUE(run.StepUntil(400, [&] { return run.state.people[0].call_tick != 0; }));
  const Tick called = run.state.tick;
  int tries = 0;
  bool had_place = false;
  ASSERT_TRUE(run.StepUntil(3100, [&] {
    const bool has_place = run.state.people[0].place != 0;
    tries += has_place && !had_place ? 1 : 0;
    had_place = has_place;
    return run.state.people[0].goals_chosen > 1;
  }));
  EXPECT_GE(run.state.tick - called, 3000u);
  EXPECT_GE(tries, 10);
}

TEST(PeopleInLifts, TheLastBitsOfTicksAreEnoughForRides) {
  HouseWorld house(3);
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{12.0, 7.0}, 2}, {{4.0, 2.0}, 0}}));
  house.AddPersonOn(1, {4.0, 5.0}, house.AddTour({{{12.0, 7.0}, 2}, {{4.0, 2.0}, 0}}));
  PeopleRun run(house.world);
  run.state.tick = (Tick{1} << 32) - 60;
  EXPECT_TRUE(run.StepUntil(900, [&] { return Level(run, anna) == 2 && run.state.people[0].lift == 0; }));
  EXPECT_TRUE(run.StepUntil(900, [&] { return Level(run, anna) == 0 && run.state.people[0].lift == 0; }));
  EXPECT_EQ(run.state.people[0].goals_chosen, 2u);
}

// A box in the way of a leaf of the lift on level 1.
TEST(PeopleInLifts, ADoorThatCannotOpenFullyKeepsNoLiftFromTheOthers) {
  HouseWorld house(3);
  house.world.objects.push_back(house.AddModel(test::Square(0.1), {0.5, 1.0}, {0.0, 6.0, HouseWorld::kStorey, 0.0}));
  const PersonId bob = house.AddPersonOn(1, {2.0, 5.0}, house.AddTour({{{10.0, 5.0}, 2}}));
  const PersonId carol = house.AddPersonOn(0, {2.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  const PersonId dave = house.AddPersonOn(0, {3.0, 5.0}, house.AddTour({{{10.0, 5.0}, 2}}));
  const PersonId erin = house.AddPersonOn(2, {6.0, 5.0}, house.AddTour({{{10.0, 5.0}, 0}}));
  PeopleRun run(house.world);
  bool was_stuck = false;
  EXPECT_TRUE(run.StepUntil(1500, [&] {
    was_stuck = was_stuck || (run.state.lifts[kLift].floor == 1 && run.state.doors[5].blocked);
    return Level(run, dave) == 2 && run.state.people[dave.index()].lift == 0 && Level(run, erin) == 0 &&
           run.state.people[erin.index()].lift == 0;
  }));
  EXPECT_TRUE(was_stuck);
  EXPECT_EQ(Level(run, bob), 1u);
  EXPECT_NE(run.state.people[carol.index()].lift, 0u);
}

TEST(PeopleInLifts, ALiftServesThoseInItsCabinWhileAnotherCannotGetOn) {
  HouseWorld house(3);
  house.AddRobot(test::Box(-0.2, -0.58, 0.2, 0.58), {0.0, 0.6}, {0.3, 5.0, HouseWorld::kStorey, 0.0});
  const PersonId anna = house.AddPersonOn(0, {2.0, 5.0}, house.AddTour({{{10.0, 5.0}, 2}}));
  house.AddPersonOn(1, {3.0, 5.0}, house.AddTour({{{10.0, 5.0}, 2}}));
  PeopleRun run(house.world);
  EXPECT_TRUE(run.StepUntil(1000, [&] { return Level(run, anna) == 2 && run.state.people[0].lift == 0; }));
}

TEST(PeopleInLifts, AGoalOnALevelWithoutAStopIsNotOnTheLevelBelow) {
  HouseWorld house(3);
  for (std::size_t i = 0; i < 3; ++i) house.world.levels.push_back({"L" + std::to_string(i), HouseWorld::LevelZ(i)});
  house.world.lifts[kLift].floors[2].doors.clear();
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 2}}));
  PeopleRun run(house.world);
  for (int i = 0; i < 300; ++i) run.Step();
  EXPECT_LT((run.Place(anna) - Vec2(4.0, 5.0)).norm(), 0.1);
  EXPECT_EQ(Level(run, anna), 0u);
}

// As objects rest on heads that have been put there.
void PutOnHead(PeopleRun& run, ObjectId object, PersonId person) {
  ObjectState& state = run.state.objects[object.index()];
  state.X_WO = run.state.people[person.index()].X_WP;
  state.X_WO.z += 1.75;
  state.mode = ObjectMode::kResting;
  state.support = run.scene->world().person(person).root;
}

TEST(PeopleInLifts, APersonWithABurdenLetsItsDoorAndItsLiftGo) {
  HouseWorld house(2);
  const ObjectId box(house.world.objects.size());
  house.world.objects.push_back(house.AddModel(test::Square(0.1), {0.0, 0.1}, {12.0, 1.0, 0.0, 0.0}));
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  const PersonId bob = house.AddPersonOn(0, {6.0, 5.0}, house.AddTour({{{12.0, 5.0}, 0}}));
  PeopleRun at_door(house.world);
  ASSERT_TRUE(at_door.StepUntil(200, [&] { return at_door.state.people[bob.index()].door == kDoor + 1; }));
  PutOnHead(at_door, box, bob);
  at_door.Step();
  EXPECT_EQ(at_door.state.people[bob.index()].door, 0u);
  EXPECT_TRUE(at_door.StepUntil(100, [&] { return at_door.state.doors[kDoor].opening == 0.0; }));
  PeopleRun at_lift(house.world);
  ASSERT_TRUE(at_lift.StepUntil(400, [&] { return at_lift.state.people[anna.index()].place != 0; }));
  PutOnHead(at_lift, box, anna);
  at_lift.Step();
  EXPECT_EQ(at_lift.state.people[anna.index()].lift, 0u);
  EXPECT_EQ(at_lift.state.people[anna.index()].place, 0u);
}

TEST(PeopleInLifts, APersonStepsOntoTheFloorOfTheCabin) {
  for (const double z : {-0.1, 0.1}) {
    SCOPED_TRACE(z);
    HouseWorld house(2);
    const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
    house.model(house.world.person(anna).root).X_PM.z = z;
    PeopleRun run(house.world);
    EXPECT_TRUE(run.StepUntil(700, [&] { return Level(run, anna) == 1 && run.state.people[0].lift == 0; }));
    EXPECT_EQ(run.state.people[0].X_WP.z, HouseWorld::kStorey);
  }
}

TEST(PeopleInLifts, OneWhoIsTooWideForACabinKeepsNoneFromRiding) {
  HouseWorld house(2, HouseWorld::Leaf::kHinged, 5.0, 1.4);
  const PersonId wide = house.AddPersonOn(0, {5.0, 2.5}, house.AddTour({{{10.0, 5.0}, 1}}), 0.8);
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  PeopleRun run(house.world);
  EXPECT_TRUE(run.StepUntil(700, [&] { return Level(run, anna) == 1 && run.state.people[anna.index()].lift == 0; }));
  EXPECT_EQ(run.state.people[wide.index()].lift, 0u);
  EXPECT_EQ(Level(run, wide), 0u);
}

// An evacuation of all levels, off at first, to an exit on the ground.
void AddEvacuation(HouseWorld& house, std::size_t levels, const Vec2& exit) {
  const std::uint32_t exits = house.AddGoals({exit});
  house.world.goal_sets[exits].heights = {HouseWorld::LevelZ(0)};
  house.world.exits = {exits};
  for (std::size_t level = 0; level < levels; ++level) {
    house.world.zones.push_back({.name = "alarm_" + std::to_string(level),
                                 .kind = ZoneKind::kEvacuation,
                                 .outline = {{-3.0, 0.0}, {14.0, 0.0}, {14.0, 10.0}, {-3.0, 10.0}},
                                 .z = HouseWorld::LevelZ(level),
                                 .is_on = false,
                                 .exits = exits});
  }
}

void RaiseAlarm(PeopleRun& run) {
  for (ZoneState& zone : run.state.zones) zone.is_on = true;
}

// It is on its way up, and neither gets off there nor calls the lift again.
TEST(Evacuation, APersonInTheCabinRidesToTheLevelOfTheExit) {
  HouseWorld house(2);
  AddEvacuation(house, 2, {10.0, 5.0});
  const PersonId anna = house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  PeopleRun run(house.world);
  const auto row = [&]() -> const PersonState& { return run.state.people[anna.index()]; };
  ASSERT_TRUE(run.StepUntil(600, [&] { return row().X_WP.z > 0.5; }));
  const std::uint32_t call = row().call_tick;
  RaiseAlarm(run);
  std::uint32_t last_call = call;
  EXPECT_TRUE(run.StepUntil(900, [&] {
    EXPECT_TRUE(row().X_WP.z < 0.5 || run.Place(anna).x() < 0.0) << "it has got off";
    if (row().call_tick != 0) last_call = row().call_tick;
    return IsAway(row());
  }));
  EXPECT_EQ(last_call, call);
}

// The people of all levels crowd before the lift, which has others in its cabin, and a robot stands there: all leave,
// while none is in another body. Places that went to the people with the earliest calls alone, across the crowd, would
// take 6000 ticks.
TEST(Evacuation, CrowdsOfAllLevelsLeaveByTheLift) {
  constexpr std::size_t kLevels = 3;
  for (const Tick alarm : {120, 300}) {
    SCOPED_TRACE(alarm);
    HouseWorld house(kLevels);
    AddEvacuation(house, kLevels, {12.0, 5.0});
    house.AddRobot(test::Square(0.6), {0.0, 0.6}, {2.2, 7.5, HouseWorld::LevelZ(1), 0.0});
    for (std::size_t level = 0; level < kLevels; ++level) {
      const std::uint32_t tour = house.AddTour({{{3.0, 5.0}, (level + 1) % kLevels}, {{3.0, 5.0}, level}});
      for (int i = 0; i < 36; ++i) house.AddPersonOn(level, {1.2 + 0.7 * (i % 9), 3.2 + 0.8 * (i / 9)}, tour);
    }
    ASSERT_TRUE(Validate(house.world).ok()) << Validate(house.world).error().message;
    PeopleRun run(house.world);
    while (run.state.tick < alarm) run.Step();
    RaiseAlarm(run);
    std::ptrdiff_t left = 0;
    const auto is_empty = [&] {
      left = std::count_if(run.state.people.begin(), run.state.people.end(),
                           [](const PersonState& person) { return !IsAway(person); });
      return left == 0;
    };
    while (run.state.tick < 4500 && !is_empty()) {
      run.Step();
      if (run.state.tick % 100 != 0) continue;
      for (std::size_t i = 0; i < run.state.people.size(); ++i) {
        if (IsAway(run.state.people[i])) continue;
        EXPECT_FALSE(FindOverlap(*run.scene, run.state, run.scene->world().people[i].root)) << i;
      }
    }
    EXPECT_EQ(left, 0);
  }
}

TEST(PeopleInLifts, AStateWithALiftOrDoorThatDoesNotExistIsRefused) {
  HouseWorld house(2);
  house.AddPersonOn(0, {4.0, 5.0}, house.AddTour({{{10.0, 5.0}, 1}}));
  const WorldState state = PlacedState(house.world);
  ASSERT_TRUE(CheckState(house.world, state).ok());
  const auto is_refused = [&](auto change) {
    WorldState changed = state;
    change(changed.people[0]);
    return !CheckState(house.world, changed).ok();
  };
  EXPECT_TRUE(is_refused([](PersonState& person) { person.lift = 2; }));
  EXPECT_TRUE(is_refused([](PersonState& person) { person.floor = 1; }));
  EXPECT_TRUE(is_refused([](PersonState& person) { person.lift = 1, person.floor = 2; }));
  EXPECT_TRUE(is_refused([](PersonState& person) { person.door = 99; }));
  EXPECT_FALSE(is_refused([](PersonState& person) { person.lift = 1, person.floor = 1; }));
}

}  // namespace
}  // namespace troupe
