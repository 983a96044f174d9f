// StageTree: the statements of one Stage file (.world, .inc), each with its bytes in the text. Worlds are made from it
// (stage_world.h), messages name its places, and edits (worldfile/edit/stage_edit.h) change the bytes of single parts:
// comments, order and blanks stay. Includes are not followed and defines not applied.
//
// The grammar is that of Stage's worldfile parser, with its quirks where world files in circulation depend on them:
// only an opening round bracket may be on a later line than its name, numbers are as long as they begin like one
// ("1.2.3" is 1.2, with a warning), the first define and the last property of a name count.
//
// The names are views of the text that the tree shares: copies of a tree are valid, and so are statements as long as
// any copy lives. Recursion is bounded by kMaxNesting, memory by StageItemCount, which all files of a world share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/result.h"
#include "worldfile/text/text_file.h"

namespace troupe {

// Limit of entries inside each other, and of macros made from each other: parser, expander and builder recurse that
// deep.
inline constexpr int kMaxNesting = 200;

enum class StatementKind : std::uint8_t {
  kProperty,  // NAME VALUE
  kEntry,     // TYPE ( statements )
  kDefine,    // define NAME BASE ( statements )
  kInclude,   // include "NAME"
};

// A number or a text of a tuple.
struct StageElement {
  TextSpan span;        // with its quotes
  double number = 0.0;  // of a number
};

struct Statement {
  StatementKind kind = StatementKind::kProperty;
  int line = 0;                        // of the name, from 1
  int column = 0;                      // of the name, from 1, in bytes
  std::string_view name;               // part of the tree's text; of an include, without its quotes
  std::string_view base;               // of a define
  TextSpan span;                       // the whole statement, up to its closing bracket
  TextSpan value;                      // of a property, with quotes or brackets
  double number = 0.0;                 // of a property that is one number
  std::vector<StageElement> elements;  // of a property that is a tuple
  TextSpan body;                       // between the brackets of an entry or a define
  std::vector<Statement> statements;   // in there
};

// What is between the brackets of an entry or a define, or a whole file.
struct StageBody {
  const std::vector<Statement>* statements = nullptr;
  TextSpan span;
  bool is_file = false;
};

inline StageBody BodyOf(const Statement& statement) {
  return {&statement.statements, statement.body, false};
}

// Limits the statements and the elements of tuples in all files of a world.
struct StageItemCount {
  std::size_t most = 4'000'000;
  std::size_t found = 0;
};

struct StageTree {
  std::string path;
  std::shared_ptr<const std::string> text;
  std::vector<Statement> statements;
  std::vector<Warning> warnings;

  StageBody body() const { return {&statements, {0, text->size()}, true}; }
  // The place of a statement's name.
  SourceLocation Where(const Statement& statement) const { return {path, statement.line, statement.column}; }
  // The place of a byte. REQUIRES: it is on the line of the statement's name.
  SourceLocation Where(const Statement& statement, std::size_t offset) const;
};

// `path` names the text in messages. Adds the items of the text to `count`.
Result<StageTree> ParseStage(std::string text, const std::string& path, StageItemCount& count);
inline Result<StageTree> ParseStage(std::string text, const std::string& path) {
  StageItemCount count;
  return ParseStage(std::move(text), path, count);
}

// The statements from the outermost to the statement whose name is at this place; empty: there is none.
std::vector<const Statement*> FindStatement(const StageTree& tree, int line, int column);

// The property of that name that counts: the last one. Null: there is none.
const Statement* FindProperty(const StageBody& body, std::string_view name);

// The define of that name that counts: the first one. Null: there is none.
const Statement* FindDefine(const StageTree& tree, std::string_view name);

}  // namespace troupe
