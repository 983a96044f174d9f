#include "testing/cases/case_search.h"

#include <cmath>
#include <utility>

#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kSearchStream = 0x7365'6172'6368;
constexpr std::size_t kMaxNear = 5;        // cases that are kept for each expectation
constexpr std::uint64_t kMaxRepeats = 50;  // draws until a case is new

std::vector<double> RobustnessOf(const CaseOutcome& outcome) {
  std::vector<double> robustness;
  for (const ExpectationOutcome& each : outcome.expectations) robustness.push_back(each.robustness);
  return robustness;
}

}  // namespace

TestCase CaseSearch::Propose() const {
  const std::uint64_t key = proposals_;
  // The first cases, and one of four later ones, are random.
  constexpr std::uint64_t kFirst = 10;
  const bool known = std::any_of(nearest_.begin(), nearest_.end(), [](const auto& list) { return !list.empty(); });
  if (proposals_ < kFirst || !known || RandomUniform({kSearchStream, key, 0}) < 0.25) return design_.Random(key);
  const std::vector<Near>* list = &nearest_[key % nearest_.size()];
  for (std::size_t i = 0; list->empty(); ++i) list = &nearest_[(key + i) % nearest_.size()];
  // The nearest one most often.
  const double chosen = RandomUniform({kSearchStream, key, 1});
  TestCase draws = (*list)[static_cast<std::size_t>(chosen * chosen * static_cast<double>(list->size()))].draws;
  // From half of all values to half a percent, on a logarithmic scale: wide steps find regions, small ones refine.
  const double amount = 0.5 * std::pow(0.01, RandomUniform({kSearchStream, key, 2}));
  const std::vector<Variation>& variations = design_.variations();
  const std::uint64_t always = RandomBits({kSearchStream, key, 3}) % std::max<std::size_t>(variations.size(), 1);
  for (std::size_t i = 0; i < variations.size(); ++i) {
    if (i != always && RandomUniform({kSearchStream, key, 4, i}) < 0.5) continue;
    draws[i].value = variations[i].Near(draws[i].value, amount, key, i);
  }
  return design_.MeetsConstraints(draws) ? draws : design_.Random(key);
}

std::optional<CaseSearch::Proposal> CaseSearch::Next() {
  // Those and no others, even if more are known.
  const std::uint64_t used = next_ - std::min(next_, Lag(next_));
  for (; used_ < used; ++used_) {
    const auto open = open_.begin();
    if (!open->second.is_known) return std::nullopt;
    Use(open->second.draws, open->second.robustness);
    open_.erase(open);
  }
  Proposal proposal{next_, {}};
  for (std::uint64_t i = 0; i < kMaxRepeats; ++i) {
    proposal.draws = Propose();
    ++proposals_;
    if (proposed_.insert(CaseText(proposal.draws)).second) break;
  }
  open_[next_++].draws = proposal.draws;
  return proposal;
}

void CaseSearch::Add(std::uint64_t number, const CaseOutcome& outcome) {
  Open& open = open_.at(number);
  open.robustness = RobustnessOf(outcome);
  open.is_known = true;
}

void CaseSearch::AddKnown(const TestCase& draws, const CaseOutcome& outcome) {
  Use(draws, RobustnessOf(outcome));
}

void CaseSearch::Use(const TestCase& draws, const std::vector<double>& robustness) {
  nearest_.resize(std::max(nearest_.size(), robustness.size()));
  for (std::size_t i = 0; i < robustness.size(); ++i) {
    if (!std::isfinite(robustness[i])) continue;
    // Each expectation has its own list: a robustness in metres and one in seconds have no common order.
    std::vector<Near>& list = nearest_[i];
    const auto place =
        std::find_if(list.begin(), list.end(), [&](const Near& near) { return robustness[i] < near.robustness; });
    list.insert(place, {robustness[i], draws});
    if (list.size() > kMaxNear) list.pop_back();
  }
}

}  // namespace troupe
