#include "worldfile/edit/json_syntax.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "worldfile/scenario/json_document.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// REQUIRES: the text is valid JSON, nested no deeper than JsonDocument allows.
class JsonReader {
 public:
  explicit JsonReader(const std::string& text) : text_(text) {}

  JsonItem ReadValue() {
    SkipBlanks();
    JsonItem item;
    item.span.begin = item.member.begin = at_;
    if (text_[at_] == '{' || text_[at_] == '[') {
      item.kind = text_[at_] == '{' ? JsonItem::Kind::kObject : JsonItem::Kind::kArray;
      ReadItems(item);
    } else if (text_[at_] == '"') {
      SkipString();
    } else {
      at_ = text_.find_first_of(",]} \t\r\n", at_);
      if (at_ == std::string::npos) at_ = text_.size();
    }
    item.span.end = item.member.end = at_;
    return item;
  }

 private:
  void SkipBlanks() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  void SkipString() {
    for (++at_; text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }

  void ReadItems(JsonItem& holder) {
    const char close = text_[at_++] == '{' ? '}' : ']';
    for (SkipBlanks(); text_[at_] != close; SkipBlanks()) {
      if (text_[at_] == ',') {
        ++at_;
        SkipBlanks();
      }
      const std::size_t begin = at_;
      std::string key;
      if (holder.kind == JsonItem::Kind::kObject) {
        SkipString();
        key = Json::parse(text_.substr(begin, at_ - begin)).get<std::string>();
        SkipBlanks();
        ++at_;  // the colon
      }
      JsonItem item = ReadValue();
      item.member.begin = begin;
      item.key = std::move(key);
      holder.items.push_back(std::move(item));
    }
    ++at_;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

bool HasSeveralLines(const std::string& text, const JsonItem& item) {
  return item.span.Of(text).find('\n') != std::string_view::npos;
}

// Appends to an object or an array, in the form of the items that it has.
std::string Appended(const std::string& text, const JsonItem& holder, const std::string& what) {
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
  const bool spread = is_root || HasSeveralLines(text, holder) || holder.kind == JsonItem::Kind::kArray;
  const std::string written = spread ? end_of_line + indent + "  " + what + end_of_line + indent : what;
  return ApplyChanges(text, {{{inside, holder.span.end - 1}, written}});
}

bool IsSameJson(std::string_view old_text, const std::string& new_text) {
  const Json before = Json::parse(old_text, nullptr, false);
  const Json after = Json::parse(new_text, nullptr, false);
  return !before.is_discarded() && before == after;
}

}  // namespace

const JsonItem* JsonItem::Find(const std::string& name) const {
  for (const JsonItem& item : items) {
    if (item.key == name) return &item;
  }
  return nullptr;
}

Result<JsonItem> ReadJsonSyntax(const std::string& text, const std::string& path) {
  if (const Result<JsonDocument> valid = JsonDocument::Parse(text, path); !valid.ok()) return valid.error();
  return JsonReader(text).ReadValue();
}

std::vector<const JsonItem*> FindJsonAt(const JsonItem& root, std::size_t offset) {
  std::vector<const JsonItem*> found;
  const JsonItem* at = root.span.Contains(offset) ? &root : nullptr;
  while (at != nullptr) {
    found.push_back(at);
    const JsonItem* next = nullptr;
    for (const JsonItem& item : at->items) {
      if (item.member.Contains(offset)) next = &item;
    }
    at = next;
  }
  return found;
}

std::size_t OffsetOf(const std::string& text, int line, int column) {
  std::size_t at = 0;
  for (int i = 1; i < line && at < text.size(); ++i) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) return text.size();
    at = end + 1;
  }
  return std::min(at + static_cast<std::size_t>(std::max(column, 1) - 1), text.size());
}

std::string WithMember(const std::string& text, const JsonItem& object, const std::string& key,
                       const std::string& value) {
  const JsonItem* const member = object.Find(key);
  if (member == nullptr) return Appended(text, object, Json(key).dump() + ": " + value);
  if (IsSameJson(member->span.Of(text), value)) return text;
  const JsonItem after = JsonReader(value).ReadValue();
  const bool alike = member->kind == JsonItem::Kind::kArray && after.kind == JsonItem::Kind::kArray &&
                     member->items.size() == after.items.size();
  if (!alike) return ApplyChanges(text, {{member->span, value}});
  std::vector<TextChange> changes;
  for (std::size_t i = 0; i < after.items.size(); ++i) {
    std::string element(after.items[i].span.Of(value));
    if (IsSameJson(member->items[i].span.Of(text), element)) continue;
    changes.push_back({member->items[i].span, std::move(element)});
  }
  return ApplyChanges(text, std::move(changes));
}

std::string WithElement(const std::string& text, const JsonItem& array, const std::string& value) {
  return Appended(text, array, value);
}

std::string WithoutItem(const std::string& text, const JsonItem& holder, std::size_t index) {
  const std::vector<JsonItem>& items = holder.items;
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

}  // namespace troupe
