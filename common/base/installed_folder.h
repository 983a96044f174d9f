// The folders of the installation that the running program belongs to.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe {

// Where the running program is.
Result<std::string> ProgramFolder();

// "PREFIX/share/troupe/worlds" for a program in PREFIX/bin; empty if there is no such folder.
std::string InstalledWorldsFolder();

}  // namespace troupe
