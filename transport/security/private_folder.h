// A folder of secrets: made whole or not at all, for its owner only.
#pragma once

#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

struct PrivateFile {
  std::string name;
  std::string content;
};

// Writes the files (mode 0600) into a new folder (0700), which appears under its name when it is complete. Missing
// folders above it are made too (0700). Fails if a folder with files, or anything else, has that name already.
Status WritePrivateFolder(const std::string& folder, const std::vector<PrivateFile>& files);

// The content of a small file of such a folder.
Result<std::string> ReadFileOfKeys(const std::string& path);

}  // namespace troupe
