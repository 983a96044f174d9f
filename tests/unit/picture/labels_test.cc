#include "common/picture/labels.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

const Rectangle kPage{0, 0, 400, 300};

double TextWidth(const std::string& text, double size) {
  return 0.6 * size * double(text.size());
}

LabelPlan Place(const std::vector<LabelRequest>& requests, const std::vector<Rectangle>& walls = {}) {
  return PlaceLabels(requests, walls, kPage, {12.0, 8.0}, TextWidth);
}

TEST(Labels, ALoneLabelIsToTheRightAtFullSize) {
  const LabelPlan plan = Place({{"r0", {100, 100, 120, 120}}});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_EQ(plan.size, 12.0);
  EXPECT_GT(plan.labels[0].box.min_x, 120.0);
}

TEST(Labels, StaysOnThePage) {
  const LabelPlan plan = Place({{"a long name", {380, 100, 398, 118}}});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_LT(plan.labels[0].box.max_x, 380.0);
}

TEST(Labels, AvoidsWallsWherePossible) {
  const Rectangle wall{121, 0, 400, 300};
  const LabelPlan plan = Place({{"r0", {100, 100, 120, 120}}}, {wall});
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_FALSE(plan.labels[0].box.Overlaps(wall));
  EXPECT_EQ(Place({{"r0", {100, 100, 120, 120}}}, {kPage}).labels.size(), 1u);
}

TEST(Labels, CoverNeitherSolidsNorEachOther) {
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 40; ++i) {
    const double x = 20.0 + (i % 8) * 45.0, y = 20.0 + (i / 8) * 50.0;
    requests.push_back({"r" + std::to_string(i), {x, y, x + 20.0, y + 20.0}});
  }
  const LabelPlan plan = Place(requests);
  EXPECT_EQ(plan.labels.size(), requests.size());
  for (std::size_t i = 0; i < plan.labels.size(); ++i) {
    for (const LabelRequest& request : requests) EXPECT_FALSE(plan.labels[i].box.Overlaps(request.box));
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(plan.labels[i].box.Overlaps(plan.labels[j].box));
  }
}

TEST(Labels, ACrowdGetsSmallerLabelsAndADenseCrowdNone) {
  std::vector<LabelRequest> rows;
  for (int i = 0; i < 12; ++i) rows.push_back({"robot", {100, 50.0 + i * 5.0, 300, 54.0 + i * 5.0}});
  EXPECT_EQ(Place(rows).size, 8.0);
  const std::vector<LabelRequest> heap(500, LabelRequest{"robot", {100, 100, 110, 110}});
  EXPECT_TRUE(Place(heap).labels.empty());
}

}  // namespace
}  // namespace troupe
