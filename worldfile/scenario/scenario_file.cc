#include "worldfile/scenario/scenario_file.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

// Properties that an entry may not set, and why.
using Refused = std::map<std::string, std::string>;

// Reads the parts of one scenario. The first error is kept; after it values are of no use.
class Reader {
 public:
  Reader(const JsonTree& tree, const std::string& directory, std::uint32_t max_spawned)
      : tree_(tree), directory_(directory), max_spawned_(max_spawned) {}

  Result<ScenarioFile> Read();

 private:
  // Only what the schema cannot say is checked here: types, required keys and ranges of numbers were checked before.
  void Fail(const JsonNode& value, std::string message) {
    if (!error_) error_ = tree_.ErrorAt(value, std::move(message));
  }
  PlacedText Text(const JsonNode& value) const { return {value.text, tree_.Where(value)}; }
  std::vector<PlacedText> Texts(const JsonNode& object, std::string_view key) const;
  // Nothing without such a member.
  std::optional<PlacedText> FindText(const JsonNode& object, std::string_view key) const {
    const JsonNode* const found = object.Find(key);
    return found != nullptr ? std::optional(Text(*found)) : std::nullopt;
  }

  RunSettings ReadSettings(const JsonNode& root);
  std::optional<ControllerEntry> ReadController(const JsonNode& object) const;
  std::vector<Property> ReadProperties(const JsonNode& object, const Refused& refused);
  std::optional<RosDomainEntry> ReadRosDomain(const JsonNode& object) const;
  std::vector<std::string> ReadLockstepNames(const JsonNode& object);
  RosLockstep ReadLockstep(const JsonNode& root);
  std::vector<NamedPlace> ReadPlaces(const JsonNode& root);
  std::vector<NamedRegion> ReadRegions(const JsonNode& root);
  PoseEntry ReadPose(const JsonNode& numbers) const;
  ModelEntry ReadModel(const JsonNode& object);
  std::vector<ModelEntry> ReadModels(const JsonNode& object, const char* key);
  Polygon ReadRegion(const JsonNode& region);
  SpawnEntry ReadSpawn(const JsonNode& object);
  std::vector<SpawnEntry> ReadSpawns(const JsonNode& root);
  OverrideEntry ReadOverride(const JsonNode& object);
  HostSettings ReadHost(const JsonNode& entry);
  HostsOfScenario ReadHosts(const JsonNode& root);

  std::string FromScenarioFolder(const std::string& path) const {
    const std::filesystem::path relative(path);
    return relative.is_absolute() ? path : (std::filesystem::path(directory_) / relative).lexically_normal().string();
  }

  const JsonTree& tree_;
  const std::string& directory_;
  std::uint32_t max_spawned_;
  std::optional<Error> error_;
};

Value::Number NumberOf(const JsonNode& value) {
  if (value.is_boolean()) return value.is_true() ? Value::Number{1.0, "1"} : Value::Number{0.0, "0"};
  // The text is written back by edits and shown in messages of the Stage language.
  const bool has_exponent = value.text.find_first_of("eE") != std::string::npos;  // Stage's numbers have none
  return {value.number, has_exponent ? ToJson(value).dump() : value.text};
}

std::vector<PlacedText> Reader::Texts(const JsonNode& object, std::string_view key) const {
  std::vector<PlacedText> texts;
  for (const JsonNode& item : object.ItemsOf(key)) texts.push_back(Text(item));
  return texts;
}

std::vector<std::string> StringsOf(const std::vector<JsonNode>& items) {
  std::vector<std::string> strings;
  for (const JsonNode& item : items) strings.push_back(item.text);
  return strings;
}

std::optional<ControllerEntry> Reader::ReadController(const JsonNode& object) const {
  const JsonNode* const found = object.Find("controller");
  if (found == nullptr) return std::nullopt;
  ControllerEntry entry;
  entry.where = tree_.Where(*found);
  if (found->is_string()) {
    entry.controller.name = found->text;
  } else {
    entry.controller.name = found->Member("name").text;
    if (const JsonNode* const parameters = found->Find("parameters")) {
      entry.controller.parameters = ToJson(*parameters).dump();
    }
  }
  const std::string& name = entry.controller.name;
  if (NamesLibrary(name)) entry.controller.name = FromScenarioFolder(name);
  return entry;
}

