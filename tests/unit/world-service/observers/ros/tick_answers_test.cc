#include "world-service/observers/ros/tick_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Name = TickAnswers::Name;
using Stage = TickAnswers::Stage;

const Name kTopic = {0, "/r0/cmd_vel"};
const Name kNode = {0, "driver"};

class TickAnswersTest : public testing::Test {
 protected:
  TickAnswers Make(const TickAnswers::Options& options, const std::set<Name>& names = {kTopic, kNode}) {
    TickAnswers answers(options, [this](const std::string& line) { lines_.push_back(line); });
    answers.SetParticipants(names);
    return answers;
  }
  static void Publish(TickAnswers& answers, Tick tick, double now) {
    answers.Publish(tick, now);
    answers.SetDelivery(TickAnswers::Delivery::kTold, {}, now);
  }
  // The names that a tick waits for at that time.
  static std::vector<std::string> Awaited(TickAnswers& answers, double now) {
    const Result<std::vector<std::string>> awaited = answers.Awaited(now);
    return awaited.ok() ? awaited.value() : std::vector<std::string>{"error: " + awaited.error().message};
  }
  // All answer, and the tick is released.
  static void Complete(TickAnswers& answers, Tick tick, double now) {
    Publish(answers, tick, now);
    answers.OnAnswer(kTopic, now);
    answers.OnAnswer(kNode, now);
    ASSERT_THAT(Awaited(answers, now), IsEmpty());
    answers.Release();
  }

  std::vector<std::string> lines_;
};

TEST_F(TickAnswersTest, ATickWaitsForEachAnswerOnceItIsPublished) {
  TickAnswers answers = Make({.limit = 10.0});
  EXPECT_EQ(answers.stage(), Stage::kIdle);
  answers.OnAnswer(kTopic, 0.0);  // of nothing
  Publish(answers, 0, 1.0);
  EXPECT_EQ(answers.stage(), Stage::kAwaitingAnswers);
  EXPECT_THAT(Awaited(answers, 1.0), ElementsAre("/r0/cmd_vel", "driver"));
  answers.OnAnswer(kTopic, 1.5);
  answers.OnAnswer({1, "/r0/cmd_vel"}, 1.5);  // of another domain
  EXPECT_THAT(Awaited(answers, 1.5), ElementsAre("driver"));
  EXPECT_FALSE(answers.are_complete());
  answers.OnOtherAnswer(kNode);
  EXPECT_THAT(Awaited(answers, 1.5), ElementsAre("driver"));
  answers.OnAnswer(kNode, 3.0);
  EXPECT_TRUE(answers.are_complete());
  EXPECT_THAT(Awaited(answers, 3.0), IsEmpty());
  answers.Release();
  EXPECT_EQ(answers.stage(), Stage::kIdle);
  Publish(answers, 1, 4.0);
  EXPECT_THAT(Awaited(answers, 4.0), ElementsAre("/r0/cmd_vel", "driver"));
  const std::vector<SlowRobot> slowest = answers.Slowest();
  ASSERT_EQ(slowest.size(), 2U);
  EXPECT_EQ(slowest[0].robot, "driver");
  EXPECT_EQ(slowest[0].times_last, 1U);
  EXPECT_DOUBLE_EQ(slowest[0].waited_seconds, 2.0);
  EXPECT_EQ(slowest[1].times_last, 0U);
}

TEST_F(TickAnswersTest, AnEditOrAnUnpreparedTickChangesTheStage) {
  TickAnswers answers = Make({.limit = 10.0});
  answers.SetArming(true);
  EXPECT_EQ(answers.stage(), Stage::kAwaitingArming);
  answers.SetArming(false);
  EXPECT_EQ(answers.stage(), Stage::kIdle);
  Publish(answers, 3, 0.0);
  answers.SetArming(true);
  EXPECT_EQ(answers.stage(), Stage::kAwaitingAnswers);
  answers.OnAnswer(kNode, 0.0);
  answers.Withdraw();
  EXPECT_EQ(answers.stage(), Stage::kIdle);
  Publish(answers, 3, 1.0);  // the edited one: each answers again
  EXPECT_THAT(Awaited(answers, 1.0), ElementsAre("/r0/cmd_vel", "driver"));
}

