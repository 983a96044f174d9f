// JsonTree: the values of a JSON text, each with its bytes in the text. Scenarios are read from it, messages name its
// places, and edits (worldfile/edit/stage_edit.h) change the bytes of single values.
//
// Not nlohmann::json: that keeps no offsets, so a fault could not be placed and an edit could not spare the comments,
// blanks and order of a hand-written file. A number keeps its text for the same reason, and because a 64-bit integer
// such as a seed does not fit a double.
//
// The parser accepts strict JSON in UTF-8 without comments. Texts come from users and from programs of the network, so
// that size, count of values and depth are limited before memory is spent; the limit of the depth also bounds the
// recursion of the readers. A repeated key is an error, because one of the two values would have no effect.
//
// A tree is immutable after Parse and does not refer to its text. Looking for a member is linear in the members of the
// object: objects are small.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/source_text.h"
#include "troupe/enum_names.h"
#include "troupe/result.h"

namespace troupe {

struct JsonNode {
  enum class Kind : std::uint8_t { kNull, kFalse, kTrue, kNumber, kString, kArray, kObject };

  Kind kind = Kind::kNull;
  double number = 0.0;  // of a number
  TextSpan span;        // of the value
  // For removing and for cursors in an editor: `span` alone would leave the key.
  TextSpan member;              // of an object's member: from its key to the end of the value; else as `span`
  std::string key;              // of an object's member
  std::string text;             // the characters of a string; a number as it is written
  std::vector<JsonNode> items;  // of an array or an object, in the order of the text

  bool is_boolean() const { return kind == Kind::kFalse || kind == Kind::kTrue; }
  bool is_number() const { return kind == Kind::kNumber; }
  bool is_string() const { return kind == Kind::kString; }
  bool is_array() const { return kind == Kind::kArray; }
  bool is_object() const { return kind == Kind::kObject; }
  bool is_true() const { return kind == Kind::kTrue; }

  // The member of that name; null: there is none.
  const JsonNode* Find(std::string_view name) const;
  // REQUIRES: there is one.
  const JsonNode& Member(std::string_view name) const;
  // The items of the member of that name, which is an array or an object; none if there is no such member.
  const std::vector<JsonNode>& ItemsOf(std::string_view name) const;

  // Reads the member of that name into `value`, which keeps its value if there is no such member; whether there is one.
  // REQUIRES: the member is of the kind of Value, which is bool, std::string, a floating-point number, an integer,
  // whose range the member is within, an enumeration, which it names, or an optional of one: a schema has been checked.
  template <typename Value>
  bool Read(std::string_view name, Value& value) const;

  // REQUIRES: a number within the range of Integer. A fraction is dropped.
  template <std::integral Integer>
  Integer ToInteger() const {
    Integer integer = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), integer);
    return read.ec == std::errc() && read.ptr == text.data() + text.size() ? integer : static_cast<Integer>(number);
  }
};

template <typename Value>
bool JsonNode::Read(std::string_view name, Value& value) const {
  const JsonNode* const found = Find(name);
  if (found == nullptr) return false;
  if constexpr (std::same_as<Value, bool>) {
    value = found->is_true();
  } else if constexpr (std::same_as<Value, std::string>) {
    value = found->text;
  } else if constexpr (std::floating_point<Value>) {
    value = found->number;
  } else if constexpr (std::integral<Value>) {
    value = found->ToInteger<Value>();
  } else if constexpr (NamedEnum<Value>) {
    value = FindByName<Value>(found->text).value_or(value);
  } else {
    return Read(name, value.emplace());
  }
  return true;
}

// Larger texts are refused unread; the count of values bounds memory.
struct JsonLimits {
  std::size_t bytes = 16u << 20;
  std::size_t values = 250'000;

  static JsonLimits OfUsers() { return {}; }
  // The reports of the run's own processes grow with its robots.
  static JsonLimits OfProcesses() { return {std::size_t{1} << 32, std::size_t{1} << 30}; }
};

class JsonTree {
 public:
  static constexpr int kMaxDepth = 64;  // bounds the stack

  // Strict JSON in UTF-8; a key that an object has twice is an error. `file` names the text in messages; empty: none.
  static Result<JsonTree> Parse(std::string_view text, const std::string& file,
                                const JsonLimits& limits = JsonLimits::OfUsers());
  static JsonTree Null() { return JsonTree("", ""); }

  const std::string& file() const { return file_; }
  const JsonNode& root() const { return root_; }

  // Where the value of a node starts, and its key; without a key the value.
  SourceLocation Where(const JsonNode& node) const { return lines_.Where(file_, node.span.begin); }
  SourceLocation WhereKey(const JsonNode& node) const { return lines_.Where(file_, node.member.begin); }
  Error ErrorAt(const JsonNode& node, std::string message) const { return {Where(node), std::move(message)}; }

  std::size_t OffsetOf(const SourceLocation& where) const { return lines_.OffsetOf(where.line, where.column); }
  // The nodes from the root to the innermost that has the byte at `offset`, as key or value; empty: none has.
  std::vector<const JsonNode*> PathTo(std::size_t offset) const;

 private:
  JsonTree(std::string_view text, std::string file) : file_(std::move(file)), lines_(text) {}

  std::string file_;
  TextLines lines_;
  JsonNode root_;
};

// The value without its places.
nlohmann::json ToJson(const JsonNode& node);

// "the string 'abc'", "the number 3", "an array of 2", "an object", "null": for messages.
std::string Describe(const JsonNode& node);

}  // namespace troupe
