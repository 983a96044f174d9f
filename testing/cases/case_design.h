// CaseDesign: which cases of a test are run: all combinations of values (product), few cases in which each pair of
// values of two variations occurs (pairwise), or random draws.
//
// Case number n is a function of the design and n alone, computed when it is asked for: shards, workers and a later
// repetition of one case agree without sharing a list. All randomness is counter-based (troupe/random.h) from the seed
// of the design, never a generator with a state. Pairwise exists because faults most often need the interaction of two
// parameters at most, and its size grows with the product of the two longest lists instead of all.
//
// Immutable after Make; any thread may read it. The cost of Make: product with constraints visits the combinations (at
// most kMaxCases) that their bounds leave, pairwise keeps all pairs (at most 4 million); the other designs keep
// nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "testing/cases/constraint.h"
#include "testing/cases/draw_solver.h"
#include "testing/cases/variation.h"
#include "troupe/result.h"

namespace troupe {

enum class DesignKind : std::uint8_t { kProduct, kPairwise, kRandom };

struct DesignSettings {
  DesignKind kind = DesignKind::kProduct;
  std::uint64_t cases = 0;  // kRandom
  std::uint64_t seed = 0;   // of random draws
};

// More cases than these are a mistake.
inline constexpr std::uint64_t kMaxCases = 10'000'000;

// A part of all cases: those whose numbers are `index` - 1 modulo `count`.
struct Shard {
  std::uint64_t index = 1;  // from 1 to `count`
  std::uint64_t count = 1;

  std::string ToString() const;
  bool Has(std::uint64_t number) const { return number % count == index - 1; }
  bool operator==(const Shard&) const = default;
};
// "2/4"; nothing for any other text.
std::optional<Shard> ParseShard(std::string_view text);

class CaseDesign {
 public:
  // The cases whose draws meet the constraints. Variations of uniform and normal numbers are drawn again for each case
  // of every design. The error: too many cases, none that meets the constraints, or some for which that is too rare to
  // be found.
  static Result<CaseDesign> Make(std::vector<Variation> variations, std::vector<Constraint> constraints,
                                 const DesignSettings& settings);

  std::uint64_t size() const { return size_; }
  // The same for the same number always.
  TestCase At(std::uint64_t number) const;
  const std::vector<Variation>& variations() const { return solver_.variations(); }
  bool MeetsConstraints(const TestCase& draws) const { return solver_.Meets(draws); }
  // Pairs of values of different variations that no case can have; kPairwise only.
  std::uint64_t impossible_pairs() const { return impossible_pairs_; }

  // A random case that meets the constraints, whatever the design: for searches. REQUIRES: CheckRandom() is ok
  TestCase Random(std::uint64_t key) const { return solver_.Random(key); }
  // The error says how rare it is that a random case meets the constraints, if it is too rare to wait for.
  Status CheckRandom() const { return solver_.CheckRandom(); }

 private:
  CaseDesign(DrawSolver solver, const DesignSettings& settings) : solver_(std::move(solver)), settings_(settings) {}
  DrawSolver::Indices ProductIndices(std::uint64_t number) const;
  Status MakeProduct();
  Status MakePairs();

  DrawSolver solver_;
  DesignSettings settings_;
  std::uint64_t size_ = 0;
  std::vector<std::uint64_t> numbers_;      // kProduct with constraints: of the cases that meet them
  std::vector<DrawSolver::Indices> pairs_;  // kPairwise: the cases
  std::uint64_t impossible_pairs_ = 0;
};

}  // namespace troupe