TEST_F(TickAnswersTest, TheLimitIsOfThoseThatHaveAnsweredBefore) {
  TickAnswers answers = Make({.limit = 10.0});
  Publish(answers, 0, 0.0);
  EXPECT_THAT(Awaited(answers, 1000.0), ElementsAre("/r0/cmd_vel", "driver"));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("tick 0 waits for /r0/cmd_vel, driver")));
  Complete(answers, 0, 1000.0);
  Publish(answers, 1, 1000.0);
  answers.OnAnswer(kTopic, 1000.0);
  EXPECT_THAT(Awaited(answers, 1010.0), ElementsAre("driver"));
  EXPECT_THAT(Awaited(answers, 1010.1), ElementsAre(HasSubstr("tick 1 has waited 10.1 s for driver of ROS")));
}

TEST_F(TickAnswersTest, ARunMayContinueWithoutOneUntilItIsHeardOf) {
  TickAnswers answers = Make({.limit = 1.0, .ends_at_limit = false});
  Complete(answers, 0, 0.0);
  Publish(answers, 1, 0.0);
  answers.OnAnswer(kTopic, 0.0);
  EXPECT_THAT(Awaited(answers, 2.0), IsEmpty());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("tick 1 continues after 2.0 s without driver")));
  answers.Release();
  Publish(answers, 2, 3.0);
  EXPECT_THAT(Awaited(answers, 3.0), ElementsAre("/r0/cmd_vel"));
  answers.OnOtherAnswer(kNode);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("continues"), "ticks wait for driver again"));
  EXPECT_THAT(Awaited(answers, 3.0), ElementsAre("/r0/cmd_vel", "driver"));
}

TEST_F(TickAnswersTest, ASuccessorOfTheServiceKnowsThatTheyHaveAnswered) {
  TickAnswers answers = Make({.limit = 2.0, .were_heard = true});
  Publish(answers, 30, 0.0);
  EXPECT_THAT(Awaited(answers, 1.9), ElementsAre("/r0/cmd_vel", "driver"));
  EXPECT_THAT(Awaited(answers, 2.1), ElementsAre(HasSubstr("tick 30 has waited 2.1 s for /r0/cmd_vel")));
  answers.SetParticipants({kTopic, {0, "/late/cmd_vel"}});  // of a robot that is spawned
  answers.OnAnswer(kTopic, 2.1);
  EXPECT_THAT(Awaited(answers, 9.0), ElementsAre("/late/cmd_vel"));
}

TEST_F(TickAnswersTest, ATimerOfSimulatedTimeIsAwaitedWhenTheTimeHasAdvanced) {
  TickAnswers answers = Make({.limit = 5.0}, {kTopic});
  Publish(answers, 0, 0.0);
  EXPECT_THAT(Awaited(answers, 100.0), ElementsAre("/r0/cmd_vel"));  // it is not there yet
  answers.SetReadsClock(kTopic, true, 100.0);
  EXPECT_THAT(Awaited(answers, 105.0), ElementsAre("/r0/cmd_vel"));
  EXPECT_THAT(Awaited(answers, 105.1), IsEmpty());
  EXPECT_THAT(lines_.back(), HasSubstr("tick 0 continues without /r0/cmd_vel"));
  answers.Release();
  Publish(answers, 1, 106.0);
  EXPECT_THAT(Awaited(answers, 1000.0), ElementsAre("/r0/cmd_vel"));  // it has never answered
  answers.OnAnswer(kTopic, 1000.0);
  answers.Release();
  Publish(answers, 1, 1001.0);  // after an edit
  EXPECT_THAT(Awaited(answers, 1001.0), IsEmpty());
  answers.Release();
  Publish(answers, 2, 1002.0);
  EXPECT_THAT(Awaited(answers, 1002.0), ElementsAre("/r0/cmd_vel"));
  answers.OnAnswer(kTopic, 1002.0);
  answers.Withdraw();
  Publish(answers, 2, 1003.0);  // edited after the answer, and before the release
  EXPECT_THAT(Awaited(answers, 1003.0), IsEmpty());
  answers.Release();
  Publish(answers, 3, 1004.0);
  answers.Withdraw();
  Publish(answers, 3, 1004.0);  // edited before the answer
  EXPECT_THAT(Awaited(answers, 1004.0), ElementsAre("/r0/cmd_vel"));
  answers.OnAnswerBeforeEdit(kTopic, 1004.0);  // which was not known yet
  EXPECT_THAT(Awaited(answers, 1004.0), IsEmpty());
  Publish(answers, 0, 1005.0);  // reset
  EXPECT_THAT(Awaited(answers, 1005.0), IsEmpty());
}

