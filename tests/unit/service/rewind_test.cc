#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>

#include "world-service/service/run_history.h"

namespace troupe {
namespace {

// A history of which the test sets the outcomes.
class RewindTest : public testing::Test, protected RunHistory {
 protected:
  class States final : public RewindStates {
   public:
    explicit States(RewindTest& test) : test_(test) {}
    Result<bool> MakeSome() override { return test_.made_; }
    Result<RewoundRun> Write() override {
      test_.is_written_ = true;
      if (test_.write_throws_) throw std::runtime_error("the disk is broken");
      RewoundRun run;
      run.frame.edition = test_.started_from_->edition + 1;
      return run;
    }

   private:
    RewindTest& test_;
  };

  RewindTest() {
    FrameMessage newest;
    newest.edition = 4;
    rewind_.Start({}, newest);
  }
  Result<std::vector<HistoryEntry>> Read(const HistoryRequest&) override { return Failure("not asked for"); }
  Result<std::unique_ptr<RewindStates>> StartRewind(const ControlRequest&, const FrameMessage& newest) override {
    started_from_ = newest;
    return std::unique_ptr<RewindStates>(std::make_unique<States>(*this));
  }
  std::optional<Result<RewoundRun>> WorkAndAdvance(bool run_ends = false) {
    rewind_.Work(*this);
    return rewind_.Advance(run_ends);
  }

  Rewind rewind_;
  std::optional<FrameMessage> started_from_;
  Result<bool> made_ = false;  // whether there are more
  bool write_throws_ = false;
  bool is_written_ = false;
};

TEST_F(RewindTest, WritesOnceAllStatesAreMade) {
  made_ = true;
  EXPECT_FALSE(WorkAndAdvance());
  EXPECT_EQ(rewind_.stage(), Rewind::Stage::kMaking);
  made_ = false;
  EXPECT_FALSE(WorkAndAdvance());
  EXPECT_EQ(rewind_.stage(), Rewind::Stage::kWriting);
  EXPECT_FALSE(is_written_);
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && outcome->ok());
  EXPECT_EQ(outcome->value().frame.edition, 5u);
  EXPECT_FALSE(rewind_.is_running());
}

TEST_F(RewindTest, AnErrorEndsItBeforeAnythingIsWritten) {
  made_ = Failure("a state is missing");
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && !outcome->ok());
  EXPECT_EQ(outcome->error().message, "a state is missing");
  EXPECT_FALSE(rewind_.is_running());
  EXPECT_FALSE(is_written_);
}

TEST_F(RewindTest, TheEndOfTheRunEndsItUnlessItIsWritten) {
  for (const bool has_more : {true, false}) {
    made_ = has_more;
    (void)WorkAndAdvance();
    const auto outcome = rewind_.Advance(true);
    EXPECT_TRUE(outcome && !outcome->ok());
    EXPECT_FALSE(rewind_.is_running());
    rewind_.Start({}, *started_from_);
  }
  EXPECT_FALSE(is_written_);
  (void)WorkAndAdvance();
  const auto written = WorkAndAdvance(true);
  EXPECT_TRUE(written && written->ok());
}

TEST_F(RewindTest, AnExceptionIsItsOutcome) {
  write_throws_ = true;
  (void)WorkAndAdvance();
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && !outcome->ok());
  EXPECT_EQ(outcome->error().message, "the disk is broken");
}

}  // namespace
}  // namespace troupe
