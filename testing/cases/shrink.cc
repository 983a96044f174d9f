#include "testing/cases/shrink.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace troupe {
namespace {

// Robots and objects that stand by themselves. Leaves of doors and cabins of lifts belong to the building.
std::vector<std::string> EntitiesOf(const WorldDescription& world) {
  std::vector<bool> is_mounted(world.objects.size());
  for (const DoorDescription& door : world.doors) {
    for (const DoorLeaf& leaf : door.leaves) is_mounted[leaf.object.index()] = true;
  }
  for (const LiftDescription& lift : world.lifts) is_mounted[lift.cabin.index()] = true;
  std::vector<std::string> names;
  for (const RobotDescription& robot : world.robots) names.push_back(world.model(robot.root).name);
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const ModelDescription& object = world.model(world.objects[i]);
    if (!object.parent && !is_mounted[i]) names.push_back(object.name);
  }
  return names;
}

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class Shrinker {
 public:
  Shrinker(const CaseWorlds& worlds, const TestCase& draws, std::size_t expectation, const ShrinkBudget& budget,
           const ProgressFunction& progress)
      : worlds_(worlds), expectation_(expectation), budget_(budget), progress_(progress), draws_(draws) {}

  ShrunkCase Run() {
    ReadStart();
    if (Try(draws_, removed_)) {  // sets the ticks
      for (bool changed = true; changed && HasTime();) {
        // Draws first: a small number of robots is simpler than a large one without some.
        changed = SimplifyDraws();
        changed = RemoveEntities() || changed;
      }
    }
    ShrunkCase shrunk;
    shrunk.draws = CaseOf(draws_, removed_);
    CaseRunOptions whole;
    whole.progress = progress_;
    shrunk.outcome = RunCase(worlds_, shrunk.draws, whole);
    shrunk.runs = runs_;
    if (const Result<LoadedWorld> world = worlds_.Load(shrunk.draws); world.ok())
      shrunk.robots = world.value().world.robots.size();
    return shrunk;
  }

 private:
  using Names = std::vector<std::string>;

  // Draws of the case that shrinking makes by itself are no part of draws_.
  void ReadStart() {
    const CaseDesign& design = worlds_.test().design();
    const auto varied = [&](const std::string& path) {
      return std::any_of(design.variations().begin(), design.variations().end(),
                         [&](const Variation& variation) { return variation.path() == path; });
    };
    may_remove_ = !varied("without");
    may_end_ = !varied("ticks");
    const TestCase all = worlds_.test().WithCommon(draws_);
    const auto drawn =
        std::find_if(all.begin(), all.end(), [](const DrawnValue& draw) { return draw.path == "without"; });
    const JsonNode* const listed = worlds_.test().scenario().tree().root().Find("without");
    if (drawn != all.end()) {
      removed_ = nlohmann::json::parse(drawn->value).get<Names>();
    } else if (listed != nullptr) {
      for (const JsonNode& name : listed->items) removed_.push_back(name.text);
    }
    before_ = removed_;
    if (may_remove_) std::erase_if(draws_, [](const DrawnValue& draw) { return draw.path == "without"; });
    const bool ended =
        may_end_ && std::erase_if(draws_, [](const DrawnValue& draw) { return draw.path == "ticks"; }) > 0;
    if (const Result<LoadedWorld> world = worlds_.Load(all); world.ok()) {
      all_ = EntitiesOf(world.value().world);
      entities_ = all_;
      ticks_ = world.value().settings.ticks.value_or(0);
      scenario_ticks_ = ended ? std::numeric_limits<Tick>::max() : ticks_;
    }
  }

  TestCase CaseOf(const TestCase& draws, const Names& removed) const {
    TestCase whole = draws;
    if (may_end_ && ticks_ < scenario_ticks_) whole.push_back({"ticks", std::to_string(ticks_)});
    if (may_remove_ && !removed.empty()) whole.push_back({"without", nlohmann::json(removed).dump()});
    return whole;
  }

  bool HasTime() const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began_;
    return runs_ < budget_.runs && passed.count() < budget_.seconds;
  }

  // Keeps the case if it fails, too. None is run twice.
  bool Try(const TestCase& draws, const Names& removed) {
    const TestCase whole = CaseOf(draws, removed);
    if (!HasTime() || !tried_.insert(CaseText(whole)).second) return false;
    ++runs_;
    CaseRunOptions options;
    options.only = expectation_;
    options.progress = progress_;
    const CaseOutcome outcome = RunCase(worlds_, whole, options);
    // A case whose verdict was known early must not become one that fails only because its run ends: that would be
    // another fault.
    if (outcome.verdict != CaseVerdict::kFailed || (known_early_ && !outcome.decided)) return false;
    known_early_ = outcome.decided;
    draws_ = draws;
    removed_ = removed;
    const ExpectationOutcome& expectation = outcome.expectations.front();
    causes_ = expectation.causes;
    // A verdict that was known before the end needs no tick more; another one depends on the end.
    if (may_end_ && outcome.decided && *expectation.decided_at < ticks_)
      ticks_ = std::max<Tick>(*expectation.decided_at, 1);
    return true;
  }

  // Leaves out all but the robots and objects that decide, then parts of the rest, down to single ones (delta
  // debugging, Zeller 1999). At least one is left, since of none everything is true.
  bool RemoveEntities() {
    if (!may_remove_) return false;
    bool changed = false;
    const auto try_keeping = [&](const Names& kept) {
      if (kept.empty() || kept.size() >= entities_.size()) return false;
      Names removed = before_;
      for (const std::string& name : all_) {
        if (!Contains(kept, name)) removed.push_back(name);
      }
      if (!Try(draws_, removed)) return false;
      entities_ = kept;
      return changed = true;
    };
    Names deciding;
    std::copy_if(entities_.begin(), entities_.end(), std::back_inserter(deciding),
                 [&](const std::string& name) { return Contains(causes_, name); });
    try_keeping(deciding);
    std::size_t part = (entities_.size() + 1) / 2;
    while (part > 0 && HasTime()) {
      bool removed = false;
      // After a success the list is shorter, and the same index is the next part.
      for (std::size_t begin = 0; begin < entities_.size() && HasTime();) {
        Names kept = entities_;
        const auto first = kept.begin() + static_cast<std::ptrdiff_t>(begin);
        kept.erase(first, first + static_cast<std::ptrdiff_t>(std::min(part, kept.size() - begin)));
        if (try_keeping(kept)) {
          removed = true;
        } else {
          begin += part;
        }
      }
      if (!removed || part > entities_.size()) part /= 2;
    }
    return changed;
  }

  // Each draw to its simplest value before the next one.
  bool SimplifyDraws() {
    bool changed = false;
    const std::vector<Variation>& variations = worlds_.test().design().variations();
    for (std::size_t i = 0; i < variations.size() && i < draws_.size(); ++i) {
      while (SimplifyDraw(variations[i], i)) changed = true;
    }
    return changed;
  }

  bool SimplifyDraw(const Variation& variation, std::size_t i) {
    for (const std::string& value : variation.SimplerThan(draws_[i].value)) {
      if (!HasTime()) return false;
      TestCase simpler = draws_;
      simpler[i].value = value;
      // A smaller case that breaks a constraint would be no case of the test, and mislead the reader.
      if (worlds_.test().CanMake(simpler) && TryDraws(simpler)) return true;
    }
    return false;
  }

  // With other draws the world may have other robots and objects. Those that it lacks cannot be left out.
  bool TryDraws(const TestCase& draws) {
    const Result<LoadedWorld> world = worlds_.Load(CaseOf(draws, before_));
    if (!world.ok()) return false;
    const Names names = EntitiesOf(world.value().world);
    Names removed = removed_;
    std::erase_if(removed, [&](const std::string& name) { return !Contains(before_, name) && !Contains(names, name); });
    if (!Try(draws, removed)) return false;
    all_ = names;
    entities_ = names;
    std::erase_if(entities_, [&](const std::string& name) { return Contains(removed_, name); });
    return true;
  }

  const CaseWorlds& worlds_;
  const std::size_t expectation_;
  const ShrinkBudget budget_;
  const ProgressFunction& progress_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::size_t runs_ = 0;
  std::set<std::string> tried_;  // texts of cases
  bool may_remove_ = true;
  bool may_end_ = true;
  // The smallest case so far.
  TestCase draws_;
  Names removed_;
  Tick ticks_ = 0;
  Tick scenario_ticks_ = 0;   // that a case without a draw of them has
  bool known_early_ = false;  // the verdict does not depend on the end of the run
  Names before_;              // that the whole case leaves out
  Names all_;                 // that it has
  Names entities_;            // of them, those that are left
  Names causes_;
};

}  // namespace

ShrunkCase ShrinkCase(const CaseWorlds& worlds, const TestCase& draws, std::size_t expectation,
                      const ShrinkBudget& budget, const ProgressFunction& progress) {
  return Shrinker(worlds, draws, expectation, budget, progress).Run();
}

}  // namespace troupe
