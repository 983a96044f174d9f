// JsonText: the text of a JSON value of nlohmann::json or ordered_json.
#pragma once

#include <string>

namespace troupe {

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
