// The parts of the checker (checker.h): what a judge of one message has at hand, and the judges of both sides.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fleet/checker.h"

namespace troupe::fleet {

// Of the ids of instant actions, before the type.
inline constexpr std::string_view kInstantPlace = "instant action ";

struct MessageJudge {
  VehicleRecord& record;
  const CheckerOptions& options;
  Version version = Version::k2_1;
  const std::string& vehicle;
  std::uint64_t message = 0;
  std::int64_t milliseconds = 0;
  std::vector<Verdict>& verdicts;

  bool is_3() const { return !IsBefore3(version); }

  // A verdict, if the version has the rule. An empty expectation: the rule's requirement.
  void Break(Rule rule, std::string found, std::string expected = "") {
    BreakAt(rule, message, std::move(found), std::move(expected));
  }
  void BreakAt(Rule rule, std::uint64_t at, std::string found, std::string expected = "") {
    if (!InfoOf(rule).IsIn(version)) return;
    const auto alike =
        std::count_if(verdicts.begin(), verdicts.end(), [&](const Verdict& verdict) { return verdict.rule == rule; });
    if (static_cast<std::size_t>(alike) >= kMostVerdicts) return;
    if (expected.empty()) expected = std::string(InfoOf(rule).requirement);
    verdicts.push_back({rule, at, vehicle, std::move(found), std::move(expected)});
  }
};

void JudgeOrder(MessageJudge& judge, const Order& order);
void JudgeInstantActions(MessageJudge& judge, const InstantActions& message);
void JudgeZoneSet(MessageJudge& judge, ZoneSet set);
void JudgeState(MessageJudge& judge, const State& state);
// What should have come by the time of the judge.
void JudgeTime(MessageJudge& judge);

// An unfinished action of the order is among the states.
bool HasUnfinishedActions(const State& state, const VehicleRecord& record);
// nodeStates, edgeStates or unfinished actions are left.
bool IsBusy(const State& state, const VehicleRecord& record);
bool IsInstant(const std::string& action_id, const VehicleRecord& record);
bool IsAmbiguous(const std::string& action_id, const VehicleRecord& record);

}  // namespace troupe::fleet
