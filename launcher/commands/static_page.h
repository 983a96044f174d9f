// A recording as a page that needs no server: one file with the page of `troupe view`, the simulation as a WebAssembly
// module, and the recording.
#pragma once

#include <string>

#include "recording/recording.h"
#include "troupe/result.h"

namespace troupe {

struct StaticPageOptions {
  std::string module;  // folder with the WebAssembly module; empty: that of the installation
  std::string output;  // file
};

// The error is a recording that ends before its first tick, a module that is not there, or the output.
Status WriteStaticPage(const Recording& recording, const StaticPageOptions& options);

}  // namespace troupe
