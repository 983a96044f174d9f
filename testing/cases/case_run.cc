#include "testing/cases/case_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "robot-agent/controller/create_controller.h"
#include "testing/cases/heat_json.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

using nlohmann::json;

template <typename T>
json OptionalToJson(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

// The least of each part of a run, so that no near miss is lost.
std::vector<Monitor::Moment> Thinned(std::span<const Monitor::Moment> history) {
  // Equal parts of the run, each with its worst moment: averages would hide the one tick that failed.
  const std::size_t part = (history.size() + kMaxMoments - 1) / kMaxMoments;
  std::vector<Monitor::Moment> thinned;
  for (std::size_t begin = 0; begin < history.size(); begin += part) {
    const auto end = history.begin() + static_cast<std::ptrdiff_t>(std::min(begin + part, history.size()));
    thinned.push_back(*std::min_element(
        history.begin() + static_cast<std::ptrdiff_t>(begin), end,
        [](const Monitor::Moment& a, const Monitor::Moment& b) { return a.robustness < b.robustness; }));
  }
  return thinned;
}

ExpectationOutcome OutcomeOf(const Monitor& monitor) {
  ExpectationOutcome outcome;
  outcome.holds = monitor.verdict() == Verdict::kTrue;
  outcome.robustness = monitor.robustness();
  outcome.decided_at = monitor.decided_at();
  Monitor::Cause cause = monitor.cause();
  outcome.cause_tick = cause.tick;
  outcome.causes = std::move(cause.names);
  outcome.history = Thinned(monitor.history());
  return outcome;
}

CaseOutcome ErrorOutcome(std::string error) {
  CaseOutcome outcome;
  outcome.verdict = CaseVerdict::kError;
  outcome.error = std::move(error);
  return outcome;
}

}  // namespace

json NumberToJson(double number) {
  if (std::isfinite(number)) return number;
  return std::isnan(number) ? "nan" : number > 0.0 ? "inf" : "-inf";
}

double ReadNumber(const JsonReader& reader) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return reader.Number(-kInfinity, kInfinity, {{"nan", nan}, {"inf", kInfinity}, {"-inf", -kInfinity}}).value_or(nan);
}

json CaseToJson(const TestCase& draws) {
  json list = json::array();
  for (const DrawnValue& draw : draws) list.push_back({draw.path, draw.value});
  return list;
}

TestCase ReadCase(const JsonReader& reader) {
  TestCase draws;
  for (const JsonReader& draw : reader.Items()) {
    std::vector<std::string> pair;
    if (!draw.To(pair)) break;
    if (pair.size() != 2) draw.Fail("a path and a value");
    if (draw.ok()) draws.push_back({pair[0], pair[1]});
  }
  return draws;
}

json ToJson(const CaseOutcome& outcome) {
  json expectations = json::array();
  for (const ExpectationOutcome& each : outcome.expectations) {
    json history = json::array();
    for (const Monitor::Moment& moment : each.history)
      history.push_back({moment.tick, NumberToJson(moment.robustness)});
    expectations.push_back({{"holds", each.holds},
                            {"robustness", NumberToJson(each.robustness)},
                            {"decided_at", OptionalToJson(each.decided_at)},
                            {"cause_tick", OptionalToJson(each.cause_tick)},
                            {"causes", each.causes},
                            {"history", std::move(history)}});
  }
  json metrics = json::array();
  for (const std::optional<double>& metric : outcome.metrics)
    metrics.push_back(metric ? NumberToJson(*metric) : json(nullptr));
  json whole = {{"verdict", NameOf(outcome.verdict)},
                {"error", outcome.error},
                {"decided", outcome.decided},
                {"ticks", outcome.ticks},
                {"state_hash", fmt::format("{:016x}", outcome.state_hash)},
                {"tick_seconds", outcome.tick_seconds},
                {"expectations", std::move(expectations)},
                {"covered", outcome.covered},
                {"metrics", std::move(metrics)},
                {"undefined", outcome.undefined},
                {"hashes", outcome.hashes}};
  if (!outcome.heat.empty()) whole["heat"] = ToJson(outcome.heat);
  return whole;
}

