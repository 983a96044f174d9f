#include "worldfile/scenario/scenario_file.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

using nlohmann::json;

// Properties that an entry may not set, and why.
using Refused = std::map<std::string, std::string>;

// Reads the parts of one scenario. The first error is kept; after it values are of no use.
class Reader {
 public:
  Reader(const JsonDocument& document, const std::string& directory, std::uint32_t max_spawned)
      : document_(document), directory_(directory), max_spawned_(max_spawned) {}

  Result<ScenarioFile> Read();

 private:
  void Fail(const json& value, std::string message) {
    if (!error_) error_ = document_.ErrorAt(value, std::move(message));
  }
  PlacedText Text(const json& value) const { return {value.get<std::string>(), document_.Where(value)}; }

  RunSettings ReadSettings(const json& root);
  std::optional<ControllerEntry> ReadController(const json& object) const;
  std::vector<Property> ReadProperties(const json& object, const Refused& refused);
  std::optional<RosDomainEntry> ReadRosDomain(const json& object) const;
  std::vector<NamedPlace> ReadPlaces(const json& root);
  PoseEntry ReadPose(const json& numbers) const;
  ModelEntry ReadModel(const json& object);
  std::vector<ModelEntry> ReadModels(const json& object, const char* key);
  Polygon ReadRegion(const json& region);
  Polygon ReadRectangle(const json& numbers);
  SpawnEntry ReadSpawn(const json& object);
  std::vector<SpawnEntry> ReadSpawns(const json& root);
  OverrideEntry ReadOverride(const json& object);
  HostSettings ReadHost(const json& entry);
  HostsOfScenario ReadHosts(const json& root);

  std::string FromScenarioFolder(const std::string& path) const {
    const std::filesystem::path relative(path);
    return relative.is_absolute() ? path : (std::filesystem::path(directory_) / relative).lexically_normal().string();
  }

  const JsonDocument& document_;
  const std::string& directory_;
  std::uint32_t max_spawned_;
  std::optional<Error> error_;
};

Value::Number NumberOf(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? Value::Number{1.0, "1"} : Value::Number{0.0, "0"};
  return {value.get<double>(), value.dump()};
}

std::optional<ControllerEntry> Reader::ReadController(const json& object) const {
  const auto found = object.find("controller");
  if (found == object.end()) return std::nullopt;
  ControllerEntry entry;
  entry.where = document_.Where(*found);
  if (found->is_string()) {
    entry.controller.name = found->get<std::string>();
  } else {
    entry.controller.name = found->at("name").get<std::string>();
    if (const auto parameters = found->find("parameters"); parameters != found->end()) {
      entry.controller.parameters = parameters->dump();
    }
  }
  const std::string& name = entry.controller.name;
  if (name.find('/') != std::string::npos || name.ends_with(".so")) entry.controller.name = FromScenarioFolder(name);
  return entry;
}

std::vector<Property> Reader::ReadProperties(const json& object, const Refused& refused) {
  std::vector<Property> properties;
  const auto found = object.find("properties");
  if (found == object.end()) return properties;
  for (const auto& [key, value] : found->items()) {
    if (refused.contains(key)) Fail(value, "found the property '" + key + "', which " + refused.at(key));
    Property property{key, Value{std::string(), document_.Where(value)}, document_.WhereKey(value)};
    if (value.is_array()) {
      std::vector<Value::Scalar> tuple;
      for (const json& item : value) {
        if (item.is_string()) {
          tuple.emplace_back(item.get<std::string>());
        } else {
          tuple.emplace_back(NumberOf(item));
        }
      }
      property.value.content = std::move(tuple);
    } else if (value.is_string()) {
      const std::string text = value.get<std::string>();
      property.value.content = key == "bitmap" ? FromScenarioFolder(text) : text;
    } else {
      property.value.content = NumberOf(value);
    }
    properties.push_back(std::move(property));
  }
  return properties;
}

std::optional<RosDomainEntry> Reader::ReadRosDomain(const json& object) const {
  const auto found = object.find("ros_domain");
  if (found == object.end()) return std::nullopt;
  const bool each = found->is_object();
  return RosDomainEntry{(each ? found->at("each") : *found).get<std::uint32_t>(), each, document_.Where(*found)};
}

std::vector<NamedPlace> Reader::ReadPlaces(const json& root) {
  std::vector<NamedPlace> places;
  const auto found = root.find("places");
  if (found == root.end()) return places;
  for (const json& entry : *found) {
    NamedPlace place;
    place.name = entry["name"].get<std::string>();
    place.description = entry.value("description", std::string());
    place.tags = entry.value("tags", std::vector<std::string>());
    place.X_WN = ReadPose(entry["pose"]).pose;
    const auto same = [&](const NamedPlace& other) { return other.name == place.name; };
    if (std::any_of(places.begin(), places.end(), same)) {
      Fail(entry["name"], "found the place '" + place.name + "' again, expected another name");
    }
    places.push_back(std::move(place));
  }
  return places;
}

