#include "worldfile/edit/json_edit.h"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "worldfile/edit/text_change.h"

namespace troupe {
namespace {

bool HasSeveralLines(const std::string& text, const JsonNode& item) {
  return item.span.Of(text).find('\n') != std::string_view::npos;
}

// Appends to an object or an array, in the form of the items that it has.
std::string Appended(const std::string& text, const JsonNode& holder, const std::string& what) {
  const std::string end_of_line = EndOfLineIn(text);
  if (!holder.items.empty()) {
    const std::size_t at = holder.items.back().member.end;
    // Items that begin lines of their own.
    const std::size_t first = holder.items.front().member.begin;
    const bool own_lines =
        text.find_first_not_of(" \t", LineStart(text, first)) == first && LineStart(text, first) > holder.span.begin;
    return ApplyChanges(text, {{{at, at}, own_lines ? "," + end_of_line + IndentOf(text, first) + what : ", " + what}});
  }
  const std::size_t inside = holder.span.begin + 1;
  const std::string indent = IndentOf(text, holder.span.begin);
  const bool is_root = holder.span.begin == text.find_first_not_of(" \t\r\n");
  const bool spread = is_root || HasSeveralLines(text, holder) || holder.is_array();
  const std::string written = spread ? end_of_line + indent + "  " + what + end_of_line + indent : what;
  return ApplyChanges(text, {{{inside, holder.span.end - 1}, written}});
}

}  // namespace

std::string WithMember(const std::string& text, const JsonNode& object, const std::string& key,
                       const std::string& value) {
  const JsonNode* const member = object.Find(key);
  if (member == nullptr) return Appended(text, object, nlohmann::json(key).dump() + ": " + value);
  const Result<JsonTree> read = JsonTree::Parse(value, "");
  if (!read.ok()) return ApplyChanges(text, {{member->span, value}});
  const JsonNode& after = read.value().root();
  if (ToJson(*member) == ToJson(after)) return text;
  const bool alike = member->is_array() && after.is_array() && member->items.size() == after.items.size();
  if (!alike) return ApplyChanges(text, {{member->span, value}});
  std::vector<TextChange> changes;
  for (std::size_t i = 0; i < after.items.size(); ++i) {
    if (ToJson(member->items[i]) == ToJson(after.items[i])) continue;
    changes.push_back({member->items[i].span, std::string(after.items[i].span.Of(value))});
  }
  return ApplyChanges(text, std::move(changes));
}

std::string WithElement(const std::string& text, const JsonNode& array, const std::string& value) {
  return Appended(text, array, value);
}

std::string WithoutItem(const std::string& text, const JsonNode& holder, std::size_t index) {
  const std::vector<JsonNode>& items = holder.items;
  TextSpan gone = items[index].member;
  if (index + 1 < items.size()) {
    gone.end = items[index + 1].member.begin;
  } else if (index > 0) {
    gone.begin = items[index - 1].member.end;
  } else {
    gone = {holder.span.begin + 1, holder.span.end - 1};
  }
  return ApplyChanges(text, {{gone, ""}});
}

std::string WithoutMember(const std::string& text, const JsonNode& object, const std::string& key) {
  const JsonNode* const member = object.Find(key);
  return member != nullptr ? WithoutItem(text, object, static_cast<std::size_t>(member - object.items.data())) : text;
}

}  // namespace troupe
