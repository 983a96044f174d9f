// The files of a command: no output is a file that the command reads, and no two outputs are one file, whatever
// spellings and links lead to it. Checked before anything is written, so that a command never destroys its own source.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// A file that a command writes, and the option that names it.
struct OutputName {
  std::string option;
  std::string path;  // empty: the option was not given
};

// Whether the paths lead to one file, also one that does not exist yet. Hard links to one file are the same file.
bool IsSameFile(const std::string& a, const std::string& b);

// Whether something is at the path that is no regular file: a device, a pipe or a folder.
bool IsDevice(const std::string& path);

// Fails if an output is one of the inputs, or if two outputs are one file; several may be one device. `inputs` is
// called if an output is there already and has content, because it may have to read a world.
Status CheckDistinct(const std::vector<OutputName>& outputs, const std::function<std::vector<std::string>()>& inputs);

}  // namespace troupe
