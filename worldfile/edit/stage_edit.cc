#include "worldfile/edit/stage_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace troupe {
namespace {

bool IsBlank(char c) {
  return c == ' ' || c == '\t';
}

// True if the value is that of the element in the text, whatever its form. `number`: of an element that is one.
bool IsSame(std::string_view element, double number, const Value::Number& value) {
  return element.front() != '"' && number == value.value;
}
bool IsSame(std::string_view element, double /*number*/, const std::string& value) {
  return element == '"' + value + '"';
}
bool IsSame(std::string_view /*element*/, double /*number*/, const Value::Tuple& /*value*/) {
  return false;
}

// A statement behind the last of its kind, or as the first of the body.
std::string Inserted(const std::string& text, const StageBody& body, const Statement* after, const std::string& what) {
  const std::string end_of_line = EndOfLineIn(text);
  const bool several_lines = body.is_file || body.span.Of(text).find('\n') != std::string_view::npos;
  const std::size_t at = after != nullptr ? after->span.end : body.span.begin;
  std::size_t rest = at;
  while (rest < text.size() && IsBlank(text[rest])) ++rest;
  // A comment behind the statement belongs to it: the new line goes below both.
  const bool ends_line = rest == text.size() || text[rest] == '\n' || text[rest] == '\r' || text[rest] == '#';
  if (several_lines && ends_line) {
    std::string indent = IndentOf(text, after != nullptr ? after->span.begin : body.span.begin);
    if (after == nullptr && !body.is_file) indent += "  ";
    // Behind a comment of that line.
    const std::size_t line_end = LineEnd(text, at);
    return ApplyChanges(text, {{{line_end, line_end}, end_of_line + indent + what}});
  }
  std::string between = " " + what;
  if (at < text.size() && !IsBlank(text[at]) && text[at] != '\n' && text[at] != '\r') between += " ";
  return ApplyChanges(text, {{{at, at}, between}});
}

std::vector<const Statement*> BlocksOf(const Statement& holder) {
  std::vector<const Statement*> blocks;
  for (const Statement& statement : holder.statements) {
    if (statement.kind == StatementKind::kEntry && statement.name == "block") blocks.push_back(&statement);
  }
  return blocks;
}

bool IsBlankAt(char c) {
  return c == ' ' || c == '\t';
}
bool EndsLine(char c) {
  return c == '\n' || c == '\r';
}

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

std::string WithProperty(const std::string& text, const StageBody& body, const std::string& name, const Value& value) {
  const Statement* const property = FindProperty(body, name);
  if (property == nullptr) {
    const Statement* last = nullptr;
    for (const Statement& statement : *body.statements) {
      if (statement.kind == StatementKind::kProperty) last = &statement;
    }
    const std::string written = name + " " + ToStage(value);
    // A file without properties may begin with defines and entries: the property goes to the very top, where it holds
    // for them all.
    if (!body.is_file || last != nullptr) return Inserted(text, body, last, written);
    return ApplyChanges(text, {{{0, 0}, written + EndOfLineIn(text)}});
  }
  const auto is_same = [&](const TextSpan& span, double number) {
    return [&text, span, number](const auto& content) { return IsSame(span.Of(text), number, content); };
  };
  const auto* const tuple = std::get_if<Value::Tuple>(&value.content);
  const bool was_tuple = text[property->value.begin] == '[';
  if (tuple != nullptr && was_tuple && tuple->size() == property->elements.size()) {
    std::vector<TextChange> changes;
    for (std::size_t i = 0; i < tuple->size(); ++i) {
      const auto& [span, number] = property->elements[i];
      if (!std::visit(is_same(span, number), (*tuple)[i])) changes.push_back({span, ToStage((*tuple)[i])});
    }
    return ApplyChanges(text, std::move(changes));
  }
  if (!was_tuple && std::visit(is_same(property->value, property->number), value.content)) return text;
  return ApplyChanges(text, {{property->value, ToStage(value)}});
}

std::string WithoutProperty(const std::string& text, const StageBody& body, const std::string& name) {
  std::vector<TextChange> changes;
  for (const Statement& statement : *body.statements) {
    if (statement.kind != StatementKind::kProperty || statement.name != name) continue;
    changes.push_back({WithSurroundings(text, statement.span), ""});
  }
  return ApplyChanges(text, std::move(changes));
}

std::string WithoutStatement(const std::string& text, const Statement& statement) {
  return ApplyChanges(text, {{WithSurroundings(text, statement.span), ""}});
}

std::string WithEntry(const std::string& text, const StageBody& body, const WrittenModel& model) {
  const std::string end_of_line = EndOfLineIn(text);
  if (body.is_file) {
    const bool ended = text.empty() || text.back() == '\n' || text.back() == '\r';
    const bool follows_define = !body.statements->empty() && body.statements->back().kind == StatementKind::kDefine;
    return text + (ended ? "" : end_of_line) + (follows_define ? end_of_line : "") + ToStage(model, "", end_of_line) +
           end_of_line;
  }
  const Statement* const last = body.statements->empty() ? nullptr : &body.statements->back();
  std::string indent = IndentOf(text, last != nullptr ? last->span.begin : body.span.begin);
  if (last == nullptr) indent += "  ";
  return Inserted(text, body, last, ToStage(model, indent, end_of_line));
}

std::string WithCopy(const std::string& text, const StageBody& body, const Statement& statement,
                     const std::string& entry) {
  return Inserted(text, body, &statement, entry);
}

std::string WithBeforeEntries(const std::string& text, const StageTree& tree, const std::string& written) {
  const std::string end_of_line = EndOfLineIn(text);
  for (const Statement& statement : tree.statements) {
    if (statement.kind != StatementKind::kEntry || statement.name == "window") continue;
    // Before the comments that belong to the entry.
    // A define in between would cut the comment from its entry.
    std::size_t at = LineStart(text, statement.span.begin);
    while (at > 0) {
      const std::size_t before = LineStart(text, at - 1 - (at > 1 && text[at - 1] == '\n' && text[at - 2] == '\r'));
      const std::size_t first = text.find_first_not_of(" \t", before);
      if (before == at || first >= at || text[first] != '#') break;
      at = before;
    }
    return ApplyChanges(text, {{{at, at}, written + end_of_line}});
  }
  const bool ended = text.empty() || text.back() == '\n' || text.back() == '\r';
  return text + (ended ? "" : end_of_line) + (text.empty() ? "" : end_of_line) + written;
}

std::string WithDefine(const std::string& text, const StageTree& tree, const std::string& name,
                       const WrittenModel& model) {
  const std::string end_of_line = EndOfLineIn(text);
  return WithBeforeEntries(text, tree, ToDefine(model, name, end_of_line) + end_of_line);
}

Result<const Statement*> StageBodyEdit::Find() {
  if (!tree_) {
    Result<StageTree> parsed = ParseStage(text_, path_);
    if (!parsed.ok()) return parsed.error();
    tree_ = std::move(parsed).value();
  }
  const auto chain = FindStatement(*tree_, line_, column_);
  if (chain.empty()) return Error{{path_, line_, column_}, "found no entry or define here, expected one"};
  return chain.back();
}

// To parse a text again is most of the work: an edit that changes nothing does not need it.
void StageBodyEdit::Replace(std::string text) {
  if (text == text_) return;
  text_ = std::move(text);
  tree_.reset();
}

Status StageBodyEdit::Set(const std::string& property, const Value& value) {
  const Result<const Statement*> statement = Find();
  if (!statement.ok()) return statement.error();
  Replace(WithProperty(text_, BodyOf(*statement.value()), property, value));
  return {};
}

Status StageBodyEdit::Remove(const std::string& property) {
  const Result<const Statement*> statement = Find();
  if (!statement.ok()) return statement.error();
  Replace(WithoutProperty(text_, BodyOf(*statement.value()), property));
  return {};
}

Status StageBodyEdit::SetBlocks(const std::vector<WrittenModel>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (Status failure = SetBlock(i, blocks[i]); !failure.ok()) return failure;
  }
  for (;;) {
    const Result<const Statement*> holder = Find();
    if (!holder.ok()) return holder.error();
    const std::vector<const Statement*> old = BlocksOf(*holder.value());
    if (old.size() <= blocks.size()) return {};
    // From the last one, so that the blocks in front keep their place; each removal makes the tree out of date.
    Replace(WithoutStatement(text_, *old.back()));
  }
}

