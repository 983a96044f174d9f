// Pages that need no server: one file with the page of `troupe view`, the simulation as a WebAssembly module, and a
// recording, which the page shows and proves, or a world or a scenario, which it runs.
//
// Everything is embedded (module and data as text), because a page that is opened from a disk may not load other files.
// The reader's browser steps the recording again and compares the hashes, so the page is evidence and not only a film.
#pragma once

#include <string>

#include "recording/recording.h"
#include "troupe/result.h"
#include "viewer/gateway/expectation_rows.h"

namespace troupe {

struct StaticPageOptions {
  std::string module;  // folder with the WebAssembly module; empty: that of the installation
  std::string output;  // file
};

// Whether the module is there.
bool HasPageModule(const StaticPageOptions& options);

// The error is a recording that ends before its first tick, a module that is not there, or the output.
Status WriteStaticPage(const Recording& recording, const ShownExpectations& expectations,
                       const StaticPageOptions& options);
// Of a world or a scenario. The error is also a world that cannot be loaded, or that cannot run in a page: by
// controllers of its own or files that the module cannot read, or that are not below one folder.
Status WriteStaticPage(const std::string& world_file, const ShownExpectations& expectations,
                       const StaticPageOptions& options);

}  // namespace troupe