// JSON to the values of a Stage file, so that one set of readers serves both.
std::vector<Property> Reader::ReadProperties(const JsonNode& object, const Refused& refused) {
  std::vector<Property> properties;
  for (const JsonNode& value : object.ItemsOf("properties")) {
    const std::string& key = value.key;
    if (refused.contains(key)) Fail(value, "found the property '" + key + "', which " + refused.at(key));
    Property property{key, Value{std::string(), tree_.Where(value)}, tree_.WhereKey(value)};
    if (value.is_array()) {
      std::vector<Value::Scalar> tuple;
      for (const JsonNode& item : value.items) {
        if (item.is_string()) {
          tuple.emplace_back(item.text);
        } else {
          tuple.emplace_back(NumberOf(item));
        }
      }
      property.value.content = std::move(tuple);
    } else if (value.is_string()) {
      // Absolute: a relative path of a bitmap is searched for in the world's folder.
      std::error_code ignored;
      property.value.content =
          key == "bitmap" ? std::filesystem::absolute(FromScenarioFolder(value.text), ignored).string() : value.text;
    } else {
      property.value.content = NumberOf(value);
    }
    properties.push_back(std::move(property));
  }
  return properties;
}

std::optional<RosDomainEntry> Reader::ReadRosDomain(const JsonNode& object) const {
  const JsonNode* const found = object.Find("ros_domain");
  if (found == nullptr) return std::nullopt;
  const bool each = found->is_object();
  return RosDomainEntry{(each ? found->Member("each") : *found).ToInteger<std::uint32_t>(), each, tree_.Where(*found)};
}

std::vector<NamedPlace> Reader::ReadPlaces(const JsonNode& root) {
  std::vector<NamedPlace> places;
  for (const JsonNode& entry : root.ItemsOf("places")) {
    NamedPlace place;
    place.name = entry.Member("name").text;
    entry.Read("description", place.description);
    place.tags = StringsOf(entry.ItemsOf("tags"));
    place.X_WN = ReadPose(entry.Member("pose")).pose;
    const auto same = [&](const NamedPlace& other) { return other.name == place.name; };
    if (std::any_of(places.begin(), places.end(), same)) {
      Fail(entry.Member("name"), "found the place '" + place.name + "' again, expected another name");
    }
    places.push_back(std::move(place));
  }
  return places;
}

std::vector<std::string> Reader::ReadLockstepNames(const JsonNode& object) {
  const JsonNode* const found = object.Find("ros_lockstep");
  const bool is_object = found != nullptr && found->is_object();
  std::vector<std::string> names;
  for (const JsonNode& item : is_object ? found->ItemsOf("names") : object.ItemsOf("ros_lockstep")) {
    if (const Status name = CheckRosLockstepName(item.text); !name.ok()) Fail(item, name.error().message);
    names.push_back(item.text);
  }
  return names;
}

RosLockstep Reader::ReadLockstep(const JsonNode& root) {
  RosLockstep lockstep;
  for (std::string& name : ReadLockstepNames(root)) lockstep.names.push_back({std::move(name)});
  const JsonNode* const found = root.Find("ros_lockstep");
  if (found == nullptr || !found->is_object()) return lockstep;
  found->Read("period", lockstep.period);
  found->Read("limit", lockstep.limit_seconds);
  if (const JsonNode* const at_limit = found->Find("at_limit")) lockstep.ends_at_limit = at_limit->text == "end";
  return lockstep;
}

