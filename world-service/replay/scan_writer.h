// ScanWriter: the file of --scans of a replay, with the lines that the agents of the run wrote.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/output_file.h"
#include "common/sensing/sensor.h"
#include "troupe/result.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class ScanWriter {
 public:
  static Result<ScanWriter> Create(const std::string& path);

  // Measures all sensors of all robots that are due, in the order of robots and sensors.
  Status Write(const ReplayedWorld& world);
  // The robots that were made anew at this edition have no line: as at the start of the run.
  void Begin(Edition fresh_edition) { fresh_edition_ = fresh_edition; }
  Status Close() { return file_.Close(); }

 private:
  explicit ScanWriter(OutputFile file) : file_(std::move(file)) {}

  OutputFile file_;
  std::shared_ptr<const Scene> scene_;  // of the sensors
  std::vector<std::unique_ptr<const Sensor>> sensors_;
  Edition fresh_edition_ = 0;  // of the newest line
};

}  // namespace troupe
