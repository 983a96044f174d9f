#include "worldfile/edit/stage_syntax.h"

#include <utility>

#include "worldfile/stage/macro_expander.h"
#include "worldfile/stage/stage_lexer.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Kind = TokenKind;

class StageReader {
 public:
  StageReader(const std::string& text, const std::string& path) : text_(text), lexer_(text, path) {}

  Result<StageSyntax> Read() {
    if (Status error = Advance(); !error.ok()) return error.error();
    StageSyntax syntax;
    syntax.size = text_.size();
    if (Status error = ReadBody(syntax.statements, 0, nullptr); !error.ok()) return error.error();
    return syntax;
  }

 private:
  Status Advance() {
    Result<Token> next = lexer_.Next();
    if (!next.ok()) return next.error();
    token_ = next.value();
    return {};
  }

  Status SkipEndsOfLines() {
    while (token_.kind == Kind::kEndOfLine) {
      if (Status error = Advance(); !error.ok()) return error;
    }
    return {};
  }

  // The quotes of a string are in its span.
  TextSpan SpanOf(const Token& token) const {
    const auto begin = static_cast<std::size_t>(token.text.data() - text_.data());
    const std::size_t quote = token.kind == Kind::kString ? 1 : 0;
    return {begin - quote, begin + token.text.size() + quote};
  }

  Error Unexpected(const std::string& expected) const {
    return {token_.where(), "found " + Describe(token_) + ", expected " + expected};
  }

  // Up to, and not over, the closing bracket or the end of the file.
  Status ReadBody(std::vector<Statement>& statements, int depth, const Statement* opener) {
    if (depth > kMaxNesting) return Unexpected("fewer models inside each other");
    for (;;) {
      if (Status error = SkipEndsOfLines(); !error.ok()) return error;
      if (token_.kind == Kind::kEndOfFile && opener == nullptr) return {};
      if (token_.kind == Kind::kCloseBody && opener != nullptr) return {};
      if (token_.kind == Kind::kEndOfFile) {
        return Unexpected("')' to close " + Quoted(opener->name) + " of line " + std::to_string(opener->line));
      }
      if (token_.kind != Kind::kWord) {
        return Unexpected(opener != nullptr ? "a property, a model or ')'" : "a property or a model");
      }
      Statement statement;
      if (Status error = ReadStatement(statement, depth); !error.ok()) return error;
      statements.push_back(std::move(statement));
    }
  }

  void SetName(Statement& statement) const {
    statement.name = std::string(token_.text);
    statement.line = token_.line;
    statement.column = token_.column;
    statement.name_span = SpanOf(token_);
  }

  Status ReadStatement(Statement& statement, int depth) {
    statement.span.begin = SpanOf(token_).begin;
    SetName(statement);
    const std::string word = statement.name;
    if (Status error = Advance(); !error.ok()) return error;
    if (word == "include") return ReadInclude(statement);
    if (word == "define") {
      statement.kind = StatementKind::kDefine;
      if (token_.kind != Kind::kWord) return Unexpected("the name of a macro after 'define'");
      SetName(statement);
      if (Status error = Advance(); !error.ok()) return error;
      if (token_.kind != Kind::kWord) return Unexpected("the model type that it is made from");
      statement.base = std::string(token_.text);
      if (Status error = Advance(); !error.ok()) return error;
      return ReadBracketed(statement, depth);
    }
    if (token_.kind == Kind::kNumber || token_.kind == Kind::kString || token_.kind == Kind::kOpenTuple) {
      return ReadValue(statement);
    }
    statement.kind = StatementKind::kEntry;
    return ReadBracketed(statement, depth);
  }

  Status ReadInclude(Statement& statement) {
    statement.kind = StatementKind::kInclude;
    if (token_.kind != Kind::kString) return Unexpected("a file name in quotes after 'include'");
    statement.name = std::string(token_.text);
    statement.span.end = SpanOf(token_).end;
    lexer_.SkipLine();  // the rest of the line does not count
    return Advance();
  }

  Status ReadValue(Statement& statement) {
    statement.value = SpanOf(token_);
    if (token_.kind == Kind::kOpenTuple) {
      for (;;) {
        if (Status error = Advance(); !error.ok()) return error;
        if (token_.kind == Kind::kCloseTuple) break;
        if (token_.kind != Kind::kNumber && token_.kind != Kind::kString) {
          return Unexpected("a number, a string in quotes, or ']' on the line of its '['");
        }
        statement.elements.push_back(SpanOf(token_));
      }
    }
    statement.span.end = statement.value.end = SpanOf(token_).end;
    return Advance();
  }

  Status ReadBracketed(Statement& statement, int depth) {
    if (Status error = SkipEndsOfLines(); !error.ok()) return error;
    if (token_.kind != Kind::kOpenBody) return Unexpected("a value or '(' after " + Quoted(statement.name));
    statement.body.begin = SpanOf(token_).end;
    if (Status error = Advance(); !error.ok()) return error;
    if (Status error = ReadBody(statement.statements, depth + 1, &statement); !error.ok()) return error;
    statement.body.end = SpanOf(token_).begin;
    statement.span.end = SpanOf(token_).end;
    return Advance();
  }

  const std::string& text_;
  StageLexer lexer_;
  Token token_;
};

bool Find(const std::vector<Statement>& statements, int line, int column, std::vector<const Statement*>& found) {
  for (const Statement& statement : statements) {
    found.push_back(&statement);
    if (statement.line == line && statement.column == column) return true;
    if (Find(statement.statements, line, column, found)) return true;
    found.pop_back();
  }
  return false;
}

}  // namespace

Result<StageSyntax> ReadStageSyntax(const std::string& text, const std::string& path) {
  return StageReader(text, path).Read();
}

std::vector<const Statement*> FindStatement(const StageSyntax& syntax, int line, int column) {
  std::vector<const Statement*> found;
  Find(syntax.statements, line, column, found);
  return found;
}

const Statement* FindProperty(const StageBody& body, const std::string& name) {
  const Statement* found = nullptr;
  for (const Statement& statement : *body.statements) {
    if (statement.kind == StatementKind::kProperty && statement.name == name) found = &statement;
  }
  return found;
}

const Statement* FindDefine(const StageSyntax& syntax, const std::string& name) {
  for (const Statement& statement : syntax.statements) {
    if (statement.kind == StatementKind::kDefine && statement.name == name) return &statement;
  }
  return nullptr;
}

}  // namespace troupe
