// The work of a worker of `troupe test` on one case: running it, shrinking it, recording it.
//
// Requests and answers are JSON, because they cross a process boundary and are few; a case takes milliseconds, a
// message microseconds. An exception of a case is an error of that case, not the end of the session.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "testing/cases/case_run.h"

namespace troupe {

// By the request's "kind", for the draws "case":
// - "run": the outcome. With a folder the case also runs in processes of its own, as `troupe run` does, which leave
//   files there; other hashes than in this process are an error of the case.
// - "shrink": the smallest case in which the expectation number "expectation" fails: "case", its "outcome", "robots"
//   and the "runs" that it took.
// - "keep": writes scenario.json, run.mcap and violation.png of a failed case with this "outcome" into the folder: the
//   names of the last two, empty if they could not be made, and the "problem".
nlohmann::json PerformCaseWork(const CaseWorlds& worlds, const JsonReader& request, const std::filesystem::path& folder,
                               const ProgressFunction& progress);

}  // namespace troupe
