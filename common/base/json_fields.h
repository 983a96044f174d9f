// Values and rows with a list of fields (troupe/fields.h) as JSON, for other processes: a member for each field, by its
// name. An optional field without a value has none.
#pragma once

#include <concepts>
#include <string>

#include "common/base/json_integer.h"
#include "troupe/fields.h"

namespace troupe {

// Reads a member if it exists; throws std::exception if it is of another type or out of range.
template <typename Json, typename Value>
void ReadMember(const Json& object, const char* name, Value& value) {
  const auto found = object.find(name);
  if (found == object.end()) return;
  if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
    value = IntegerOf<Value>(*found);
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

}  // namespace troupe
