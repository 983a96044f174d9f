#include "fleet/vehicle_settings.h"

#include <optional>

#include "common/base/json_reader.h"

namespace troupe::fleet {
namespace {

constexpr std::string_view kEpoch = "2026-01-01T00:00:00.000Z";

// A level of a topic: not empty, and without the separators and wildcards of MQTT and blanks.
bool IsLevel(std::string_view text) {
  if (text.empty()) return false;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= ' ' || byte == 0x7f || c == '/' || c == '+' || c == '#' || c == '$') return false;
  }
  return true;
}

void ReadLevel(const JsonReader& json, std::string_view key, std::string& level) {
  json.Read(key, level);
  if (json.ok() && !IsLevel(level)) {
    json.FailWith("found the " + std::string(key) + " '" + level + "', expected a text without blanks and / + # $");
  }
}

void ReadVersion(const JsonReader& json, Version& version) {
  const std::optional<std::string> text = json.Optional<std::string>("version");
  if (!text) return;
  if (const std::optional<Version> named = FindByName<Version>(*text)) {
    version = *named;
  } else if (const std::optional<Version> full = FindVersion(*text)) {
    version = *full;
  } else {
    json.FailWith("found the version '" + *text + "', expected 2.0, 2.1 or 3.0");
  }
}

}  // namespace

std::string VehicleSettings::TopicOf(std::string_view name) const {
  std::string topic = interface_name;
  topic += IsBefore3(version) ? "/v2/" : "/v3/";
  topic += manufacturer + "/" + serial_number + "/";
  topic += name;
  return topic;
}

Result<VehicleSettings> ReadVehicleSettings(const std::string& parameters, std::string_view robot) {
  const JsonReader json = JsonReader::OfText(parameters, "vda5050");
  VehicleSettings settings;
  settings.serial_number = robot;
  ReadVersion(json, settings.version);
  settings.interface_name = IsBefore3(settings.version) ? "uagv" : "vda5050";
  ReadLevel(json, "manufacturer", settings.manufacturer);
  ReadLevel(json, "serial_number", settings.serial_number);
  ReadLevel(json, "interface", settings.interface_name);
  const std::string epoch = json.Optional<std::string>("epoch").value_or(std::string(kEpoch));
  if (const std::optional<std::int64_t> time = ParseTimestamp(epoch)) {
    settings.epoch_ms = *time;
  } else {
    json.FailWith("found the epoch '" + epoch + "', expected a time such as " + std::string(kEpoch));
  }
  json.Read("map", settings.map);
  const auto read = [&](std::string_view key, double min, double max, double& value) {
    value = json.Number(key, min, max).value_or(value);
  };
  read("speed", 0.01, 100.0, settings.speed);
  read("turn_rate", 0.01, 100.0, settings.turn_rate);
  read("tolerance", 0.01, 100.0, settings.tolerance);
  read("heading_tolerance", 0.01, 3.2, settings.heading_tolerance);
  read("gap", 0.0, 100.0, settings.gap);
  read("blocked_after", 0.0, 3600.0, settings.blocked_after);
  read("load_time", 0.0, 3600.0, settings.load_time);
  read("minimum_state_interval", 0.0, 30.0, settings.minimum_state_interval);
  read("state_interval", 0.1, 30.0, settings.state_interval);
  read("visualization_interval", 0.0, 3600.0, settings.visualization_interval);
  if (Status status = json.Finish(); !status.ok()) return status.error();
  return settings;
}

}  // namespace troupe::fleet
