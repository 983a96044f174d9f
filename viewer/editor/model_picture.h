// The bodies of a model for a picture in the page. Private to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

// [{"outline": [[x, y], ...], "z": [min, max], "color": [r, g, b]}], in m and the world's frame; at most some hundred.
nlohmann::json PictureOf(const WorldDescription& world);
// Of these models alone, without their children.
nlohmann::json PictureOf(const WorldDescription& world, const std::vector<ModelId>& models);

}  // namespace troupe
