#include "worldfile/stage/stage_tree.h"

#include <optional>
#include <utility>

namespace troupe {
namespace {

enum class TokenKind {
  kWord,        // a letter, then letters, digits and . - _ [ ]
  kNumber,      // a sign, digits and a point
  kString,      // in double quotes
  kOpenBody,    // (
  kCloseBody,   // )
  kOpenTuple,   // [
  kCloseTuple,  // ]
  kEndOfLine,   // LF, CR, CRLF or LFCR
  kEndOfFile,
};

struct Token {
  TokenKind kind = TokenKind::kEndOfFile;
  TextSpan span;
  std::string_view text;  // of a string, without its quotes
  double number = 0.0;
  int line = 0;
  int column = 0;
};

// "word 'foo'", "the end of the line", ...
std::string Describe(const Token& token) {
  switch (token.kind) {
    case TokenKind::kWord:
      return Quoted(token.text);
    case TokenKind::kNumber:
      return "number " + Quoted(token.text);
    case TokenKind::kString:
      return "string " + Quoted(token.text);
    case TokenKind::kEndOfLine:
      return "the end of the line";
    case TokenKind::kEndOfFile:
      return "the end of the file";
    default:
      return Quoted(token.text);  // a bracket
  }
}

// Not the C library's functions, which depend on the locale.
bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool IsBlank(char c) {
  return c == ' ' || c == '\t';
}
bool IsEndOfLine(char c) {
  return c == '\n' || c == '\r';
}
bool IsNumberPart(char c) {
  return IsDigit(c) || c == '+' || c == '-' || c == '.';
}
bool IsWordPart(char c) {
  return IsLetter(c) || IsDigit(c) || c == '.' || c == '-' || c == '_' || c == '[' || c == ']';
}

// "name" or "name[digits]".
bool BracketsAreAnIndex(std::string_view word) {
  const std::size_t open = word.find('[');
  if (open == std::string_view::npos) return word.find(']') == std::string_view::npos;
  if (word.back() != ']' || open + 2 >= word.size()) return false;
  for (const char c : word.substr(open + 1, word.size() - open - 2)) {
    if (!IsDigit(c)) return false;
  }
  return true;
}

// Characters to tokens. Next and what it calls return false at a fault.
class Lexer {
 public:
  Lexer(std::string_view text, const std::string& path, std::vector<Warning>& warnings)
      : text_(text), path_(path), warnings_(warnings) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text_.starts_with(kByteOrderMark)) at_ = line_start_ = kByteOrderMark.size();
  }

  // Skips blanks and comments. At the end it yields kEndOfFile, again and again.
  bool Next(Token& token) {
    if (!SkipBlanksAndComment()) return false;
    begin_ = at_;
    if (AtEnd()) return Make(TokenKind::kEndOfFile, token);
    const char c = Peek();
    if (IsEndOfLine(c)) return EndOfLine(token);
    if (IsLetter(c)) return Word(token);
    if (IsNumberPart(c)) return Number(token);
    if (c == '"') return String(token);
    constexpr std::string_view kBrackets = "()[]";
    constexpr TokenKind kKinds[] = {TokenKind::kOpenBody, TokenKind::kCloseBody, TokenKind::kOpenTuple,
                                    TokenKind::kCloseTuple};
    const std::size_t i = kBrackets.find(c);
    if (i == std::string_view::npos) {
      return Fail(begin_, "found " + Quoted(text_.substr(at_, 1)) + ", expected a name, a value or a bracket");
    }
    ++at_;
    return Make(kKinds[i], token);
  }

  // Skips to the end of the present line. True if it skipped more than blanks and a comment.
  bool SkipLine() {
    bool skipped = false;
    bool comment = false;
    for (; !AtEnd() && !IsEndOfLine(Peek()); ++at_) {
      comment = comment || Peek() == '#';
      skipped = skipped || (!comment && !IsBlank(Peek()));
    }
    return skipped;
  }

  const Error& error() const { return *error_; }

