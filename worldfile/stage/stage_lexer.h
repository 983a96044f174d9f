// The lexer of the Stage worldfile language: characters to tokens.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "troupe/result.h"

namespace troupe {

enum class TokenKind {
  kWord,        // a letter, then letters, digits and . - _ [ ]
  kNumber,      // a sign, digits and a point; `number` is its value
  kString,      // in double quotes, which `text` leaves out
  kOpenBody,    // (
  kCloseBody,   // )
  kOpenTuple,   // [
  kCloseTuple,  // ]
  kEndOfLine,   // LF, CR, CRLF or LFCR
  kEndOfFile,
};

struct Token {
  TokenKind kind = TokenKind::kEndOfFile;
  std::string_view text;  // part of the lexer's text
  double number = 0.0;
  std::string_view file;
  int line = 0;    // from 1
  int column = 0;  // from 1, in bytes

  SourceLocation where() const { return {std::string(file), line, column}; }
};

// A token for messages: "word 'foo'", "the end of the line", ...
std::string Describe(const Token& token);

class StageLexer {
 public:
  // Both views must outlive the lexer and its tokens. `file` names the text in messages.
  StageLexer(std::string_view text, std::string_view file);

  // Skips blanks and comments. At the end it yields kEndOfFile, again and again.
  Result<Token> Next();

  // Skips to the end of the present line. True if it skipped more than blanks and a comment.
  bool SkipLine();

  std::string_view file() const { return file_; }
  // The place of a comment that is not UTF-8, once: worth a warning, because Stage reads it.
  std::optional<SourceLocation> PopOddComment() { return std::exchange(odd_comment_, std::nullopt); }

 private:
  char Peek() const { return position_ < text_.size() ? text_[position_] : '\0'; }
  bool AtEnd() const { return position_ >= text_.size(); }
  int Column() const { return static_cast<int>(position_ - line_start_) + 1; }
  Token Make(TokenKind kind, std::size_t start) const;
  Error Fail(std::size_t at, const std::string& message) const;
  Status SkipBlanksAndComment();
  Token EndOfLine();
  Result<Token> Word();
  Result<Token> Number();
  Result<Token> String();

  std::string_view text_;
  std::string_view file_;
  std::size_t position_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
  std::optional<SourceLocation> odd_comment_;
};

}  // namespace troupe
