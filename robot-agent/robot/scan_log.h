// ScanLog: a file of JSON lines, one or more for each reading of each sensor (Sensor::JsonLines), in the order of
// ticks, robots and sensors. A ranger writes {"tick","robot","sensor","ranges"} for each ray sensor.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "troupe/result.h"

namespace troupe {

class ScanLog {
 public:
  ~ScanLog();
  ScanLog(const ScanLog&) = delete;
  ScanLog& operator=(const ScanLog&) = delete;

  // With `keep` new lines follow those in the file; a last line without its end, as a killed agent leaves, is removed.
  static Result<std::unique_ptr<ScanLog>> Open(const std::string& path, bool keep = false);

  // Appends lines, each with its line end.
  void Write(const std::string& lines);

  // Marks a restart of the robots, perhaps at an earlier tick: writes {"edition":N}.
  void Restart(std::uint32_t edition);

  // While it is muted, nothing is written.
  void Mute(bool muted) { muted_ = muted; }

  // The first error of a write (a full disk); nothing is written after it.
  const Status& status() const { return status_; }
  // Writes all buffered lines to the file.
  Status Flush();

 private:
  explicit ScanLog(std::FILE* file, std::string path) : file_(file), path_(std::move(path)) {}
  void Fail();

  std::FILE* file_;
  std::string path_;
  Status status_;
  bool muted_ = false;
};

}  // namespace troupe
