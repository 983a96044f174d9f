// Tables for pandas and spreadsheets: a file for each kind of row.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/output_file.h"
#include "common/signals/state_tables.h"
#include "launcher/export/run_export.h"
#include "world-service/observers/recorder/recorder.h"

namespace troupe {
namespace {

// A table of rows; the first row has the names of the columns.
class Table {
 public:
  // The header is written at once, so that a run without rows leaves a table with columns.
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
    Begin(cells...);
    return End();
  }
  // The same by its parts: Begin, AppendCell for each further cell, End.
  template <typename... Cells>
  void Begin(const Cells&... cells) {
    bool is_first = true;
    const auto add = [&](const auto& cell) {
      if (!std::exchange(is_first, false)) file_.Append(",");
      Append(cell);
    };
    (add(cells), ...);
  }
  // The value of a signal; nothing if it has none.
  void AppendCell(const Signal& signal, const SignalView& view, std::size_t row) {
    file_.Append(",");
    if (signal.type == ValueType::kText) return Append(signal.text(view, row));
    const double number = signal.number(view, row);
    if (signal.type == ValueType::kTruth) return Append(number != 0.0);
    if (!std::isnan(number)) Append(number);
  }
  Status End() { return file_.EndLine(); }
  Status Close() { return file_.Close(); }

 private:
  explicit Table(OutputFile file) : file_(std::move(file)) {}

  void Append(const std::string& text) { file_.Append(QuoteForCsv(text)); }
  void Append(const char* text) { file_.Append(text); }
  void Append(double number) { file_.Append(number); }
  void Append(std::uint64_t number) { file_.Append(number); }
  // Numbers of 0 and 1: pandas reads a column of them without a converter.
  void Append(bool is_true) { file_.Append(is_true ? "1" : "0"); }

  OutputFile file_;
};

// The file of a table of the state: that of robots has the name that users know from `troupe run --poses`.
std::string FileOf(const StateTable& table) {
  return (table.name == "robots" ? "poses" : table.name) + ".csv";
}
constexpr const char* kEventsFile = "events.csv";
constexpr const char* kReadingsFile = "readings.csv";

class CsvExport final : public RunExport {
 public:
  // The tables of a folder, or that of robots alone.
  // The columns come from the tables of the state (common/signals): a new signal is a new column without a change here.
  static Result<std::unique_ptr<RunExport>> Create(const std::string& path) {
    std::unique_ptr<CsvExport> csv(new CsvExport);
    const bool is_file = path.ends_with(".csv");
    const auto make = [&](const std::string& file, const std::string& columns) -> Result<Table> {
      return Table::Create(is_file ? path : path + "/" + file, "time,tick," + columns);
    };
    if (!is_file) {
      std::error_code failure;
      std::filesystem::create_directories(path, failure);
      if (failure) return Error{{path}, "cannot make the folder: " + failure.message(), ErrorCode::kFailure};
    }
    for (const StateTable& table : StateTables()) {
      if (is_file && table.name != "robots") continue;
      std::string columns = table.singular;
      for (const Signal& signal : table.signals) columns += "," + signal.name;
      Result<Table> made = make(FileOf(table), columns);
      if (!made.ok()) return made.error();
      csv->tables_.push_back({table, std::move(made).value()});
    }
    if (is_file) return std::unique_ptr<RunExport>(std::move(csv));
    for (auto [table, file, columns] :
         {std::tuple(&csv->events_, kEventsFile, "event,robot,object,other,detail"),
          std::tuple(&csv->readings_, kReadingsFile, "robot,sensor,scan,ray,bearing,elevation,range,intensity")}) {
      Result<Table> made = make(file, columns);
      if (!made.ok()) return made.error();
      *table = std::move(made).value();
    }
    return std::unique_ptr<RunExport>(std::move(csv));
  }

  Status Add(const ReplayedWorld& world, std::uint64_t nanoseconds) override {
    const double time = static_cast<double>(nanoseconds) / 1e9;
    if (scene_ != world.scene()) {
      scene_ = world.scene();
      things_.emplace(world.world());
    }
    for (RowTable& table : tables_) {
      if (Status status = AddRows(world, time, table); !status.ok()) return status;
    }
    Status status;
    if (events_) status = AddEvents(world, time);
    if (status.ok() && readings_) status = AddReadings(world, time);
    return status;
  }

  Status Close() override {
    Status first;
    const auto close = [&](Table& table) {
      if (Status closed = table.Close(); first.ok()) first = std::move(closed);
    };
    for (RowTable& table : tables_) close(table.file);
    if (events_) close(*events_);
    if (readings_) close(*readings_);
    return first;
  }

 private:
  // The rows of a table of the state.
  struct RowTable {
    const StateTable& table;
    Table file;
  };

  CsvExport() = default;

  // A row for each thing that exists; a table that varies has rows of its own number and no names.
  Status AddRows(const ReplayedWorld& world, double time, RowTable& rows) {
    const SignalView view{*things_, world.world(), world.state()};
    const StateTable& table = rows.table;
    const std::size_t kind = KindOf(table.name);
    for (std::size_t row = 0; row < table.rows(view.world, view.state); ++row) {
      std::string name;
      if (!table.varies) {
        const ThingId thing = things_->first(kind) + static_cast<ThingId>(row);
        if (!things_->exists(thing)) continue;
        name = things_->name(thing);
      }
      rows.file.Begin(time, view.state.tick, name);
      for (const Signal& signal : table.signals) rows.file.AppendCell(signal, view, row);
      if (Status status = rows.file.End(); !status.ok()) return status;
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
      Status status = events_->Add(time, event.tick, NameOf(event.type), robot, name(event.object), name(event.other),
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

  std::vector<RowTable> tables_;
  std::optional<Table> events_;
  std::optional<Table> readings_;
  std::shared_ptr<const Scene> scene_;  // of things_
  std::optional<Things> things_;
  RunReadings measured_;
};

}  // namespace

std::vector<std::string> FilesOfCsvExport(const std::string& path) {
  if (path.ends_with(".csv")) return {path};
  std::vector<std::string> files = {path + "/" + kEventsFile, path + "/" + kReadingsFile};
  for (const StateTable& table : StateTables()) files.push_back(path + "/" + FileOf(table));
  return files;
}

Result<std::unique_ptr<RunExport>> MakeCsvExport(const std::string& path) {
  return CsvExport::Create(path);
}

}  // namespace troupe
