// The files of the page. They are a part of the program: the gateway reads no file.
#pragma once

#include <span>
#include <string_view>

namespace troupe {

struct PageFile {
  std::string_view path;  // of the URL: "/viewer.js"
  std::string_view type;  // of the content: "text/javascript"
  std::string_view content;
  bool compressed = false;  // with gzip
};

// Generated at the build (viewer/web/build.mjs). Without node it is a page that says so.
std::span<const PageFile> PageFiles();

}  // namespace troupe
