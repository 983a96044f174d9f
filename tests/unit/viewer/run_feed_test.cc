#include "viewer/gateway/run_feed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "common/model/states.h"
#include "tests/support/small_world.h"

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
  EXPECT_EQ(feed.history().At(content.state->position).value()->state.get(), &frame->state);
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
    feed.OnFrame(Frame(session, tick, 3));
    feed.OnFrame(Frame(session, tick, 3));  // resent
  }
  feed.Read(content);
  ASSERT_EQ(content.events.size(), kEventsKept);
  EXPECT_EQ(content.events.back().number, 600u);
  EXPECT_EQ(content.events.front().number, 101u);
}

TEST(RunFeedTest, EventsHaveTheNamesOfTheWorldInWhichTheyHappened) {
  RunFeed feed;
  FeedContent content;
  const SessionMessage first = Session();
  SessionMessage second = Session(1, 5);
  second.world.robots[0].name = "other";
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

}  // namespace
}  // namespace troupe
