#include "worldfile/map/map_yaml.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "common/geometry/limits.h"
#include "worldfile/text/text_file.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {
namespace {

// "nan", ".nan", "-nan", "-NaN".
bool EndsInNan(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text.ends_with("nan") && text.find_first_not_of("+-.") == text.size() - 3;
}

class MapYamlReader {
 public:
  explicit MapYamlReader(const std::string& path) : path_(path), yaml_(path, diagnostics_) {}

  Result<MapYaml> Read(const std::string& text) {
    root_ = &yaml_.Read(text, "image");
    if (yaml_.failed()) return *diagnostics_.error();
    MapYaml map;
    map.image_where = yaml_.At(Require("image"));
    map.image = ReadImage(Require("image"));
    map.resolution = Number(Require("resolution"), "resolution", 1e-6, kMaxMagnitude);
    map.origin = ReadOrigin(Require("origin"));
    const bool negate = ReadNegate(Require("negate"));
    const double occupied = ReadThreshold(Require("occupied_thresh"), "occupied_thresh");
    CheckFreeThreshold(Find("free_thresh"), occupied);
    map.rule = ReadRule(Find("mode"), negate, occupied);
    const YamlNode& free = Find("free_thresh");
    map.numbers = Numbers(Mode(Find("mode")), negate, occupied, free ? ReadThresholdQuietly(free) : 0.0);
    if (const YamlNode& height = Find("wall_height")) {
      map.wall_height = Number(height, "wall_height", 1e-3, kMaxMagnitude);
    }
    yaml_.WarnOfUnknownKeys(
        *root_, kThis,
        {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode", "wall_height"});
    if (yaml_.failed()) return *diagnostics_.error();
    map.warnings = std::move(diagnostics_.warnings());
    return map;
  }

 private:
  static constexpr const char* kThis = "a ROS map";

  const YamlNode& Find(const char* key) const { return yaml_.Find(*root_, key); }
  const YamlNode& Require(const char* key) { return yaml_.Require(*root_, key, kThis); }

  double Number(const YamlNode& node, const char* key, double min, double max) {
    // A missing key has already failed in Require: the value does not matter then.
    return yaml_.Number(node, Quoted(key), min, min, max);
  }

  // Any number is read, as in map_server, but one beyond 0 to 1 is not meant.
  double ReadThreshold(const YamlNode& node, const char* key) {
    const double value = yaml_.Number(node, Quoted(key), 0.0);
    if (!(value >= 0.0 && value <= 1.0)) {
      yaml_.Warn(node,
                 "found " + NumberText(value) + " for " + Quoted(key) + ", expected 0 to 1; it is compared as it is");
    }
    return value;
  }

  // It has no effect, so it may be missing.
  void CheckFreeThreshold(const YamlNode& node, double occupied) {
    if (!node) return yaml_.Warn(node, "found no key 'free_thresh', expected it; it has no effect here");
    const double free = ReadThreshold(node, "free_thresh");
    if (yaml_.failed() || free <= occupied) return;
    yaml_.Warn(node, "found a free_thresh of " + NumberText(free) + " above the occupied_thresh of " +
                         NumberText(occupied) +
                         ", expected at most that; pixels from occupied_thresh on are occupied, as in map_server");
  }

  // A flag, or any number, as in map_server.
  bool ReadNegate(const YamlNode& node) {
    const std::optional<LeadingNumber> number = ReadLeadingNumber(node.text);
    if (!number || !number->is_all || node.text == "0" || node.text == "1") return yaml_.Flag(node, "'negate'", false);
    const bool flag = number->value != 0.0;
    yaml_.Warn(node,
               "found " + Quoted(node.text) + " for 'negate', expected 0 or 1; " + (flag ? "1" : "0") + " is used");
    return flag;
  }

  std::string ReadImage(const YamlNode& node) {
    const std::string image = yaml_.Text(node, "'image'");
    if (yaml_.failed()) return "";
    if (image.empty()) yaml_.Fail(node, "found an empty image name, expected a file");
    const std::filesystem::path folder = DirectoryOf(path_);
    const std::filesystem::path named = (folder / image).lexically_normal();
    // map_saver writes the path on the machine where it ran.
    const std::filesystem::path beside = (folder / named.filename()).lexically_normal();
    std::error_code ignored;
    if (named != beside && !std::filesystem::exists(named, ignored) &&
        std::filesystem::is_regular_file(beside, ignored)) {
      yaml_.Warn(node, "found no image " + QuotedPath(image) + "; the one beside this file is used, " +
                           QuotedPath(beside.string()));
      return beside.string();
    }
    return named.string();
  }

  Pose ReadOrigin(const YamlNode& node) {
    if (!node) return {};
    if (node.size() < 3) {
      yaml_.Fail(node, "found no list of three for 'origin', expected [x, y, yaw]");
      return {};
    }
    if (node.size() > 3) {
      yaml_.Warn(node, "found " + CountText(node.size(), "value") +
                           " for 'origin', expected [x, y, yaw]; the rest is ignored");
    }
    const double x = yaml_.Number(node[0], "'origin'", 0.0);
    const double y = yaml_.Number(node[1], "'origin'", 0.0);
    // map_saver writes a heading of "-nan" if a localization has no estimate.
    if (EndsInNan(node[2].text)) {
      yaml_.Warn(node[2], "found " + Quoted(node[2].text) + " for the yaw of 'origin', expected a number; 0 is used");
      return {x, y, 0.0, 0.0};
    }
    return {x, y, 0.0, WrapAngle(yaml_.Number(node[2], "'origin'", 0.0))};
  }

  std::string Mode(const YamlNode& node) {
    std::string mode = yaml_.Text(node, "'mode'", "trinary");
    for (char& c : mode) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;  // as in map_server
    return mode;
  }

  // Its warning has been given.
  double ReadThresholdQuietly(const YamlNode& node) { return yaml_.Number(node, "'free_thresh'", 0.0); }

  static std::array<std::uint8_t, 256> Numbers(const std::string& mode, bool negate, double occupied, double free) {
    std::array<std::uint8_t, 256> numbers{};
    for (int value = 0; value < 256; ++value) {
      const double probability = (negate ? value : 255 - value) / 255.0;
      std::uint8_t& number = numbers[static_cast<std::size_t>(value)];
      if (mode == "raw") {
        number = value <= 100 ? static_cast<std::uint8_t>(value) : MapYaml::kUnknownCell;
      } else if (probability >= occupied) {
        number = 100;
      } else if (probability <= free) {
        number = 0;
      } else if (mode == "scale") {
        number = static_cast<std::uint8_t>(
            std::clamp(std::round((probability - free) / (occupied - free) * 100.0), 0.0, 100.0));
      } else {
        number = MapYaml::kUnknownCell;
      }
    }
    return numbers;
  }

  // trinary and scale: a dark pixel is probably occupied (negate: a bright one). raw: the pixel is the probability in
  // percent, above 100 it is unknown. Unknown pixels are free.
  PixelRule ReadRule(const YamlNode& mode_node, bool negate, double occupied_threshold) {
    const std::string mode = Mode(mode_node);
    if (mode != "trinary" && mode != "scale" && mode != "raw") {
      yaml_.Fail(mode_node, "found mode " + Quoted(mode) + ", expected trinary, scale or raw");
    }
    PixelRule rule;
    // As in map_server; Stage takes the red channel alone.
    rule.mean_of_channels = true;
    rule.transparent_is_free = mode == "scale";
    for (int value = 0; value < 256; ++value) {
      double probability = (negate ? value : 255 - value) / 255.0;
      // map_server reads raw values as its own occupancy numbers: 0 to 100, 255 for unknown.
      if (mode == "raw") probability = value <= 100 ? value / 100.0 : 0.0;
      rule.occupied[static_cast<std::size_t>(value)] = probability >= occupied_threshold;
    }
    return rule;
  }

  const std::string& path_;
  Diagnostics diagnostics_;
  YamlReader yaml_;
  const YamlNode* root_ = nullptr;
};

}  // namespace

Result<MapYaml> ReadMapYamlText(const std::string& text, const std::string& path) {
  return MapYamlReader(path).Read(text);
}

}  // namespace troupe