TEST_F(TickAnswersTest, AnAnswerBeforeAnEditIsNoneForOneThatAnswersAgain) {
  TickAnswers answers = Make({}, {kTopic});
  Publish(answers, 1, 0.0);
  answers.Withdraw();
  Publish(answers, 1, 1.0);
  answers.OnAnswerBeforeEdit(kTopic, 1.0);
  EXPECT_THAT(Awaited(answers, 1.0), ElementsAre("/r0/cmd_vel"));
}

TEST_F(TickAnswersTest, TheLimitOfATickThatIsHeldBackIsThatOfThoseThatAreAbsent) {
  TickAnswers answers = Make({.limit = 5.0});
  Complete(answers, 0, 0.0);
  answers.Publish(1, 10.0);
  answers.SetDelivery(TickAnswers::Delivery::kHeld, {}, 10.0);
  EXPECT_THAT(Awaited(answers, 100.0), ElementsAre("/r0/cmd_vel", "driver"));
  answers.SetDelivery(TickAnswers::Delivery::kTold, {}, 100.0);
  EXPECT_THAT(Awaited(answers, 104.0), ElementsAre("/r0/cmd_vel", "driver"));
  EXPECT_THAT(Awaited(answers, 105.1), ElementsAre(HasSubstr("tick 1 has waited 5.1 s for /r0/cmd_vel")));
  answers.SetDelivery(TickAnswers::Delivery::kHeld, {kNode}, 200.0);
  EXPECT_THAT(Awaited(answers, 200.0), ElementsAre(HasSubstr("tick 1 has waited 100.0 s for driver")));
}

TEST_F(TickAnswersTest, TheLimitIsNotThatOfOneWhoseCallWaitsForAnotherOne) {
  TickAnswers answers = Make({.limit = 5.0});
  Complete(answers, 0, 0.0);
  Publish(answers, 1, 10.0);
  answers.SetCalling({kTopic}, 11.0);
  EXPECT_THAT(Awaited(answers, 15.1), ElementsAre("error: tick 1 has waited 5.1 s for driver of ROS "
                                                  "(--ros-lockstep-limit); for it waits a call of /r0/cmd_vel"));
  answers.OnAnswer(kNode, 15.2);
  answers.SetCalling({}, 16.0);  // it is executed
  EXPECT_THAT(Awaited(answers, 20.9), ElementsAre("/r0/cmd_vel"));
  EXPECT_THAT(Awaited(answers, 21.1), ElementsAre(HasSubstr("tick 1 has waited 5.1 s for /r0/cmd_vel")));

  TickAnswers others = Make({.limit = 5.0, .ends_at_limit = false});
  Complete(others, 0, 0.0);
  Publish(others, 1, 10.0);
  others.SetCalling({kTopic}, 11.0);
  EXPECT_EQ(others.drops(), 0U);
  EXPECT_THAT(Awaited(others, 15.1), ElementsAre("/r0/cmd_vel"));
  EXPECT_EQ(others.drops(), 1U);
}

TEST_F(TickAnswersTest, WithoutALimitASilentTopicIsAwaitedWithoutEnd) {
  TickAnswers answers = Make({.limit = 0.0}, {kTopic});
  Publish(answers, 0, 0.0);
  answers.SetReadsClock(kTopic, true, 0.0);
  EXPECT_THAT(Awaited(answers, 1e6), ElementsAre("/r0/cmd_vel"));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("a timer of simulated time needs --ros-lockstep-limit")));
}

}  // namespace
}  // namespace troupe
