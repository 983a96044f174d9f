#include "ros/service_bridge/serialized_text.h"

#include <gtest/gtest.h>

#include <vector>

namespace troupe::ros {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(SerializedText, IsReadInBothByteOrders) {
  EXPECT_EQ(SerializedText(Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'h', 'i', 0}), "hi");
  EXPECT_EQ(SerializedText(Bytes{0, 0, 0, 0, 0, 0, 0, 3, 'h', 'i', 0, 0}), "hi");
  EXPECT_EQ(SerializedText(Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0}), "");
}

TEST(SerializedText, ASampleOfAnotherLayoutHasNone) {
  EXPECT_FALSE(SerializedText(Bytes{}));
  EXPECT_FALSE(SerializedText(Bytes{0, 1, 0, 0, 3, 0, 0}));
  EXPECT_FALSE(SerializedText(Bytes{0, 3, 0, 0, 3, 0, 0, 0, 'h', 'i', 0})) << "a list of parameters";
  EXPECT_FALSE(SerializedText(Bytes{0, 1, 0, 0, 0, 0, 0, 0})) << "without the zero";
  EXPECT_FALSE(SerializedText(Bytes{0, 1, 0, 0, 4, 0, 0, 0, 'h', 'i', 0})) << "too short";
  EXPECT_FALSE(SerializedText(Bytes{0, 1, 0, 0, 2, 0, 0, 0, 'h', 'i', 0})) << "does not end in a zero";
}

}  // namespace
}  // namespace troupe::ros
