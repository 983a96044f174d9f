// In place of the page in a program that was built without node.
#include "viewer/gateway/web_server.h"

namespace troupe {
namespace {

constexpr PageFile kFiles[] = {{"/", "text/html; charset=utf-8",
                                "<!doctype html><title>Troupe</title><p>This program was built without the page of "
                                "its viewer, which needs node and npm at the build (scripts/setup installs them)."}};

}  // namespace

std::span<const PageFile> PageFiles() {
  return kFiles;
}

}  // namespace troupe
