#include "robot-agent/agent/scan_log.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

// The shortest decimal that reads back as the same number.
void AppendNumber(std::string& line, double value) {
  char digits[32];
  line.append(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
}

std::string Quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Cuts off what follows the last line end. False if the file cannot be cut.
bool CutToWholeLines(std::FILE* file) {
  off_t end = 0;
  off_t position = 0;
  for (int c = std::getc(file); c != EOF; c = std::getc(file)) {
    ++position;
    if (c == '\n') end = position;
  }
  return ftruncate(fileno(file), end) == 0 && fseeko(file, end, SEEK_SET) == 0;
}

}  // namespace

Result<std::unique_ptr<ScanLog>> ScanLog::Open(const std::string& path, bool keep) {
  std::FILE* file = keep ? std::fopen(path.c_str(), "r+e") : nullptr;
  if (file != nullptr && !CutToWholeLines(file)) {
    std::fclose(file);
    file = nullptr;
  } else if (file == nullptr && (!keep || errno == ENOENT)) {
    file = std::fopen(path.c_str(), "we");
  }
  if (file == nullptr) return Error{{path}, std::string("cannot write scans here: ") + std::strerror(errno)};
  return std::unique_ptr<ScanLog>(new ScanLog(file, path));
}

ScanLog::~ScanLog() {
  std::fclose(file_);
}

void ScanLog::Write(Tick tick, const RobotDescription& robot, const RangerDescription& ranger,
                    const RangerReading& reading) {
  if (status_) return;
  for (std::size_t sensor = 0; sensor < reading.scans.size(); ++sensor) {
    line_ = "{\"tick\":" + std::to_string(tick) + ",\"robot\":" + Quoted(robot.name) +
            ",\"sensor\":" + Quoted(ranger.name + "." + std::to_string(sensor)) + ",\"ranges\":[";
    for (double range : reading.scans[sensor].ranges) {
      AppendNumber(line_, range);
      line_ += ',';
    }
    if (line_.back() == ',') line_.pop_back();
    line_ += "]}\n";
    if (std::fwrite(line_.data(), 1, line_.size(), file_) != line_.size()) return Fail();
  }
}

void ScanLog::Restart(std::uint32_t edition) {
  if (status_) return;
  line_ = "{\"edition\":" + std::to_string(edition) + "}\n";
  if (std::fwrite(line_.data(), 1, line_.size(), file_) != line_.size()) Fail();
}

Status ScanLog::Flush() {
  if (!status_ && std::fflush(file_) != 0) Fail();
  return status_;
}

void ScanLog::Fail() {
  status_ = Error{{path_}, std::string("cannot write scans: ") + std::strerror(errno)};
}

}  // namespace troupe