CaseOutcome ReadOutcome(const JsonReader& reader) {
  CaseOutcome outcome;
  outcome.verdict = reader.Get<CaseVerdict>("verdict");
  outcome.error = reader.Get<std::string>("error");
  outcome.decided = reader.Get<bool>("decided");
  outcome.ticks = reader.Get<Tick>("ticks");
  reader.ReadHash("state_hash", outcome.state_hash);
  outcome.tick_seconds = reader.Get<double>("tick_seconds");
  for (const JsonReader& each : reader.ItemsOf("expectations")) {
    ExpectationOutcome expectation;
    expectation.holds = each.Get<bool>("holds");
    if (const auto robustness = each.Find("robustness")) expectation.robustness = ReadNumber(*robustness);
    each.Read("decided_at", expectation.decided_at);
    each.Read("cause_tick", expectation.cause_tick);
    each.Read("causes", expectation.causes);
    for (const JsonReader& moment : each.ItemsOf("history")) {
      const std::vector<JsonReader> pair = moment.Items();
      if (pair.size() != 2) moment.Fail("a tick and a robustness");
      if (!reader.ok()) break;
      pair[0].To(expectation.history.emplace_back(Monitor::Moment{0, ReadNumber(pair[1])}).tick);
    }
    outcome.expectations.push_back(std::move(expectation));
  }
  reader.Read("covered", outcome.covered);
  outcome.metrics = ReadMetrics(reader);
  outcome.undefined = reader.Get<std::vector<std::uint64_t>>("undefined");
  outcome.hashes = reader.Get<std::vector<std::uint64_t>>("hashes");
  if (const auto heat = reader.Find("heat")) outcome.heat = ReadHeatMaps(*heat);
  return outcome;
}

std::vector<std::optional<double>> ReadMetrics(const JsonReader& outcome) {
  std::vector<std::optional<double>> metrics;
  for (const JsonReader& metric : outcome.ItemsOf("metrics")) {
    metrics.push_back(metric.is_null() ? std::nullopt : std::optional(ReadNumber(metric)));
  }
  return metrics;
}

CaseWorlds::CaseWorlds(const TestFile& test)
    : test_(test), trees_(std::make_unique<std::map<std::string, WorldTree>>()) {
  tools_.read_world = [trees = trees_.get()](const std::string& path,
                                             const AllowedPaths& allowed) -> Result<WorldTree> {
    if (const auto found = trees->find(path); found != trees->end()) return found->second;
    Result<WorldTree> read = ReadWorldTree(path, allowed);
    if (read.ok()) trees->emplace(path, read.value());
    return read;
  };
  // Bitmaps are read once; what is known before the workers are forked, they share.
  tools_.build.known_bitmaps = std::make_shared<KnownBitmaps>();
}

Result<LoadedWorld> CaseWorlds::Load(const TestCase& draws, const LoadOverrides& overrides) const {
  const Result<std::string> text = test_.TextOf(draws);
  if (!text.ok()) return text.error();
  Result<LoadedWorld> loaded = LoadScenarioText(text.value(), test_.scenario_path(), overrides, tools_);
  if (!loaded.ok()) {
    // Without draws the scenario itself is wrong, and its place says all.
    if (draws.empty()) return loaded.error();
    return Error{loaded.error().where, fmt::format("{} (in the case {})", loaded.error().message, CaseText(draws)),
                 loaded.error().code};
  }
  return loaded;
}

Status CaseWorlds::Check(const TestCase& draws) const {
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  const Result<LoadedWorld> loaded = Load(draws, overrides);
  if (!loaded.ok()) return loaded.error();
  if (!loaded.value().settings.ticks) {
    return Error{{test_.path()}, "found no 'ticks', expected the number of ticks of each case"};
  }
  const Result<CaseMonitors> monitors = CaseMonitors::Make(test_, loaded.value().world, loaded.value().regions);
  return monitors.ok() ? Status() : monitors.error();
}

Result<CaseMonitors> CaseMonitors::Make(const TestFile& test, const WorldDescription& world,
                                        const std::vector<NamedRegion>& regions, std::optional<std::size_t> only) {
  const ExpectationScope scope{world, regions};
  CaseMonitors monitors;
  const auto add = [&](const std::vector<TestClause>& clauses, std::vector<Monitor>& list) -> Status {
    for (const TestClause& clause : clauses) {
      const Result<Expectation> expectation = Expectation::Parse(clause.text, scope);
      if (!expectation.ok()) return test.At(clause, expectation.error());
      list.emplace_back(expectation.value());
    }
    return {};
  };
  if (Status error = add(test.expect(), monitors.expectations_); !error.ok()) return error.error();
  if (Status error = add(test.cover(), monitors.cover_); !error.ok()) return error.error();
  for (const TestClause& clause : test.metrics()) {
    const Result<Metric> metric = Metric::Parse(clause.text, scope);
    if (!metric.ok()) return test.At(clause, metric.error());
    monitors.metrics_.emplace_back(metric.value());
  }
  if (only) {  // the others have to fit the world, too
    monitors.expectations_ = {monitors.expectations_[*only]};
    monitors.cover_.clear();
    monitors.metrics_.clear();
  }
  return monitors;
}

