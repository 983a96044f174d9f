// KeptCases: the cases of a test that failed in earlier sessions, in a file beside the test (its path with .failing in
// place of .json): one on each line, as --case has it. They run first in each later session, so that a repaired fault
// stays repaired.
//
// The file is meant for version control: a text without dates, in a stable order, at most a hundred lines. A line that
// the test cannot make any more (a variation has changed) is a warning and not an error; it stays out of the run. Read
// at the beginning of a session and written at its end, by the command's own thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "testing/cases/test_file.h"
#include "troupe/result.h"

namespace troupe {

struct KeptCase {
  TestCase draws;
  std::optional<std::uint64_t> number;  // in the design; nothing: a case beside it, a smaller one in general
};

class KeptCases {
 public:
  // A file that does not exist has no cases. The error: it cannot be read. Lines that are no case of the test (any
  // more) are left out, and named in `warnings`.
  static Result<KeptCases> Read(const TestFile& test, std::vector<std::string>& warnings);

  static std::string PathOf(const TestFile& test);

  const std::vector<KeptCase>& cases() const { return cases_; }
  // Adds `failing`, without those that are there, up to a hundred cases, and writes the file.
  Status Write(const TestFile& test, const std::vector<TestCase>& failing) const;

 private:
  std::vector<KeptCase> cases_;
};

}  // namespace troupe