 private:
  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool AtEnd() const { return at_ >= text_.size(); }
  SourceLocation WhereOnLine(std::size_t offset) const {
    return {path_, line_, static_cast<int>(offset - line_start_) + 1};
  }
  bool Fail(std::size_t offset, std::string message) {
    error_ = Error{WhereOnLine(offset), std::move(message)};
    return false;
  }
  std::string_view Text() const { return text_.substr(begin_, at_ - begin_); }

  bool Make(TokenKind kind, Token& token) const {
    token = {kind, {begin_, at_}, Text(), 0.0, line_, static_cast<int>(begin_ - line_start_) + 1};
    return true;
  }

  bool SkipBlanksAndComment() {
    while (IsBlank(Peek())) ++at_;
    if (Peek() != '#') return true;
    const std::size_t begin = at_;
    while (!AtEnd() && !IsEndOfLine(Peek())) ++at_;
    const std::string_view comment = text_.substr(begin, at_ - begin);
    if (const std::size_t nul = comment.find('\0'); nul != std::string_view::npos) {
      return Fail(begin + nul, "found a NUL byte, expected text");
    }
    // One warning for a file: a comment in Latin-1 is seldom alone.
    if (has_odd_comment_) return true;
    if (const std::size_t odd = FindInvalidUtf8(comment); odd != std::string_view::npos) {
      warnings_.push_back({WhereOnLine(begin + odd), "a comment is not UTF-8"});  // Stage reads it
      has_odd_comment_ = true;
    }
    return true;
  }

  bool EndOfLine(Token& token) {
    const char first = text_[at_++];
    // CRLF and LFCR are one line end, LFLF are two: line numbers agree with editors.
    if (IsEndOfLine(Peek()) && Peek() != first) ++at_;
    Make(TokenKind::kEndOfLine, token);
    ++line_;
    line_start_ = at_;
    return true;
  }

  bool Word(Token& token) {
    while (IsWordPart(Peek())) ++at_;
    if (BracketsAreAnIndex(Text())) return Make(TokenKind::kWord, token);
    return Fail(begin_, "found " + Quoted(Text()) + ", expected a blank before '[', or an index as in 'point[0]'");
  }

  bool Number(Token& token) {
    while (IsNumberPart(Peek())) ++at_;
    if (IsLetter(Peek()) || Peek() == '_') {
      while (IsWordPart(Peek())) ++at_;
      return Fail(begin_, "found " + Quoted(Text()) + ", expected a plain decimal number (without exponent or unit)");
    }
    Make(TokenKind::kNumber, token);
    // Longer ones overflow a double or are a fault of the file's generator.
    constexpr std::size_t kMaxDigits = 300;
    if (token.text.size() > kMaxDigits) {
      return Fail(begin_, "found " + Quoted(token.text) + ", expected a number of fewer digits");
    }
    const std::optional<LeadingNumber> number = ReadLeadingNumber(token.text);
    token.number = number ? number->value : 0.0;
    if (!number || !number->is_all) {  // as in Stage
      warnings_.push_back({WhereOnLine(begin_), "found " + Quoted(token.text) +
                                                    ", expected a number such as 1, -0.5 or .25; it is read as " +
                                                    NumberText(token.number)});
    }
    return true;
  }

  bool String(Token& token) {
    ++at_;
    while (!AtEnd() && Peek() != '"' && !IsEndOfLine(Peek())) ++at_;
    const std::string_view content = text_.substr(begin_ + 1, at_ - begin_ - 1);
    if (Peek() != '"') {
      return Fail(begin_, "found a string that does not end on its line, expected '\"' after " + Quoted(content));
    }
    ++at_;
    if (const std::size_t nul = content.find('\0'); nul != std::string_view::npos) {
      return Fail(begin_ + 1 + nul, "found a NUL byte, expected text");
    }
    if (const std::size_t odd = FindInvalidUtf8(content); odd != std::string_view::npos) {
      warnings_.push_back({WhereOnLine(begin_ + 1 + odd), "found a byte that is not UTF-8 in string " +
                                                              Quoted(content) + "; the string is read as Latin-1"});
    }
    Make(TokenKind::kString, token);
    token.text = content;
    return true;
  }

