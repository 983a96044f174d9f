// The syntax of JSON text with the place of every value, so that an edit changes the bytes of that value alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/edit/text_change.h"

namespace troupe {

struct JsonItem {
  enum class Kind : std::uint8_t { kObject, kArray, kScalar };

  Kind kind = Kind::kScalar;
  TextSpan span;                // of the value
  TextSpan member;              // of an object's member: from its key to the end of the value; else as `span`
  std::string key;              // of an object's member
  std::vector<JsonItem> items;  // of an object or an array

  // The member of that name; null: there is none.
  const JsonItem* Find(const std::string& name) const;
};

// The error names the place as JsonDocument does.
Result<JsonItem> ReadJsonSyntax(const std::string& text, const std::string& path);

// The values from the outermost to the innermost that holds the byte at `offset`; empty: none does.
std::vector<const JsonItem*> FindJsonAt(const JsonItem& root, std::size_t offset);

// The offset of a line and a column, both from 1, in bytes.
std::size_t OffsetOf(const std::string& text, int line, int column);

// Edits. Each returns the changed text; the item is of that text.
// Changes or adds a member. Of an array of as many plain values only those change that have another value.
std::string WithMember(const std::string& text, const JsonItem& object, const std::string& key,
                       const std::string& value);
std::string WithElement(const std::string& text, const JsonItem& array, const std::string& value);
// `item`: of `holder`, by its index.
std::string WithoutItem(const std::string& text, const JsonItem& holder, std::size_t index);

}  // namespace troupe
