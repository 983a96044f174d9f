// ShrinkCase: the smallest case that fails as another one does.
//
// It tries candidates one after another in this process; each is a run of the simulation, so the budget is in
// runs and seconds. It is greedy: the result is small, not proven smallest. Time decides only how far it comes, and
// every case that it returns was run and fails by itself.
#pragma once

#include <cstddef>

#include "testing/cases/case_run.h"

namespace troupe {

struct ShrinkBudget {
  std::size_t runs = 2000;
  double seconds = 30.0;  // of wall time, after which no further run begins
};

struct ShrunkCase {
  TestCase draws;       // of the test's `vary`, then "ticks" and "without"
  CaseOutcome outcome;  // of a whole run
  std::size_t runs = 0;
  std::size_t robots = 0;  // that are left
};

// The smallest case found in which the same expectation does not hold: with fewer robots and objects (which "without"
// names), fewer ticks, and simpler values of each draw. Each candidate is one that the test could have: draws are
// values of their variations and meet the constraints, and robots keep the places of the whole case. An outcome that
// depends on the end of the run keeps its ticks. `progress`: as of CaseRunOptions. REQUIRES: the expectation does not
// hold in the case.
ShrunkCase ShrinkCase(const CaseWorlds& worlds, const TestCase& draws, std::size_t expectation,
                      const ShrinkBudget& budget = {}, const ProgressFunction& progress = nullptr);

}  // namespace troupe
