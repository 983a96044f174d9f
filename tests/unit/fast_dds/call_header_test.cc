#include <gtest/gtest.h>

#include "ros/fast_dds/rtps_datagram.h"

namespace troupe::ros {
namespace {

TEST(CallHeader, IsPutBehindTheEncodingInItsByteOrder) {
  const Bytes little = {0, 1, 0, 0, 9, 8};
  EXPECT_EQ(WithHeader(little, {0x0102030405060708, 5}),
            (Bytes{0, 1, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 5, 0, 0, 0, 0, 0, 0, 0, 9, 8}));
  const Bytes big = {0, 0, 0, 0, 9, 8};
  EXPECT_EQ(WithHeader(big, {0x0102030405060708, 5}),
            (Bytes{0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 0, 0, 0, 5, 9, 8}));
}

TEST(CallHeader, IsSplitFromASample) {
  for (const std::uint8_t order : {0, 1}) {
    const Bytes sample = {0, order, 0, 2, 7, 7, 7};
    const std::optional<Bytes> headed = WithHeader(sample, {0xfedcba9876543210, -2});
    ASSERT_TRUE(headed);
    const std::optional<HeadedSample> split = SplitHeader(*headed);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->header.client_guid, 0xfedcba9876543210);
    EXPECT_EQ(split->header.sequence_number, -2);
    EXPECT_EQ(split->sample, sample);
  }
}

TEST(CallHeader, AnotherEncodingOrAShortSampleHasNone) {
  EXPECT_FALSE(WithHeader(Bytes{}, {}));
  EXPECT_FALSE(WithHeader(Bytes{0, 1, 0}, {}));
  EXPECT_FALSE(WithHeader(Bytes{0, 3, 0, 0, 1}, {})) << "a parameter list";
  EXPECT_FALSE(WithHeader(Bytes{1, 1, 0, 0, 1}, {}));
  EXPECT_FALSE(SplitHeader(Bytes(19, 0)));
  EXPECT_TRUE(SplitHeader(Bytes(20, 0)));
}

}  // namespace
}  // namespace troupe::ros
