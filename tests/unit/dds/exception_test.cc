#include <gtest/gtest.h>

#include "transport/dds/binding/entity.h"

namespace troupe::dds {
namespace {

TEST(ExceptionTest, NamesTheReturnCodeAndTheOperation) {
  const Exception exception(DDS_RETCODE_TIMEOUT, "writing a sample");
  EXPECT_STREQ("DDS: Timeout while writing a sample", exception.what());
  EXPECT_EQ(DDS_RETCODE_TIMEOUT, exception.code());
}

TEST(CheckTest, ReturnsEveryOtherResult) {
  EXPECT_EQ(0, Check(DDS_RETCODE_OK, "nothing"));
  EXPECT_EQ(7, Check(7, "counting"));
}

TEST(CheckTest, ThrowsFailures) {
  EXPECT_THROW(Check(DDS_RETCODE_BAD_PARAMETER, "trying"), Exception);
}

}  // namespace
}  // namespace troupe::dds
