#include "common/trace/tick_trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"

namespace troupe {
namespace {

using nlohmann::json;
using testing::ElementsAre;

class Trace : public testing::Test, public test::TemporaryFolder {
 protected:
  TraceOptions To(const std::string& name) const {
    TraceOptions options;
    options.file = Path(name);
    return options;
  }
  static std::unique_ptr<TickTrace> Make(const TraceOptions& options) {
    Result<std::unique_ptr<TickTrace>> trace = TickTrace::Create(options, "agent \"r0\"");
    EXPECT_TRUE(trace.ok());
    return std::move(trace).value();
  }
  // "name tick robot" of all spans.
  static std::vector<std::string> Spans(const json& events) {
    std::vector<std::string> spans;
    for (const json& event : events) {
      if (event["ph"] != "X") continue;
      spans.push_back(event["name"].get<std::string>() + " " + event["args"]["tick"].dump() + " " +
                      event["args"].value("robot", "-"));
    }
    return spans;
  }
  json Merged(const std::vector<std::string>& parts) {
    EXPECT_TRUE(MergeTraces(parts, Path("merged")).ok());
    return json::parse(Read("merged"));
  }
};

TEST_F(Trace, AProgramsPhasesFollowEachOther) {
  auto trace = Make(To("a"));
  trace->NameRobots({"r0", "r1"});
  TraceLane* const lane = trace->AddLane();
  lane->Enter(TickPhase::kApply, 7);
  lane->Enter(TickPhase::kSense, 7, RobotId(1));
  lane->Leave();
  lane->Enter(TickPhase::kSend, 7);
  EXPECT_TRUE(trace->Close().ok());
  const json events = Merged({Path("a")});
  EXPECT_THAT(Spans(events), ElementsAre("apply 7 -", "sense 7 r1", "send 7 -"));
  EXPECT_THAT(events[0]["args"]["name"].get<std::string>(), testing::StartsWith("agent \"r0\""));
  EXPECT_EQ(events[1]["ts"], 0.0) << "time begins with the first event";
  EXPECT_NEAR(events[1]["dur"].get<double>(), events[2]["ts"].get<double>(), 1e-3);
}

TEST_F(Trace, TicksOutsideTheWindowAreLeftOut) {
  TraceOptions options = ParseTraceTicks("3:4").value();
  options.file = Path("window");
  auto trace = Make(options);
  TraceLane* const lane = trace->AddLane();
  for (Tick tick = 1; tick <= 6; ++tick) lane->Enter(TickPhase::kStep, tick);
  EXPECT_TRUE(trace->Close().ok());
  EXPECT_THAT(Spans(Merged({Path("window")})), ElementsAre("step 3 -", "step 4 -"));
}

TEST_F(Trace, PartsAreMergedWithProcessesOfTheirOwn) {
  for (const char* name : {"first", "second"}) {
    auto trace = Make(To(name));
    trace->AddLane()->Enter(TickPhase::kWait, 1);
  }
  const json events = Merged({Path("first"), Path("missing"), Path("second")});
  EXPECT_THAT(Spans(events), ElementsAre("wait 1 -", "wait 1 -"));
  EXPECT_NE(events[1]["pid"], events[3]["pid"]);
  EXPECT_EQ(events[0]["pid"], events[1]["pid"]);
  EXPECT_GE(events[3]["ts"], 0.0);
}

TEST_F(Trace, ALineThatWasCutOffIsLeftOut) {
  {
    auto trace = Make(To("cut"));
    TraceLane* const lane = trace->AddLane();
    lane->Enter(TickPhase::kWait, 1);
    lane->Enter(TickPhase::kWait, 2);
  }
  std::filesystem::resize_file(Path("cut"), std::filesystem::file_size(Path("cut")) - 5);
  EXPECT_THAT(Spans(Merged({Path("cut")})), ElementsAre("wait 1 -"));
}

TEST_F(Trace, NothingMergedIsAnEmptyList) {
  EXPECT_EQ(Merged({Path("missing")}), json::array());
}

TEST_F(Trace, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_FALSE(TickTrace::Create(To("no/such/folder"), "x").ok());
}

TEST(TraceTicks, AreReadAsAWindow) {
  EXPECT_EQ(ParseTraceTicks("100:120").value().first, 100u);
  EXPECT_EQ(ParseTraceTicks("100:120").value().last, 120u);
  EXPECT_EQ(ParseTraceTicks("100:").value().last, std::nullopt);
  EXPECT_EQ(ParseTraceTicks(":120").value().first, 0u);
  for (const char* bad : {"", "5", "a:b", "5:4", "1:2:3", "-1:2"}) EXPECT_FALSE(ParseTraceTicks(bad).ok()) << bad;
}

TEST(NoTrace, EnteringAPhaseDoesNothing) {
  Enter(nullptr, TickPhase::kStep, 1);
}

constexpr std::int64_t kMillisecond = 1'000'000;  // ns

class PhaseTimesTest : public testing::Test {
 protected:
  // A tick with the phases as TickEngine has them, of these times in ms.
  void Tick(int wait, int step, int record, int publish) {
    Spend(TickPhase::kWait, wait);
    Spend(TickPhase::kStep, step);
    Spend(TickPhase::kRecord, record / 2);
    Spend(TickPhase::kPublish, publish);
    Spend(TickPhase::kRecord, record - record / 2);
    times_.Enter(TickPhase::kWait, now_);
  }
  void Spend(TickPhase phase, int milliseconds) {
    times_.Enter(phase, now_);
    now_ += milliseconds * kMillisecond;
  }
  double Mean(TickPhase phase) const { return times_.Mean(phase, now_); }

  PhaseTimes times_;
  std::int64_t now_ = 1'700'000'000'000'000'000;
};

TEST_F(PhaseTimesTest, AreZeroWithoutTicks) {
  EXPECT_EQ(Mean(TickPhase::kStep), 0.0);
  Spend(TickPhase::kWait, 300);
  EXPECT_EQ(Mean(TickPhase::kWait), 0.0);
}

TEST_F(PhaseTimesTest, AreMeansOfATickWithAllPartsOfAPhase) {
  for (int i = 0; i < 4; ++i) Tick(40, i % 2 == 0 ? 5 : 7, 6, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 0.040, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.006, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kRecord), 0.006, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kPublish), 0.002, 1e-9);
}

TEST_F(PhaseTimesTest, ForgetWhatIsLongerAgoThanASecond) {
  for (int i = 0; i < 30; ++i) Tick(90, 10, 0, 0);
  for (int i = 0; i < 4; ++i) Tick(98, 2, 0, 0);
  EXPECT_GT(Mean(TickPhase::kStep), 0.002);
  for (int i = 0; i < 9; ++i) Tick(98, 2, 0, 0);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.002, 1e-9);
}

TEST_F(PhaseTimesTest, OfSlowTicksAreThoseOfTheLastOnes) {
  Tick(3000, 10, 2, 2);
  Tick(2000, 20, 2, 2);
  Tick(2000, 40, 2, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 2.0, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.040, 1e-9);
}

TEST_F(PhaseTimesTest, DoNotCountAPause) {
  Tick(50, 4, 2, 2);
  now_ += 60'000 * kMillisecond;
  EXPECT_EQ(Mean(TickPhase::kStep), 0.0) << "nothing happens";
  times_.Restart(now_);
  for (int i = 0; i < 2; ++i) Tick(50, 4, 2, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 0.050, 1e-9);
}

}  // namespace
}  // namespace troupe