PoseEntry Reader::ReadPose(const json& numbers) const {
  PoseEntry entry;
  entry.has_z = numbers.size() == 4;
  entry.where = document_.Where(numbers);
  entry.pose.x = numbers[0].get<double>();
  entry.pose.y = numbers[1].get<double>();
  if (entry.has_z) entry.pose.z = numbers[2].get<double>();
  entry.pose.heading = WrapAngle(DegreesToRadians(numbers.back().get<double>()));
  return entry;
}

ModelEntry Reader::ReadModel(const json& object) {
  ModelEntry model;
  model.where = document_.Where(object);
  if (object.contains("name")) model.name = Text(object["name"]);
  if (object.contains("model")) model.model = Text(object["model"]);
  if (object.contains("pose")) model.pose = ReadPose(object["pose"]);
  model.controller = ReadController(object);
  model.ros_domain = ReadRosDomain(object);
  const Refused refused{{"name", "is expected as a key of the model itself"},
                        {"pose", "is expected as a key of the model itself"}};
  model.properties = ReadProperties(object, refused);
  model.children = ReadModels(object, "children");
  return model;
}

std::vector<ModelEntry> Reader::ReadModels(const json& object, const char* key) {
  std::vector<ModelEntry> models;
  const auto found = object.find(key);
  if (found == object.end()) return models;
  for (const json& entry : *found) models.push_back(ReadModel(entry));
  return models;
}

