// ROS maps: the YAML files of map_server, which name an image and the rule to read it by.
#pragma once

#include <string>
#include <vector>

#include "common/base/allowed_paths.h"
#include "common/image/image_file.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

struct MapYaml {
  SourceLocation image_where;
  std::string image;         // path, relative names resolved
  double resolution = 0.05;  // m, width and height of a pixel
  Pose origin;               // X_WM of the image's lower left corner; z is 0
  PixelRule rule;            // occupied: the pixel's probability is at least occupied_thresh
  double wall_height = 2.0;  // m
  std::vector<Warning> warnings;
};

// A file that cannot be read is an error at `where`, which names it.
Result<MapYaml> ReadMapYaml(const std::string& path, const SourceLocation& where,
                            const AllowedPaths& allowed = AllowedPaths::All());
Result<MapYaml> ReadMapYamlText(const std::string& text, const std::string& path);

// A world of one static model, "map", made from the YAML file at `path`.
WorldTree MapYamlTree(const std::string& path);

}  // namespace troupe
