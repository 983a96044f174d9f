#include "world-service/observers/recorder/recorder.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/identity.h"
#include "common/base/json.h"
#include "common/model/states.h"
#include "recording/recording.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

nlohmann::json RecordedEvent(const WorldDescription& world, const Event& event) {
  nlohmann::json json = EventJson(world, event);
  // The detail of a join names the process, which differs from run to run; recordings of one simulation are equal.
  if (!event.detail.empty() && event.type != EventType::kJoined) json["detail"] = event.detail;
  return json;
}

// Whether lines have a format of their own for the table's rows; those of the others are the table's signals.
// Sensors have it in the lines of --scans.
bool HasOwnFormat(const StateTable& table) {
  return table.name == "robots" || table.name == "joints" || table.name == "grippers" || table.name == "objects" ||
         table.name == "sensors";
}

constexpr auto kFlushPeriod = std::chrono::milliseconds(500);

// Nothing for an empty path.
Result<std::optional<OutputFile>> CreateIfNamed(const std::string& path) {
  if (path.empty()) return std::optional<OutputFile>();
  Result<OutputFile> created = OutputFile::Create(path);
  if (!created.ok()) return created.error();
  return std::optional(std::move(created).value());
}

}  // namespace

std::string QuoteForCsv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Result<std::unique_ptr<Recorder>> Recorder::Create(const WorldDescription& world, const OutputFiles& files) {
  std::unique_ptr<Recorder> recorder(new Recorder(world));
  const std::pair<const std::string&, std::optional<OutputFile>&> wanted[] = {
      {files.hash_log, recorder->hash_log_}, {files.poses, recorder->poses_}, {files.record, recorder->record_}};
  for (const auto& [path, file] : wanted) {
    Result<std::optional<OutputFile>> created = CreateIfNamed(path);
    if (!created.ok()) return created.error();
    file = std::move(created).value();
  }
  recorder->QuoteNames();
  if (recorder->poses_) {
    if (Status error = recorder->WritePosesHeading(); !error.ok()) return error.error();
  }
  if (recorder->record_) {
    if (Status error = recorder->WriteRecordHeader({}); !error.ok()) return error.error();
  }
  return recorder;
}

void Recorder::QuoteNames() {
  csv_names_.clear();
  if (!poses_) return;
  for (const ModelDescription& model : world_->models) csv_names_.push_back(QuoteForCsv(model.name));
}

void Recorder::OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition edition) {
  scene_ = scene;
  world_ = &scene->world();
  QuoteNames();
  if (record_) (void)WriteRecordHeader(edition);  // the file keeps its error
}

Status Recorder::WritePosesHeading() {
  wide_poses_ = manipulates() || !world_->people.empty();
  poses_->Append("tick,robot,x,y,z,heading,stalled");
  if (wide_poses_) poses_->Append(",kind,position,mode,on");
  return poses_->EndLine();
}

Status Recorder::WriteRecordHeader(std::optional<Edition> edition) {
  nlohmann::json robots = nlohmann::json::array();
  // A removed model keeps its place in each line.
  const auto name_of = [&](ModelId id) {
    const ModelDescription& model = world_->model(id);
    return model.removed ? nlohmann::json() : nlohmann::json(model.name);
  };
  for (const RobotDescription& robot : world_->robots) robots.push_back(name_of(robot.root));
  nlohmann::json header = {{"troupe", VersionText()},
                           {"world", world_->name},
                           {"seed", world_->seed},
                           {"interval_ns", world_->interval_ns},
                           {"robots", std::move(robots)}};
  if (edition) header["edition"] = *edition;
  if (manipulates()) {
    for (const char* part : {"joints", "grippers", "objects"}) header[part] = nlohmann::json::array();
    for (const JointDescription& joint : world_->joints) header["joints"].push_back(name_of(joint.model));
    for (const GripperDescription& gripper : world_->grippers) {
      header["grippers"].push_back(name_of(gripper.model));
    }
    for (ModelId object : world_->objects) header["objects"].push_back(name_of(object));
  }
  things_.emplace(*world_);
  for (const StateTable& table : StateTables()) {
    const std::size_t kind = KindOf(table.name);
    if (HasOwnFormat(table) || things_->count(kind) == 0) continue;
    nlohmann::json columns = nlohmann::json::array();
    for (const Signal& signal : table.signals) columns.push_back(signal.name);
    nlohmann::json names = nlohmann::json::array();
    for (ThingId thing = things_->first(kind); thing < things_->first(kind) + things_->count(kind); ++thing) {
      names.push_back(things_->exists(thing) ? nlohmann::json(things_->name(thing)) : nlohmann::json());
    }
    header["tables"][table.name] = {{"columns", std::move(columns)}, {"names", std::move(names)}};
  }
  record_->Append(JsonText(header));
  return record_->EndLine();
}