  const std::string_view text_;
  const std::string& path_;
  std::vector<Warning>& warnings_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;  // of the token
  std::size_t line_start_ = 0;
  int line_ = 1;
  bool has_odd_comment_ = false;
  std::optional<Error> error_;
};

// A recursive descent parser, one token ahead. Its methods return false at a fault.
class Parser {
 public:
  Parser(StageTree& tree, StageItemCount& count)
      : tree_(tree), count_(count), lexer_(*tree.text, tree.path, tree.warnings) {}

  Status ParseFile() {
    if (Advance() && ParseBody(tree_.statements, nullptr, 0)) return {};
    return error_ ? *error_ : lexer_.error();
  }

 private:
  using Kind = TokenKind;

  bool Advance() { return lexer_.Next(token_); }
  bool AdvanceOverLines() {
    while (Advance()) {
      if (token_.kind != Kind::kEndOfLine) return true;
    }
    return false;
  }
  bool SkipLines() { return token_.kind != Kind::kEndOfLine || AdvanceOverLines(); }

  bool Fail(int line, int column, std::string message) {
    error_ = Error{{tree_.path, line, column}, std::move(message)};
    return false;
  }
  bool Unexpected(const Token& token, const std::string& expected) {
    return Fail(token.line, token.column, "found " + Describe(token) + ", expected " + expected);
  }
  bool Unexpected(const std::string& expected) { return Unexpected(token_, expected); }

  bool CountItem(int line, int column) {
    if (++count_.found <= count_.most) return true;
    return Fail(line, column,
                "found more than " + std::to_string(count_.most) + " models and properties, expected fewer");
  }

  // Up to, and not over, the closing bracket of `opener`, or the end of the file if that is null.
  bool ParseBody(std::vector<Statement>& statements, const Statement* opener, int depth) {
    if (depth > kMaxNesting) {
      return Fail(opener->line, opener->column,
                  "found more than " + std::to_string(kMaxNesting) + " models inside each other, expected fewer");
    }
    for (;;) {
      if (!SkipLines()) return false;
      if (token_.kind == Kind::kCloseBody && opener != nullptr) return true;
      if (token_.kind == Kind::kEndOfFile) {
        if (opener == nullptr) return true;
        return Unexpected("')' to close " + Quoted(opener->name) + " of line " + std::to_string(opener->line));
      }
      if (token_.kind != Kind::kWord) {
        return Unexpected(opener != nullptr ? "a property, a model or ')'" : "a property or a model");
      }
      if (!ParseStatement(statements.emplace_back(), opener, depth)) return false;
    }
  }

  void SetName(Statement& statement) const {
    statement.name = token_.text;
    statement.line = token_.line;
    statement.column = token_.column;
  }

  bool ParseStatement(Statement& statement, const Statement* opener, int depth) {
    statement.span.begin = token_.span.begin;
    SetName(statement);
    if (token_.text == "include") return ParseInclude(statement);
    if (token_.text == "define") {
      if (opener == nullptr) return ParseDefine(statement);
      return Fail(token_.line, token_.column,
                  "found 'define' inside " + Quoted(opener->name) + ", expected it at the top level");
    }
    if (!CountItem(token_.line, token_.column) || !Advance()) return false;
    if (token_.kind == Kind::kNumber || token_.kind == Kind::kString) {
      statement.value = token_.span;
      statement.number = token_.number;
      statement.span.end = token_.span.end;
      return Advance();
    }
    if (token_.kind == Kind::kOpenTuple) return ParseTuple(statement);
    // Only an opening bracket may be on a later line.
    const Token after_name = token_;
    if (!SkipLines()) return false;
    if (token_.kind == Kind::kOpenBody) return ParseBracketed(statement, StatementKind::kEntry, depth);
    return Unexpected(after_name, "a number, a string in quotes, '[' or '(' after " + Quoted(statement.name));
  }

