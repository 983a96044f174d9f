#include "viewer/gateway/run_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "common/model/states.h"
#include "recording/timeline/timeline.h"
#include "tests/support/small_world.h"
#include "tests/unit/viewer/gateway/page_reader.h"
#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/page_values.h"

namespace troupe {
namespace {

SessionMessage Session(RunId run = 1, Edition edition = 0) {
  SmallWorld world;
  world.AddBox("box", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  world.AddRobot("r0", {});
  return {.run = run, .world = world.world(), .world_edition = edition};
}

SharedFrame Frame(const SessionMessage& session, Tick tick, std::size_t events = 0, bool is_last = false) {
  FrameMessage frame{.run = session.run, .state = PlacedState(session.world)};
  frame.state.tick = tick;
  frame.state_hash = tick;
  frame.edition = session.world_edition;
  frame.world_edition = session.world_edition;
  for (std::size_t i = 0; i < events; ++i)
    frame.events.push_back({tick, EventType::kStallBegan, RobotId(0), {}, {}, {}});
  frame.last = is_last;
  return std::make_shared<const FrameMessage>(std::move(frame));
}

TEST(RunFeedTest, HasNothingBeforeTheFirstFrame) {
  RunFeed feed;
  FeedContent content;
  feed.OnFrame(Frame(Session(), 1));  // of no known world
  feed.OnSession(Session());
  feed.Read(content);
  EXPECT_EQ(content.version, 0u);
  EXPECT_EQ(content.state, nullptr);
}

TEST(RunFeedTest, HasTheNewestStateWithItsWorld) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage session = Session();
  feed.OnSession(session);
  feed.OnFrame(Frame(session, 3));
  feed.OnFrame(Frame(session, 2));  // late
  feed.Read(content);
  ASSERT_NE(content.state, nullptr);
  EXPECT_EQ(content.state->state->tick, 3u);
  EXPECT_EQ(content.state->world->description(), session.world);
}

TEST(RunFeedTest, TheStateOfAFrameIsNotCopied) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage session = Session();
  const SharedFrame frame = Frame(session, 3);
  feed.OnSession(session);
  feed.OnFrame(frame);
  feed.Read(content);
  EXPECT_EQ(content.state->state.get(), &frame->state);
  EXPECT_EQ(feed.At(content.state->position).value()->state.get(), &frame->state);
}

TEST(RunFeedTest, AStateThatTheWorldCannotHaveIsNotShown) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage session = Session();
  feed.OnSession(session);
  feed.OnFrame(Frame(session, 3));
  FrameMessage bad = *Frame(session, 4);
  bad.state.robots.clear();
  feed.OnFrame(std::make_shared<const FrameMessage>(bad));
  bad = *Frame(session, 4);
  bad.state.robots[0].X_WR.x = std::nan("");
  feed.OnFrame(std::make_shared<const FrameMessage>(bad));
  feed.Read(content);
  EXPECT_EQ(content.state->state->tick, 3u);
}

TEST(RunFeedTest, AFrameOfAnotherEditionWaitsForItsWorld) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage first = Session();
  const SessionMessage second = Session(1, 5);
  feed.OnSession(first);
  feed.OnFrame(Frame(first, 3));
  feed.OnFrame(Frame(second, 0));  // its world is not known yet
  feed.Read(content);
  EXPECT_EQ(content.state->state->tick, 3u);
  feed.OnSession(second);
  feed.Read(content);
  EXPECT_EQ(content.state->world->number, 1u);  // the state is still the one of the first world
  feed.OnFrame(Frame(second, 0));
  feed.Read(content);
  EXPECT_EQ(content.state->world->number, 2u);
  EXPECT_EQ(content.state->state->tick, 0u);
}

TEST(RunFeedTest, CountsEventsOnceAndKeepsTheNewest) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage session = Session();
  feed.OnSession(session);
  for (Tick tick = 1; tick <= 200; ++tick) {
    feed.OnFrame(Frame(session, tick, 60));
    feed.OnFrame(Frame(session, tick, 60));  // resent
    if (tick % 50 == 0) feed.Read(content);
  }
  feed.Read(content);
  ASSERT_EQ(content.events.size(), kEventsKept);
  EXPECT_EQ(content.events.back().number, 12000u);
  EXPECT_EQ(content.events.front().number, 2001u);
}

