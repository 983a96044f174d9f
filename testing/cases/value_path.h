// ValuePath: the place of a value in a scenario, as `vary` and `--case` name it: "spawn[0].count",
// "robots[anna].controller.parameters.speed". And ScenarioText: a scenario's text in which such values are replaced.
//
// Text is edited at the spans of its values, never printed again from a tree: comments, order and line numbers of all
// other values stay, so that a message about a case is at the line that the user knows. Both classes are immutable
// values.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/json_tree.h"
#include "troupe/result.h"

namespace troupe {

class ValuePath {
 public:
  // KEY, then any number of ".KEY", "[INDEX]" (from 0) and "[NAME]": the object of an array whose "name" is NAME. A key
  // or name may be a JSON string: only so can a key have '.', '[', and a name ']' or digits alone. The error's column
  // counts from 1 in `text`.
  static Result<ValuePath> Parse(std::string_view text);
  // The path at the beginning of `text`, up to a '=' that belongs to no name, or to the end; `size`: its bytes.
  static Result<ValuePath> ParseBeforeEquals(std::string_view text, std::size_t& size);

  // As it was written, but keys with '=' in quotes: in front of '=' it is read as the same path.
  const std::string& text() const { return text_; }
  // Whether one of the two is the other one or a part of its value.
  bool Overlaps(const ValuePath& other) const;
  // Two spellings of one path are equal.
  bool operator==(const ValuePath& other) const { return steps_ == other.steps_; }

 private:
  friend class ScenarioText;

  struct Step {
    enum class Kind : unsigned char { kKey, kIndex, kName };
    Kind kind = Kind::kKey;
    std::string name;       // of a key or of an object
    std::size_t index = 0;  // of an element
    bool operator==(const Step&) const = default;
  };

  static Result<ValuePath> ParseUpTo(std::string_view text, const char* ends_of_keys, std::size_t& size);
  // Adds the key, name or index at text[i], which ends before one of `ends`, and moves i to its end.
  Status ParseName(std::string_view text, Step::Kind kind, const char* ends, std::size_t& i);

  std::string text_;
  std::vector<Step> steps_;  // never empty; the first is a key
};

// A value at a place of a scenario. One draw of a case.
struct DrawnValue {
  std::string path;   // as ValuePath
  std::string value;  // JSON, on one line

  bool operator==(const DrawnValue&) const = default;
};

// A scenario's text in which values are replaced.
class ScenarioText {
 public:
  // `file` names the text in messages.
  static Result<ScenarioText> Parse(std::string text, const std::string& file);

  const JsonTree& tree() const { return tree_; }
  const std::string& text() const { return text_; }
  // The value at the path; null: there is none, but With can add it.
  Result<const JsonNode*> Find(const ValuePath& path) const;
  // The text with all these values; the lines of all others stay. A key that an object lacks is added to it. REQUIRES:
  // the paths do not overlap. The error says which part of a path is not in the scenario, without a place.
  Result<std::string> With(const std::vector<DrawnValue>& draws) const;
  // The text with absolute paths of all files that it names, for a scenario in another folder than that of `path`. Each
  // is the file that a load of the text at `path` finds: in the scenario's folder, in STAGEPATH or in the installed
  // models.
  std::string WithAbsolutePaths(const std::string& path) const;

 private:
  ScenarioText(std::string text, JsonTree tree) : text_(std::move(text)), tree_(std::move(tree)) {}

  // The value, or the innermost object that lacks the last key.
  struct Place {
    const JsonNode* value = nullptr;   // null: `parent` lacks it
    const JsonNode* parent = nullptr;  // an object, if value is null
  };
  Result<Place> Locate(const ValuePath& path) const;

  std::string text_;
  JsonTree tree_;
};

}  // namespace troupe
