// JsonReader: reads the values of a JSON text strictly, whoever wrote it: parameters of controllers, requests of the
// page, layouts, messages between processes. Each value has to be of the kind that is read; the first fault becomes
// the error, which says what was found, at which path and, in a file, at which line and column:
//
//   layout.lif.json:7:12: error: found the string 'a' as 'layouts[0].nodes[2].nodePosition.x', expected a number
//
// A reader is a cursor at one value, cheap to copy. All readers of a text share its error. After an error values are of
// no use, but reading goes on safely: the caller asks for status() once, at the end.
//
// A row with a list of fields (troupe/fields.h) is read from an object, each field by its name; members that are
// missing keep their values. A row of numbers, such as a pose, may also be a list of them.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/json_tree.h"
#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/result.h"

namespace troupe {

class JsonReader {
 public:
  struct NamedNumber {
    std::string_view name;
    double value = 0.0;
  };

  // At the root. `subject` begins every message, for instance "wander".
  explicit JsonReader(JsonTree tree, std::string subject = "");
  // The same for a text without a file. One that is not JSON is an error.
  static JsonReader OfText(std::string_view text, std::string subject = "",
                           const JsonLimits& limits = JsonLimits::OfUsers());

  // The value, as long as a reader of the text exists.
  const JsonNode& node() const { return *node_; }
  bool is_null() const { return node_->kind == JsonNode::Kind::kNull; }
  // Of a member of an object.
  const std::string& key() const { return node_->key; }
  SourceLocation where() const { return shared_->tree.Where(*node_); }

  bool ok() const { return !shared_->error.has_value(); }
  Status status() const { return ok() ? Status() : Status(*shared_->error); }

  // Records "found VALUE as 'PATH', expected EXPECTED", if it is the first error. False.
  bool Fail(const std::string& expected) const;
  // Records a message of its own.
  bool FailWith(const std::string& message) const;
  // The same at the key of a member.
  bool FailAtKey(const std::string& message) const;
  // Records that a member is missing.
  bool FailWithout(std::string_view key, const std::string& expected) const;

  // The member of that name; nothing if there is none, or, which is an error, if the value is no object.
  std::optional<JsonReader> Find(std::string_view key) const;
  bool Has(std::string_view key) const { return node_->Find(key) != nullptr; }
  // The items of an array, at most `most`; none if it is another value, which is an error.
  std::vector<JsonReader> Items(std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  // The items of a member; none if there is no such member.
  std::vector<JsonReader> ItemsOf(std::string_view key) const {
    const std::optional<JsonReader> list = Find(key);
    return list ? list->Items() : std::vector<JsonReader>();
  }
  // The members of an object, in the order of the text; none if it is another value, which is an error.
  std::vector<JsonReader> Members() const;
  // Members that have not been looked for are an error.
  void RefuseOthers() const;
  // The error, also of members that have not been looked for.
  Status Finish() const {
    RefuseOthers();
    return status();
  }

  // Reads the value; false after an error. Integers are exact, numbers finite, enumerations names of their values or,
  // without names, integers. Null is an optional without a value.
  template <typename Value>
  bool To(Value& value) const;
  // Reads a member, if there is one, into `value`, which else keeps its value.
  template <typename Value>
  bool Read(std::string_view key, Value& value) const {
    const std::optional<JsonReader> member = Find(key);
    return member && member->To(value);
  }
  // A member that may be missing.
  template <typename Value>
  std::optional<Value> Optional(std::string_view key) const {
    std::optional<Value> value;
    const std::optional<JsonReader> member = Find(key);
    if (member && !member->To(value.emplace())) value.reset();
    return value;
  }
  // A member that has to be there.
  template <typename Value>
  Value Get(std::string_view key) const {
    Value value{};
    if (const std::optional<JsonReader> member = Find(key)) {
      member->To(value);
    } else {
      FailWithout(key, Expected<Value>());
    }
    return value;
  }

  // The value as a number from `min` to `max`, or one of the names of numbers; names only if min > max.
  std::optional<double> Number(double min, double max, const std::vector<NamedNumber>& names = {}) const;
  // The same for a member, which may be missing.
  std::optional<double> Number(std::string_view key, double min, double max,
                               const std::vector<NamedNumber>& names = {}) const {
    const std::optional<JsonReader> member = Find(key);
    return member ? member->Number(min, max, names) : std::nullopt;
  }
  // A member that is a hash in hexadecimal digits: JSON numbers lose bits beyond 2^53.
  bool ReadHash(std::string_view key, std::uint64_t& hash) const;
  // The value as a list of exactly `count` numbers whose amounts are at most `most`; nothing after an error.
  std::optional<std::vector<double>> Numbers(std::size_t count, double most) const;

 private:
  struct Shared {
    JsonTree tree;
    std::string subject;
    std::optional<Error> error = {};
    std::map<std::size_t, std::vector<std::string>> asked =
        {};  // keys that were looked for, by the place of the object in the text
  };

  JsonReader(std::shared_ptr<Shared> shared, const JsonNode& node) : shared_(std::move(shared)), node_(&node) {}

  bool FailAt(const SourceLocation& where, const std::string& message) const;
  // " as 'commands[0].at'"; empty for the root.
  std::string AsPath(const char* preposition) const;
  template <typename Integer>
  bool ToInteger(Integer& value) const;
  template <typename Row>
  bool ToRow(Row& row) const;

  template <typename Row>
  static constexpr bool kIsNumbers = std::apply(
      []<typename... Listed>(const Listed&...) {
        return sizeof...(Listed) > 0 && (... && std::same_as<std::remove_cvref_t<typename Listed::Part>, double>);
      },
      kFields<Row>);

  template <typename Value>
  static std::string Expected();

  std::shared_ptr<Shared> shared_;
  const JsonNode* node_;
};

// "found the key 'sped', expected one of reach, speed; did you mean 'speed'?"
std::string UnknownKeyText(std::string_view key, std::vector<std::string> known, const std::string& place = "");

// Reads a row with a list of fields from a text of another process of the same run.
template <HasFields Row>
Result<Row> RowFromJson(std::string_view text) {
  const JsonReader reader = JsonReader::OfText(text, "", JsonLimits::OfProcesses());
  Row row;
  reader.To(row);
  if (Status status = reader.status(); !status.ok()) return status.error();
  return row;
}

template <typename Value>
std::string JsonReader::Expected() {
  if constexpr (kIsOptional<Value>) {
    return Expected<typename Value::value_type>();
  } else if constexpr (kIsList<Value>) {
    return "a list";
  } else if constexpr (std::same_as<Value, bool>) {
    return "true or false";
  } else if constexpr (std::same_as<Value, std::string>) {
    return "a text";
  } else if constexpr (NamedEnum<Value>) {
    std::string names;
    for (const std::string& name : AllNames<Value>()) names += (names.empty() ? "" : ", ") + name;
    return "one of " + names;
  } else if constexpr (std::integral<Value> || std::is_enum_v<Value>) {
    return "a whole number";
  } else if constexpr (HasFields<Value>) {
    if constexpr (kIsNumbers<Value>) return "a list of " + CountText(kMemberCount<Value>, "number");
    return "an object";
  } else if constexpr (requires(Value point) { point.x(), point.y(); }) {
    return "a list of 2 numbers";
  } else {
    return "a number";
  }
}

template <typename Integer>
bool JsonReader::ToInteger(Integer& value) const {
  const std::string& digits = node_->text;
  Integer read = 0;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), read);
  const bool is_integer = end.ec == std::errc() && end.ptr == digits.data() + digits.size();
  // Many programs write whole numbers as 2.0 or 1e3. Doubles up to 2^53 are exact.
  constexpr double kExact = 9007199254740992.0;
  const double number = node_->number;
  if (!is_integer && node_->is_number() && std::fabs(number) <= kExact && number == std::trunc(number) &&
      std::in_range<Integer>(static_cast<std::int64_t>(number))) {
    read = static_cast<Integer>(number);
  } else if (!node_->is_number() || !is_integer) {
    return Fail(Expected<Integer>());
  }
  value = read;
  return true;
}

