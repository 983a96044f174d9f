#include "common/spatial/static_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ConvexPiece PieceAt(const Rectangle& r) {
  return {test::Box(r.min_x, r.min_y, r.max_x, r.max_y), {0.0, 1.0}, {}, true, 1.0};
}

// Numbers of kept pieces.
std::vector<std::ptrdiff_t> Find(const StaticIndex& index, const Rectangle& box) {
  NearPieces near;
  index.Query(box, near);
  std::vector<std::ptrdiff_t> result;
  for (const ConvexPiece* piece : near) result.push_back(piece - index.kept_pieces().data());
  return result;
}

TEST(StaticIndex, IsEmptyWithoutPieces) {
  for (const StaticIndex& index : {StaticIndex(), StaticIndex(std::vector<ConvexPiece>{})}) {
    EXPECT_TRUE(Find(index, {-1e6, -1e6, 1e6, 1e6}).empty());
    EXPECT_TRUE(index.bounds().empty());
    index.WalkRay({0, 0}, {1, 0}, {1, kInfinity}, 10.0, [](std::span<const std::uint32_t>, double) {
      ADD_FAILURE();
      return true;
    });
  }
}

TEST(StaticIndex, FindsAFewPieces) {
  const StaticIndex index({PieceAt({0, 0, 1, 1}), PieceAt({5, 5, 6, 6}), PieceAt({0.5, 0.5, 5.5, 5.5})});
  EXPECT_EQ(index.bounds(), (Rectangle{0, 0, 6, 6}));
  EXPECT_EQ(Find(index, {0.2, 0.2, 0.3, 0.3}), (std::vector<std::ptrdiff_t>{0}));
  EXPECT_EQ(Find(index, {0.7, 0.7, 0.8, 0.8}), (std::vector<std::ptrdiff_t>{0, 2}));
  EXPECT_EQ(Find(index, {1.0, 0.0, 2.0, 0.1}), (std::vector<std::ptrdiff_t>{0})) << "touching counts";
  EXPECT_EQ(Find(index, {-9, -9, 9, 9}), (std::vector<std::ptrdiff_t>{0, 1, 2}));
  EXPECT_TRUE(Find(index, {7, 0, 8, 1}).empty());
}

// Numbers of kept pieces that a ray may hit, in the order of its walk.
std::vector<std::uint32_t> Walk(const StaticIndex& index, double y) {
  std::vector<std::uint32_t> walked;
  index.WalkRay({-1.0, y}, {1.0, 0.0}, {1.0, kInfinity}, 100.0, [&](std::span<const std::uint32_t> pieces, double) {
    walked.insert(walked.end(), pieces.begin(), pieces.end());
    return true;
  });
  return walked;
}

std::vector<ConvexPiece> Steps(int count) {
  std::vector<ConvexPiece> pieces;
  for (int i = 0; i < count; ++i) pieces.push_back(PieceAt({2.0 * i, 1.0 * i, 2.0 * i + 1.0, 1.0 * i + 1.0}));
  return pieces;
}

TEST(StaticIndex, EqualPiecesGiveEqualBytesForRays) {
  const StaticIndex index(Steps(50));
  const StaticIndex same(Steps(50));
  const StaticIndex other(Steps(51));
  const auto bytes = index.ray_map().bytes();
  ASSERT_GT(bytes.size(), 50 * sizeof(RayPiece));
  EXPECT_TRUE(std::ranges::equal(bytes, same.ray_map().bytes()));
  EXPECT_FALSE(std::ranges::equal(bytes, other.ray_map().bytes()));
}

TEST(StaticIndex, RaysWalkInMemoryOfOthers) {
  StaticIndex index(Steps(50));
  const StaticIndex before = index;
  ASSERT_EQ(Walk(index, 7.5), Walk(before, 7.5));
  const auto bytes = before.ray_map().bytes();
  struct alignas(64) Line {
    std::byte bytes[64];
  };
  const auto memory = std::make_shared<std::vector<Line>>(bytes.size() / sizeof(Line));
  std::memcpy(memory->data(), bytes.data(), bytes.size());
  const std::weak_ptr<std::vector<Line>> lives = memory;
  index.ShareRayMap(
      [memory](std::span<const std::byte>) { return std::shared_ptr<const std::byte>(memory, memory->data()->bytes); });
  EXPECT_EQ(index.ray_map().bytes().data(), memory->data()->bytes);
  for (const double y : {0.5, 7.5, 49.5, 50.5}) EXPECT_EQ(Walk(index, y), Walk(before, y));
  EXPECT_EQ(Find(index, {-9, -9, 99, 99}).size(), 50u);
  index.ShareRayMap([](std::span<const std::byte>) { return nullptr; });
  EXPECT_EQ(index.ray_map().bytes().data(), memory->data()->bytes) << "nothing better was found";
  index = StaticIndex();
  EXPECT_EQ(lives.use_count(), 1) << "the memory is still held";
}

TEST(StaticIndex, CopesWithManyRectangles) {
  std::vector<ConvexPiece> pieces;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 500; ++x) pieces.push_back(PieceAt({x * 0.1, y * 0.1, x * 0.1 + 0.05, y * 0.1 + 0.05}));
  }
  const StaticIndex index(std::move(pieces));
  EXPECT_EQ(Find(index, {10.01, 10.01, 10.02, 10.02}), (std::vector<std::ptrdiff_t>{100 * 500 + 100}));
  EXPECT_EQ(Find(index, {0.0, 0.0, 0.31, 0.01}).size(), 4u);
  EXPECT_EQ(Find(index, {-1, -1, 100, 100}).size(), 200'000u);
}

TEST(StaticIndex, CopesWithManyPiecesInOnePlace) {
  std::vector<ConvexPiece> pieces(20'000, PieceAt({0, 0, 10, 10}));
  pieces.push_back(PieceAt({1000, 1000, 1000.1, 1000.1}));
  const StaticIndex index(std::move(pieces));
  EXPECT_EQ(Find(index, {5, 5, 5, 5}).size(), 20'000u);
  EXPECT_EQ(Find(index, {999, 999, 1001, 1001}), (std::vector<std::ptrdiff_t>{20'000}));
}

TEST(StaticIndex, RayWalkVisitsHitPiecesInTime) {
  const StaticIndex index({PieceAt({0, 0, 1, 1}), PieceAt({3, 0, 4, 1}), PieceAt({0, 7, 1, 8})});
  double first_distance = -1.0;
  bool saw_second = false;
  index.WalkRay({-1.0, 0.5}, {1.0, 0.0}, {1.0, kInfinity}, 20.0,
                [&](std::span<const std::uint32_t> pieces, double distance) {
                  for (std::uint32_t piece : pieces) {
                    if (piece == 0 && first_distance < 0.0) first_distance = distance;
                    saw_second |= piece == 1;
                  }
                  return true;
                });
  EXPECT_GE(first_distance, 0.0);
  EXPECT_LE(first_distance, 1.0);
  EXPECT_TRUE(saw_second);
}

}  // namespace
}  // namespace troupe
