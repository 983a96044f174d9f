#include "launcher/commands/shown_expectations.h"

#include <utility>

#include "testing/cases/case_run.h"
#include "testing/cases/test_file.h"

namespace troupe {
namespace {

ShownExpectations ExpectationsIn(const std::string& file) {
  if (!file.ends_with(".json")) return {};
  Result<ShownExpectations> expectations = ReadExpectations(file);
  return expectations.ok() ? std::move(expectations).value() : ShownExpectations();
}

}  // namespace

// Regions are those of the first case: a page shows one world.
Result<ShownExpectations> ReadExpectations(const std::string& file) {
  const Result<TestFile> test = TestFile::Read(file);
  if (!test.ok()) return test.error();
  ShownExpectations shown;
  for (const TestClause& clause : test.value().expect()) shown.list.push_back({clause.name, clause.text});
  if (shown.list.empty()) return Error{{file}, "found no 'expect', expected a test or a scenario with expectations"};
  const CaseWorlds worlds(test.value());
  Result<LoadedWorld> loaded = worlds.Load(test.value().design().At(0));
  if (!loaded.ok()) return loaded.error();
  shown.regions = std::move(loaded.value().regions);
  return shown;
}

ShownExpectations ExpectationsOfRun(const std::string& file) {
  if (!IsRecordingPath(file)) return ExpectationsIn(file);
  const Result<Recording> recording = Recording::Open(file);
  return recording.ok() ? ExpectationsOf(recording.value()) : ShownExpectations();
}

ShownExpectations ExpectationsOf(const Recording& recording) {
  return {recording.run().expectations, recording.run().regions};
}

}  // namespace troupe
