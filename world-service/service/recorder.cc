#include "world-service/service/recorder.h"

#include <nlohmann/json.hpp>

#include "common/base/version.h"

namespace troupe {
namespace {

std::string QuoteForCsv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

// As JSON; what is not UTF-8 is replaced.
std::string Dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json EventJson(const WorldDescription& world, const Event& event) {
  nlohmann::json json = {{"event", ToString(event.type)}};
  if (event.robot) json["robot"] = world.robot(*event.robot).name;
  if (event.other) json["other"] = world.model(*event.other).name;
  // Which process took a robot up differs from run to run; recordings of one simulation are equal.
  if (!event.detail.empty() && event.type != EventType::kJoined) json["detail"] = event.detail;
  return json;
}

Status CreateInto(const std::string& path, std::optional<OutputFile>& file) {
  if (path.empty()) return std::nullopt;
  Result<OutputFile> created = OutputFile::Create(path);
  if (!created.ok()) return created.error();
  file = std::move(created).value();
  return std::nullopt;
}

}  // namespace

Result<Recorder> Recorder::Create(const WorldDescription& world, const OutputFiles& files) {
  Recorder recorder(world);
  if (Status error = CreateInto(files.hash_log, recorder.hash_log_)) return *error;
  if (Status error = CreateInto(files.poses, recorder.poses_)) return *error;
  if (Status error = CreateInto(files.record, recorder.record_)) return *error;
  if (recorder.poses_) {
    for (const RobotDescription& robot : world.robots) recorder.csv_names_.push_back(QuoteForCsv(robot.name));
    recorder.poses_->Append("tick,robot,x,y,z,heading,stalled");
    if (Status error = recorder.poses_->EndLine()) return *error;
  }
  if (recorder.record_) {
    if (Status error = recorder.WriteRecordHeader()) return *error;
  }
  return recorder;
}

Status Recorder::WriteRecordHeader() {
  nlohmann::json robots = nlohmann::json::array();
  for (const RobotDescription& robot : world_->robots) robots.push_back(robot.name);
  record_->Append(Dump({{"troupe", VersionText()},
                        {"world", world_->name},
                        {"seed", world_->seed},
                        {"interval_ns", world_->interval_ns},
                        {"robots", std::move(robots)}}));
  return record_->EndLine();
}

Status Recorder::Write(const FrameMessage& frame) {
  if (hash_log_) {
    if (Status error = WriteHash(frame)) return error;
  }
  if (poses_) {
    if (Status error = WritePoses(frame)) return error;
  }
  if (record_) return WriteRecord(frame);
  return std::nullopt;
}

Status Recorder::WriteHash(const FrameMessage& frame) {
  hash_log_->Append(frame.state.tick);
  hash_log_->Append(" ");
  hash_log_->AppendHex(frame.state_hash);
  return hash_log_->EndLine();
}

Status Recorder::WritePoses(const FrameMessage& frame) {
  Status error;
  for (std::size_t i = 0; i < frame.state.robots.size() && !error; ++i) {
    const RobotState& robot = frame.state.robots[i];
    poses_->Append(frame.state.tick);
    poses_->Append(",");
    poses_->Append(csv_names_[i]);
    for (double number : {robot.X_WR.x, robot.X_WR.y, robot.X_WR.z, robot.X_WR.heading}) {
      poses_->Append(",");
      poses_->Append(number);
    }
    poses_->Append(robot.stalled ? ",1" : ",0");
    error = poses_->EndLine();
  }
  return error;
}

Status Recorder::WriteRecord(const FrameMessage& frame) {
  record_->Append(R"({"tick":)");
  record_->Append(frame.state.tick);
  record_->Append(R"(,"hash":")");
  record_->AppendHex(frame.state_hash);
  record_->Append(R"(","robots":[)");
  const char* separator = "[";
  for (const RobotState& robot : frame.state.robots) {
    for (double number : {robot.X_WR.x, robot.X_WR.y, robot.X_WR.z, robot.X_WR.heading}) {
      record_->Append(separator);
      record_->Append(number);
      separator = ",";
    }
    record_->Append(robot.stalled ? ",1]" : ",0]");
    separator = ",[";
  }
  record_->Append("]");
  if (!frame.events.empty()) {
    nlohmann::json events = nlohmann::json::array();
    for (const Event& event : frame.events) events.push_back(EventJson(*world_, event));
    record_->Append(R"(,"events":)");
    record_->Append(Dump(events));
  }
  record_->Append("}");
  return record_->EndLine();
}

Status Recorder::Close() {
  Status first;
  for (std::optional<OutputFile>* file : {&hash_log_, &poses_, &record_}) {
    if (!*file) continue;
    const Status error = (*file)->Close();
    if (!first) first = error;
  }
  return first;
}

}  // namespace troupe