Status Recorder::Write(const FrameMessage& frame) {
  if (hash_log_) {
    if (Status error = WriteHash(frame); !error.ok()) return error;
  }
  if (poses_) {
    if (Status error = WritePoses(frame); !error.ok()) return error;
  }
  if (record_) {
    if (Status error = WriteRecord(frame); !error.ok()) return error;
  }
  return FlushSometimes();
}

Status Recorder::FlushSometimes() {
  const auto now = std::chrono::steady_clock::now();
  if (now < flushed_at_ + kFlushPeriod) return Status();
  flushed_at_ = now;
  Status first;
  for (std::optional<OutputFile>* file : {&hash_log_, &poses_, &record_}) {
    if (!*file) continue;
    const Status error = (*file)->Flush();
    if (first.ok()) first = error;
  }
  return first;
}

Status Recorder::WriteHash(const FrameMessage& frame) {
  hash_log_->Append(frame.state.tick);
  hash_log_->Append(" ");
  hash_log_->AppendHex(frame.state_hash);
  return hash_log_->EndLine();
}

Status Recorder::WritePoses(const FrameMessage& frame) {
  Status error;
  for (std::size_t i = 0; i < frame.state.robots.size() && error.ok(); ++i) {
    if (!RobotExists(*world_, RobotId(i))) continue;
    const RobotState& robot = frame.state.robots[i];
    AppendPose(frame.state.tick, world_->robots[i].root, robot.X_WR, robot.stalled);
    if (wide_poses_) poses_->Append(",robot,,,");
    error = poses_->EndLine();
  }
  if (!wide_poses_) return error;
  if (error.ok()) error = WriteObjectPoses(frame.state);
  if (error.ok()) error = WritePeoplePoses(frame.state);
  if (error.ok()) error = WriteJointPoses(frame.state);
  if (error.ok()) error = WriteDevicePoses(frame.state);
  return error;
}

void Recorder::AppendPose(Tick tick, ModelId model, const Pose& X_WM, bool flag) {
  poses_->Append(tick);
  poses_->Append(",");
  poses_->Append(csv_names_[model.index()]);
  for (double number : {X_WM.x, X_WM.y, X_WM.z, X_WM.heading}) {
    poses_->Append(",");
    poses_->Append(number);
  }
  poses_->Append(flag ? ",1" : ",0");
}

Status Recorder::WriteObjectPoses(const WorldState& state) {
  Status error;
  for (std::size_t i = 0; i < state.objects.size() && error.ok(); ++i) {
    if (world_->model(world_->objects[i]).removed) continue;
    const ObjectState& object = state.objects[i];
    AppendPose(state.tick, world_->objects[i], object.X_WO, false);
    poses_->Append(",object,,");
    poses_->Append(NameOf(object.mode));
    poses_->Append(",");
    const std::optional<ModelId> on = CarrierOf(*world_, object);
    if (on) poses_->Append(csv_names_[on->index()]);
    error = poses_->EndLine();
  }
  return error;
}

