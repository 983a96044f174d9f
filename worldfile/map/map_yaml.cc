#include "worldfile/map/map_yaml.h"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "common/geometry/limits.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxYamlBytes = 1'000'000;

SourceLocation At(const std::string& path, const YAML::Mark& mark) {
  if (mark.is_null()) return {path, 1, 1};
  return {path, mark.line + 1, mark.column + 1};
}

// "nan", ".nan", "-nan", "-NaN".
bool EndsInNan(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text.ends_with("nan") && text.find_first_not_of("+-.") == text.size() - 3;
}

// Reads the keys of the file one by one. The first error is kept; after it values are defaults.
class MapYamlReader {
 public:
  explicit MapYamlReader(const std::string& path) : path_(path) {}

  Result<MapYaml> Read(const std::string& text) {
    if (Status error = ReadKeys(text); !error.ok()) return error.error();
    MapYaml map;
    map.image = ReadImage();
    map.image_where = WhereOf("image");
    map.resolution = Number("resolution", std::nullopt, 1e-6, kMaxMagnitude);
    map.origin = ReadOrigin();
    const bool negate = Flag("negate", std::nullopt);
    const double occupied = Threshold("occupied_thresh");
    const bool has_free = nodes_.contains("free_thresh");  // it has no effect, so it may be missing
    const double free = has_free ? Threshold("free_thresh") : 0.0;
    if (!has_free) {
      warnings_.push_back({{path_, 1, 1}, "found no key 'free_thresh', expected it; it has no effect here"});
    }
    if (error_.ok() && has_free && free > occupied) {
      Warn("free_thresh", "found a free_thresh of " + NumberText(free) + " above the occupied_thresh of " +
                              NumberText(occupied) +
                              ", expected at most that; pixels from occupied_thresh on are occupied, as in map_server");
    }
    map.rule = ReadRule(negate, occupied);
    map.wall_height = Number("wall_height", map.wall_height, 1e-3, kMaxMagnitude);
    for (const auto& [key, node] : nodes_) {
      if (!used_[key]) warnings_.push_back({At(path_, marks_[key]), "key " + Quoted(key) + " has no effect"});
    }
    if (!error_.ok()) return error_.error();
    map.warnings = std::move(warnings_);
    return map;
  }

 private:
  void Warn(const std::string& key, const std::string& message) {
    warnings_.push_back({At(path_, nodes_.at(key).Mark()), message});
  }
  void Fail(const YAML::Mark& mark, const std::string& message) {
    if (error_.ok()) error_ = Error{At(path_, mark), message};
  }

  Status ReadKeys(const std::string& text) {
    YAML::Node root;
    try {
      root = YAML::Load(text);
      if (!root.IsMap()) return Error{At(path_, root.Mark()), "found no YAML map, expected keys such as 'image'"};
      for (const auto& entry : root) {
        if (!entry.first.IsScalar())
          return Error{At(path_, entry.first.Mark()), "found a key that is not a word, expected one such as 'image'"};
        const std::string& key = entry.first.Scalar();
        if (nodes_.emplace(key, entry.second).second) {
          marks_[key] = entry.first.Mark();
        } else {  // as in map_server
          warnings_.push_back({At(path_, entry.first.Mark()),
                               "found key " + Quoted(key) + " twice, expected it once; the first one counts"});
        }
      }
    } catch (const YAML::DeepRecursion& exception) {
      return Error{At(path_, exception.mark), "found text nested too deeply, expected keys such as 'image'"};
    } catch (const YAML::Exception& exception) {
      return Error{At(path_, exception.mark), "found text that is not YAML (" + exception.msg + "), expected YAML"};
    }
    return Status();
  }

  // The value of a key as text; nothing if it is missing or not a single value.
  std::optional<std::string> Scalar(const std::string& key, bool required) {
    used_[key] = true;
    const auto found = nodes_.find(key);
    if (found == nodes_.end()) {
      if (required && error_.ok()) error_ = Error{{path_, 1, 1}, "found no key " + Quoted(key) + ", expected it"};
      return std::nullopt;
    }
    if (!found->second.IsScalar()) {
      Fail(found->second.Mark(), "found no single value for " + Quoted(key) + ", expected one");
      return std::nullopt;
    }
    return found->second.Scalar();
  }

  std::optional<double> ToNumber(const YAML::Node& node, const std::string& key) {
    if (node.IsScalar()) {
      const std::optional<LeadingNumber> number = ReadLeadingNumber(node.Scalar());
      if (number && number->is_all) return number->value;
    }
    Fail(node.Mark(), "found " + (node.IsScalar() ? Quoted(node.Scalar()) : "no single value") + " for " + Quoted(key) +
                          ", expected a number");
    return std::nullopt;
  }

  double Number(const std::string& key, std::optional<double> otherwise, double min, double max) {
    if (!Scalar(key, !otherwise)) return otherwise.value_or(min);
    const YAML::Node& node = nodes_.at(key);
    const std::optional<double> value = ToNumber(node, key);
    if (!value) return min;
    if (*value >= min && *value <= max) return *value;
    Fail(node.Mark(), "found " + NumberText(*value) + " for " + Quoted(key) + ", expected " + NumberText(min) + " to " +
                          NumberText(max));
    return min;
  }

  // Any number is read, as in map_server, but one beyond 0 to 1 is not meant.
  double Threshold(const std::string& key) {
    const double value = Number(key, std::nullopt, -kMaxMagnitude, kMaxMagnitude);
    if (error_.ok() && !(value >= 0.0 && value <= 1.0)) {
      Warn(key, "found " + NumberText(value) + " for " + Quoted(key) + ", expected 0 to 1; it is compared as it is");
    }
    return value;
  }

