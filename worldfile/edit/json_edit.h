// Edits of JSON text. Each returns the changed text, in which all bytes that the edit does not concern stay. REQUIRES,
// of all: the nodes are those of the text.
#pragma once

#include <cstddef>
#include <string>

#include "worldfile/text/json_tree.h"

namespace troupe {

// Changes or adds a member. Of an array of as many plain values only those change that have another value.
std::string WithMember(const std::string& text, const JsonNode& object, const std::string& key,
                       const std::string& value);
std::string WithElement(const std::string& text, const JsonNode& array, const std::string& value);
// `index`: of an item of the holder.
std::string WithoutItem(const std::string& text, const JsonNode& holder, std::size_t index);
// Without the member of that name, if there is one.
std::string WithoutMember(const std::string& text, const JsonNode& object, const std::string& key);

}  // namespace troupe
