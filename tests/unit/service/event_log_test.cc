#include "world-service/service/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(EventLog, OrdersEventsBetweenFramesByRobotBeforeThoseOfTheStep) {
  EventLog log;
  log.Add(EventType::kJoined, 4, RobotId(2), "b");
  log.Add(EventType::kJoined, 4, RobotId(0), "a");
  log.Add(EventType::kProposalRejected, 4, std::nullopt, "c");
  const Event stall{5, EventType::kStallBegan, RobotId(1), ModelId(3), ""};
  EXPECT_THAT(log.CompleteFrame(5, {stall}),
              ElementsAre(Event{5, EventType::kProposalRejected, std::nullopt, std::nullopt, "c"},
                          Event{5, EventType::kJoined, RobotId(0), std::nullopt, "a"},
                          Event{5, EventType::kJoined, RobotId(2), std::nullopt, "b"}, stall));
  EXPECT_THAT(log.CompleteFrame(6, {}), IsEmpty());
}

TEST(NoticeList, NoticesOfPeersAreShortPlainLines) {
  NoticeList notices;
  notices.AddFromPeer("robot r: \xff\x1b[2J\n");
  notices.AddFromPeer(std::string(999, 'x') + "\u00e4");
  EXPECT_EQ(notices.Drain(), (std::vector<std::string>{"robot r: ? [2J ", std::string(999, 'x')}));
}

TEST(EventLog, ReportsEachEventOnceInOrder) {
  EventLog log;
  log.Add(EventType::kLeft, 4, RobotId(2), "");
  log.CompleteFrame(5, {{5, EventType::kStallBegan, RobotId(1), std::nullopt, ""}});
  EXPECT_THAT(log.DrainUnreported(), SizeIs(2));
  EXPECT_THAT(log.DrainUnreported(), IsEmpty());
  EXPECT_EQ(log.stalls(), 1u);
}

}  // namespace
}  // namespace troupe
