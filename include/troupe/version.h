// The version of the library and of the programs.
#pragma once

namespace troupe {

// "0.1.0"
const char* VersionText();

}  // namespace troupe