std::vector<NamedRegion> Reader::ReadRegions(const JsonNode& root) {
  std::vector<NamedRegion> regions;
  for (const JsonNode& entry : root.ItemsOf("regions")) {
    NamedRegion region{entry.Member("name").text, ReadRegion(entry.Member("region"))};
    if (const JsonNode* const z = entry.Find("z")) region.z = z->number;
    const auto same = [&](const NamedRegion& other) { return other.name == region.name; };
    if (std::any_of(regions.begin(), regions.end(), same)) {
      Fail(entry.Member("name"), "found the region '" + region.name + "' again, expected another name");
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

// [x, y, heading] or [x, y, z, heading]: m and degrees in the file, radians from here on.
PoseEntry Reader::ReadPose(const JsonNode& numbers) const {
  PoseEntry entry;
  entry.has_z = numbers.items.size() == 4;
  entry.where = tree_.Where(numbers);
  entry.pose.x = numbers.items[0].number;
  entry.pose.y = numbers.items[1].number;
  if (entry.has_z) entry.pose.z = numbers.items[2].number;
  entry.pose.heading = WrapAngle(DegreesToRadians(numbers.items.back().number));
  return entry;
}

ModelEntry Reader::ReadModel(const JsonNode& object) {
  ModelEntry model;
  model.where = tree_.Where(object);
  model.name = FindText(object, "name");
  model.model = FindText(object, "model");
  if (const JsonNode* const found = object.Find("pose")) model.pose = ReadPose(*found);
  model.controller = ReadController(object);
  model.ros_domain = ReadRosDomain(object);
  model.ros_lockstep = ReadLockstepNames(object);
  const Refused refused{{"name", "is expected as a key of the model itself"},
                        {"pose", "is expected as a key of the model itself"}};
  model.properties = ReadProperties(object, refused);
  model.children = ReadModels(object, "children");
  return model;
}

std::vector<ModelEntry> Reader::ReadModels(const JsonNode& object, const char* key) {
  std::vector<ModelEntry> models;
  for (const JsonNode& entry : object.ItemsOf(key)) models.push_back(ReadModel(entry));
  return models;
}

Polygon Reader::ReadRegion(const JsonNode& region) {
  Result<Polygon> outline = troupe::ReadRegion(tree_, region);
  if (outline.ok()) return std::move(outline).value();
  if (!error_) error_ = outline.error();
  return {};
}

// No heading, or "random": drawn for each model.
SpawnEntry Reader::ReadSpawn(const JsonNode& object) {
  SpawnEntry spawn;
  spawn.where = tree_.Where(object);
  spawn.model = Text(object.Member("model"));
  spawn.count = object.Member("count").ToInteger<std::uint32_t>();
  spawn.region = ReadRegion(object.Member("region"));
  object.Read("z", spawn.z);
  object.Read("spacing", spawn.spacing);
  object.Read("seed", spawn.seed);
  spawn.name_prefix = FindText(object, "name_prefix");
  if (const JsonNode* const heading = object.Find("heading")) {
    if (heading->is_number()) {
      spawn.heading = WrapAngle(DegreesToRadians(heading->number));
    } else if (heading->text != "random") {
      Fail(*heading, "found " + Describe(*heading) + ", expected a heading in degrees, or 'random'");
    }
  }
  spawn.controller = ReadController(object);
  spawn.ros_domain = ReadRosDomain(object);
  spawn.ros_lockstep = ReadLockstepNames(object);
  return spawn;
}

// The limit is for all rules together, and is checked before any model is made.
std::vector<SpawnEntry> Reader::ReadSpawns(const JsonNode& root) {
  std::vector<SpawnEntry> spawns;
  std::uint32_t total = 0;
  for (const JsonNode& spawn : root.ItemsOf("spawn")) {
    spawns.push_back(ReadSpawn(spawn));
    total += spawns.back().count;
    if (total <= max_spawned_) continue;
    Fail(spawn.Member("count"), "found " + std::to_string(total) + " models to spawn in all, expected at most " +
                                    std::to_string(max_spawned_));
    break;
  }
  return spawns;
}

OverrideEntry Reader::ReadOverride(const JsonNode& object) {
  OverrideEntry entry;
  const JsonNode& match = object.Member("match");
  entry.where = tree_.Where(match);
  match.Read("name", entry.name);
  match.Read("type", entry.type);
  entry.properties = ReadProperties(object, {{"name", "no rule can change"}});
  return entry;
}

// A speed of the file counts with and without a viewer.
RunSettings Reader::ReadSettings(const JsonNode& root) {
  RunSettings settings;
  root.Read("ticks", settings.ticks);
  root.Read("mode", settings.mode);
  if (const JsonNode* const speed = root.Find("speed")) {
    if (speed->is_number()) {
      settings.speed = speed->number;
    } else if (speed->text != "max") {
      Fail(*speed, "found " + Describe(*speed) + ", expected a multiple of real time above 0, or 'max'");
    }
    settings.watched_speed = settings.speed;
  }
  root.Read("on_agent_loss", settings.on_agent_loss);
  root.Read("robots_per_process", settings.robots_per_process);
  root.Read("restart_agents", settings.restart_agents);
  root.Read("agent_deadline", settings.agent_deadline_seconds);
  root.Read("ros", settings.ros);
  if (const JsonNode* const found = root.Find("ros_no_hit")) settings.ros_infinite_ranges = found->text == "inf";
  return settings;
}

// A text is an address alone. `robots`: names with wildcards, or a number.
HostSettings Reader::ReadHost(const JsonNode& entry) {
  HostSettings host;
  host.where = tree_.Where(entry);
  if (entry.is_string()) {
    host.name = host.address = entry.text;
    return host;
  }
  entry.Read("address", host.address);
  if (!entry.Read("name", host.name)) host.name = host.address;
  entry.Read("start", host.start);
  entry.Read("programs", host.programs);
  entry.Read("interface", host.network_interface);
  entry.Read("service", host.service);
  if (!host.start.empty() && host.start.find("{command") == std::string::npos) {
    Fail(entry.Member("start"), "found no '{command}' in this text, expected one, or '{command_text}'");
  }
  const JsonNode* const robots = entry.Find("robots");
  if (robots == nullptr) return host;
  if (robots->is_array()) host.robot_names = StringsOf(robots->items);
  if (!robots->is_array() || robots->items.empty())
    host.robot_count = robots->is_array() ? 0 : robots->ToInteger<std::uint32_t>();
  return host;
}

// Names are unique, as messages and files of hosts have them.
HostsOfScenario Reader::ReadHosts(const JsonNode& root) {
  HostsOfScenario result;
  root.Read("network", result.network);
  for (const JsonNode& entry : root.ItemsOf("hosts")) {
    HostSettings host = ReadHost(entry);
    for (const HostSettings& other : result.hosts) {
      if (other.name == host.name) Fail(entry, "found a second host '" + host.name + "', expected another name");
      if (other.service && host.service) {
        Fail(entry.Member("service"), "found a second host with the world service, expected it on one host");
      }
    }
    result.hosts.push_back(std::move(host));
  }
  return result;
}

// In the order of the schema; names are resolved later, when the world is known.
Result<ScenarioFile> Reader::Read() {
  const JsonNode& root = tree_.root();
  ScenarioFile file;
  if (const JsonNode* const found = root.Find("scenario")) {
    // The schema is shared with files of `troupe test`: a clear message, not one about a missing world.
    Fail(*found, "found a test of another scenario, expected a scenario: 'troupe test' runs tests");
  }
  file.world = FindText(root, "world");
  file.includes = Texts(root, "include");
  root.Read("name", file.name);
  root.Read("seed", file.seed);
  file.settings = ReadSettings(root);
  file.ros_lockstep = ReadLockstep(root);
  file.hosts = ReadHosts(root);
  file.controller = ReadController(root);
  file.properties = ReadProperties(root, {});
  file.models = ReadModels(root, "models");
  file.robots = ReadModels(root, "robots");
  file.spawns = ReadSpawns(root);
  for (const JsonNode& entry : root.ItemsOf("override")) file.overrides.push_back(ReadOverride(entry));
  file.places = ReadPlaces(root);
  file.regions = ReadRegions(root);
  for (const JsonNode& entry : root.ItemsOf("expect")) {
    const std::string& text = entry.is_string() ? entry.text : entry.Member("that").text;
    const JsonNode* const name = entry.is_object() ? entry.Find("name") : nullptr;
    file.expectations.push_back({name != nullptr ? name->text : text, text});
  }
  Result<std::vector<PeopleEntry>> people = ReadPeopleEntries(tree_, root);
  if (people.ok()) {
    file.people = std::move(people).value();
  } else if (!error_) {
    error_ = people.error();
  }
  file.recorded_people = ReadRecordedEntries(tree_, root);
  Result<SiteEntries> site = ReadSiteEntries(tree_, root);
  if (site.ok()) {
    file.site = std::move(site).value();
  } else if (!error_) {
    error_ = site.error();
  }
  file.without = Texts(root, "without");
  if (error_) return *error_;
  return file;
}

}  // namespace

Result<ScenarioFile> ReadScenarioFile(const JsonTree& tree, const std::string& directory, std::uint32_t max_spawned) {
  return Reader(tree, directory, max_spawned).Read();
}

}  // namespace troupe
