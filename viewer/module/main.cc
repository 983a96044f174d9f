// troupe-core: the simulation as a program for node, which compares it with that of the host.
//   troupe-core.mjs FILE TICKS HASH_LOG [SCANS]
// Steps a world or a scenario, and writes the logs of `troupe run --hash-log --scans`.
#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "common/base/output_file.h"
#include "common/sensing/sensor_suite.h"
#include "testing/expectations/tick_view.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

// Line by line the files of the host's program, so that a comparison of bytes is the test.
class Logs {
 public:
  Status Open(const std::string& hashes, const std::string& scans) {
    for (auto [path, log] : {std::pair(&hashes, &hashes_), std::pair(&scans, &scans_)}) {
      if (path->empty()) continue;
      Result<OutputFile> file = OutputFile::Create(*path);
      if (!file.ok()) return file.error();
      log->emplace(std::move(file).value());
    }
    return {};
  }

  Status Write(const Simulation& simulation) {
    hashes_->Append(simulation.tick());
    hashes_->Append(" ");
    hashes_->AppendHex(simulation.state_hash());
    if (Status failure = hashes_->EndLine(); !failure.ok() || !scans_) return failure;
    const TickView view = simulation.View();
    if (sensors_.empty()) {
      for (std::size_t i = 0; i < view.scene.world().robots.size(); ++i) {
        for (auto& sensor : MakeSensors(view.scene, RobotId(i))) sensors_.push_back(std::move(sensor));
      }
    }
    for (const auto& sensor : sensors_) {
      if (!sensor->IsDueAt(simulation.tick())) continue;
      std::string lines = sensor->JsonLines(simulation.world(),
                                            sensor->Measure({view.scene, view.bodies, &view.state}, simulation.tick()));
      if (lines.empty()) continue;
      lines.pop_back();  // the last line end
      scans_->Append(lines);
      if (Status failure = scans_->EndLine(); !failure.ok()) return failure;
    }
    return {};
  }

  Status Close() {
    for (std::optional<OutputFile>* log : {&hashes_, &scans_}) {
      if (!*log) continue;
      if (Status failure = (*log)->Close(); !failure.ok()) return failure;
    }
    return {};
  }

 private:
  std::optional<OutputFile> hashes_;
  std::optional<OutputFile> scans_;  // nothing: none are written
  std::vector<std::unique_ptr<const Sensor>> sensors_;
};

Status Run(const std::vector<std::string>& arguments) {
  Result<Simulation> loaded = Simulation::Load(arguments[0]);
  if (!loaded.ok()) return loaded.error();
  Simulation& simulation = loaded.value();
  Logs logs;
  if (Status failure = logs.Open(arguments[2], arguments.size() > 3 ? arguments[3] : ""); !failure.ok()) return failure;
  const auto ticks = static_cast<Tick>(std::atoll(arguments[1].c_str()));
  if (Status failure = logs.Write(simulation); !failure.ok()) return failure;
  while (simulation.tick() < ticks) {
    simulation.Step();
    if (Status failure = logs.Write(simulation); !failure.ok()) return failure;
  }
  for (const std::string& failure : simulation.failures()) fmt::print(stderr, "{}\n", failure);
  return logs.Close();
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() < 3) {
    fmt::print(stderr, "error: found {} arguments, expected FILE TICKS HASH_LOG [SCANS]\n", arguments.size());
    return 2;
  }
  const troupe::Status outcome = troupe::Run(arguments);
  if (outcome.ok()) return 0;
  fmt::print(stderr, "error: {}\n", outcome.error().ToString());
  return 2;
}