  bool ParseInclude(Statement& statement) {
    statement.kind = StatementKind::kInclude;
    if (!Advance()) return false;
    if (token_.kind != Kind::kString) return Unexpected("a file name in quotes after 'include'");
    SetName(statement);
    statement.span.end = token_.span.end;
    // Before Advance, which would read the rest of the line as a statement.
    if (lexer_.SkipLine()) {
      tree_.warnings.push_back({tree_.Where(statement), "the text after an include on its line is ignored"});
    }
    return Advance();
  }

  bool ParseDefine(Statement& statement) {
    if (!Advance()) return false;
    if (token_.kind != Kind::kWord) return Unexpected("the name of a macro after 'define'");
    SetName(statement);
    if (!Advance()) return false;
    const std::string name = Quoted(statement.name);
    if (token_.kind != Kind::kWord) return Unexpected("the model type that " + name + " is made from");
    statement.base = token_.text;
    if (!AdvanceOverLines()) return false;
    if (token_.kind != Kind::kOpenBody) return Unexpected("'(' to open the body of macro " + name);
    return ParseBracketed(statement, StatementKind::kDefine, 0);
  }

  bool ParseTuple(Statement& statement) {
    statement.value.begin = token_.span.begin;
    const int line = token_.line;
    const int column = token_.column;
    for (;;) {
      if (!Advance()) return false;
      if (token_.kind == Kind::kCloseTuple) break;
      if (token_.kind != Kind::kNumber && token_.kind != Kind::kString) {
        return Unexpected("a number, a string in quotes, or ']' on the line of its '['");
      }
      if (!CountItem(line, column)) return false;
      statement.elements.push_back({token_.span, token_.number});
    }
    statement.value.end = statement.span.end = token_.span.end;
    return Advance();
  }

  // REQUIRES: the token is '('.
  bool ParseBracketed(Statement& statement, StatementKind kind, int depth) {
    statement.kind = kind;
    statement.body.begin = token_.span.end;
    if (!Advance() || !ParseBody(statement.statements, &statement, depth + 1)) return false;
    statement.body.end = token_.span.begin;
    statement.span.end = token_.span.end;
    return Advance();
  }

  StageTree& tree_;
  StageItemCount& count_;
  Lexer lexer_;
  Token token_;
  std::optional<Error> error_;  // of the parser
};

bool Find(const std::vector<Statement>& statements, int line, int column, std::vector<const Statement*>& found) {
  for (const Statement& statement : statements) {
    found.push_back(&statement);
    // A place, not a pointer, identifies a statement across edits: an editor holds lines and columns.
    if (statement.line == line && statement.column == column) return true;
    if (Find(statement.statements, line, column, found)) return true;
    found.pop_back();
  }
  return false;
}

}  // namespace

SourceLocation StageTree::Where(const Statement& statement, std::size_t offset) const {
  const auto name = statement.name.data() - text->data();
  return {path, statement.line, statement.column + static_cast<int>(static_cast<std::ptrdiff_t>(offset) - name)};
}

Result<StageTree> ParseStage(std::string text, const std::string& path, StageItemCount& count) {
  StageTree tree{path, std::make_shared<const std::string>(std::move(text)), {}, {}};
  if (Status error = Parser(tree, count).ParseFile(); !error.ok()) return error.error();
  return tree;
}

std::vector<const Statement*> FindStatement(const StageTree& tree, int line, int column) {
  std::vector<const Statement*> found;
  Find(tree.statements, line, column, found);
  return found;
}

const Statement* FindProperty(const StageBody& body, std::string_view name) {
  const Statement* found = nullptr;
  for (const Statement& statement : *body.statements) {
    if (statement.kind == StatementKind::kProperty && statement.name == name) found = &statement;
  }
  return found;
}

const Statement* FindDefine(const StageTree& tree, std::string_view name) {
  for (const Statement& statement : tree.statements) {
    if (statement.kind == StatementKind::kDefine && statement.name == name) return &statement;
  }
  return nullptr;
}

}  // namespace troupe