Status StageBodyEdit::SetBlock(std::size_t index, const WrittenModel& block) {
  const Result<const Statement*> holder = Find();
  if (!holder.ok()) return holder.error();
  const std::vector<const Statement*> old = BlocksOf(*holder.value());
  if (index >= old.size()) {
    Replace(WithEntry(text_, BodyOf(*holder.value()), block));
    return {};
  }
  // Corners that are too many go first.
  StageBodyEdit edit(text_, path_, old[index]->line, old[index]->column);
  for (const Statement& statement : old[index]->statements) {
    const bool is_wanted = std::any_of(block.properties.begin(), block.properties.end(),
                                       [&](const auto& property) { return property.first == statement.name; });
    if (is_wanted || !statement.name.starts_with("point[")) continue;
    if (Status failure = edit.Remove(std::string(statement.name)); !failure.ok()) return failure;
  }
  for (const auto& [name, value] : block.properties) {
    if (Status failure = edit.Set(name, value); !failure.ok()) return failure;
  }
  Replace(edit.text());
  return {};
}

std::string ApplyChanges(std::string_view text, std::vector<TextChange> changes) {
  // Stable: two insertions at one place keep their order.
  std::stable_sort(changes.begin(), changes.end(),
                   [](const TextChange& a, const TextChange& b) { return a.span.begin < b.span.begin; });
  std::string result;
  std::size_t at = 0;
  for (const TextChange& change : changes) {
    result.append(text.substr(at, change.span.begin - at));
    result.append(change.replacement);
    at = change.span.end;
  }
  result.append(text.substr(at));
  return result;
}

