// JSON that is written: the text of a value of nlohmann::json, and rows with a list of fields (troupe/fields.h). JSON
// that is read: JsonReader (json_reader.h).
#pragma once

#include <string>

#include "troupe/fields.h"

namespace troupe {

// A row as an object with a member for each field, by its name. An optional field without a value has none.
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
