#include "testing/cases/case_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kDesignStream = 0x6465'7369'676e;
constexpr std::uint64_t kMaxDraws = 1000;       // of a case until one meets the constraints
constexpr std::uint64_t kMaxPairs = 4'000'000;  // of a pairwise design
constexpr std::uint64_t kPairCandidates = 30;   // of a case that has a pair, of which the best is chosen

}  // namespace

Result<CaseDesign> CaseDesign::Make(std::vector<Variation> variations, std::vector<Constraint> constraints,
                                    const DesignSettings& settings) {
  CaseDesign design;
  design.variations_ = std::move(variations);
  design.constraints_ = std::move(constraints);
  design.settings_ = settings;
  const bool fixed = std::all_of(design.variations_.begin(), design.variations_.end(),
                                 [](const Variation& variation) { return variation.size() == 1; });
  // All values are fixed by --case: one case, whatever the design would draw.
  if (fixed) design.settings_.kind = DesignKind::kProduct;
  if (design.settings_.kind == DesignKind::kRandom) {
    design.size_ = settings.cases;
    // At(0) has tried kMaxDraws draws already. A design of random cases does not visit them all to be checked.
    if (!design.MeetsConstraints(design.At(0))) {
      return Error{{}, "found constraints that none of 1000 random cases meets, expected weaker ones"};
    }
    return design;
  }
  std::uint64_t all = 1;
  for (const Variation& variation : design.variations_) {
    if (variation.size() == 0) continue;
    if (design.settings_.kind == DesignKind::kProduct && all > kMaxCases / variation.size()) {
      return Error{{},
                   fmt::format("found more than {} combinations of values, expected fewer, or the design 'pairwise' or "
                               "'random'",
                               kMaxCases)};
    }
    all *= variation.size();
  }
  if (design.settings_.kind == DesignKind::kPairwise) {
    std::uint64_t values = 0;
    for (const Variation& variation : design.variations_) values += variation.size();
    if (values * values / 2 > kMaxPairs) {
      return Error{
          {}, fmt::format("found {} values, whose pairs are too many, expected fewer, or the design 'random'", values)};
    }
    design.MakePairs();
  } else if (design.constraints_.empty()) {
    design.size_ = all;
  } else {
    for (std::uint64_t number = 0; number < all; ++number) {
      if (design.MeetsConstraints(design.MakeProduct(number))) design.numbers_.push_back(number);
    }
    design.size_ = design.numbers_.size();
  }
  if (design.size_ == 0) return Error{{}, "found constraints that no case meets, expected weaker ones"};
  return design;
}

bool CaseDesign::MeetsConstraints(const TestCase& draws) const {
  return std::all_of(constraints_.begin(), constraints_.end(),
                     [&](const Constraint& constraint) { return constraint.Holds(draws); });
}

TestCase CaseDesign::FromIndices(const std::vector<std::uint64_t>& indices, std::uint64_t key) const {
  TestCase draws;
  for (std::size_t i = 0; i < variations_.size(); ++i) {
    const bool listed = variations_[i].size() > 0;
    draws.push_back({variations_[i].path(), listed ? variations_[i].At(indices[i]) : variations_[i].Draw(key, i)});
  }
  return draws;
}

TestCase CaseDesign::MakeProduct(std::uint64_t number) const {
  // The last variation changes fastest.
  std::vector<std::uint64_t> indices(variations_.size());
  std::uint64_t rest = number;
  for (std::size_t i = variations_.size(); i-- > 0;) {
    const std::uint64_t size = variations_[i].size();
    if (size == 0) continue;
    indices[i] = rest % size;
    rest /= size;
  }
  TestCase draws;
  for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
    draws = FromIndices(indices, RandomBits({kDesignStream, settings_.seed, number, draw}));
    const bool all_listed =
        std::all_of(variations_.begin(), variations_.end(), [](const auto& v) { return v.size() > 0; });
    if (all_listed || MeetsConstraints(draws)) break;
  }
  return draws;
}

TestCase CaseDesign::Random(std::uint64_t key) const {
  TestCase draws;
  for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
    draws.clear();
    const std::uint64_t bits = RandomBits({kDesignStream, settings_.seed, key, draw});
    for (std::size_t i = 0; i < variations_.size(); ++i)
      draws.push_back({variations_[i].path(), variations_[i].Draw(bits, i)});
    if (MeetsConstraints(draws)) break;
  }
  return draws;
}

TestCase CaseDesign::At(std::uint64_t number) const {
  switch (settings_.kind) {
    case DesignKind::kRandom:
      return Random(number);
    case DesignKind::kPairwise:
      return FromIndices(pairs_[number], RandomBits({kDesignStream, settings_.seed, number, 0}));
    case DesignKind::kProduct:
      break;
  }
  return MakeProduct(numbers_.empty() ? number : numbers_[number]);
}

// For each pair of values that no case has yet, the candidate with the most such pairs among some that have it.
void CaseDesign::MakePairs() {
  using Pair = std::tuple<std::size_t, std::uint64_t, std::size_t, std::uint64_t>;
  std::vector<std::size_t> listed;
  for (std::size_t i = 0; i < variations_.size(); ++i) {
    if (variations_[i].size() > 0) listed.push_back(i);
  }
  std::set<Pair> missing;
  for (const std::size_t a : listed) {
    for (const std::size_t b : listed) {
      if (b <= a) continue;
      for (std::uint64_t x = 0; x < variations_[a].size(); ++x) {
        for (std::uint64_t y = 0; y < variations_[b].size(); ++y) missing.emplace(a, x, b, y);
      }
    }
  }
  if (listed.size() < 2) {  // one variation alone: each of its values
    const std::uint64_t values = listed.empty() ? 1 : variations_[listed.front()].size();
    for (std::uint64_t value = 0; value < values; ++value) {
      std::vector<std::uint64_t> indices(variations_.size());
      if (!listed.empty()) indices[listed.front()] = value;
      if (MeetsConstraints(FromIndices(indices, 0))) pairs_.push_back(std::move(indices));
    }
  }
  std::uint64_t counter = 0;
  while (!missing.empty()) {
    // The set is ordered: the greedy choice, and so the list of cases, is the same everywhere.
    const auto [a, x, b, y] = *missing.begin();
    std::vector<std::uint64_t> best;
    std::size_t most = 0;
    std::uint64_t valid = 0;
    for (std::uint64_t draw = 0; draw < kMaxDraws && valid < kPairCandidates; ++draw) {
      std::vector<std::uint64_t> indices(variations_.size());
      for (const std::size_t i : listed) {
        const std::uint64_t size = std::max<std::uint64_t>(variations_[i].size(), 1);
        indices[i] = RandomBits({kDesignStream, settings_.seed, ++counter}) % size;
      }
      indices[a] = x;
      indices[b] = y;
      if (!MeetsConstraints(FromIndices(indices, RandomBits({kDesignStream, settings_.seed, pairs_.size(), 0}))))
        continue;
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
    // No draw with this pair meets the constraints: the pair is given up, and the report says how many were.
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
}

}  // namespace troupe
