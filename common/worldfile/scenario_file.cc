#include "common/worldfile/scenario_file.h"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

using nlohmann::json;

// Properties that an entry may not set, and why.
using Refused = std::map<std::string, std::string>;

// Reads the parts of one scenario. The first error stops it: every Read function returns false after one.
class Reader {
 public:
  Reader(const JsonDocument& document, const std::string& directory, std::uint32_t max_spawned)
      : document_(document), directory_(directory), max_spawned_(max_spawned) {}

  bool Read(ScenarioFile* file);
  const Error& error() const { return *error_; }

 private:
  bool Fail(const json& value, std::string message) {
    error_ = document_.ErrorAt(value, std::move(message));
    return false;
  }
  PlacedText Text(const json& value) const { return {value.get<std::string>(), document_.Where(value)}; }

  bool ReadSettings(const json& root, ScenarioFile* file);
  void ReadController(const json& object, std::optional<ControllerEntry>* result) const;
  bool ReadProperties(const json& object, const Refused& refused, std::vector<Property>* result);
  bool ReadModel(const json& object, ModelEntry* model);
  bool ReadModels(const json& object, const char* key, std::vector<ModelEntry>* models);
  bool ReadRegion(const json& region, Polygon* result);
  bool ReadSpawn(const json& object, SpawnEntry* spawn);
  bool ReadOverride(const json& object, OverrideEntry* entry);
  bool ReadHost(const json& entry, HostSettings* host);
  bool ReadHosts(const json& root, HostsOfScenario* result);

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

void Reader::ReadController(const json& object, std::optional<ControllerEntry>* result) const {
  const auto found = object.find("controller");
  if (found == object.end()) return;
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
  *result = std::move(entry);
}

bool Reader::ReadProperties(const json& object, const Refused& refused, std::vector<Property>* result) {
  const auto found = object.find("properties");
  if (found == object.end()) return true;
  for (const auto& [key, value] : found->items()) {
    if (refused.contains(key)) {
      return Fail(value, "found the property '" + key + "', which " + refused.at(key));
    }
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
    result->push_back(std::move(property));
  }
  return true;
}

bool Reader::ReadModel(const json& object, ModelEntry* model) {
  model->where = document_.Where(object);
  if (object.contains("name")) model->name = Text(object["name"]);
  if (object.contains("model")) model->model = Text(object["model"]);
  if (object.contains("pose")) {
    const json& numbers = object["pose"];
    const bool has_z = numbers.size() == 4;
    PoseEntry entry;
    entry.has_z = has_z;
    entry.where = document_.Where(numbers);
    entry.pose.x = numbers[0].get<double>();
    entry.pose.y = numbers[1].get<double>();
    if (has_z) entry.pose.z = numbers[2].get<double>();
    entry.pose.heading = WrapAngle(DegreesToRadians(numbers.back().get<double>()));
    model->pose = entry;
  }
  ReadController(object, &model->controller);
  const Refused refused{{"name", "is expected as a key of the model itself"},
                        {"pose", "is expected as a key of the model itself"}};
  return ReadProperties(object, refused, &model->properties) && ReadModels(object, "children", &model->children);
}

bool Reader::ReadModels(const json& object, const char* key, std::vector<ModelEntry>* models) {
  const auto found = object.find(key);
  if (found == object.end()) return true;
  for (const json& entry : *found) {
    if (!ReadModel(entry, &models->emplace_back())) return false;
  }
  return true;
}

bool Reader::ReadRegion(const json& region, Polygon* result) {
  const bool rectangle = region[0].is_number();
  for (const json& item : region) {
    if (item.is_number() != rectangle) {
      return Fail(item, "found " + Describe(item) + ", expected " + (rectangle ? "a number" : "a corner [x, y]") +
                            " as before it");
    }
  }
  if (rectangle) {
    if (region.size() != 4) {
      return Fail(region, "found " + std::to_string(region.size()) + " numbers, expected [xmin, ymin, xmax, ymax]");
    }
    const double x0 = region[0].get<double>(), y0 = region[1].get<double>();
    const double x1 = region[2].get<double>(), y1 = region[3].get<double>();
    if (!(x0 < x1)) return Fail(region[2], "found an xmax that is not above xmin, expected one that is");
    if (!(y0 < y1)) return Fail(region[3], "found a ymax that is not above ymin, expected one that is");
    *result = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
    return true;
  }
  for (const json& corner : region) result->emplace_back(corner[0].get<double>(), corner[1].get<double>());
  if (const std::string fault = Normalize(*result); !fault.empty()) {
    return Fail(region, "found a region that is no simple polygon: " + fault);
  }
  return true;
}

bool Reader::ReadSpawn(const json& object, SpawnEntry* spawn) {
  spawn->where = document_.Where(object);
  spawn->model = Text(object["model"]);
  spawn->count = object["count"].get<std::uint32_t>();
  if (!ReadRegion(object["region"], &spawn->region)) return false;
  if (object.contains("spacing")) spawn->spacing = object["spacing"].get<double>();
  if (object.contains("seed")) spawn->seed = object["seed"].get<std::uint64_t>();
  if (object.contains("name_prefix")) spawn->name_prefix = Text(object["name_prefix"]);
  if (const auto heading = object.find("heading"); heading != object.end()) {
    if (heading->is_number()) {
      spawn->heading = WrapAngle(DegreesToRadians(heading->get<double>()));
    } else if (*heading != "random") {
      return Fail(*heading, "found " + Describe(*heading) + ", expected a heading in degrees, or 'random'");
    }
  }
  ReadController(object, &spawn->controller);
  return true;
}

bool Reader::ReadOverride(const json& object, OverrideEntry* entry) {
  const json& match = object["match"];
  entry->where = document_.Where(match);
  if (match.contains("name")) entry->name = match["name"].get<std::string>();
  if (match.contains("type")) entry->type = match["type"].get<std::string>();
  return ReadProperties(object, {{"name", "no rule can change"}}, &entry->properties);
}

bool Reader::ReadSettings(const json& root, ScenarioFile* file) {
  RunSettings& settings = file->settings;
  if (root.contains("name")) file->name = root["name"].get<std::string>();
  if (root.contains("seed")) file->seed = root["seed"].get<std::uint64_t>();
  if (root.contains("ticks")) settings.ticks = root["ticks"].get<std::uint64_t>();
  if (root.contains("mode")) settings.mode = root["mode"] == "realtime" ? Mode::kRealtime : Mode::kLockstep;
  if (const auto speed = root.find("speed"); speed != root.end()) {
    if (speed->is_number()) {
      settings.speed = speed->get<double>();
    } else if (*speed != "max") {
      return Fail(*speed, "found " + Describe(*speed) + ", expected a multiple of real time above 0, or 'max'");
    }
  }
  if (const auto loss = root.find("on_agent_loss"); loss != root.end()) {
    settings.on_agent_loss = *loss == "pause"   ? OnAgentLoss::kPause
                             : *loss == "abort" ? OnAgentLoss::kAbort
                                                : OnAgentLoss::kFreeze;
  }
  if (root.contains("robots_per_process")) {
    settings.robots_per_process = root["robots_per_process"].get<std::uint32_t>();
  }
  if (root.contains("agent_deadline")) settings.agent_deadline_seconds = root["agent_deadline"].get<double>();
  if (root.contains("ros")) settings.ros = root["ros"].get<bool>();
  return ReadHosts(root, &file->hosts);
}

bool Reader::ReadHost(const json& entry, HostSettings* host) {
  host->where = document_.Where(entry);
  if (entry.is_string()) {
    host->name = host->address = entry.get<std::string>();
    return true;
  }
  const auto text = [&](const char* key) { return entry.value(key, std::string()); };
  host->address = text("address");
  host->name = entry.value("name", host->address);
  host->start = text("start");
  host->programs = text("programs");
  host->network_interface = text("interface");
  host->service = entry.value("service", false);
  if (!host->start.empty() && host->start.find("{command") == std::string::npos) {
    return Fail(entry["start"], "found no '{command}' in this text, expected one, or '{command_text}'");
  }
  const auto robots = entry.find("robots");
  if (robots == entry.end()) return true;
  if (robots->is_array()) {
    for (const json& name : *robots) host->robot_names.push_back(name.get<std::string>());
  }
  if (!robots->is_array() || robots->empty()) host->robot_count = robots->is_array() ? 0 : robots->get<std::uint32_t>();
  return true;
}

bool Reader::ReadHosts(const json& root, HostsOfScenario* result) {
  result->network = root.value("network", std::string());
  const auto hosts = root.find("hosts");
  if (hosts == root.end()) return true;
  for (const json& entry : *hosts) {
    HostSettings host;
    if (!ReadHost(entry, &host)) return false;
    for (const HostSettings& other : result->hosts) {
      if (other.name == host.name) return Fail(entry, "found a second host '" + host.name + "', expected another name");
      if (other.service && host.service) {
        return Fail(entry["service"], "found a second host with the world service, expected it on one host");
      }
    }
    result->hosts.push_back(std::move(host));
  }
  return true;
}

bool Reader::Read(ScenarioFile* file) {
  const json& root = document_.root();
  if (root.contains("world")) file->world = Text(root["world"]);
  if (const auto includes = root.find("include"); includes != root.end()) {
    for (const json& include : *includes) file->includes.push_back(Text(include));
  }
  if (!ReadSettings(root, file)) return false;
  ReadController(root, &file->controller);
  if (!ReadProperties(root, {}, &file->properties)) return false;
  if (!ReadModels(root, "models", &file->models)) return false;
  if (!ReadModels(root, "robots", &file->robots)) return false;
  if (const auto spawns = root.find("spawn"); spawns != root.end()) {
    std::uint32_t total = 0;
    for (const json& spawn : *spawns) {
      if (!ReadSpawn(spawn, &file->spawns.emplace_back())) return false;
      total += file->spawns.back().count;
      if (total > max_spawned_) {
        return Fail(spawn["count"], "found " + std::to_string(total) + " models to spawn in all, expected at most " +
                                        std::to_string(max_spawned_));
      }
    }
  }
  if (const auto overrides = root.find("override"); overrides != root.end()) {
    for (const json& entry : *overrides) {
      if (!ReadOverride(entry, &file->overrides.emplace_back())) return false;
    }
  }
  return true;
}

}  // namespace

Result<ScenarioFile> ReadScenarioFile(const JsonDocument& document, const std::string& directory,
                                      std::uint32_t max_spawned) {
  ScenarioFile file;
  Reader reader(document, directory, max_spawned);
  if (!reader.Read(&file)) return reader.error();
  return file;
}

}  // namespace troupe
