// ImageSource: contents that stand in for image files, of images that are edited and not saved yet.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/image/image_file.h"

namespace troupe {

// The occupied pixels of the image at a path, by the rule; nothing: the file is to be read. A source that is empty
// stands in for no file.
using ImageSource = std::function<std::optional<Bitmap>(const std::string& path, const PixelRule& rule)>;

}  // namespace troupe
