#include "worldfile/edit/stage_edit.h"

#include <algorithm>
#include <utility>

#include "worldfile/edit/text_change.h"

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

}  // namespace

std::string WithProperty(const std::string& text, const StageBody& body, const std::string& name, const Value& value) {
  const Statement* const property = FindProperty(body, name);
  if (property == nullptr) {
    const Statement* last = nullptr;
    for (const Statement& statement : *body.statements) {
      if (statement.kind == StatementKind::kProperty) last = &statement;
    }
    const std::string written = name + " " + ToStage(value);
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

std::string WithDefine(const std::string& text, const StageTree& tree, const std::string& name,
                       const WrittenModel& model) {
  const std::string end_of_line = EndOfLineIn(text);
  const std::string written = ToDefine(model, name, end_of_line) + end_of_line;
  for (const Statement& statement : tree.statements) {
    if (statement.kind != StatementKind::kEntry || statement.name == "window") continue;
    // Before the comments that belong to the entry.
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

}  // namespace troupe
