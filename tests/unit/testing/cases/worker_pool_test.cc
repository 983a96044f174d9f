// Requests in copies of this process.
#include "testing/cases/worker_pool.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>

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
    WorkerPool pool(jobs, [](const std::string& request) { return request + std::string(100'000, '!'); });
    const std::map<int, std::string> replies = Ask(pool, 50);
    ASSERT_EQ(replies.size(), 50U);
    for (const auto& [request, reply] : replies) EXPECT_EQ(reply, std::to_string(request) + std::string(100'000, '!'));
    EXPECT_EQ(Ask(pool, 2).size(), 2U);  // again
  }
}

TEST(WorkerPool, ACopyThatDiesSpoilsItsRequestOnly) {
  WorkerPool pool(2, [](const std::string& request) -> std::string {
    if (request == "3") raise(SIGKILL);
    if (request == "5") _exit(7);
    return "done";
  });
  const std::map<int, std::string> replies = Ask(pool, 20);
  ASSERT_EQ(replies.size(), 20U);
  for (const auto& [request, reply] : replies) EXPECT_EQ(reply, request == 3 || request == 5 ? "" : "done");
}

TEST(WorkerPool, LeavesNoProcessWhenItIsStopped) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  {
    WorkerPool pool(2, [](const std::string&) -> std::string {
      for (;;) pause();
    });
    ASSERT_EQ(write(ends[1], "x", 1), 1);
    const Result<bool> whole =
        pool.Run([]() { return std::optional<std::string>("forever"); },
                 [](const std::string&, const Result<std::string>&) { ADD_FAILURE(); }, ends[0], [] { return true; });
    ASSERT_TRUE(whole.ok());
    EXPECT_FALSE(whole.value());
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // there is no child
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace troupe
