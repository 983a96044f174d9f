#include "world-service/replay/scan_writer.h"

#include <utility>

#include "common/sensing/sensor_registry.h"

namespace troupe {

Result<ScanWriter> ScanWriter::Create(const std::string& path) {
  Result<OutputFile> file = OutputFile::Create(path);
  if (!file.ok()) return file.error();
  return ScanWriter(std::move(file).value());
}

Status ScanWriter::Write(const ReplayedWorld& world) {
  const WorldDescription& description = world.world();
  if (world.scene() != scene_) {
    scene_ = world.scene();
    sensors_.clear();
    for (std::size_t i = 0; i < description.robots.size(); ++i) {
      if (!IsThere(description, RobotId(i))) continue;
      for (auto& sensor : MakeSensors(*scene_, RobotId(i))) sensors_.push_back(std::move(sensor));
    }
  }
  const Tick tick = world.state().tick;
  for (const auto& sensor : sensors_) {
    if (!sensor->IsDueAt(tick)) continue;
    if (fresh_edition_ != world.fresh_edition()) {
      fresh_edition_ = world.fresh_edition();
      file_.Append("{\"edition\":" + std::to_string(fresh_edition_) + "}");
      if (Status failure = file_.EndLine(); !failure.ok()) return failure;
    }
    std::string lines =
        sensor->JsonLines(description, sensor->Measure({*scene_, world.bodies(), &world.state()}, tick));
    if (lines.empty()) continue;
    lines.pop_back();  // the last line end
    file_.Append(lines);
    if (Status failure = file_.EndLine(); !failure.ok()) return failure;
  }
  return {};
}

}  // namespace troupe
