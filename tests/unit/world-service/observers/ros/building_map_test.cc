// The drawings that the map of a building shows to all programs in ROS.
#include "world-service/observers/ros/building_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "transport/dds/binding/wire.h"
#include "worldfile/sites/site.h"

namespace troupe::ros {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class BuildingMapTest : public testing::Test {
 protected:
  BuildingMapTest() { folder_.Write("site/L1.png", picture_); }

  // The number of bytes of the drawing in the map of a building in the folder "site"; 0: it is left out.
  std::size_t PublishedBytesOf(const std::string& drawing, const AllowedPaths& files = {}) {
    Site site;
    site.file = folder_.Path("site/a.building.yaml");
    site.levels.resize(1);
    site.levels[0].name = "L1";
    site.levels[0].drawing = drawing;
    dds::WireArena arena;
    left_out_.clear();
    const BuildingMapMessage map = MakeBuildingMap(site, files, arena, left_out_);
    const auto images = dds::Elements(dds::Elements(map.levels)[0].images);
    return images.empty() ? 0 : dds::Elements(images[0].data).size();
  }

  const std::string picture_ = test::ValueOf(EncodeGreyPng({.width = 2, .height = 1, .values = {0, 255}}));
  test::TemporaryFolder folder_;
  std::vector<std::string> left_out_;
};

TEST_F(BuildingMapTest, HasPicturesBelowTheFolderOfTheBuilding) {
  EXPECT_EQ(PublishedBytesOf("L1.png"), picture_.size());
  EXPECT_EQ(PublishedBytesOf("../site/L1.png"), picture_.size());
  EXPECT_EQ(PublishedBytesOf(folder_.Path("site/L1.png")), picture_.size());
  folder_.Write("site/drawings/second.jpg", picture_);
  EXPECT_EQ(PublishedBytesOf("drawings/second.jpg"), picture_.size()) << "the content tells the format";
  EXPECT_EQ(PublishedBytesOf("missing.png"), 0U);
  EXPECT_EQ(PublishedBytesOf(""), 0U);
  EXPECT_THAT(left_out_, IsEmpty());
}

TEST_F(BuildingMapTest, HasNoOtherFiles) {
  folder_.Write("site/secret.png", "root:x:0:0");
  EXPECT_EQ(PublishedBytesOf("secret.png"), 0U);
  ASSERT_EQ(left_out_.size(), 1U);
  EXPECT_THAT(left_out_[0], HasSubstr("the drawing of level 'L1': found an unknown image format, expected PNG"));
  EXPECT_THAT(left_out_[0], Not(HasSubstr("root")));
  folder_.Write("site/cut.png", picture_.substr(0, 20));
  EXPECT_EQ(PublishedBytesOf("cut.png"), 0U);
  EXPECT_EQ(PublishedBytesOf("/etc/passwd"), 0U);
  EXPECT_THAT(left_out_, ElementsAre(HasSubstr("found /etc/passwd, expected a file below the folder of the building")));
}

TEST_F(BuildingMapTest, HasPicturesOfOtherFoldersIfTheOwnerAllowsThem) {
  const std::string outside = folder_.Write("other/L1.png", picture_);
  std::filesystem::create_symlink(outside, folder_.Path("site/link.png"));
  EXPECT_EQ(PublishedBytesOf(outside), 0U);
  EXPECT_EQ(PublishedBytesOf("../other/L1.png"), 0U);
  EXPECT_EQ(PublishedBytesOf("link.png"), 0U);
  AllowedPaths files;
  files.Add(folder_.Path("other"));
  EXPECT_EQ(PublishedBytesOf(outside, files), picture_.size());
  EXPECT_EQ(PublishedBytesOf("link.png", files), picture_.size());
}

TEST_F(BuildingMapTest, ShowsTheBeginningOfALongName) {
  EXPECT_EQ(PublishedBytesOf("/" + std::string(100'000, 'x')), 0U);
  ASSERT_EQ(left_out_.size(), 1U);
  EXPECT_LT(left_out_[0].size(), 500U);
}

}  // namespace
}  // namespace troupe::ros
