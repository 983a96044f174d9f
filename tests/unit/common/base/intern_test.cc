#include "common/base/intern.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe {
namespace {

using Names = std::vector<std::string>;

TEST(Intern, EqualValuesAreOne) {
  const Shared<Names> a = Intern(Names{"front", "left"});
  const Shared<Names> other = Intern(Names{"rear"});
  const Shared<Names> b = Intern(Names{"front", "left"});
  EXPECT_EQ(&*a, &*b);
  EXPECT_EQ(*b, (Names{"front", "left"}));
  EXPECT_EQ(*other, Names{"rear"});
}

TEST(Intern, ManyKindsKeepTheirValues) {
  std::vector<Shared<Names>> lists;
  for (int i = 0; i < 100; ++i) lists.push_back(Intern(Names{std::to_string(i)}));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(*lists[static_cast<std::size_t>(i)], Names{std::to_string(i)});
  EXPECT_EQ(*Intern(Names{"0"}), Names{"0"});
}

TEST(Intern, AValueWithoutOwnersIsMadeAnew) {
  static_cast<void>(Intern(Names{"brief"}));
  EXPECT_EQ(*Intern(Names{"brief"}), Names{"brief"});
}

}  // namespace
}  // namespace troupe