std::size_t LineStart(std::string_view text, std::size_t offset) {
  while (offset > 0 && !EndsLine(text[offset - 1])) --offset;
  return offset;
}

std::size_t LineEnd(std::string_view text, std::size_t offset) {
  while (offset < text.size() && !EndsLine(text[offset])) ++offset;
  return offset;
}

std::string IndentOf(std::string_view text, std::size_t offset) {
  const std::size_t start = LineStart(text, offset);
  std::size_t end = start;
  while (end < text.size() && IsBlankAt(text[end])) ++end;
  return std::string(text.substr(start, end - start));
}

std::string EndOfLineIn(std::string_view text) {
  const std::size_t first = text.find('\n');
  return first != std::string_view::npos && first > 0 && text[first - 1] == '\r' ? "\r\n" : "\n";
}

TextSpan WithSurroundings(std::string_view text, TextSpan span) {
  std::size_t begin = span.begin;
  while (begin > 0 && IsBlankAt(text[begin - 1])) --begin;
  const bool starts_line = begin == 0 || EndsLine(text[begin - 1]);
  std::size_t end = span.end;
  while (end < text.size() && IsBlankAt(text[end])) ++end;
  const bool ends_line = end == text.size() || EndsLine(text[end]);
  if (!starts_line) return {begin, ends_line ? end : span.end};
  if (!ends_line) return {span.begin, end};
  // The line's own end goes too, with both bytes of a CRLF.
  if (end < text.size()) {
    const char first = text[end++];
    if (end < text.size() && EndsLine(text[end]) && text[end] != first) ++end;
  }
  return {begin, end};
}

std::string PlainNumber(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  // Rounding of a small negative number.
  return text == "-0" ? "0" : text;
}

std::string WithMember(const std::string& text, const JsonNode& object, const std::string& key,
                       const std::string& value) {
  const JsonNode* const member = object.Find(key);
  if (member == nullptr) return Appended(text, object, nlohmann::json(key).dump() + ": " + value);
  const Result<JsonTree> read = JsonTree::Parse(value, "");
  if (!read.ok()) return ApplyChanges(text, {{member->span, value}});
  const JsonNode& after = read.value().root();
  // By value, not by text: a form that rewrites an unchanged pose keeps the user's spelling.
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
    // With the comma behind the item, and without it for the last: a trailing comma is not JSON.
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

namespace {

// The value, in the objects and arrays that the steps from `first` on name. Entries of a list of the file itself begin
// lines of their own.
Result<std::string> ValueInSteps(const JsonPath& path, std::size_t first, const std::string& value) {
  std::string whole = value;
  for (std::size_t i = path.size(); i > first; --i) {
    if (const auto* const key = std::get_if<std::string>(&path[i - 1])) {
      whole.insert(0, "{" + nlohmann::json(*key).dump() + ": ").push_back('}');
      continue;
    }
    if (std::get<std::size_t>(path[i - 1]) != 0) return Error{{}, "found no list of that length"};
    const bool is_entry = i == 2 && whole.starts_with('{');
    whole.insert(0, is_entry ? "[\n    " : "[").append(is_entry ? "\n  ]" : "]");
  }
  return whole;
}

}  // namespace

Result<std::string> WithValueAt(const std::string& text, const JsonNode& node, const JsonPath& path,
                                const std::optional<std::string>& value) {
  const JsonNode* holder = &node;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool is_last = i + 1 == path.size();
    const Result<std::string> inside = ValueInSteps(path, i + 1, value.value_or("null"));
    if (const auto* const key = std::get_if<std::string>(&path[i])) {
      if (!holder->is_object()) return Error{{}, "found " + Describe(*holder) + ", expected an object with " + *key};
      const JsonNode* const next = holder->Find(*key);
      if (next != nullptr && !is_last) {
        holder = next;
        continue;
      }
      if (!value) return WithoutMember(text, *holder, *key);
      if (!inside.ok()) return inside.error();
      return WithMember(text, *holder, *key, inside.value());
    }
    const std::size_t index = std::get<std::size_t>(path[i]);
    if (!holder->is_array() || index > holder->items.size()) {
      return Error{{}, "found " + Describe(*holder) + ", expected a list with an element " + std::to_string(index)};
    }
    const bool is_new = index == holder->items.size();
    if (!is_new && !is_last) {
      holder = &holder->items[index];
      continue;
    }
    if (!value) return is_new ? text : WithoutItem(text, *holder, index);
    if (!inside.ok()) return inside.error();
    if (is_new) return WithElement(text, *holder, inside.value());
    return ApplyChanges(text, {{holder->items[index].span, inside.value()}});
  }
  return text;
}

}  // namespace troupe
