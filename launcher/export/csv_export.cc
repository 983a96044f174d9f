// Tables for pandas and spreadsheets: a file for each kind of row.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/output_file.h"
#include "launcher/export/run_export.h"
#include "world-service/observers/recorder/recorder.h"

namespace troupe {
namespace {

// A table of rows; the first row has the names of the columns.
class Table {
 public:
  static Result<Table> Create(const std::string& path, std::string_view columns) {
    Result<OutputFile> file = OutputFile::Create(path);
    if (!file.ok()) return file.error();
    Table table(std::move(file).value());
    table.file_.Append(columns);
    if (Status status = table.file_.EndLine(); !status.ok()) return status.error();
    return table;
  }

  // A row: texts (quoted where they need it), numbers, and nothing for an empty cell.
  template <typename... Cells>
  Status Add(const Cells&... cells) {
    bool is_first = true;
    const auto add = [&](const auto& cell) {
      if (!std::exchange(is_first, false)) file_.Append(",");
      Append(cell);
    };
    (add(cells), ...);
    return file_.EndLine();
  }
  Status Close() { return file_.Close(); }

 private:
  explicit Table(OutputFile file) : file_(std::move(file)) {}

  void Append(const std::string& text) { file_.Append(QuoteForCsv(text)); }
  void Append(const char* text) { file_.Append(text); }
  void Append(double number) { file_.Append(number); }
  void Append(std::uint64_t number) { file_.Append(number); }
  void Append(bool is_true) { file_.Append(is_true ? "1" : "0"); }
  template <typename Value>
  void Append(const std::optional<Value>& value) {
    if (value) Append(*value);
  }

  OutputFile file_;
};

class CsvExport final : public RunExport {
 public:
  // The tables of a folder, or the poses alone.
  static Result<std::unique_ptr<RunExport>> Create(const std::string& path) {
    std::unique_ptr<CsvExport> csv(new CsvExport);
    const bool is_file = path.ends_with(".csv");
    const auto make = [&](std::optional<Table>& table, const std::string& file, std::string_view columns) -> Status {
      Result<Table> created = Table::Create(is_file ? path : path + "/" + file, columns);
      if (!created.ok()) return created.error();
      table = std::move(created).value();
      return {};
    };
    if (!is_file) {
      std::error_code failure;
      std::filesystem::create_directories(path, failure);
      if (failure) return Error{{path}, "cannot make the folder: " + failure.message(), ErrorCode::kFailure};
    }
    Status made = make(csv->poses_, "poses.csv", "time,tick,robot,x,y,z,heading,vx,vy,wz,stalled,joules");
    if (!is_file) {
      if (made.ok()) made = make(csv->objects_, "objects.csv", "time,tick,object,x,y,z,heading,mode,on");
      if (made.ok()) made = make(csv->joints_, "joints.csv", "time,tick,joint,position,velocity,blocked");
      if (made.ok()) made = make(csv->events_, "events.csv", "time,tick,event,robot,object,other,detail");
      if (made.ok()) {
        made =
            make(csv->readings_, "readings.csv", "time,tick,robot,sensor,scan,ray,bearing,elevation,range,intensity");
      }
    }
    if (!made.ok()) return made.error();
    return std::unique_ptr<RunExport>(std::move(csv));
  }

  Status Add(const ReplayedWorld& world, std::uint64_t nanoseconds) override {
    const double time = static_cast<double>(nanoseconds) / 1e9;
    Status status = AddPoses(world, time);
    if (status.ok() && objects_) status = AddObjects(world, time);
    if (status.ok() && joints_) status = AddJoints(world, time);
    if (status.ok() && events_) status = AddEvents(world, time);
    if (status.ok() && readings_) status = AddReadings(world, time);
    return status;
  }

  Status Close() override {
    Status first;
    for (std::optional<Table>* table : {&poses_, &objects_, &joints_, &events_, &readings_}) {
      if (!*table) continue;
      if (Status closed = (*table)->Close(); first.ok()) first = std::move(closed);
    }
    return first;
  }

 private:
  CsvExport() = default;