Status Recorder::WritePeoplePoses(const WorldState& state) {
  Status error;
  for (std::size_t i = 0; i < state.people.size() && error.ok(); ++i) {
    const ModelId root = world_->person(PersonId(i)).root;
    if (world_->model(root).removed || IsAway(state.people[i])) continue;
    AppendPose(state.tick, root, state.people[i].X_WP, false);
    poses_->Append(",person,,,");
    error = poses_->EndLine();
  }
  return error;
}

Status Recorder::WriteJointPoses(const WorldState& state) {
  if (state.joints.empty()) return Status();
  const std::vector<Pose> X_WM = ModelPoses(*world_, state);
  Status error;
  for (std::size_t i = 0; i < state.joints.size() && error.ok(); ++i) {
    const ModelId model = world_->joints[i].model;
    if (world_->model(model).removed) continue;
    AppendPose(state.tick, model, X_WM[model.index()], state.joints[i].blocked);
    poses_->Append(",joint,");
    poses_->Append(state.joints[i].position);
    poses_->Append(",,");
    error = poses_->EndLine();
  }
  return error;
}

Status Recorder::WriteDevicePoses(const WorldState& state) {
  if (state.doors.empty() && state.lifts.empty()) return Status();
  const std::vector<Pose> X_WM = ModelPoses(*world_, state);
  Status error;
  for (std::size_t i = 0; i < state.doors.size() && error.ok(); ++i) {
    const ModelId model = world_->doors[i].model;
    AppendPose(state.tick, model, X_WM[model.index()], state.doors[i].blocked);
    poses_->Append(",door,");
    poses_->Append(state.doors[i].opening);
    poses_->Append(",,");
    error = poses_->EndLine();
  }
  for (std::size_t i = 0; i < state.lifts.size() && error.ok(); ++i) {
    const LiftDescription& lift = world_->lifts[i];
    AppendPose(state.tick, lift.model, state.objects[lift.cabin.index()].X_WO, state.lifts[i].blocked);
    poses_->Append(",lift,");
    poses_->Append(state.lifts[i].z);
    poses_->Append(",");
    poses_->Append(QuoteForCsv(lift.floors[state.lifts[i].floor].name));
    poses_->Append(",");
    error = poses_->EndLine();
  }
  return error;
}

Status Recorder::WriteRecord(const FrameMessage& frame) {
  line_.clear();
  JsonWriter json(line_);
  json.BeginObject().Member("tick", frame.state.tick).Member("hash", fmt::format("{:016x}", frame.state_hash));
  json.Key("robots").BeginList();
  for (const RobotState& robot : frame.state.robots) {
    json.BeginList();
    for (const double number : {robot.X_WR.x, robot.X_WR.y, robot.X_WR.z, robot.X_WR.heading}) json.Value(number);
    json.Value(robot.stalled ? 1 : 0).EndList();
  }
  json.EndList();
  if (manipulates()) {
    WriteJoints(frame.state, json);
    WriteGrippers(frame.state, json);
    WriteObjects(frame.state, json);
  }
  WriteTables(frame.state, json);
  if (!frame.events.empty()) {
    nlohmann::json events = nlohmann::json::array();
    for (const Event& event : frame.events) events.push_back(RecordedEvent(*world_, event));
    json.Key("events").Raw(JsonText(events));
  }
  json.EndObject();
  record_->Append(line_);
  return record_->EndLine();
}

void Recorder::WriteJoints(const WorldState& state, JsonWriter& json) {
  json.Key("joints").BeginList();
  for (const JointState& joint : state.joints) {
    json.BeginList().Value(joint.position).Value(joint.velocity).Value(joint.blocked ? 1 : 0).EndList();
  }
  json.EndList();
}

void Recorder::WriteName(const std::optional<ModelId>& model, JsonWriter& json) const {
  model ? json.Value(world_->model(*model).name) : json.Null();
}

void Recorder::WriteGrippers(const WorldState& state, JsonWriter& json) const {
  json.Key("grippers").BeginList();
  for (const GripperState& gripper : state.grippers) {
    std::optional<ModelId> clamped;
    if (gripper.clamped) clamped = world_->objects[gripper.clamped->index()];
    json.BeginList();
    for (const std::optional<ModelId>& model : {gripper.left_contact, gripper.right_contact, clamped}) {
      WriteName(model, json);
    }
    json.EndList();
  }
  json.EndList();
}