  bool Flag(const std::string& key, std::optional<bool> otherwise) {
    const std::optional<std::string> text = Scalar(key, !otherwise);
    if (!text) return otherwise.value_or(false);
    if (*text == "1" || *text == "0") return *text == "1";
    bool flag = false;
    if (YAML::convert<bool>::decode(nodes_.at(key), flag)) return flag;  // true, yes, on ...
    const std::optional<LeadingNumber> number = ReadLeadingNumber(*text);
    if (number && number->is_all) {
      flag = number->value != 0.0;
      Warn(key,
           "found " + Quoted(*text) + " for " + Quoted(key) + ", expected 0 or 1; " + (flag ? "1" : "0") + " is used");
      return flag;
    }
    Fail(nodes_.at(key).Mark(), "found " + Quoted(*text) + " for " + Quoted(key) + ", expected 0 or 1");
    return false;
  }

  // The value of a key; the file if it is missing.
  SourceLocation WhereOf(const std::string& key) const {
    const auto found = nodes_.find(key);
    return found == nodes_.end() ? SourceLocation{path_} : At(path_, found->second.Mark());
  }

  std::string ReadImage() {
    const std::optional<std::string> image = Scalar("image", true);
    if (!image) return "";
    if (image->empty()) Fail(nodes_.at("image").Mark(), "found an empty image name, expected a file");
    const std::filesystem::path folder = DirectoryOf(path_);
    const std::filesystem::path named = (folder / *image).lexically_normal();
    // map_saver writes the path on the machine where it ran.
    const std::filesystem::path beside = (folder / named.filename()).lexically_normal();
    std::error_code ignored;
    if (named != beside && !std::filesystem::exists(named, ignored) &&
        std::filesystem::is_regular_file(beside, ignored)) {
      Warn("image", "found no image " + QuotedPath(*image) + "; the one beside this file is used, " +
                        QuotedPath(beside.string()));
      return beside.string();
    }
    return named.string();
  }

  Pose ReadOrigin() {
    used_["origin"] = true;
    const auto found = nodes_.find("origin");
    if (found == nodes_.end()) {
      if (error_.ok()) error_ = Error{{path_, 1, 1}, "found no key 'origin', expected it"};
      return {};
    }
    if (!found->second.IsSequence() || found->second.size() < 3) {
      Fail(found->second.Mark(), "found no list of three for 'origin', expected [x, y, yaw]");
      return {};
    }
    if (found->second.size() > 3) {
      Warn("origin", "found " + CountText(found->second.size(), "value") +
                         " for 'origin', expected [x, y, yaw]; the rest is ignored");
    }
    double values[3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const YAML::Node& node = found->second[i];
      // map_saver writes a heading of "-nan" if a localization has no estimate.
      if (i == 2 && node.IsScalar() && EndsInNan(node.Scalar())) {
        Warn("origin", "found " + Quoted(node.Scalar()) + " for the yaw of 'origin', expected a number; 0 is used");
        continue;
      }
      values[i] = ToNumber(node, "origin").value_or(0.0);
      if (std::fabs(values[i]) > kMaxMagnitude)
        Fail(node.Mark(), "found " + NumberText(values[i]) + " for 'origin', expected at most 1e6");
    }
    return {values[0], values[1], 0.0, WrapAngle(values[2])};
  }

  // trinary and scale: a dark pixel is probably occupied (negate: a bright one). raw: the pixel is the probability in
  // percent, above 100 it is unknown. Unknown pixels are free.
  PixelRule ReadRule(bool negate, double occupied_threshold) {
    std::string mode = Scalar("mode", false).value_or("trinary");
    for (char& c : mode) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;  // as in map_server
    if (mode != "trinary" && mode != "scale" && mode != "raw") {
      Fail(nodes_.at("mode").Mark(), "found mode " + Quoted(mode) + ", expected trinary, scale or raw");
    }
    PixelRule rule;
    rule.mean_of_channels = true;
    rule.transparent_is_free = mode == "scale";
    for (int value = 0; value < 256; ++value) {
      double probability = (negate ? value : 255 - value) / 255.0;
      if (mode == "raw") probability = value <= 100 ? value / 100.0 : 0.0;
      rule.occupied[static_cast<std::size_t>(value)] = probability >= occupied_threshold;
    }
    return rule;
  }

  const std::string& path_;
  std::map<std::string, YAML::Node> nodes_;
  std::map<std::string, YAML::Mark> marks_;
  std::map<std::string, bool> used_;
  std::vector<Warning> warnings_;
  Status error_;
};

}  // namespace

Result<MapYaml> ReadMapYamlText(const std::string& text, const std::string& path) {
  if (text.size() > kMaxYamlBytes) {
    return Error{{path},
                 "found " + std::to_string(text.size()) + " bytes, expected at most " + std::to_string(kMaxYamlBytes)};
  }
  const auto place = [&](std::size_t odd) {
    const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(odd), '\n') + 1;
    return SourceLocation{path, static_cast<int>(line), 1};
  };
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos) {
    return Error{place(nul), "found a byte that is not text, expected YAML"};
  }
  Result<MapYaml> map = MapYamlReader(path).Read(text);
  const std::size_t odd = FindInvalidUtf8(text);
  if (map.ok() && odd != std::string::npos) {  // in a comment, mostly
    map.value().warnings.push_back({place(odd), "found a byte that is not UTF-8, expected UTF-8 text; it is left out"});
  }
  return map;
}

}  // namespace troupe
