#include <gtest/gtest.h>

#include "launcher/supervise/output_files.h"

namespace troupe {
namespace {

std::string TextOf(const std::string& line) {
  const std::optional<Error> failure = OutputFailure(line, "/proc/7/fd/15", "scans.json");
  return failure ? failure->ToString() : "";
}

TEST(OutputFailure, NamesTheFileOfTheUser) {
  EXPECT_EQ(TextOf("agent of r0 and 3 more: /proc/7/fd/15: error: cannot write scans: No space left on device"),
            "scans.json: error: cannot write scans: No space left on device");
  EXPECT_EQ(TextOf("/proc/7/fd/15: error: cannot write a trace: File too large"),
            "scans.json: error: cannot write a trace: File too large");
}

TEST(OutputFailure, IsNothingForOtherLines) {
  EXPECT_EQ(TextOf("agent of r0: error: the world service is gone"), "");
  EXPECT_EQ(TextOf("agent of r0: /proc/7/fd/151: error: cannot write scans: No space left on device"), "");
  EXPECT_EQ(TextOf("agent of r0: /x/proc/7/fd/15: error: cannot write scans: No space left on device"), "");
  EXPECT_EQ(TextOf("agent of r0: /proc/7/fd/15: warning: slow"), "");
  EXPECT_FALSE(OutputFailure(": error: x", "", "scans.json"));
}

}  // namespace
}  // namespace troupe