TEST(RunFeedTest, EventsHaveTheNamesOfTheWorldInWhichTheyHappened) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage first = Session();
  SessionMessage second = Session(1, 5);
  second.world.Change().robots[0].name = "other";
  feed.OnSession(first);
  feed.OnFrame(Frame(first, 1, 1));
  feed.OnSession(second);
  feed.OnFrame(Frame(second, 0, 1));
  feed.Read(content);
  ASSERT_EQ(content.events.size(), 2u);
  EXPECT_EQ(content.events[0].names.robot, "r0");
  EXPECT_EQ(content.events[1].names.robot, "other");
}

TEST(RunFeedTest, TheEndOfARunStaysInViewButALostRunDoesNot) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage session = Session();
  feed.OnSession(session);
  feed.OnFrame(Frame(session, 9, 0, true));
  feed.OnServiceGone();
  feed.Read(content);
  EXPECT_NE(content.state, nullptr);
  EXPECT_TRUE(content.last);
  EXPECT_TRUE(feed.ConsumeServiceGone());
  EXPECT_FALSE(feed.ConsumeServiceGone());

  const SessionMessage next = Session(2);
  feed.OnSession(next);
  feed.OnFrame(Frame(next, 1));
  feed.OnServiceGone();
  feed.Read(content);
  EXPECT_EQ(content.state, nullptr);
}

std::vector<std::uint64_t> PositionsOf(RunFeed& feed, const SessionMessage& session, const std::vector<Tick>& ticks) {
  std::vector<std::uint64_t> positions;
  FeedContent content;
  for (const Tick tick : ticks) {
    feed.OnFrame(Frame(session, tick));
    feed.Read(content);
    positions.push_back(content.state->position);
  }
  return positions;
}

