#include "troupe/ids.h"

#include <gtest/gtest.h>

#include <limits>

namespace troupe {
namespace {

TEST(Id, ADefaultOneIsThatOfNothing) {
  EXPECT_NE(ModelId(), ModelId(0));
  EXPECT_GE(ModelId().index(), std::numeric_limits<std::uint32_t>::max()) << "the first entity has 0";
}

TEST(Id, AnIndexOfMoreBitsIsNotCutToThatOfSomethingElse) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(RobotId(kMost - 1).index(), kMost - 1);
  for (const std::size_t index : {kMost, kMost + 1, kMost + 4, std::numeric_limits<std::size_t>::max()}) {
    EXPECT_EQ(RobotId(index), RobotId()) << index;
  }
}

}  // namespace
}  // namespace troupe
