// YamlReader: reads values of a YAML file as numbers, flags and texts; a wrong one is an error with its place.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "common/geometry/limits.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// A file with its first error; after it values are defaults, so that callers need not check each one.
class YamlReader {
 public:
  YamlReader(std::string path, Diagnostics& diagnostics) : path_(std::move(path)), diagnostics_(diagnostics) {}

  // Passes the top map to `read`. Text that is no YAML, and exceptions of the YAML library, become the error.
  void Read(const std::string& text, const std::function<void(const YAML::Node& root)>& read);

  bool failed() const { return diagnostics_.failed(); }
  SourceLocation At(const YAML::Node& node) const;
  void Fail(const YAML::Node& node, const std::string& message);
  void Warn(const YAML::Node& node, const std::string& message);

  // The value of a key of a map. False in a condition if the map has no such key, or is none.
  static YAML::Node Find(const YAML::Node& map, const char* key);
  // The same, which must be there. `of`: "level 'L1'".
  YAML::Node Require(const YAML::Node& map, const char* key, const std::string& of);
  // The value of a parameter: `key: [type, value]`, or `key: value`.
  static YAML::Node Parameter(const YAML::Node& map, const char* key);

  // Calls visit for the items of a list; a value of another kind is an error, but for null and a missing one.
  void ForEachItem(const YAML::Node& list, const std::string& what,
                   const std::function<void(const YAML::Node&)>& visit);
  // The same for a map, with the keys.
  void ForEachEntry(const YAML::Node& map, const std::string& what,
                    const std::function<void(const std::string& key, const YAML::Node& value)>& visit);
  // Whether the value is a list of at least that many; else an error.
  bool HasItems(const YAML::Node& list, std::size_t least, const std::string& what);

  // `otherwise` for a missing value.
  double Number(const YAML::Node& node, const std::string& what, double otherwise, double min = -kMaxMagnitude,
                double max = kMaxMagnitude);
  std::size_t Index(const YAML::Node& node, const std::string& what, std::size_t count);
  bool Flag(const YAML::Node& node, const std::string& what, bool otherwise);
  std::string Text(const YAML::Node& node, const std::string& what, const std::string& otherwise = "");

  // Warns once of each key of a map that is not among `known`.
  void WarnOfUnknownKeys(const YAML::Node& map, const std::string& what, const std::set<std::string>& known);

 private:
  std::string path_;
  Diagnostics& diagnostics_;
  std::set<std::string> warned_;
};

}  // namespace troupe