bool CaseMonitors::decided() const {
  return std::all_of(expectations_.begin(), expectations_.end(),
                     [](const Monitor& monitor) { return monitor.verdict() != Verdict::kUndecided; });
}

void CaseMonitors::Finish(CaseOutcome& outcome) {
  outcome.verdict = CaseVerdict::kPassed;
  outcome.decided = decided();
  for (Monitor& monitor : expectations_) {
    monitor.Finish();
    outcome.expectations.push_back(OutcomeOf(monitor));
    if (!outcome.expectations.back().holds) outcome.verdict = CaseVerdict::kFailed;
  }
  for (Monitor& monitor : cover_) {
    monitor.Finish();
    outcome.covered.push_back(monitor.verdict() == Verdict::kTrue);
  }
  for (MetricMonitor& monitor : metrics_) {
    monitor.Finish();
    outcome.metrics.push_back(monitor.value());
    outcome.undefined.push_back(monitor.undefined());
  }
  const auto is_none = [](std::uint64_t count) { return count == 0; };
  if (std::all_of(outcome.undefined.begin(), outcome.undefined.end(), is_none)) outcome.undefined.clear();
}

namespace {

CaseOutcome Simulate(const CaseWorlds& worlds, LoadedWorld loaded, const CaseRunOptions& options) {
  const Tick ticks = *loaded.settings.ticks;
  Result<Simulation> created = Simulation::Create(std::move(loaded.world));
  if (!created.ok()) return ErrorOutcome(created.error().ToString());
  Simulation& simulation = created.value();
  Result<CaseMonitors> made = CaseMonitors::Make(worlds.test(), simulation.world(), loaded.regions, options.only);
  if (!made.ok()) return ErrorOutcome(made.error().ToString());
  CaseMonitors& monitors = made.value();
  CaseOutcome outcome;
  if (options.heat) outcome.heat = worlds.test().heat().EmptyMaps();
  for (;;) {
    if (options.progress) options.progress(WorkProgress::kStep);
    // Tick 0 is judged, too: a world can violate an expectation before anything moves.
    if (const Status error = monitors.Push(simulation); !error.ok()) return ErrorOutcome(error.error().ToString());
    if (options.hashes) outcome.hashes.push_back(simulation.state_hash());
    if (options.picture && simulation.tick() >= options.picture->tick) {
      if (const Status saved = simulation.SavePicture(options.picture->file); !saved.ok()) {
        return ErrorOutcome(saved.error().message);
      }
      break;
    }
    // A whole case runs to its end although all is decided: metrics, covers and the hash of its state are of all ticks.
    if (simulation.tick() >= ticks || (options.only && monitors.decided())) break;
    simulation.Step();
    if (!simulation.failures().empty()) return ErrorOutcome(simulation.failures().front());
    for (HeatMap& map : outcome.heat) map.Add(simulation.world(), simulation.state());
  }
  outcome.ticks = simulation.tick();
  outcome.state_hash = simulation.state_hash();
  outcome.tick_seconds = simulation.world().interval_seconds();
  monitors.Finish(outcome);
  return outcome;
}

}  // namespace

CaseOutcome RunCase(const CaseWorlds& worlds, const TestCase& draws, const CaseRunOptions& options) {
  if (options.progress) options.progress(WorkProgress::kPart);
  Result<LoadedWorld> loaded = worlds.Load(draws);
  if (!loaded.ok()) return ErrorOutcome(loaded.error().ToString());
  // A test without an end would run for ever; Check reports it before any case, this is for cases of later draws.
  if (!loaded.value().settings.ticks)
    return ErrorOutcome("found no 'ticks', expected the number of ticks of each case");
  const std::vector<RobotDescription>& robots = loaded.value().world.robots;
  if (std::none_of(robots.begin(), robots.end(),
                   [](const auto& robot) { return NamesLibrary(robot.controller.name); })) {
    return Simulate(worlds, std::move(loaded).value(), options);
  }
  // A library is code of a user, which may crash or leave state behind: a copy of the process runs it, and how the copy
  // died is the outcome of this case alone.
  const Result<std::string> reply = RunInCopy([&] {
    return ToJson(Simulate(worlds, std::move(loaded).value(), options))
        .dump(-1, ' ', false, json::error_handler_t::replace);
  });
  if (!reply.ok()) return ErrorOutcome(reply.error().message);
  return ReadOutcome(JsonReader::OfText(reply.value(), "", JsonLimits::OfProcesses()));
}

}  // namespace troupe
