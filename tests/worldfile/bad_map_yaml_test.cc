// Faults of ROS maps.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadMap {
  const char* name;
  std::string text;
  const char* message;
};

const BadMap kBadMaps[] = {
    {"empty file", "", "w.yaml:1:1: error: found no YAML map, expected keys such as 'image'"},
    {"no map",
     "- 1\n"
     "- 2\n",
     "w.yaml:1:1: error: found no YAML map, expected keys such as 'image'"},
    {"not YAML",
     "image: [1, 2\n"
     "resolution: 0.05\n",
     "w.yaml:2:11: error: found text that is not YAML (end of sequence flow not found), expected YAML"},
    {"tabs",
     "image:\011map.pgm\n"
     "\011resolution: 5\n",
     "w.yaml:2:1: error: found text that is not YAML (illegal tab when looking for indentation), expected YAML"},
    {"key that is a list", "[a, b]: 5\n",
     "w.yaml:1:1: error: found a key that is not a word, expected one such as 'image'"},
    {"NUL byte", std::string("image: \"a\000\"\n", 12),
     "w.yaml:1:1: error: found a byte that is not text, expected YAML"},
    {"no image",
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:1: error: found no key 'image', expected it"},
    {"empty image",
     "image: \"\"\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:8: error: found an empty image name, expected a file"},
    {"image that is a list",
     "image: [1, 2]\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:8: error: found no single value for 'image', expected one"},
    {"missing image",
     "image: missing.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:8: error: bitmap 'missing.pgm': cannot read the image (No such file or directory), expected a readable "
     "file"},
    {"image that is no image",
     "image: text.png\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:8: error: bitmap 'text.png': found an unknown image format, expected PNG, JPEG, BMP or PGM (P2 or P5)"},
    {"no resolution",
     "image: map.pgm\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:1: error: found no key 'resolution', expected it"},
    {"resolution as text",
     "image: map.pgm\n"
     "resolution: fine\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:2:13: error: found 'fine' for 'resolution', expected a number"},
    {"resolution of zero",
     "image: map.pgm\n"
     "resolution: 0\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:2:13: error: found 0 for 'resolution', expected 1e-06 to 1000000"},
    {"negative resolution",
     "image: map.pgm\n"
     "resolution: -0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:2:13: error: found -0.05 for 'resolution', expected 1e-06 to 1000000"},
    {"resolution that is not a number",
     "image: map.pgm\n"
     "resolution: .nan\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:2:13: error: found '.nan' for 'resolution', expected a number"},
    {"infinite resolution",
     "image: map.pgm\n"
     "resolution: .inf\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:2:13: error: found '.inf' for 'resolution', expected a number"},
    {"no origin",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:1: error: found no key 'origin', expected it"},
    {"origin of two values",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:3:9: error: found no list of three for 'origin', expected [x, y, yaw]"},
    {"origin as a number",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: 5\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:3:9: error: found no list of three for 'origin', expected [x, y, yaw]"},
    {"origin with text",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, north]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:3:16: error: found 'north' for 'origin', expected a number"},
    {"origin that is no number",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [.nan, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:3:10: error: found '.nan' for 'origin', expected a number"},
    {"origin far away",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [1e300, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:3:10: error: found 1e+300 for 'origin', expected at most 1e6"},
    {"no negate",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:1: error: found no key 'negate', expected it"},
    {"no occupied_thresh",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "free_thresh: 0.196\n",
     "w.yaml:1:1: error: found no key 'occupied_thresh', expected it"},
    {"unknown mode",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n"
     "mode: fuzzy\n",
     "w.yaml:7:7: error: found mode 'fuzzy', expected trinary, scale or raw"},
    {"walls without height",
     "image: map.pgm\n"
     "resolution: 0.05\n"
     "origin: [0, 0, 0]\n"
     "negate: 0\n"
     "occupied_thresh: 0.65\n"
     "free_thresh: 0.196\n"
     "wall_height: 0\n",
     "w.yaml:7:14: error: found 0 for 'wall_height', expected 0.001 to 1000000"},
};

TEST(BadMapYaml, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadMap& map : kBadMaps) {
    folder.Write("w.yaml", map.text);
    EXPECT_EQ(folder.ErrorOf("w.yaml"), map.message) << map.name;
  }
}

TEST(BadMapYaml, NestingHasALimit) {
  WorldFolder folder;
  folder.Write("w.yaml", "image: " + std::string(100000, '[') + "\n");
  EXPECT_THAT(folder.ErrorOf("w.yaml"), testing::HasSubstr("found text nested too deeply"));
}

}  // namespace
}  // namespace troupe
