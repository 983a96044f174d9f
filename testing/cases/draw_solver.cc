#include "testing/cases/draw_solver.h"

#include <fmt/format.h>

#include <algorithm>

#include "troupe/random.h"

namespace troupe {
namespace {

constexpr std::uint64_t kDesignStream = 0x6465'7369'676e;
constexpr std::uint64_t kFirstTries = 1000;  // before bounds are asked, which cost more than these
constexpr std::uint64_t kMaxTries = 50'000;  // of a case
constexpr std::uint64_t kRandomTries = 100'000;
constexpr std::uint64_t kRandomHits = 10;  // of these, at least: then a random case takes 10,000 tries on average
constexpr std::size_t kMaxBoxes = 2000;    // parts of the ranges of random numbers
constexpr double kMinBox = 1e-6;           // as a part of a range

}  // namespace

DrawSolver::DrawSolver(std::vector<Variation> variations, std::vector<Constraint> constraints, std::uint64_t seed)
    : variations_(std::move(variations)), constraints_(std::move(constraints)), seed_(seed) {
  for (const Variation& variation : variations_) {
    bounds_.push_back(variation.NumberBounds());
    has_random_ = has_random_ || variation.size() == 0;
  }
}

bool DrawSolver::Meets(const TestCase& draws) const {
  return std::all_of(constraints_.begin(), constraints_.end(),
                     [&](const Constraint& constraint) { return constraint.Holds(draws); });
}

bool DrawSolver::CanHold(const std::vector<DrawBounds>& draws) const {
  return std::all_of(constraints_.begin(), constraints_.end(),
                     [&](const Constraint& constraint) { return constraint.CanHold(draws); });
}

std::vector<DrawBounds> DrawSolver::BoundsOf(const Choice& choice) const {
  std::vector<DrawBounds> draws;
  for (std::size_t i = 0; i < variations_.size(); ++i) {
    if (choice[i] && variations_[i].size() > 0) {
      draws.push_back({variations_[i].At(*choice[i]), {}});
    } else {
      draws.push_back({{}, bounds_[i]});
    }
  }
  return draws;
}

bool DrawSolver::CanMeet(const Choice& choice) const {
  return constraints_.empty() || CanHold(BoundsOf(choice));
}

TestCase DrawSolver::FromIndices(const Indices& indices, std::uint64_t key) const {
  TestCase draws;
  for (std::size_t i = 0; i < variations_.size(); ++i) {
    const bool listed = variations_[i].size() > 0;
    draws.push_back({variations_[i].path(), listed ? variations_[i].At(indices[i]) : variations_[i].Draw(key, i)});
  }
  return draws;
}

std::optional<TestCase> DrawSolver::Draw(const Indices& indices, std::uint64_t number, std::uint64_t tries) const {
  // Without random numbers all tries are one.
  for (std::uint64_t draw = 0; draw < (has_random_ ? tries : 1); ++draw) {
    TestCase draws = FromIndices(indices, RandomBits({kDesignStream, seed_, number, draw}));
    if (Meets(draws)) return draws;
  }
  return std::nullopt;
}

TestCase DrawSolver::DrawFound(const Indices& indices, std::uint64_t number) const {
  std::optional<TestCase> draws = Draw(indices, number, kMaxTries);
  return draws ? *std::move(draws) : FromIndices(indices, RandomBits({kDesignStream, seed_, number, 0}));
}

// Branch and bound, depth first: a box in which bounds exclude one of the constraints is dropped, any other is halved
// along the side that is relatively the longest. Without an answer it ends at boxes so small that bounds exclude no
// more, or after as many boxes as a design can wait for.
bool DrawSolver::IsRefuted(const Indices& indices) const {
  const std::vector<DrawBounds> whole = BoundsOf({indices.begin(), indices.end()});
  std::vector<std::vector<DrawBounds>> boxes = {whole};
  for (std::size_t count = 0; !boxes.empty(); ++count) {
    std::vector<DrawBounds> box = std::move(boxes.back());
    boxes.pop_back();
    if (!CanHold(box)) continue;
    std::size_t widest = 0;
    double width = 0.0;
    for (std::size_t i = 0; i < box.size(); ++i) {
      if (box[i].value || !box[i].numbers) continue;
      const double all = whole[i].numbers->max - whole[i].numbers->min;
      const double part = all > 0.0 ? (box[i].numbers->max - box[i].numbers->min) / all : 0.0;
      if (part <= width) continue;
      width = part;
      widest = i;
    }
    if (width < kMinBox || count >= kMaxBoxes) return false;
    const Interval range = *box[widest].numbers;
    const double middle = 0.5 * (range.min + range.max);
    box[widest].numbers = Interval{range.min, middle};
    boxes.push_back(box);
    box[widest].numbers = Interval{middle, range.max};
    boxes.push_back(std::move(box));
  }
  return true;
}

// The state of ForEach.
struct DrawSolver::Walk {
  Choice choice;
  std::uint64_t from;
  Tries& tries;
  const std::function<std::uint64_t(const Indices&)>& number_of;
  const std::function<bool(const Indices&)>& visit;
  Status status = {};
};

bool DrawSolver::Visit(Walk& walk, std::size_t variation) const {
  while (variation < variations_.size() && (variations_[variation].size() == 0 || walk.choice[variation])) ++variation;
  if (variation < variations_.size()) {
    // No case has the values chosen so far: all combinations with them are left out at once.
    if (!CanMeet(walk.choice)) return true;
    const std::uint64_t size = variations_[variation].size();
    bool goes_on = true;
    for (std::uint64_t i = 0; i < size && goes_on; ++i) {
      walk.choice[variation] = (walk.from + i) % size;
      goes_on = Visit(walk, variation + 1);
    }
    walk.choice[variation].reset();
    return goes_on;
  }
  // Without random numbers, the draw below is one exact test.
  if (has_random_ && !CanMeet(walk.choice)) return true;
  Indices indices;
  for (const std::optional<std::uint64_t>& index : walk.choice) indices.push_back(index.value_or(0));
  const std::uint64_t number = walk.number_of(indices);
  // The cheapest question first: most values are met by one of a few draws. Only then the proof that none meets them,
  // and the many tries if there is none.
  bool found = Draw(indices, number, kFirstTries).has_value();
  const bool is_refuted = !found && (!has_random_ || IsRefuted(indices));
  if (!found && !is_refuted) found = Draw(indices, number, kMaxTries).has_value();
  if (found) {
    ++walk.tries.met;
    return walk.visit(indices);
  }
  if (!is_refuted) {
    std::string values;
    for (std::size_t i = 0; i < variations_.size(); ++i) {
      if (variations_[i].size() < 2) continue;
      values += (values.empty() ? " beside " : ",") + variations_[i].path() + "=" + variations_[i].At(indices[i]);
    }
    walk.status = Error{{},
                        fmt::format("found constraints that none of {} draws of random numbers{} meets, expected "
                                    "weaker ones, or one that leaves out these values",
                                    kMaxTries, values)};
    return false;
  }
  // Refuted values count as the tries that they took, so that a design of which almost nothing can occur ends with an
  // error.
  walk.tries.failed += has_random_ ? kFirstTries : 1;
  if (walk.tries.failed <= walk.tries.most) return true;
  walk.status = Error{{},
                      fmt::format("found constraints that {} of {} tries meet, too few to find all cases, expected "
                                  "weaker ones",
                                  walk.tries.met, walk.tries.met + walk.tries.failed)};
  return false;
}

Status DrawSolver::ForEach(const Choice& choice, std::uint64_t from, Tries& tries,
                           const std::function<std::uint64_t(const Indices&)>& number_of,
                           const std::function<bool(const Indices&)>& visit) const {
  Walk walk{choice, from, tries, number_of, visit};
  Visit(walk, 0);
  return walk.status;
}

TestCase DrawSolver::RandomTry(std::uint64_t key, std::uint64_t draw) const {
  TestCase draws;
  const std::uint64_t bits = RandomBits({kDesignStream, seed_, key, draw});
  for (std::size_t i = 0; i < variations_.size(); ++i)
    draws.push_back({variations_[i].path(), variations_[i].Draw(bits, i)});
  return draws;
}

TestCase DrawSolver::Random(std::uint64_t key) const {
  // Ends: CheckRandom has seen how often one is met.
  for (std::uint64_t draw = 0;; ++draw) {
    TestCase draws = RandomTry(key, draw);
    if (Meets(draws)) return draws;
  }
}

Status DrawSolver::CheckRandom() const {
  // Else an estimate of how often a draw meets them. It ends at once where bounds exclude all draws.
  if (constraints_.empty()) return {};
  std::uint64_t hits = 0;
  for (std::uint64_t draw = 0; draw < kRandomTries && CanMeet(Choice(variations_.size())); ++draw) {
    hits += Meets(RandomTry(0, draw)) ? 1 : 0;
    if (hits == kRandomHits) return {};
  }
  return Error{
      {},
      fmt::format("found constraints that {} of {} random cases meet{}, expected weaker ones, which {} meet",
                  hits == 0 ? "none" : fmt::format("{}", hits), kRandomTries, hits <= 1 ? "s" : "", kRandomHits)};
}

}  // namespace troupe
