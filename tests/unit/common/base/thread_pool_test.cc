#include "common/base/thread_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <vector>

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

// Waits until `calls` is `count`.
void Await(const std::atomic<int>& calls, int count) {
  for (int now = calls; now < count; now = calls) calls.wait(now);
}

TEST(ThreadPool, AllThreadsHelpWithWorkThatLastsLongEnough) {
  ThreadPool pool(3);
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> calls = 0;
    std::mutex mutex;
    std::vector<std::size_t> numbers;
    std::set<std::thread::id> threads;
    pool.Run(3, [&](std::size_t number) {
      {
        const std::lock_guard lock(mutex);
        numbers.push_back(number);
        threads.insert(std::this_thread::get_id());
      }
      ++calls;
      calls.notify_all();
      Await(calls, 3);
    });
    EXPECT_THAT(numbers, UnorderedElementsAre(0, 1, 2));
    EXPECT_EQ(threads.size(), 3u);
  }
}

TEST(ThreadPool, AtMostAsManyThreadsHelpAsAreWanted) {
  ThreadPool pool(4);
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> calls = 0;
    pool.Run(2, [&](std::size_t number) {
      EXPECT_LT(number, 2u);
      ++calls;
      calls.notify_all();
      Await(calls, 2);
    });
    EXPECT_EQ(calls, 2);
  }
}

TEST(ThreadPool, ARunDuringThatOfAnotherThreadGetsNoHelp) {
  ThreadPool pool(2);
  std::vector<std::size_t> numbers;
  std::atomic<int> calls = 0;
  pool.Run(2, [&](std::size_t) {
    if (calls++ == 0) {
      std::thread([&] { pool.Run(2, [&](std::size_t number) { numbers.push_back(number); }); }).join();
    }
  });
  EXPECT_THAT(numbers, ElementsAre(0));
}

TEST(ThreadPool, OneThreadHasNoHelp) {
  for (const std::size_t size : {0u, 1u}) {
    ThreadPool pool(size);
    EXPECT_EQ(pool.size(), 1u);
    std::vector<std::size_t> numbers;
    pool.Run(5, [&](std::size_t number) { numbers.push_back(number); });
    EXPECT_THAT(numbers, ElementsAre(0));
  }
}

TEST(ThreadPool, RethrowsAnExceptionOfAnyThreadAndContinues) {
  for (const std::size_t thrower : {0u, 2u}) {
    ThreadPool pool(3);
    std::atomic<int> calls = 0;
    const auto work = [&](std::size_t number) {
      ++calls;
      calls.notify_all();
      Await(calls, 3);
      if (number == thrower) throw std::bad_alloc();
    };
    EXPECT_THROW(pool.Run(3, work), std::bad_alloc);
    EXPECT_EQ(calls, 3);
    calls = 0;
    EXPECT_NO_THROW(pool.Run(3, [&](std::size_t) {
      ++calls;
      calls.notify_all();
      Await(calls, 3);
    }));
  }
}

}  // namespace
}  // namespace troupe