  Status AddPoses(const ReplayedWorld& world, double time) {
    const WorldState& state = world.state();
    for (std::size_t i = 0; i < state.robots.size(); ++i) {
      if (!RobotExists(world.world(), RobotId(i))) continue;
      const auto& [X_WR, twist, stalled] = state.robots[i];
      std::optional<double> joules;
      const RobotDescription& robot = world.world().robots[i];
      if (const auto store = world.scene()->store_of(robot.root)) joules = state.stores[*store].joules;
      Status status = poses_->Add(time, state.tick, robot.name, X_WR.x, X_WR.y, X_WR.z, X_WR.heading, twist.vx,
                                  twist.vy, twist.wz, stalled, joules);
      if (!status.ok()) return status;
    }
    return {};
  }

  Status AddObjects(const ReplayedWorld& world, double time) {
    const WorldDescription& description = world.world();
    const WorldState& state = world.state();
    for (std::size_t i = 0; i < state.objects.size(); ++i) {
      const ModelDescription& model = description.model(description.objects[i]);
      if (model.removed) continue;
      const ObjectState& object = state.objects[i];
      const std::optional<ModelId> carrier = CarrierOf(description, object);
      const Pose& X_WO = object.X_WO;
      Status status = objects_->Add(time, state.tick, model.name, X_WO.x, X_WO.y, X_WO.z, X_WO.heading,
                                    NameOf(object.mode), carrier ? description.model(*carrier).name : std::string());
      if (!status.ok()) return status;
    }
    return {};
  }

  Status AddJoints(const ReplayedWorld& world, double time) {
    const WorldDescription& description = world.world();
    for (std::size_t i = 0; i < world.state().joints.size(); ++i) {
      const JointState& joint = world.state().joints[i];
      const ModelDescription& model = description.model(description.joints[i].model);
      if (model.removed) continue;
      Status status = joints_->Add(time, world.state().tick, model.name, joint.position, joint.velocity, joint.blocked);
      if (!status.ok()) return status;
    }
    return {};
  }

  Status AddEvents(const ReplayedWorld& world, double time) {
    const WorldDescription& description = world.world();
    const auto name = [&](const std::optional<ModelId>& model) {
      return model ? description.model(*model).name : std::string();
    };
    for (const Event& event : world.events()) {
      const std::string robot = event.robot ? description.robot(*event.robot).name : std::string();
      Status status = events_->Add(time, event.tick, ToString(event.type), robot, name(event.object), name(event.other),
                                   event.detail);
      if (!status.ok()) return status;
    }
    return {};
  }

  // A row for each ray of each ranger that is due.
  Status AddReadings(const ReplayedWorld& world, double time) {
    measured_.SetState(world);
    const WorldDescription& description = world.world();
    for (std::size_t i = 0; i < description.robots.size(); ++i) {
      const RobotId robot(i);
      if (!RobotExists(description, robot)) continue;
      const std::vector<SensorDescription>& sensors = description.robots[i].sensors;
      for (std::size_t s = 0; s < sensors.size(); ++s) {
        if (!std::holds_alternative<RangerParameters>(sensors[s].parameters) || !measured_.IsDue(robot, s)) continue;
        const RangerReading* const reading = measured_.Measure(robot, s).ranger();
        if (reading == nullptr) continue;
        for (std::size_t k = 0; k < reading->geometry->size(); ++k) {
          const RangeScan scan = reading->scan(k);
          for (std::size_t ray = 0; ray < scan.ranges.size(); ++ray) {
            Status status =
                readings_->Add(time, world.state().tick, description.robots[i].name, sensors[s].name, std::uint64_t{k},
                               std::uint64_t{ray}, scan.fan.Bearing(ray % scan.fan.count),
                               scan.elevation(ray / scan.fan.count), scan.ranges[ray], scan.intensities[ray]);
            if (!status.ok()) return status;
          }
        }
      }
    }
    return {};
  }

  std::optional<Table> poses_;
  std::optional<Table> objects_;
  std::optional<Table> joints_;
  std::optional<Table> events_;
  std::optional<Table> readings_;
  RunReadings measured_;
};

}  // namespace

Result<std::unique_ptr<RunExport>> MakeCsvExport(const std::string& path) {
  return CsvExport::Create(path);
}

}  // namespace troupe
