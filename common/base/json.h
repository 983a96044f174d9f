// JSON of nlohmann: the text of a value, integers of other processes, and rows with a list of fields (troupe/fields.h).
//
// Names and values of other processes may be anything: conversions throw for every value that does not fit, and the
// caller turns the exception into an error (or_failure.h). Files of users are read by JsonTree
// (worldfile/text/json_tree.h), which knows places.
#pragma once

#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "troupe/fields.h"

namespace troupe {

// IntegerOf: an integer in a JSON value of nlohmann::json that comes from another process.
// Throws std::out_of_range for a value of another type, with a fraction, or beyond the range of Integer, which a
// conversion of nlohmann's would turn into any number.
template <std::integral Integer, typename Json>
Integer IntegerOf(const Json& json) {
  if (json.is_number_unsigned()) {
    const auto value = json.template get<std::uint64_t>();
    if (std::in_range<Integer>(value)) return static_cast<Integer>(value);
  } else if (json.is_number_integer()) {
    const auto value = json.template get<std::int64_t>();
    if (std::in_range<Integer>(value)) return static_cast<Integer>(value);
  }
  throw std::out_of_range("found " + json.dump() + ", expected an integer in range");
}

// Values and rows with a list of fields (troupe/fields.h) as JSON, for other processes: a member for each field, by its
// name. An optional field without a value has none.

// Reads a member if it exists; throws std::exception if it is of another type or out of range.
template <typename Json, typename Value>
void ReadMember(const Json& object, const char* name, Value& value) {
  const auto found = object.find(name);
  if (found == object.end()) return;
  if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
    value = IntegerOf<Value>(*found);
  } else if constexpr (std::is_enum_v<Value>) {  // any number of its type
    value = static_cast<Value>(IntegerOf<std::underlying_type_t<Value>>(*found));
  } else {
    found->get_to(value);
  }
}

template <typename Json, HasFields Row>
Json FieldsToJson(const Row& row) {
  Json object = Json::object();
  ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
    const std::string name(field.name);
    if constexpr (HasFields<Part>) {
      object[name] = FieldsToJson<Json>(field.Of(row));
    } else if constexpr (requires { field.Of(row).has_value(); }) {
      if (field.Of(row)) object[name] = *field.Of(row);
    } else {
      object[name] = field.Of(row);
    }
  });
  return object;
}

// The inverse. Throws as ReadMember does.
template <typename Json, HasFields Row>
void FieldsFromJson(const Json& object, Row& row) {
  ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
    const std::string name(field.name);
    if constexpr (HasFields<Part>) {
      if (const auto found = object.find(name); found != object.end()) FieldsFromJson(*found, field.Of(row));
    } else if constexpr (requires { field.Of(row).has_value(); }) {
      if (object.contains(name)) ReadMember(object, name.c_str(), field.Of(row).emplace());
    } else {
      ReadMember(object, name.c_str(), field.Of(row));
    }
  });
}

// JsonText: the text of a JSON value of nlohmann::json or ordered_json.

struct JsonTextOptions {
  int indent = -1;     // spaces; -1: all on one line
  bool ascii = false;  // other characters are escaped
};

// Bytes that are not UTF-8, as in file names, become U+FFFD: they are no reason to fail.
template <typename Json>
std::string JsonText(const Json& json, const JsonTextOptions& options = {}) {
  return json.dump(options.indent, ' ', options.ascii, Json::error_handler_t::replace);
}

}  // namespace troupe