Polygon Reader::ReadRectangle(const json& numbers) {
  if (numbers.size() != 4) {
    Fail(numbers, "found " + std::to_string(numbers.size()) + " numbers, expected [xmin, ymin, xmax, ymax]");
    return {};
  }
  const double x0 = numbers[0].get<double>(), y0 = numbers[1].get<double>();
  const double x1 = numbers[2].get<double>(), y1 = numbers[3].get<double>();
  if (!(x0 < x1)) Fail(numbers[2], "found an xmax that is not above xmin, expected one that is");
  if (!(y0 < y1)) Fail(numbers[3], "found a ymax that is not above ymin, expected one that is");
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Polygon Reader::ReadRegion(const json& region) {
  const bool rectangle = region[0].is_number();
  for (const json& item : region) {
    if (item.is_number() == rectangle) continue;
    Fail(item,
         "found " + Describe(item) + ", expected " + (rectangle ? "a number" : "a corner [x, y]") + " as before it");
    return {};
  }
  if (rectangle) return ReadRectangle(region);
  Polygon corners;
  for (const json& corner : region) corners.emplace_back(corner[0].get<double>(), corner[1].get<double>());
  Result<Polygon> outline = Normalized(std::move(corners));
  if (outline.ok()) return std::move(outline).value();
  Fail(region, "found a region that is no simple polygon: " + outline.error().message);
  return {};
}

SpawnEntry Reader::ReadSpawn(const json& object) {
  SpawnEntry spawn;
  spawn.where = document_.Where(object);
  spawn.model = Text(object["model"]);
  spawn.count = object["count"].get<std::uint32_t>();
  spawn.region = ReadRegion(object["region"]);
  if (object.contains("spacing")) spawn.spacing = object["spacing"].get<double>();
  if (object.contains("seed")) spawn.seed = object["seed"].get<std::uint64_t>();
  if (object.contains("name_prefix")) spawn.name_prefix = Text(object["name_prefix"]);
  if (const auto heading = object.find("heading"); heading != object.end()) {
    if (heading->is_number()) {
      spawn.heading = WrapAngle(DegreesToRadians(heading->get<double>()));
    } else if (*heading != "random") {
      Fail(*heading, "found " + Describe(*heading) + ", expected a heading in degrees, or 'random'");
    }
  }
  spawn.controller = ReadController(object);
  spawn.ros_domain = ReadRosDomain(object);
  return spawn;
}

std::vector<SpawnEntry> Reader::ReadSpawns(const json& root) {
  std::vector<SpawnEntry> spawns;
  const auto found = root.find("spawn");
  if (found == root.end()) return spawns;
  std::uint32_t total = 0;
  for (const json& spawn : *found) {
    spawns.push_back(ReadSpawn(spawn));
    total += spawns.back().count;
    if (total <= max_spawned_) continue;
    Fail(spawn["count"], "found " + std::to_string(total) + " models to spawn in all, expected at most " +
                             std::to_string(max_spawned_));
    break;
  }
  return spawns;
}

OverrideEntry Reader::ReadOverride(const json& object) {
  OverrideEntry entry;
  const json& match = object["match"];
  entry.where = document_.Where(match);
  if (match.contains("name")) entry.name = match["name"].get<std::string>();
  if (match.contains("type")) entry.type = match["type"].get<std::string>();
  entry.properties = ReadProperties(object, {{"name", "no rule can change"}});
  return entry;
}

RunSettings Reader::ReadSettings(const json& root) {
  RunSettings settings;
  if (root.contains("ticks")) settings.ticks = root["ticks"].get<std::uint64_t>();
  if (root.contains("mode")) settings.mode = ParseMode(root["mode"].get<std::string>()).value_or(settings.mode);
  if (const auto speed = root.find("speed"); speed != root.end()) {
    if (speed->is_number()) {
      settings.speed = speed->get<double>();
    } else if (*speed != "max") {
      Fail(*speed, "found " + Describe(*speed) + ", expected a multiple of real time above 0, or 'max'");
    }
  }
  if (const auto loss = root.find("on_agent_loss"); loss != root.end()) {
    settings.on_agent_loss = ParseOnAgentLoss(loss->get<std::string>()).value_or(settings.on_agent_loss);
  }
  if (root.contains("robots_per_process")) {
    settings.robots_per_process = root["robots_per_process"].get<std::uint32_t>();
  }
  if (root.contains("restart_agents")) settings.restart_agents = root["restart_agents"].get<std::uint32_t>();
  if (root.contains("agent_deadline")) settings.agent_deadline_seconds = root["agent_deadline"].get<double>();
  if (root.contains("ros")) settings.ros = root["ros"].get<bool>();
  if (root.contains("ros_no_hit")) settings.ros_infinite_ranges = root["ros_no_hit"] == "inf";
  return settings;
}

HostSettings Reader::ReadHost(const json& entry) {
  HostSettings host;
  host.where = document_.Where(entry);
  if (entry.is_string()) {
    host.name = host.address = entry.get<std::string>();
    return host;
  }
  const auto text = [&](const char* key) { return entry.value(key, std::string()); };
  host.address = text("address");
  host.name = entry.value("name", host.address);
  host.start = text("start");
  host.programs = text("programs");
  host.network_interface = text("interface");
  host.service = entry.value("service", false);
  if (!host.start.empty() && host.start.find("{command") == std::string::npos) {
    Fail(entry["start"], "found no '{command}' in this text, expected one, or '{command_text}'");
  }
  const auto robots = entry.find("robots");
  if (robots == entry.end()) return host;
  if (robots->is_array()) {
    for (const json& name : *robots) host.robot_names.push_back(name.get<std::string>());
  }
  if (!robots->is_array() || robots->empty()) host.robot_count = robots->is_array() ? 0 : robots->get<std::uint32_t>();
  return host;
}

HostsOfScenario Reader::ReadHosts(const json& root) {
  HostsOfScenario result;
  result.network = root.value("network", std::string());
  const auto hosts = root.find("hosts");
  if (hosts == root.end()) return result;
  for (const json& entry : *hosts) {
    HostSettings host = ReadHost(entry);
    for (const HostSettings& other : result.hosts) {
      if (other.name == host.name) Fail(entry, "found a second host '" + host.name + "', expected another name");
      if (other.service && host.service) {
        Fail(entry["service"], "found a second host with the world service, expected it on one host");
      }
    }
    result.hosts.push_back(std::move(host));
  }
  return result;
}

Result<ScenarioFile> Reader::Read() {
  const json& root = document_.root();
  ScenarioFile file;
  if (root.contains("world")) file.world = Text(root["world"]);
  if (const auto includes = root.find("include"); includes != root.end()) {
    for (const json& include : *includes) file.includes.push_back(Text(include));
  }
  if (root.contains("name")) file.name = root["name"].get<std::string>();
  if (root.contains("seed")) file.seed = root["seed"].get<std::uint64_t>();
  file.settings = ReadSettings(root);
  file.hosts = ReadHosts(root);
  file.controller = ReadController(root);
  file.properties = ReadProperties(root, {});
  file.models = ReadModels(root, "models");
  file.robots = ReadModels(root, "robots");
  file.spawns = ReadSpawns(root);
  if (const auto overrides = root.find("override"); overrides != root.end()) {
    for (const json& entry : *overrides) file.overrides.push_back(ReadOverride(entry));
  }
  file.places = ReadPlaces(root);
  if (error_) return *error_;
  return file;
}

}  // namespace

Result<ScenarioFile> ReadScenarioFile(const JsonDocument& document, const std::string& directory,
                                      std::uint32_t max_spawned) {
  return Reader(document, directory, max_spawned).Read();
}

}  // namespace troupe
