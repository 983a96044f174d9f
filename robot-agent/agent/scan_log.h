// ScanLog: a file of JSON lines {"tick","robot","sensor","ranges"}, one for each reading of each ray sensor, in the
// order of ticks, robots and sensors.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

class ScanLog {
 public:
  ~ScanLog();
  ScanLog(const ScanLog&) = delete;
  ScanLog& operator=(const ScanLog&) = delete;

  // With `keep` it adds to what the file holds, but for a last line without its end, as a killed agent leaves.
  static Result<std::unique_ptr<ScanLog>> Open(const std::string& path, bool keep = false);

  // Sensors are named "<ranger>.<index>", for instance "ranger:0.3".
  void Write(Tick tick, const RobotDescription& robot, const RangerDescription& ranger, const RangerReading& reading);

  // The robots begin anew, perhaps at an earlier tick: writes {"edition":N}, so that what follows can be told apart.
  void Restart(std::uint32_t edition);

  // The first error that any write had (a full disk); nothing is written after it.
  const Status& status() const { return status_; }
  // Forces everything out, and says how it went.
  Status Flush();

 private:
  explicit ScanLog(std::FILE* file, std::string path) : file_(file), path_(std::move(path)) {}
  void Fail();

  std::FILE* file_;
  std::string path_;
  std::string line_;
  Status status_;
};

}  // namespace troupe
