#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "world-service/program/prepared_run.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

std::string OwnSession(const std::string& name) {
  return "lock-test-" + std::to_string(getpid()) + "-" + name;
}

TEST(SessionLock, HasOneOwnerForASessionAndDomain) {
  const std::string session = OwnSession("a");
  const Result<SessionLock> first = SessionLock::Acquire(7, session);
  ASSERT_TRUE(first.ok()) << first.error().ToString();
  const Result<SessionLock> second = SessionLock::Acquire(7, session);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("pid " + std::to_string(getpid())));
  EXPECT_THAT(second.error().message, HasSubstr(session));
  EXPECT_TRUE(SessionLock::Acquire(8, session).ok());
  EXPECT_TRUE(SessionLock::Acquire(7, OwnSession("b")).ok());
}

TEST(SessionLock, IsFreeAgainWhenItsOwnerHasEnded) {
  const std::string session = OwnSession("c");
  EXPECT_TRUE(SessionLock::Acquire(7, session).ok());
  EXPECT_TRUE(SessionLock::Acquire(7, session).ok());
}

TEST(SessionLock, RefusesANameThatIsTooLong) {
  const Result<SessionLock> lock = SessionLock::Acquire(7, std::string(200, 'x'));
  ASSERT_FALSE(lock.ok());
  EXPECT_THAT(lock.error().message, HasSubstr("too long"));
}

}  // namespace
}  // namespace troupe
