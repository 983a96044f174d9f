#include "robot-agent/controller/lane_settings.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "robot-agent/controller/built_in.h"

namespace troupe {
namespace {

using nlohmann::json;

constexpr double kFar = 1e6;  // m
constexpr std::size_t kMostOfEach = 100'000;

// Reads one entry of a list of the graph; the first fault is the error of all.
class EntryReader {
 public:
  EntryReader(std::string place, const json& object) : reader_(std::move(place), object) {}

  std::string Text(const char* key) { return reader_.ReadText(key).value_or(""); }
  double Number(const char* key, double least, double otherwise) {
    return reader_.ReadNumber(key, {least, kFar}).value_or(otherwise);
  }
  bool Flag(const char* key) { return reader_.ReadBool(key).value_or(false); }

  std::size_t Vertex(const char* key, std::size_t count) {
    const std::optional<double> number = reader_.ReadNumber(key, {0.0, static_cast<double>(count) - 1.0});
    if (!number) reader_.Fail(fmt::format("'{}' is missing, expected the number of a vertex", key));
    return number ? static_cast<std::size_t>(*number) : 0;
  }

  // `[x, y]` or `[x, y, z]`.
  void ReadPoint(LaneVertex& vertex) {
    const std::vector<json> point = reader_.ReadArray("at");
    bool is_good = point.size() == 2 || point.size() == 3;
    for (const json& value : point) {
      is_good = is_good && value.is_number() && std::abs(value.get<double>()) <= kFar;
    }
    if (!is_good) return reader_.Fail("'at' is no point, expected [x, y] or [x, y, z]");
    vertex.position = {point[0].get<double>(), point[1].get<double>()};
    if (point.size() == 3) vertex.z = point[2].get<double>();
  }

  LaneFacing Facing() {
    const std::string text = Text("facing");
    if (text == "forward") return LaneFacing::kForward;
    if (text == "backward") return LaneFacing::kBackward;
    if (!text.empty()) reader_.Fail(fmt::format("'facing' is \"{}\", expected \"forward\" or \"backward\"", text));
    return LaneFacing::kAny;
  }

  std::vector<std::string> Texts(const char* key) {
    std::vector<std::string> texts;
    for (const json& value : reader_.ReadArray(key)) {
      if (value.is_string()) {
        texts.push_back(value.get<std::string>());
      } else {
        reader_.Fail(fmt::format("'{}' has an item that is no text, expected names", key));
      }
    }
    return texts;
  }

  std::vector<LaneDoor> Doors() {
    std::vector<LaneDoor> doors;
    for (const json& value : reader_.ReadArray("doors")) {
      EntryReader door("door " + std::to_string(doors.size()), value);
      LaneDoor read{door.Text("name"), door.Number("at", 0.0, 0.0), door.Number("clearance", 0.0, 1.0)};
      if (Status status = door.Finish(); !status.ok()) {
        reader_.Fail(status.error().message);
        return {};
      }
      doors.push_back(std::move(read));
    }
    return doors;
  }

  Status Finish() { return reader_.Finish(); }

 private:
  NestedParameters reader_;
};

LaneVertex ReadLaneVertex(EntryReader& entry) {
  LaneVertex vertex;
  vertex.name = entry.Text("name");
  entry.ReadPoint(vertex);
  vertex.is_charger = entry.Flag("charger");
  vertex.dock = entry.Text("dock");
  vertex.mutex = entry.Text("mutex");
  vertex.lift = entry.Text("lift");
  vertex.floor = entry.Text("floor");
  vertex.lift_doors = entry.Texts("lift_doors");
  return vertex;
}

Lane ReadLaneEntry(EntryReader& entry, std::size_t vertices) {
  Lane lane;
  lane.start = entry.Vertex("from", vertices);
  lane.end = entry.Vertex("to", vertices);
  lane.is_bidirectional = entry.Flag("both_ways");
  lane.speed_limit = entry.Number("speed", 0.0, 0.0);
  lane.facing = entry.Facing();
  lane.mutex = entry.Text("mutex");
  lane.doors = entry.Doors();
  return lane;
}

// `graph`: an object, or the number of a graph of the site, which the loader of the world replaces.
void ReadGraph(NestedParameters& reader, LaneSettings& settings) {
  const std::optional<json> value = reader.ReadAny("graph");
  if (!value || value->is_number_unsigned()) return;
  const auto read = std::make_shared<LaneGraph>();
  NestedParameters graph("graph", *value);
  for (const json& item : graph.ReadArray("vertices")) {
    EntryReader entry(fmt::format("vertex {}", read->vertices.size()), item);
    read->vertices.push_back(ReadLaneVertex(entry));
    if (Status status = entry.Finish(); !status.ok()) graph.Fail(status.error().message);
  }
  const std::size_t count = read->vertices.size();
  if (count == 0) graph.Fail("found no vertices, expected some");
  for (const json& item : graph.ReadArray("lanes")) {
    if (count == 0) break;  // has failed
    EntryReader entry(fmt::format("lane {}", read->lanes.size()), item);
    read->lanes.push_back(ReadLaneEntry(entry, count));
    if (Status status = entry.Finish(); !status.ok()) graph.Fail(status.error().message);
  }
  if (count > kMostOfEach || read->lanes.size() > kMostOfEach) graph.Fail("found more than 100000 of a kind");
  if (Status status = graph.Finish(); !status.ok()) return reader.Fail(status.error().message);
  settings.graph = read;
}

void ReadPlaces(NestedParameters& reader, LaneSettings& settings) {
  for (const json& place : reader.ReadArray("places")) {
    if (!place.is_string()) return reader.Fail("'places' has an item that is no text, expected names of places");
    settings.places.push_back(place.get<std::string>());
    if (settings.graph == nullptr || settings.graph->Find(settings.places.back())) continue;
    std::vector<std::string> names;
    for (const LaneVertex& vertex : settings.graph->vertices) {
      if (!vertex.name.empty()) names.push_back(vertex.name);
    }
    return reader.Fail(fmt::format("the lanes have no place '{}', expected one of: {}{}", settings.places.back(),
                                   fmt::join(names, ", "), DidYouMean(settings.places.back(), names)));
  }
}

}  // namespace

Result<LaneSettings> ParseLaneSettings(const std::string& text) {
  LaneSettings settings;
  NestedParameters reader("lanes", text);
  ReadGraph(reader, settings);
  ReadPlaces(reader, settings);
  settings.repeat = reader.ReadBool("repeat").value_or(settings.repeat);
  const auto read = [&](const char* key, double& value, double least, double most) {
    value = reader.ReadNumber(key, {least, most}).value_or(value);
  };
  read("wait", settings.wait, 0.0, 1e6);
  read("speed", settings.speed, 0.01, 100.0);
  read("dock_speed", settings.dock_speed, 0.01, 100.0);
  read("turn_rate", settings.turn_rate, 0.01, 100.0);
  read("tolerance", settings.tolerance, 0.02, 1.0);
  read("charge_below", settings.charge_below, 0.0, 1.0);
  read("charge_to", settings.charge_to, 0.0, 1.0);
  if (settings.charge_to < settings.charge_below) reader.Fail("'charge_to' is below 'charge_below'");
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return settings;
}

}  // namespace troupe
