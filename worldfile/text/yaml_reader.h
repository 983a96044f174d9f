// YamlReader: the values of a YAML text as numbers, flags and texts; a wrong one is an error with its place. The maps
// of map_server and the buildings of traffic_editor are read by it.
//
// A text may come from a stranger: its size, its depth and its values are limited. Aliases share the nodes of their
// anchor, but count as copies of it, because a reader visits each of them: so a few lines cannot stand for a billion
// values. No exception of the YAML library leaves this file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/limits.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// A value of the text. Nodes are shared by aliases, so that the tree is a graph without cycles; they are owned by the
// reader and never change after Read. A missing value is a node too (kMissing), so that chains of Find need no checks.
struct YamlNode {
  enum class Kind : std::uint8_t { kMissing, kNull, kScalar, kList, kMap };

  Kind kind = Kind::kMissing;
  int line = 1;  // of the text, from 1, as the column
  int column = 1;
  std::string text;                    // of a scalar
  std::vector<const YamlNode*> items;  // of a list; of a map: key, value, key, value, ... with scalars as keys

  // False for what a map or a list does not have.
  explicit operator bool() const { return kind != Kind::kMissing; }
  bool is_missing_or_null() const { return kind == Kind::kMissing || kind == Kind::kNull; }
  bool is_scalar() const { return kind == Kind::kScalar; }
  bool is_list() const { return kind == Kind::kList; }
  bool is_map() const { return kind == Kind::kMap; }

  // The length of a list; 0 for another value.
  std::size_t size() const { return is_list() ? items.size() : 0; }
  // An item of a list, missing if there are fewer.
  const YamlNode& operator[](std::size_t index) const;
};

// A text with its first error; after it values are defaults, so that callers need not check each one. One text, one
// thread.
class YamlReader {
 public:
  static constexpr std::size_t kMaxBytes = 16u << 20;
  // A building of a hundred rooms has some thousands.
  static constexpr std::size_t kMaxValues = 1'000'000;

  YamlReader(std::string path, Diagnostics& diagnostics) : path_(std::move(path)), diagnostics_(diagnostics) {}
  YamlReader(const YamlReader&) = delete;
  YamlReader& operator=(const YamlReader&) = delete;

  // The top map of the first document of a text; a missing node after a fault. `key`: one that the map may have, for
  // messages. Of two entries with one key the first counts. Nodes are valid as long as the reader. REQUIRES: no call
  // before.
  const YamlNode& Read(std::string_view text, const char* key);

  bool failed() const { return diagnostics_.failed(); }
  SourceLocation At(const YamlNode& node) const { return {path_, node.line, node.column}; }
  void Fail(const YamlNode& node, const std::string& message) { diagnostics_.Fail(At(node), message); }
  void Warn(const YamlNode& node, const std::string& message) { diagnostics_.Warn(At(node), message); }

  // The value of a key; missing if the map has no such key, or is none.
  static const YamlNode& Find(const YamlNode& map, std::string_view key);
  // The same, which must be there. `of`: "level 'L1'".
  const YamlNode& Require(const YamlNode& map, const char* key, const std::string& of);
  // The value of a parameter: `key: [type, value]`, or `key: value`.
  static const YamlNode& Parameter(const YamlNode& map, std::string_view key);

  // Calls visit for the items of a list; a value of another kind is an error, but for null and a missing one.
  void ForEachItem(const YamlNode& list, const std::string& what, const std::function<void(const YamlNode&)>& visit);
  // The same for a map, with the keys.
  void ForEachEntry(const YamlNode& map, const std::string& what,
                    const std::function<void(const std::string& key, const YamlNode& value)>& visit);
  // Whether the value is a list of at least that many; else an error.
  bool HasItems(const YamlNode& list, std::size_t least, const std::string& what);

  // `otherwise` for a missing value.
  double Number(const YamlNode& node, const std::string& what, double otherwise, double min = -kMaxMagnitude,
                double max = kMaxMagnitude);
  std::size_t Index(const YamlNode& node, const std::string& what, std::size_t count);
  bool Flag(const YamlNode& node, const std::string& what, bool otherwise);
  std::string Text(const YamlNode& node, const std::string& what, const std::string& otherwise = "");

  // Warns once of each key of a map that is not among `known`.
  void WarnOfUnknownKeys(const YamlNode& map, const std::string& what, const std::set<std::string>& known);

 private:
  std::string path_;
  Diagnostics& diagnostics_;
  std::deque<YamlNode> nodes_;
  std::set<std::string> warned_;
};

}  // namespace troupe
