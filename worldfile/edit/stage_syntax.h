// The syntax of one Stage file with the place of every part, so that an edit changes the bytes of that part alone:
// comments, order and blanks stay. Includes are not followed and defines not applied; stage_parser.h gives the meaning.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "worldfile/edit/text_change.h"

namespace troupe {

enum class StatementKind : std::uint8_t { kProperty, kEntry, kDefine, kInclude };

struct Statement {
  StatementKind kind = StatementKind::kProperty;
  std::string name;                   // of the property or the define; type of the entry; path of the include
  std::string base;                   // of a define
  int line = 0;                       // of the name, as in messages and in WorldNode::where
  int column = 0;                     // in bytes, from 1
  TextSpan name_span;                 // the word that is the name
  TextSpan span;                      // the whole statement, up to its closing bracket
  TextSpan value;                     // of a property, with quotes or brackets
  std::vector<TextSpan> elements;     // of a tuple
  TextSpan body;                      // between the brackets of an entry or a define
  std::vector<Statement> statements;  // in there
};

// What is between the brackets of an entry or a define, or a whole file.
struct StageBody {
  const std::vector<Statement>* statements = nullptr;
  TextSpan span;
  bool is_file = false;
};

struct StageSyntax {
  std::vector<Statement> statements;
  std::size_t size = 0;  // of the text

  StageBody body() const { return {&statements, {0, size}, true}; }
};

inline StageBody BodyOf(const Statement& statement) {
  return {&statement.statements, statement.body, false};
}

// `path` names the text in messages.
Result<StageSyntax> ReadStageSyntax(const std::string& text, const std::string& path);

// The statements from the outermost to the one whose name is at this place; empty: there is none.
std::vector<const Statement*> FindStatement(const StageSyntax& syntax, int line, int column);

// The property of that name that counts: the last one. Null: there is none.
const Statement* FindProperty(const StageBody& body, const std::string& name);

// The define of that name that counts: the first one. Null: there is none.
const Statement* FindDefine(const StageSyntax& syntax, const std::string& name);

}  // namespace troupe
