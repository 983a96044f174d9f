#include "testing/cases/case_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <tuple>

#include "troupe/check.h"
#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kPairStream = 0x7061'6972'73;
constexpr std::uint64_t kMaxPairs = 4'000'000;  // of a pairwise design
constexpr std::uint64_t kPairTries = 200;       // of a case that has a pair, until its values are searched for
constexpr std::uint64_t kPairCandidates = 30;   // of these, at most: the best is chosen
constexpr std::uint64_t kCandidateTries = 20;   // of the random numbers of a candidate

}  // namespace

std::string Shard::ToString() const {
  return fmt::format("{}/{}", index, count);
}

std::optional<Shard> ParseShard(std::string_view text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

Result<CaseDesign> CaseDesign::Make(std::vector<Variation> variations, std::vector<Constraint> constraints,
                                    const DesignSettings& settings) {
  const bool is_constrained = !constraints.empty();
  CaseDesign design(DrawSolver(std::move(variations), std::move(constraints), settings.seed), settings);
  const bool fixed = std::all_of(design.variations().begin(), design.variations().end(),
                                 [](const Variation& variation) { return variation.size() == 1; });
  // All values are fixed by --case: one case, whatever the design would draw.
  if (fixed) design.settings_.kind = DesignKind::kProduct;
  if (design.settings_.kind == DesignKind::kRandom) {
    // A design of random cases does not visit them all to be checked.
    if (Status rare = design.CheckRandom(); !rare.ok()) return rare.error();
    design.size_ = settings.cases;
    return design;
  }
  std::uint64_t all = 1;
  std::uint64_t values = 0;
  for (const Variation& variation : design.variations()) {
    if (variation.size() == 0) continue;
    if (design.settings_.kind == DesignKind::kProduct && all > kMaxCases / variation.size()) {
      return Error{{},
                   fmt::format("found more than {} combinations of values, expected fewer, or the design 'pairwise' or "
                               "'random'",
                               kMaxCases)};
    }
    all *= variation.size();
    values += variation.size();
  }
  Status made;
  if (design.settings_.kind == DesignKind::kPairwise) {
    if (values * values / 2 > kMaxPairs) {
      return Error{
          {}, fmt::format("found {} values, whose pairs are too many, expected fewer, or the design 'random'", values)};
    }
    made = design.MakePairs();
  } else if (!is_constrained) {
    design.size_ = all;
  } else {
    made = design.MakeProduct();
  }
  if (!made.ok()) return made.error();
  if (design.size_ == 0) return Error{{}, "found constraints that no case meets, expected weaker ones"};
  return design;
}

DrawSolver::Indices CaseDesign::ProductIndices(std::uint64_t number) const {
  // The last variation changes fastest.
  DrawSolver::Indices indices(variations().size());
  std::uint64_t rest = number;
  for (std::size_t i = variations().size(); i-- > 0;) {
    const std::uint64_t size = variations()[i].size();
    if (size == 0) continue;
    indices[i] = rest % size;
    rest /= size;
  }
  return indices;
}

TestCase CaseDesign::At(std::uint64_t number) const {
  switch (settings_.kind) {
    case DesignKind::kRandom:
      return Random(number);
    case DesignKind::kPairwise:
      return solver_.DrawFound(pairs_[number], number);
    case DesignKind::kProduct:
      break;
  }
  const std::uint64_t place = numbers_.empty() ? number : numbers_[number];
  return solver_.DrawFound(ProductIndices(place), place);
}

Status CaseDesign::MakeProduct() {
  const auto number_of = [&](const DrawSolver::Indices& indices) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < variations().size(); ++i) {
      if (const std::uint64_t size = variations()[i].size(); size > 0) number = number * size + indices[i];
    }
    return number;
  };
  DrawSolver::Tries tries{.most = 2 * kMaxCases};
  Status status =
      solver_.ForEach(DrawSolver::Choice(variations().size()), 0, tries, number_of, [&](const auto& indices) {
        numbers_.push_back(number_of(indices));
        return true;
      });
  size_ = numbers_.size();
  return status;
}

// For each pair of values that no case has yet, the candidate with the most such pairs among some that have it.
Status CaseDesign::MakePairs() {
  using Pair = std::tuple<std::size_t, std::uint64_t, std::size_t, std::uint64_t>;
  DrawSolver::Tries tries;
  const auto next = [&](const DrawSolver::Indices&) { return pairs_.size(); };
  const DrawSolver::Choice open(variations().size());
  if (!solver_.CanMeet(open)) return {};
  std::vector<std::size_t> listed;
  for (std::size_t i = 0; i < variations().size(); ++i) {
    if (variations()[i].size() > 0) listed.push_back(i);
  }
  if (listed.size() < 2) {  // one variation alone: each of its values
    Status status = solver_.ForEach(open, 0, tries, next, [&](const DrawSolver::Indices& indices) {
      pairs_.push_back(indices);
      return true;
    });
    size_ = pairs_.size();
    return status;
  }
  std::set<Pair> missing;
  for (const std::size_t a : listed) {
    for (const std::size_t b : listed) {
      if (b <= a) continue;
      for (std::uint64_t x = 0; x < variations()[a].size(); ++x) {
        for (std::uint64_t y = 0; y < variations()[b].size(); ++y) missing.emplace(a, x, b, y);
      }
    }
  }
  const std::size_t pairs_of_a_case = listed.size() * (listed.size() - 1) / 2;
  std::uint64_t counter = 0;
  while (!missing.empty()) {
    // The set is ordered: the greedy choice, and so the list of cases, is the same everywhere.
    const auto [a, x, b, y] = *missing.begin();
    DrawSolver::Choice choice = open;
    choice[a] = x;
    choice[b] = y;
    DrawSolver::Indices best;
    std::size_t most = 0;
    std::uint64_t valid = 0;
    const bool can_meet = solver_.CanMeet(choice);
    for (std::uint64_t draw = 0; can_meet && draw < kPairTries && valid < kPairCandidates && most < pairs_of_a_case;
         ++draw) {
      DrawSolver::Indices indices(variations().size());
      for (const std::size_t i : listed) {
        const std::uint64_t size = variations()[i].size();
        TROUPE_CHECK(size > 0);
        indices[i] = RandomBits({kPairStream, settings_.seed, ++counter}) % size;
      }
      indices[a] = x;
      indices[b] = y;
      if (!solver_.Draw(indices, pairs_.size(), kCandidateTries)) continue;
      ++valid;
      std::size_t covered = 0;
      for (const std::size_t i : listed) {
        for (const std::size_t j : listed)
          covered += j > i && missing.contains({i, indices[i], j, indices[j]}) ? 1U : 0U;
      }
      if (covered > most) {
        most = covered;
        best = std::move(indices);
      }
    }
    if (best.empty() && can_meet) {
      Status status = solver_.ForEach(choice, counter, tries, next, [&](const DrawSolver::Indices& indices) {
        best = indices;
        return false;
      });
      if (!status.ok()) return status;
    }
    // The constraints leave out the pair, and the report says how many of them.
    if (best.empty()) {
      ++impossible_pairs_;
      missing.erase(missing.begin());
      continue;
    }
    for (const std::size_t i : listed) {
      for (const std::size_t j : listed) missing.erase({i, best[i], j, best[j]});
    }
    pairs_.push_back(std::move(best));
  }
  size_ = pairs_.size();
  return {};
}

}  // namespace troupe