TEST(RunFeedTest, HasThePastInItsOrder) {
  RunFeed feed;
  EXPECT_TRUE(feed.Spans()->empty());
  EXPECT_FALSE(feed.At(0).ok());
  const SessionMessage session = Session();
  feed.OnSession(session);
  EXPECT_THAT(PositionsOf(feed, session, {5, 6, 7, 8, 9}), testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(feed.At(2).value()->state_hash, 7u);
  EXPECT_EQ(feed.At(77).value()->position, 4u) << "the nearest one";
  const SessionMessage edited = Session(1, 1);
  feed.OnSession(edited);
  EXPECT_THAT(PositionsOf(feed, edited, {6}), testing::ElementsAre(5)) << "behind a reset";
  EXPECT_EQ(feed.Spans()->Last(6), 5u);
  EXPECT_EQ(feed.Spans()->Last(9), 4u);
  EXPECT_EQ(feed.Spans()->Last(4), std::nullopt);
}

TEST(RunFeedTest, ItsMemoryIsBounded) {
  const SessionMessage session = Session();
  RunFeed feed(nullptr, 10 * SizeOf({.state = std::make_shared<const WorldState>(PlacedState(session.world))}));
  feed.OnSession(session);
  for (Tick tick = 0; tick < 1000; ++tick) feed.OnFrame(Frame(session, tick));
  EXPECT_EQ(feed.Spans()->last(), 999u);
  EXPECT_GE(feed.Spans()->first(), 985u);
  EXPECT_EQ(feed.At(0).value()->position, feed.Spans()->first());
  const SessionMessage next = Session(2);
  feed.OnSession(next);
  EXPECT_THAT(PositionsOf(feed, next, {0}), testing::ElementsAre(1000)) << "positions are never used twice";
}

TEST(RunFeedTest, PositionsCountTheTicksThatWereNotReceived) {
  RunFeed feed;
  const SessionMessage session = Session();
  feed.OnSession(session);
  EXPECT_THAT(PositionsOf(feed, session, {5, 6, 9, 10}), testing::ElementsAre(0, 1, 4, 5));
  EXPECT_EQ(feed.At(3).value()->state->tick, 6u) << "the one before the gap";
  const SessionMessage edited = Session(1, 1);
  feed.OnSession(edited);
  feed.OnFrame(Frame(edited, 0));
  EXPECT_THAT(feed.Spans()->all(),
              testing::ElementsAre(TimeSpan{0, 1, 5, 0}, TimeSpan{4, 5, 9, 0}, TimeSpan{6, 6, 0, 1}));
}

// The journal of a run that stalls once in each tick.
class ScriptedJournal : public RecordedTimeline {
 public:
  ScriptedJournal(const SessionMessage& session, WorldCache& worlds, Tick last, bool is_whole = false)
      : world_(worlds.Of(session)),
        is_whole_(is_whole),
        spans_(std::make_shared<const TimeSpans>(std::vector<TimeSpan>{{0, last, 0, 0}})) {
    for (Tick tick = 1; tick <= last; ++tick) {
      events_.push_back({tick, tick, {tick, EventType::kStallBegan, RobotId(0), {}, {}, {}}, {"r0", "", ""}});
    }
  }
  std::shared_ptr<const TimeSpans> Spans() const override { return spans_; }
  RunId run() const override { return world_->run; }
  bool is_whole() const override { return is_whole_; }
  Result<SharedState> At(std::uint64_t position) override {
    TimelineState state{position, world_, nullptr, 1000 + position, 0};
    WorldState placed = PlacedState(world_->description());
    placed.tick = position;
    state.state = std::make_shared<const WorldState>(std::move(placed));
    return std::make_shared<const TimelineState>(std::move(state));
  }
  const std::deque<NumberedEvent>& Events() const override { return events_; }

 private:
  const std::shared_ptr<const TimelineWorld> world_;
  const bool is_whole_;
  const std::shared_ptr<const TimeSpans> spans_;
  std::deque<NumberedEvent> events_;
};

std::vector<Tick> TicksOf(const std::deque<NumberedEvent>& events) {
  std::vector<Tick> ticks;
  for (const NumberedEvent& event : events) ticks.push_back(event.event.tick);
  return ticks;
}

TEST(RunFeedTest, TheJournalHasWhatHappenedBeforeTheFirstFrame) {
  RunFeed feed;
  const SessionMessage session = Session();
  feed.SetRecorded(std::make_shared<ScriptedJournal>(session, feed.worlds(), 5));
  feed.OnSession(session);
  for (const Tick tick : {6u, 7u}) feed.OnFrame(Frame(session, tick, 1));
  FeedContent content;
  feed.Read(content);
  EXPECT_THAT(TicksOf(content.events), testing::ElementsAre(1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(content.events.back().number, 7u);
  EXPECT_EQ(content.state->position, 7u);
  EXPECT_FALSE(feed.lacks_states());
  const auto past = feed.At(3).value();
  EXPECT_EQ(past->state_hash, 1003u);
  EXPECT_EQ(past->world, content.state->world) << "a page need not build it again";
  EXPECT_THAT(feed.Spans()->all(), testing::ElementsAre(TimeSpan{0, 7, 0, 0}));
}

TEST(RunFeedTest, TheJournalHasTheEventsOfFramesThatWereLost) {
  RunFeed feed;
  const SessionMessage session = Session();
  feed.SetRecorded(std::make_shared<ScriptedJournal>(session, feed.worlds(), 2));
  feed.OnSession(session);
  feed.OnFrame(Frame(session, 3, 1));
  FeedContent content;
  feed.Read(content);
  const std::uint64_t list = content.event_list;
  feed.OnFrame(Frame(session, 7, 1));
  EXPECT_TRUE(feed.lacks_states());
  feed.SetRecorded(std::make_shared<ScriptedJournal>(session, feed.worlds(), 6));
  EXPECT_FALSE(feed.lacks_states());
  feed.Read(content);
  EXPECT_THAT(TicksOf(content.events), testing::ElementsAre(1, 2, 3, 4, 5, 6, 7));
  EXPECT_NE(content.event_list, list) << "viewers are to have them all again";
}

TEST(RunFeedTest, ARunThatEndedUnseenIsShownAtItsEnd) {
  RunFeed feed;
  const SessionMessage session = Session();
  FeedContent content;
  feed.SetRecorded(std::make_shared<ScriptedJournal>(session, feed.worlds(), 4));
  feed.Read(content);
  EXPECT_EQ(content.state, nullptr) << "it may continue";
  feed.SetRecorded(std::make_shared<ScriptedJournal>(session, feed.worlds(), 4, true));
  feed.Read(content);
  ASSERT_NE(content.state, nullptr);
  EXPECT_EQ(content.state->state->tick, 4u);
  EXPECT_TRUE(content.last);
  EXPECT_EQ(content.events.size(), 4u);
  // Another run of the session.
  const SessionMessage next = Session(2);
  feed.OnSession(next);
  feed.OnFrame(Frame(next, 1, 1));
  feed.Read(content);
  EXPECT_FALSE(content.last);
  EXPECT_EQ(content.events.size(), 1u);
}

// A viewer's copy of the rows, as the page keeps it.
struct Copy {
  WorldState state;

  // Returns the number of rows in the message.
  std::size_t Apply(const std::string& bytes) {
    test::PageReader reader(bytes);
    std::size_t count = 0;
    ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
      if constexpr (!std::is_same_v<Row, ImuState> && !kIsVaryingTable<Row>) {
        count += reader.ReadRows(table.Of(state)).size();
      }
    });
    EXPECT_TRUE(reader.at_end());
    return count;
  }
};

WorldState SomeState() {
  WorldState state;
  state.robots.resize(20);
  state.joints.resize(10);
  state.grippers.resize(4);
  state.objects.resize(8);
  state.stores.resize(6);
  state.lights.resize(5);
  state.cameras.resize(2);
  state.doors.resize(3);
  state.lifts.resize(2);
  state.people.resize(3);
  return state;
}

std::string Difference(const StateRows& rows, std::uint64_t since) {
  std::string bytes;
  PageWriter writer(bytes);
  rows.Write(writer, since);
  return bytes;
}

TEST(StateRowsTest, AViewerThatSkipsAnyUpdatesHasTheWholeState) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  WorldState state = SomeState();
  StateRows rows;
  Copy quick;
  Copy slow;
  std::uint64_t slow_has = 0;
  for (std::uint64_t update = 1; update <= 300; ++update) {
    // Floats, as twists are sent.
    for (int i = 0; i < 3; ++i) {
      RobotState& robot = state.robots[below(state.robots.size())];
      robot.X_WR.x += 0.1;
      robot.X_WR.heading = 1.0 / static_cast<double>(update);
      robot.twist.vx = 0.5;
      robot.stalled = below(2) == 0;
    }
    state.joints[below(state.joints.size())].position += 1e-9;
    state.grippers[below(state.grippers.size())].clamped = ObjectId(below(8));
    state.objects[0].support = ModelId(update);
    ObjectState& object = state.objects[below(state.objects.size())];
    object.mode = ObjectMode::kHeld;
    object.holder = GripperId(below(4));
    state.stores[below(state.stores.size())].joules -= 0.5;
    state.lights[below(state.lights.size())].is_switched_on = below(2) == 0;
    state.doors[below(3)].opening = 1.0 / static_cast<double>(update);
    state.lifts[below(2)].floor = static_cast<std::uint32_t>(update);
    ++state.people[below(state.people.size())].goals_chosen;
    rows.Assign(std::make_shared<const WorldState>(state), update, update == 1);
    EXPECT_LE(quick.Apply(Difference(rows, update - 1)), update == 1 ? 63u : 12u);
    EXPECT_EQ(quick.state, state);
    if (below(10) == 0) {
      slow.Apply(Difference(rows, slow_has));
      slow_has = update;
      EXPECT_EQ(slow.state, state);
    }
  }
}

TEST(StateRowsTest, NothingIsSentOfAStateThatDoesNotChange) {
  StateRows rows;
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 1, true);
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 2, false);
  EXPECT_EQ(Copy().Apply(Difference(rows, 1)), 0u);
  EXPECT_EQ(Copy().Apply(Difference(rows, 0)), 63u);
}

TEST(StateRowsTest, AnotherWorldIsSentWhole) {
  StateRows rows;
  rows.Assign(std::make_shared<const WorldState>(SomeState()), 1, true);
  WorldState smaller;
  smaller.robots.resize(3);
  rows.Assign(std::make_shared<const WorldState>(smaller), 2, true);
  Copy copy;
  EXPECT_EQ(copy.Apply(Difference(rows, 1)), 3u);
  EXPECT_EQ(copy.state, smaller);
}

}  // namespace
}  // namespace troupe
