#include "worldfile/stage/stage_lexer.h"

#include <charconv>
#include <system_error>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

// Not the C library's functions: those depend on the locale.
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

}  // namespace

std::string Describe(const Token& token) {
  switch (token.kind) {
    case TokenKind::kWord:
      return Quoted(token.text);
    case TokenKind::kNumber:
      return "number " + Quoted(token.text);
    case TokenKind::kString:
      return "string " + Quoted(token.text);
    case TokenKind::kOpenBody:
      return "'('";
    case TokenKind::kCloseBody:
      return "')'";
    case TokenKind::kOpenTuple:
      return "'['";
    case TokenKind::kCloseTuple:
      return "']'";
    case TokenKind::kEndOfLine:
      return "the end of the line";
    case TokenKind::kEndOfFile:
      return "the end of the file";
  }
  return "";
}

StageLexer::StageLexer(std::string_view text, std::string_view file) : text_(text), file_(file) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text_.substr(0, kByteOrderMark.size()) == kByteOrderMark) text_.remove_prefix(kByteOrderMark.size());
}

Result<Token> StageLexer::Next() {
  if (Status error = SkipBlanksAndComment(); !error.ok()) return error.error();
  const std::size_t start = position_;
  if (AtEnd()) return Make(TokenKind::kEndOfFile, start);
  const char c = Peek();
  if (IsEndOfLine(c)) return EndOfLine();
  if (IsLetter(c)) return Word();
  if (IsNumberPart(c)) return Number();
  if (c == '"') return String();
  constexpr std::string_view kPunctuation = "()[]";
  constexpr TokenKind kKinds[] = {TokenKind::kOpenBody, TokenKind::kCloseBody, TokenKind::kOpenTuple,
                                  TokenKind::kCloseTuple};
  if (const std::size_t i = kPunctuation.find(c); i != std::string_view::npos) {
    ++position_;
    return Make(kKinds[i], start);
  }
  return Fail(start, "found " + Quoted(text_.substr(start, 1)) + ", expected a name, a value or a bracket");
}

bool StageLexer::SkipLine() {
  bool skipped = false;
  bool comment = false;
  for (; !AtEnd() && !IsEndOfLine(Peek()); ++position_) {
    comment = comment || Peek() == '#';
    skipped = skipped || (!comment && !IsBlank(Peek()));
  }
  return skipped;
}

Token StageLexer::Make(TokenKind kind, std::size_t start) const {
  Token token;
  token.kind = kind;
  token.text = text_.substr(start, position_ - start);
  token.file = file_;
  token.line = line_;
  token.column = static_cast<int>(start - line_start_) + 1;
  return token;
}

Error StageLexer::Fail(std::size_t at, const std::string& message) const {
  return Error{{std::string(file_), line_, static_cast<int>(at - line_start_) + 1}, message};
}

Status StageLexer::SkipBlanksAndComment() {
  while (IsBlank(Peek())) ++position_;
  if (Peek() != '#') return Status();
  const std::size_t start = position_;
  while (!AtEnd() && !IsEndOfLine(Peek())) ++position_;
  const std::string_view comment = text_.substr(start, position_ - start);
  if (const std::size_t nul = comment.find('\0'); nul != std::string_view::npos) {
    return Fail(start + nul, "found a NUL byte, expected text");
  }
  if (!odd_comment_) {
    if (const std::size_t odd = FindInvalidUtf8(comment); odd != std::string_view::npos) {
      odd_comment_ = Fail(start + odd, "").where;
    }
  }
  return Status();
}

Token StageLexer::EndOfLine() {
  const char first = Peek();
  const std::size_t start = position_++;
  if (!AtEnd() && IsEndOfLine(Peek()) && Peek() != first) ++position_;
  const Token token = Make(TokenKind::kEndOfLine, start);
  ++line_;
  line_start_ = position_;
  return token;
}

Result<Token> StageLexer::Word() {
  const std::size_t start = position_;
  while (!AtEnd() && IsWordPart(Peek())) ++position_;
  const Token token = Make(TokenKind::kWord, start);
  if (!BracketsAreAnIndex(token.text)) {
    return Fail(start, "found " + Quoted(token.text) + ", expected a blank before '[', or an index as in 'point[0]'");
  }
  return token;
}

Result<Token> StageLexer::Number() {
  const std::size_t start = position_;
  while (!AtEnd() && IsNumberPart(Peek())) ++position_;
  Token token = Make(TokenKind::kNumber, start);
  if (!AtEnd() && (IsLetter(Peek()) || Peek() == '_')) {
    while (!AtEnd() && IsWordPart(Peek())) ++position_;
    const std::string_view text = text_.substr(start, position_ - start);
    return Fail(start, "found " + Quoted(text) + ", expected a plain decimal number (without exponent or unit)");
  }
  std::string_view digits = token.text;
  if (digits.front() == '+' && digits.substr(1, 1) != "-") digits.remove_prefix(1);
  const char* const end = digits.data() + digits.size();
  const std::from_chars_result read = std::from_chars(digits.data(), end, token.number);
  if (read.ec == std::errc::result_out_of_range && read.ptr == end) {
    return Fail(start, "found " + Quoted(token.text) + ", expected a number of fewer digits");
  }
  if (read.ec != std::errc() || read.ptr != end) {
    return Fail(start, "found " + Quoted(token.text) + ", expected a number such as 1, -0.5 or .25");
  }
  return token;
}

Result<Token> StageLexer::String() {
  const std::size_t start = position_++;
  while (!AtEnd() && Peek() != '"' && !IsEndOfLine(Peek())) ++position_;
  const std::string_view content = text_.substr(start + 1, position_ - start - 1);
  if (AtEnd() || Peek() != '"') {
    return Fail(start, "found a string that does not end on its line, expected '\"' after " + Quoted(content));
  }
  ++position_;
  if (const std::size_t nul = content.find('\0'); nul != std::string_view::npos) {
    return Fail(start + 1 + nul, "found a NUL byte, expected text");
  }
  if (const std::size_t odd = FindInvalidUtf8(content); odd != std::string_view::npos) {
    return Fail(start + 1 + odd, "found a byte that is not UTF-8 in a string, expected UTF-8 text");
  }
  Token token = Make(TokenKind::kString, start);
  token.text = content;
  return token;
}

}  // namespace troupe
