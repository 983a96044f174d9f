#include "troupe/shared.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace troupe {
namespace {

using List = Shared<std::vector<std::string>>;

TEST(SharedTest, CopiesShareTheValue) {
  const List list({"a", "b"});
  const List copy = list;
  EXPECT_EQ(&*copy, &*list);
  EXPECT_EQ(copy->size(), 2u);
}

TEST(SharedTest, AChangeConcernsOneOwner) {
  const List list({"a"});
  List changed = list;
  changed.Change().push_back("b");
  EXPECT_EQ(*list, std::vector<std::string>({"a"}));
  EXPECT_EQ(*changed, std::vector<std::string>({"a", "b"}));
}

TEST(SharedTest, EqualityIsThatOfTheValues) {
  EXPECT_EQ(List({"a"}), List({"a"}));
  EXPECT_FALSE(List({"a"}) == List({"b"}));
  EXPECT_TRUE(List({"a"}) == std::vector<std::string>({"a"}));
  EXPECT_EQ(List(), List(std::vector<std::string>()));
}

TEST(SharedTest, APartOfAnotherObjectKeepsThatAlive) {
  auto pair = std::make_shared<std::pair<int, std::string>>(1, "part");
  const std::weak_ptr<void> whole = pair;
  std::shared_ptr<const std::string> part(pair, &pair->second);
  pair.reset();
  const Shared<std::string> shared(std::move(part));
  EXPECT_FALSE(whole.expired());
  EXPECT_EQ(*shared, "part");
}

}  // namespace
}  // namespace troupe