void Recorder::WriteObjects(const WorldState& state, JsonWriter& json) const {
  json.Key("objects").BeginList();
  for (const ObjectState& object : state.objects) {
    json.BeginList();
    for (const double number : {object.X_WO.x, object.X_WO.y, object.X_WO.z, object.X_WO.heading}) json.Value(number);
    const std::optional<ModelId> on = CarrierOf(*world_, object);
    json.Value(NameOf(object.mode));
    WriteName(on, json);
    json.EndList();
  }
  json.EndList();
}

void Recorder::WriteTables(const WorldState& state, JsonWriter& json) const {
  const SignalView view{*things_, *world_, state};
  for (const StateTable& table : StateTables()) {
    const std::size_t rows = table.rows(*world_, state);
    if (HasOwnFormat(table) || table.varies || rows == 0) continue;
    json.Key(table.name).BeginList();
    for (std::size_t row = 0; row < rows; ++row) {
      json.BeginList();
      for (const Signal& signal : table.signals) WriteCell(signal, view, row, json);
      json.EndList();
    }
    json.EndList();
  }
}

Status Recorder::OnEnd() {
  Status first;
  for (std::optional<OutputFile>* file : {&hash_log_, &poses_, &record_}) {
    if (!*file) continue;
    const Status error = (*file)->Close();
    if (first.ok()) first = error;
  }
  return first;
}

bool WritesTexts(const OutputFiles& files) {
  const bool records_text = !files.record.empty() && !IsRecordingPath(files.record);
  return !files.hash_log.empty() || !files.poses.empty() || records_text;
}

Result<std::unique_ptr<Recorder>> MakeTextRecorder(const WorldDescription& world, const OutputFiles& files) {
  OutputFiles texts = files;
  if (IsRecordingPath(files.record)) texts.record.clear();
  if (!WritesTexts(files)) return std::unique_ptr<Recorder>();
  return Recorder::Create(world, texts);
}

RecordingOptions RecordingOptionsOf(const OutputFiles& files, const std::string& world_file) {
  RecordingOptions options;
  options.world_file = world_file;
  options.keyframe_interval = files.keyframe_interval;
  options.begin = files.begin;
  options.expectations = files.expectations;
  options.regions = files.regions;
  options.journal = files.journal;
  options.sync = files.journal_sync;
  options.journal_is_optional = files.journal_is_optional;
  return options;
}

Result<Recorders> MakeRecorders(const WorldDescription& world, const OutputFiles& files, const std::string& world_file,
                                bool needs_memory) {
  Recorders recorders;
  RecordingOptions options = RecordingOptionsOf(files, world_file);
  const auto add = [&recorders](const std::string& path, const RecordingOptions& with) -> Status {
    Result<std::unique_ptr<RunRecorder>> recorder = RunRecorder::Create(path, with);
    if (!recorder.ok()) return recorder.error();
    recorders.recordings.push_back(recorder.value().get());
    recorders.observers.push_back(std::move(recorder).value());
    return {};
  };
  if (files.journal) {
    if (Status failure = add(files.journal->recording, options); !failure.ok()) return failure.error();
  }
  options.journal.reset();
  if (IsRecordingPath(files.record)) {
    if (Status failure = add(files.record, options); !failure.ok()) return failure.error();
  }
  if (needs_memory && recorders.recordings.empty()) {
    Result<TemporaryFile> file = TemporaryFile::Create();
    if (!file.ok()) return file.error();
    recorders.temporary = std::move(file).value();
    if (Status failure = add(recorders.temporary->path(), options); !failure.ok()) return failure.error();
  }
  Result<std::unique_ptr<Recorder>> texts = MakeTextRecorder(world, files);
  if (!texts.ok()) return texts.error();
  if (texts.value() != nullptr) recorders.observers.push_back(std::move(texts).value());
  return recorders;
}

}  // namespace troupe
