// Faults of ROS maps.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadMap {
  std::string text;
  std::string where;
  std::string what;
};

const std::string kValidMap =
    "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

// The valid map with another line for the key of `line`.
std::string MapWith(const std::string& line) {
  const std::size_t at = kValidMap.find(line.substr(0, line.find(':')));
  return std::string(kValidMap).replace(at, kValidMap.find('\n', at) - at, line);
}
std::string MapWithout(const std::string& key) {
  const std::size_t at = kValidMap.find(key);
  return std::string(kValidMap).erase(at, kValidMap.find('\n', at) + 1 - at);
}

const BadMap kBadMaps[] = {
    {"", "1:1", "found no YAML map, expected keys such as 'image'"},
    {"- 1\n- 2\n", "1:1", "found no YAML map, expected keys such as 'image'"},
    {"image: [1, 2\nresolution: 0.05\n", "2:11",
     "found text that is not YAML (end of sequence flow not found), expected YAML"},
    {"image:\011map.pgm\n\011resolution: 5\n", "2:1",
     "found text that is not YAML (illegal tab when looking for indentation), expected YAML"},
    {"[a, b]: 5\n", "1:1", "found a key that is not a word, expected one such as 'image'"},
    {std::string("image: \"a\000\"\n", 12), "1:1", "found a byte that is not text, expected YAML"},
    {MapWithout("image"), "1:1", "found no key 'image', expected it"},
    {MapWith("image: \"\""), "1:8", "found an empty image name, expected a file"},
    {MapWith("image: [1, 2]"), "1:8", "found no single value for 'image', expected one"},
    {MapWith("image: missing.pgm"), "1:8",
     "bitmap 'missing.pgm': cannot read the image (No such file or directory), expected a readable file"},
    {MapWith("image: text.png"), "1:8",
     "bitmap 'text.png': found an unknown image format, expected PNG, JPEG, BMP or PGM (P2 or P5)"},
    {MapWithout("resolution"), "1:1", "found no key 'resolution', expected it"},
    {MapWith("resolution: fine"), "2:13", "found 'fine' for 'resolution', expected a number"},
    {MapWith("resolution: 0"), "2:13", "found 0 for 'resolution', expected 1e-06 to 1000000"},
    {MapWith("resolution: -0.05"), "2:13", "found -0.05 for 'resolution', expected 1e-06 to 1000000"},
    {MapWith("resolution: .nan"), "2:13", "found '.nan' for 'resolution', expected a number"},
    {MapWith("resolution: .inf"), "2:13", "found '.inf' for 'resolution', expected a number"},
    {MapWithout("origin"), "1:1", "found no key 'origin', expected it"},
    {MapWith("origin: [0, 0]"), "3:9", "found no list of three for 'origin', expected [x, y, yaw]"},
    {MapWith("origin: 5"), "3:9", "found no list of three for 'origin', expected [x, y, yaw]"},
    {MapWith("origin: [0, 0, north]"), "3:16", "found 'north' for 'origin', expected a number"},
    {MapWith("origin: [.nan, 0, 0]"), "3:10", "found '.nan' for 'origin', expected a number"},
    {MapWith("origin: [1e300, 0, 0]"), "3:10", "found 1e+300 for 'origin', expected at most 1e6"},
    {MapWithout("negate"), "1:1", "found no key 'negate', expected it"},
    {MapWithout("occupied_thresh"), "1:1", "found no key 'occupied_thresh', expected it"},
    {kValidMap + "mode: fuzzy\n", "7:7", "found mode 'fuzzy', expected trinary, scale or raw"},
    {kValidMap + "wall_height: 0\n", "7:14", "found 0 for 'wall_height', expected 0.001 to 1000000"},
};

TEST(BadMapYaml, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadMap& map : kBadMaps) {
    folder.Write("w.yaml", map.text);
    EXPECT_EQ(folder.ErrorOf("w.yaml"), "w.yaml:" + map.where + ": error: " + map.what) << map.text;
  }
}

TEST(BadMapYaml, NestingHasALimit) {
  WorldFolder folder;
  folder.Write("w.yaml", "image: " + std::string(100000, '[') + "\n");
  EXPECT_THAT(folder.ErrorOf("w.yaml"), testing::HasSubstr("found text nested too deeply"));
}

}  // namespace
}  // namespace troupe
