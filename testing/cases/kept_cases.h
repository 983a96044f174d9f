// KeptCases: the cases of a test that failed in earlier sessions, in a file beside the test (its path with .failing in
// place of .json): one on each line, as --case has it. They run first in each later session, so that a repaired fault
// stays repaired.
//
// A kept case is a whole one, with the draws of `vary`, and is judged by all expectations: of a smaller case, which
// shrinking has made for one of them, the others may not hold, and it would fail for ever.
//
// The file is meant for version control, and its lines are the user's: comments, order and lines that are no case of
// the test at present (a variation has changed) stay; those are a warning. So a session only appends to it, under a
// lock, and shards of one machine can share it. Read at the beginning of a session and appended to at its end, by the
// command's own thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "testing/cases/test_file.h"
#include "troupe/result.h"

namespace troupe {

struct KeptCase {
  TestCase draws;
  std::optional<std::uint64_t> number;  // in the design; nothing: beside it, as of a search
};

// Lines that a session can add to the file: more failing cases are one fault most often.
inline constexpr std::size_t kMaxKeptCases = 1000;

std::string KeptCasesPath(const TestFile& test);

// A file that does not exist has no cases. The error: it cannot be read. `warnings`: lines that are no case of the
// test.
Result<std::vector<KeptCase>> ReadKeptCases(const TestFile& test, std::vector<std::string>& warnings);

// Appends those of the failing cases that the file does not have; a file of kMaxKeptCases cases stays as it is. The
// result: the number of cases that have found no place. The error: it cannot be written, and is as before.
Result<std::size_t> KeepCases(const TestFile& test, const std::vector<TestCase>& failing);

}  // namespace troupe
