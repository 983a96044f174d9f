// Running one case of a test in this process: the world of its draws, monitors of the test's clauses, and the outcome.
//
// RunCase is a function of the test file, the draws and the files that the scenario names: it reads no clock, so that a
// case fails again in the same way on any machine, alone or among thousands. An outcome is small (no states) and has a
// JSON form, since it is sent between processes and kept in cases.jsonl.
//
// A world that cannot be loaded or a controller that fails is the verdict kError, not an error of the caller: one bad
// case must not end a session of thousands. Cost: loading the world, then the simulation with its monitors.
//
// Built-in controllers leave nothing behind. Of a library or a class in Python this is not known: a global variable
// that one case sets would change the next one, so that results would depend on the number of jobs. A case with such a
// controller therefore runs in a copy of the process, in which no other case has run.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/json_reader.h"
#include "testing/cases/test_file.h"
#include "testing/cases/worker_pool.h"
#include "troupe/enum_names.h"
#include "troupe/expectation.h"
#include "troupe/simulation.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {

enum class CaseVerdict : std::uint8_t {
  kPassed,
  kFailed,  // an expectation does not hold
  kError,   // the case could not be run
  kNotRun,  // the tests were stopped before
};
constexpr auto NamesOf(CaseVerdict) {
  return std::array{"passed", "failed", "error", "not run"};
}

// The end of one expectation in a case.
struct ExpectationOutcome {
  bool holds = false;
  double robustness = 0.0;               // in the expectation's unit; may be infinite
  std::optional<Tick> decided_at;        // the tick after which the verdict was known
  std::optional<Tick> cause_tick;        // that decides the robustness
  std::vector<std::string> causes;       // robots and objects that decide it
  std::vector<Monitor::Moment> history;  // at most kMaxMoments: the least robustness of each part of the run

  bool operator==(const ExpectationOutcome&) const = default;
};
inline constexpr std::size_t kMaxMoments = 200;

struct CaseOutcome {
  CaseVerdict verdict = CaseVerdict::kNotRun;
  std::string error;     // why the case could not be run
  bool decided = false;  // the verdicts of all expectations were known before the run ended
  Tick ticks = 0;        // of the last state
  std::uint64_t state_hash = 0;
  double tick_seconds = 0.0;                     // s, simulated, of each tick
  std::vector<ExpectationOutcome> expectations;  // in the order of the test
  std::vector<bool> covered;                     // as above
  std::vector<std::optional<double>> metrics;    // as above; nothing: it does not exist in this run
  std::vector<std::uint64_t> undefined;          // as above: values of ticks that were no numbers; empty: none was
  std::vector<std::uint64_t> hashes;             // of each state, if CaseRunOptions asks for them
  std::vector<HeatMap> heat = {};                // of the test, if CaseRunOptions asks for them

  bool operator==(const CaseOutcome&) const = default;
};

// As JSON, and back; other JSON is an error of the reader. JSON has no infinite numbers: they are the texts "inf" and
// "-inf".
nlohmann::json NumberToJson(double number);
double ReadNumber(const JsonReader& json);
nlohmann::json CaseToJson(const TestCase& draws);
TestCase ReadCase(const JsonReader& json);
nlohmann::json ToJson(const CaseOutcome& outcome);
CaseOutcome ReadOutcome(const JsonReader& json);
std::vector<std::optional<double>> ReadMetrics(const JsonReader& outcome);

// Loads the worlds of a test's cases. Files that the scenario names are read once, also for copies of the process.
class CaseWorlds {
 public:
  explicit CaseWorlds(const TestFile& test);  // the test outlives this

  // The error is at a place of the scenario or of the test.
  Result<LoadedWorld> Load(const TestCase& draws, const LoadOverrides& overrides = {}) const;
  const TestFile& test() const { return test_; }
  // The controllers and clauses of the test on the world of `draws`. The error is bad input.
  Status Check(const TestCase& draws) const;

 private:
  const TestFile& test_;
  std::unique_ptr<std::map<std::string, WorldTree>> trees_;  // by path
  ScenarioTools tools_;
};

struct CaseRunOptions {
  // Monitors this expectation alone, and ends when its verdict is known: for shrinking. Nothing: all clauses.
  std::optional<std::size_t> only = {};
  bool hashes = false;  // keeps them in the outcome
  bool heat = false;    // fills the heat maps of the test
  // Saves a picture of this tick, at which the run ends. The verdict is kError if it cannot be saved.
  struct Picture {
    Tick tick = 0;
    std::string file;
  };
  std::optional<Picture> picture = {};
  ProgressFunction progress = nullptr;  // told of the run and of each tick; may be null
};

// REQUIRES: this process has no other thread, if a controller is a library
CaseOutcome RunCase(const CaseWorlds& worlds, const TestCase& draws, const CaseRunOptions& options = {});

// The clauses of a test on one run: for simulations and recordings.
class CaseMonitors {
 public:
  // The error is a clause that the world does not fit, at its place in the test's file. `only`: as above; the other
  // clauses are checked.
  static Result<CaseMonitors> Make(const TestFile& test, const WorldDescription& world,
                                   const std::vector<NamedRegion>& regions, std::optional<std::size_t> only = {});

  template <typename TickSource>  // Simulation or TickView
  Status Push(const TickSource& tick) {
    for (Monitor& monitor : expectations_) {
      if (Status error = monitor.Push(tick); !error.ok()) return error;
    }
    for (Monitor& monitor : cover_) {
      if (Status error = monitor.Push(tick); !error.ok()) return error;
    }
    for (MetricMonitor& monitor : metrics_) {
      if (Status error = monitor.Push(tick); !error.ok()) return error;
    }
    return {};
  }
  // Whether the verdicts of all expectations are known.
  bool decided() const;
  const std::vector<Monitor>& expectations() const { return expectations_; }
  const std::vector<MetricMonitor>& metrics() const { return metrics_; }
  // Ends the monitors, and fills the verdicts.
  void Finish(CaseOutcome& outcome);

 private:
  CaseMonitors() = default;

  std::vector<Monitor> expectations_;
  std::vector<Monitor> cover_;
  std::vector<MetricMonitor> metrics_;
};

}  // namespace troupe
