#include "common/base/alike.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe {
namespace {

using Names = std::vector<std::string>;

TEST(OneOfAlike, EqualValuesAreOne) {
  const Shared<Names> a = OneOfAlike(Names{"front", "left"});
  const Shared<Names> other = OneOfAlike(Names{"rear"});
  const Shared<Names> b = OneOfAlike(Names{"front", "left"});
  EXPECT_EQ(&*a, &*b);
  EXPECT_EQ(*b, (Names{"front", "left"}));
  EXPECT_EQ(*other, Names{"rear"});
}

TEST(OneOfAlike, ManyKindsKeepTheirValues) {
  std::vector<Shared<Names>> lists;
  for (int i = 0; i < 100; ++i) lists.push_back(OneOfAlike(Names{std::to_string(i)}));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(*lists[static_cast<std::size_t>(i)], Names{std::to_string(i)});
  EXPECT_EQ(*OneOfAlike(Names{"0"}), Names{"0"});
}

TEST(OneOfAlike, AValueWithoutOwnersIsMadeAnew) {
  static_cast<void>(OneOfAlike(Names{"brief"}));
  EXPECT_EQ(*OneOfAlike(Names{"brief"}), Names{"brief"});
}

}  // namespace
}  // namespace troupe
