// CheckReport: the verdicts of a checker for people and build servers: a line for each, a summary, and JUnit.
//
// It keeps the first verdicts of a rule and vehicle, and counts the others: messages may be hostile.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fleet/checker.h"

namespace troupe::fleet {

class CheckReport {
 public:
  static constexpr std::size_t kMostKept = 100;  // verdicts of a rule and vehicle

  // Returns the line of the verdict, which was made about a message at `place`: a line of a file, or a time; of that
  // topic.
  //   log.jsonl:12: cancel_clears: Acme/anna, state: found ..., expected ...
  std::string Add(const Verdict& verdict, const std::string& place, const std::string& topic);

  std::uint64_t violations() const { return violations_; }
  // A line for each vehicle that the checker has seen, and one of all.
  std::vector<std::string> Summary(const CheckerMemory& memory) const;
  // A suite for each vehicle, with a case for each rule of its version that is not in `left_out`.
  std::string JUnit(const CheckerMemory& memory, const std::vector<Rule>& left_out) const;

 private:
  struct Broken {
    std::uint64_t count = 0;
    std::vector<std::string> lines;
  };

  std::uint64_t violations_ = 0;
  std::map<std::string, std::map<Rule, Broken>> vehicles_;
};

}  // namespace troupe::fleet
