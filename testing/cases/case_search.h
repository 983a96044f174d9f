// CaseSearch: cases that come nearer and nearer to failing: near those that came nearest so far, and random ones
// between them, for each expectation by itself, since robustness has its unit.
//
// It uses robustness as a distance from failing, a number that plain true or false could not give. It is a plain local
// search with random restarts: robustness over draws is neither smooth nor monotonic, so that a method with gradients
// has nothing to follow.
//
// Its cases are a sequence that depends on the design alone, not on the jobs that run them: case n is proposed from the
// outcomes of the first cases up to n - Lag(n), in their order, however many are known. So several cases run at once,
// and any number of jobs, on any machine, finds the same one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "testing/cases/case_run.h"

namespace troupe {

class CaseSearch {
 public:
  explicit CaseSearch(const CaseDesign& design) : design_(design) {}

  struct Proposal {
    std::uint64_t number = 0;  // from 0, without a gap
    TestCase draws;
  };
  // The next case, none that was proposed before, if a few draws find one. Nothing: it follows from outcomes that are
  // missing.
  std::optional<Proposal> Next();
  // The outcome of a proposal, once for each, in any order.
  void Add(std::uint64_t number, const CaseOutcome& outcome);
  // The outcome of a case that failed before. REQUIRES: nothing is proposed yet
  void AddKnown(const TestCase& draws, const CaseOutcome& outcome);

  // Proposals before case n whose outcomes it does not use: at least so many cases run at once.
  static std::uint64_t Lag(std::uint64_t n) { return std::max<std::uint64_t>(kMinLag, n / 4); }
  static constexpr std::uint64_t kMinLag = 8;

 private:
  struct Near {
    double robustness = 0.0;
    TestCase draws;
  };
  struct Open {
    TestCase draws;
    std::vector<double> robustness;  // by expectation
    bool is_known = false;
  };
  TestCase Propose() const;
  void Use(const TestCase& draws, const std::vector<double>& robustness);

  const CaseDesign& design_;
  std::uint64_t proposals_ = 0;         // also those that were proposed before: the key of the next draws
  std::uint64_t next_ = 0;              // number
  std::uint64_t used_ = 0;              // outcomes: of the first cases
  std::map<std::uint64_t, Open> open_;  // cases whose outcomes are not used yet
  std::set<std::string> proposed_;
  std::vector<std::vector<Near>> nearest_;  // by expectation; the nearest to failing first
};

}  // namespace troupe