template <typename Row>
bool JsonReader::ToRow(Row& row) const {
  if constexpr (kIsNumbers<Row>) {
    if (node_->is_array()) {
      if (node_->items.size() != kMemberCount<Row>) return Fail(Expected<Row>());
      std::size_t next = 0;
      return std::apply(
          [&](const auto&... field) { return (... && JsonReader(shared_, node_->items[next++]).To(field.Of(row))); },
          kFields<Row>);
    }
  }
  if (!node_->is_object()) return Fail(Expected<Row>());
  ForEachField<Row>([&](const auto& field) { Read(field.name, field.Of(row)); });
  return ok();
}

template <typename Value>
bool JsonReader::To(Value& value) const {
  if constexpr (kIsOptional<Value>) {
    if (is_null()) {
      value.reset();
      return true;
    }
    return To(value.emplace());
  } else if constexpr (kIsList<Value>) {
    value.clear();
    for (const JsonReader& item : Items()) {
      typename Value::value_type element{};
      if (!item.To(element)) return false;
      value.push_back(std::move(element));
    }
    return ok();
  } else if constexpr (std::same_as<Value, bool>) {
    if (!node_->is_boolean()) return Fail(Expected<Value>());
    value = node_->is_true();
    return true;
  } else if constexpr (std::same_as<Value, std::string>) {
    if (!node_->is_string()) return Fail(Expected<Value>());
    value = node_->text;
    return true;
  } else if constexpr (NamedEnum<Value>) {
    const std::optional<Value> named = node_->is_string() ? FindByName<Value>(node_->text) : std::nullopt;
    if (!named) return Fail(Expected<Value>());
    value = *named;
    return true;
  } else if constexpr (std::is_enum_v<Value>) {
    std::underlying_type_t<Value> number = 0;
    if (!ToInteger(number)) return false;
    value = static_cast<Value>(number);
    return true;
  } else if constexpr (std::integral<Value>) {
    return ToInteger(value);
  } else if constexpr (HasFields<Value>) {
    return ToRow(value);
  } else if constexpr (requires { value.x() = 0.0, value.y() = 0.0; }) {
    if (!node_->is_array() || node_->items.size() != 2) return Fail(Expected<Value>());
    return JsonReader(shared_, node_->items[0]).To(value.x()) && JsonReader(shared_, node_->items[1]).To(value.y());
  } else {
    static_assert(std::same_as<Value, double>, "no JSON value is of this type");
    if (!node_->is_number()) return Fail(Expected<Value>());
    value = node_->number;
    return true;
  }
}

}  // namespace troupe
