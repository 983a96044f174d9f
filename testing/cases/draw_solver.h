// DrawSolver: draws of a test's variations that meet its constraints.
//
// Random numbers are drawn until they meet the constraints, which needs no knowledge of these and keeps their
// distribution. Two things are decided without draws: bounds of a formula over all values that are left show that none
// of them meets it, and what has lists of values alone is searched through. So a value that cannot occur is told from
// one that occurs rarely; the latter is an error when it exceeds the tries, since a test that left it out in silence
// would claim more than it has run.
//
// Immutable after construction; any thread may ask. A draw is a function of its key (troupe/random.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "testing/cases/constraint.h"
#include "testing/cases/variation.h"
#include "troupe/interval.h"
#include "troupe/result.h"

namespace troupe {

class DrawSolver {
 public:
  // By variation: the number of the value; of a variation of random numbers nothing is read.
  using Indices = std::vector<std::uint64_t>;
  // The same of a part of the variations; nothing: any value.
  using Choice = std::vector<std::optional<std::uint64_t>>;

  // Of all questions about one design together: combinations of values, and random numbers beside them.
  struct Tries {
    std::uint64_t most = 5'000'000;  // that fail
    std::uint64_t failed = 0;
    std::uint64_t met = 0;
  };

  DrawSolver(std::vector<Variation> variations, std::vector<Constraint> constraints, std::uint64_t seed);

  const std::vector<Variation>& variations() const { return variations_; }
  bool Meets(const TestCase& draws) const;
  // False only if no draws with these values meet the constraints.
  bool CanMeet(const Choice& choice) const;
  // Case `number` of these values: with the first random numbers that meet the constraints; nothing if none of `tries`
  // does.
  std::optional<TestCase> Draw(const Indices& indices, std::uint64_t number, std::uint64_t tries) const;
  // As above, with as many tries as ForEach makes.
  TestCase DrawFound(const Indices& indices, std::uint64_t number) const;
  // Calls visit(indices) for all values of the variations that `choice` leaves open, as far as they have a case of
  // number number_of(indices), until it returns false. The last variation changes fastest, each from value `from` on,
  // cyclically. The error: of some values it is not known whether they meet the constraints.
  Status ForEach(const Choice& choice, std::uint64_t from, Tries& tries,
                 const std::function<std::uint64_t(const Indices&)>& number_of,
                 const std::function<bool(const Indices&)>& visit) const;

  // A random case. REQUIRES: CheckRandom() is ok
  TestCase Random(std::uint64_t key) const;
  // The error says how rare it is that a random case meets the constraints, if it is too rare to wait for.
  Status CheckRandom() const;

 private:
  struct Walk;
  // False: `visit` has ended it, or there is an error.
  bool Visit(Walk& walk, std::size_t variation) const;
  TestCase FromIndices(const Indices& indices, std::uint64_t key) const;
  TestCase RandomTry(std::uint64_t key, std::uint64_t draw) const;
  std::vector<DrawBounds> BoundsOf(const Choice& choice) const;
  bool CanHold(const std::vector<DrawBounds>& draws) const;
  // True only if no random numbers beside these values meet the constraints: shown by bounds of parts of their ranges.
  bool IsRefuted(const Indices& indices) const;

  std::vector<Variation> variations_;
  std::vector<Constraint> constraints_;
  std::uint64_t seed_ = 0;
  std::vector<std::optional<Interval>> bounds_;  // by variation: of its numbers
  bool has_random_ = false;                      // numbers, beside lists of values
};

}  // namespace troupe
