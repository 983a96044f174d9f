#include <gtest/gtest.h>

#include "transport/shared_memory/shared_memory.h"

namespace troupe {
namespace {

TEST(SharingAddressTest, TextIsReadBack) {
  const SharingAddress address{ThisMachine(), 4711, 5, 6, 0xfedcba9876543210};
  ASSERT_FALSE(address.machine.empty());
  EXPECT_EQ(ToText(address).find(';'), std::string::npos);
  EXPECT_EQ(ParseSharingAddress(ToText(address)), address);
  EXPECT_TRUE(IsThisBoot(address));
}

TEST(SharingAddressTest, OtherTextsAreRefused) {
  for (const char* text : {"", ",1,2,3,4", "m", "m,1,2,3", "m,0,2,3,4", "m,-1,2,3,4", "m,1,-2,3,4", "m,1,2,3,4,5",
                           "m,1,2,3,x", "m,1,2,99999999999,4", "m,1,2,3,10000000000000000"}) {
    EXPECT_FALSE(ParseSharingAddress(text)) << text;
  }
}

TEST(SharingAddressTest, AnotherBootIsAnotherMachine) {
  EXPECT_FALSE(IsThisBoot({"another-boot/pid:[1]/net:[2]/uid:0", 1, 2, 3, 4}));
  const std::string boot = ThisMachine().substr(0, ThisMachine().find('/'));
  EXPECT_TRUE(IsThisBoot({boot + "/pid:[1]/net:[2]/uid:0", 1, 2, 3, 4}));
}

}  // namespace
}  // namespace troupe
