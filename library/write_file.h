// Writes the files of pictures. Private to this folder.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

// The error names the file.
Status WritePicture(const std::string& path, const std::string& bytes);

}  // namespace troupe
