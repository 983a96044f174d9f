// Requests in copies of this process.
#include "testing/cases/worker_pool.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <utility>

namespace troupe {
namespace {

// The replies to 0 ... count - 1; "" for one whose process died.
std::map<int, std::string> Ask(WorkerPool& pool, int count) {
  std::map<int, std::string> replies;
  int asked = 0;
  const Result<bool> whole = pool.Run(
      [&]() -> std::optional<std::string> {
        return asked < count ? std::optional(std::to_string(asked++)) : std::nullopt;
      },
      [&](const std::string& request, const Result<std::string>& reply) {
        EXPECT_TRUE(replies.emplace(std::stoi(request), reply.ok() ? reply.value() : "").second);
      });
  EXPECT_TRUE(whole.ok() && whole.value());
  return replies;
}

TEST(WorkerPool, AnswersEachRequestOnce) {
  for (const std::size_t jobs : {1U, 3U}) {
    WorkerPool pool(
        jobs, [](const std::string& request, const ProgressFunction&) { return request + std::string(100'000, '!'); });
    const std::map<int, std::string> replies = Ask(pool, 50);
    ASSERT_EQ(replies.size(), 50U);
    for (const auto& [request, reply] : replies) EXPECT_EQ(reply, std::to_string(request) + std::string(100'000, '!'));
    EXPECT_EQ(Ask(pool, 2).size(), 2U);  // again
  }
}

TEST(WorkerPool, ACopyThatDiesSpoilsItsRequestOnly) {
  WorkerPool pool(2, [](const std::string& request, const ProgressFunction&) -> std::string {
    if (request == "3") raise(SIGKILL);
    if (request == "5") _exit(7);
    return "done";
  });
  const std::map<int, std::string> replies = Ask(pool, 20);
  ASSERT_EQ(replies.size(), 20U);
  for (const auto& [request, reply] : replies) EXPECT_EQ(reply, request == 3 || request == 5 ? "" : "done");
}

// The reply to one request, or the error's message.
std::string AskOnce(WorkerPool& pool, const std::string& request, const WorkLimits& limits) {
  std::string answer;
  bool asked = false;
  const Result<bool> whole =
      pool.Run([&]() { return std::exchange(asked, true) ? std::nullopt : std::optional(request); },
               [&](const std::string&, const Result<std::string>& reply) {
                 answer = reply.ok() ? reply.value() : reply.error().message;
               },
               limits);
  EXPECT_TRUE(whole.ok() && whole.value());
  return answer;
}

TEST(WorkerPool, KillsACopyThatPassesALimit) {
  WorkerPool pool(1, [](const std::string& request, const ProgressFunction& progress) -> std::string {
    progress(WorkProgress::kPart);
    if (request == "stuck") {
      for (;;) pause();
    }
    for (int i = 0; request == "endless" || i < 80; ++i) {
      usleep(20'000);
      progress(request == "parts" ? WorkProgress::kPart : WorkProgress::kStep);
    }
    return "done";
  });
  EXPECT_EQ(AskOnce(pool, "stuck", {.step = 0.3}), "a tick of the case has not ended within 0.3 s");
  EXPECT_EQ(AskOnce(pool, "stuck", {.part = 0.3}), "the case has not ended within 0.3 s");
  EXPECT_EQ(AskOnce(pool, "endless", {.part = 0.3}), "the case has not ended within 0.3 s");
  // Longer than a limit in all, but each part and step is shorter.
  EXPECT_EQ(AskOnce(pool, "parts", {.part = 1.5}), "done");
  EXPECT_EQ(AskOnce(pool, "steps", {.step = 1.5}), "done");
}

TEST(RunInCopy, LeavesNothingBehindInThisProcess) {
  static int count = 0;
  for (int i = 0; i < 2; ++i) {
    const Result<std::string> reply = RunInCopy([] { return std::to_string(++count); });
    ASSERT_TRUE(reply.ok());
    EXPECT_EQ(reply.value(), "1");
  }
  const Result<std::string> died = RunInCopy([]() -> std::string { _exit(7); });
  ASSERT_FALSE(died.ok());
  EXPECT_EQ(died.error().message, "the process of the case ended with exit status 7");
}

TEST(WorkerPool, LeavesNoProcessWhenItIsStopped) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  {
    WorkerPool pool(2, [](const std::string&, const ProgressFunction&) -> std::string {
      for (;;) pause();
    });
    ASSERT_EQ(write(ends[1], "x", 1), 1);
    const Result<bool> whole = pool.Run([]() { return std::optional<std::string>("forever"); },
                                        [](const std::string&, const Result<std::string>&) { ADD_FAILURE(); }, {},
                                        ends[0], [] { return true; });
    ASSERT_TRUE(whole.ok());
    EXPECT_FALSE(whole.value());
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // there is no child
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace troupe
