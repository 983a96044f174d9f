#include "common/base/thread_pool.h"

#include <gtest/gtest.h>

#include <new>

namespace troupe {
namespace {

TEST(ThreadPool, RethrowsAnExceptionOfAnyThreadAndContinues) {
  for (const std::size_t thrower : {0u, 2u}) {
    ThreadPool pool(3);
    std::atomic<int> calls = 0;
    const auto work = [&](std::size_t number) {
      ++calls;
      if (number == thrower) throw std::bad_alloc();
    };
    EXPECT_THROW(pool.Run(work), std::bad_alloc);
    EXPECT_EQ(calls, 3);
    EXPECT_NO_THROW(pool.Run([&](std::size_t) { ++calls; }));
    EXPECT_EQ(calls, 6);
  }
}

}  // namespace
}  // namespace troupe
