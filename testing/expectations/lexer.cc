#include "testing/expectations/lexer.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "common/base/text.h"

namespace troupe {
namespace {

// Factors to SI; the dimension has exponents of m, s, rad and J. A tick has that of a time, whose length is the
// world's.
constexpr std::array kUnits{
    Unit{"m/s^2", 1.0, {1, -2, 0, 0}},
    Unit{"m/s", 1.0, {1, -1, 0, 0}},
    Unit{"km/h", 1.0 / 3.6, {1, -1, 0, 0}},
    Unit{"rad/s", 1.0, {0, -1, 1, 0}},
    Unit{"deg/s", 0.017453292519943295, {0, -1, 1, 0}},
    Unit{"ticks", 1.0, {0, 1, 0, 0}},
    Unit{"tick", 1.0, {0, 1, 0, 0}},
    Unit{"mm", 1e-3, {1, 0, 0, 0}},
    Unit{"cm", 1e-2, {1, 0, 0, 0}},
    Unit{"km", 1e3, {1, 0, 0, 0}},
    Unit{"m", 1.0, {1, 0, 0, 0}},
    Unit{"ms", 1e-3, {0, 1, 0, 0}},
    Unit{"min", 60.0, {0, 1, 0, 0}},
    Unit{"s", 1.0, {0, 1, 0, 0}},
    Unit{"h", 3600.0, {0, 1, 0, 0}},
    Unit{"rad", 1.0, {0, 0, 1, 0}},
    Unit{"deg", 0.017453292519943295, {0, 0, 1, 0}},
    Unit{"kJ", 1e3, {0, 0, 0, 1}},
    Unit{"Wh", 3600.0, {0, 0, 0, 1}},
    Unit{"J", 1.0, {0, 0, 0, 1}},
    Unit{"W", 1.0, {0, -1, 0, 1}},
    Unit{"%", 1e-2, {}},
};

bool IsLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsWordCharacter(char c) {
  return IsLetter(c) || IsDigit(c);
}
bool IsSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// Offsets are bytes of the text, so that errors name the column.
class Lexer {
 public:
  explicit Lexer(std::string_view text, NameSyntax names = NameSyntax::kWord) : text_(text), names_(names) {}

  Result<std::vector<Token>> ReadAll() {
    std::vector<Token> tokens;
    do {
      Result<Token> token = Read();
      if (!token.ok()) return token.error();
      tokens.push_back(std::move(token).value());
    } while (tokens.back().kind != TokenKind::kEnd);
    return tokens;
  }

 private:
  Result<Token> Read() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
    Token token{TokenKind::kEnd, at_, {}, 0.0};
    if (at_ == text_.size()) return token;
    const char c = text_[at_];
    if (IsDigit(c) || (c == '.' && at_ + 1 < text_.size() && IsDigit(text_[at_ + 1]))) return ReadNumber();
    if (c == '\'' || c == '"') return ReadText();
    if (IsLetter(c) || (c == '$' && IsOfPath(c))) {
      token.kind = TokenKind::kWord;
      token.text = ReadWord();
      return token;
    }
    token.kind = TokenKind::kSign;
    for (const std::string_view sign : {"->", "<=", ">=", "==", "!="}) {
      if (text_.substr(at_).starts_with(sign)) {
        token.text = sign;
        at_ += sign.size();
        return token;
      }
    }
    if (std::string_view("()[],:<>+-*/").find(c) != std::string_view::npos) {
      token.text = c;
      ++at_;
      return token;
    }
    std::string hint;
    if (c == '=') hint = "; did you mean '=='?";
    if (c == '&') hint = "; did you mean 'and'?";
    if (c == '|') hint = "; did you mean 'or'?";
    if (c == '!') hint = "; did you mean 'not'?";
    const std::size_t length = std::max<std::size_t>(Utf8Length(text_, at_), 1);
    return TextError(
        at_, "found '" + PlainLine(text_.substr(at_, length)) + "', expected a name, a number or an operator" + hint);
  }

  // In constraints of tests a name is a path of values, "spawn[0].count".
  bool IsOfPath(char c) const { return names_ == NameSyntax::kPath && (c == '.' || c == '[' || c == '$'); }

  std::string ReadWord() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (IsWordCharacter(text_[at_]) || IsOfPath(text_[at_]))) {
      const char c = text_[at_++];
      // Keys and names of a path may be in quotes; names may have any characters but ']' without.
      if (!IsOfPath(c)) continue;
      if (at_ < text_.size() && text_[at_] == '"') at_ = std::min(text_.find('"', at_ + 1), text_.size() - 1) + 1;
      if (c == '[') at_ = std::min(text_.find(']', at_), text_.size() - 1) + 1;
    }
    return std::string(text_.substr(begin, at_ - begin));
  }

  Result<Token> ReadText() {
    const std::size_t begin = at_;
    const std::size_t end = text_.find(text_[begin], begin + 1);
    if (end == std::string_view::npos) {
      return TextError(begin, "found a text without an end, expected a second " + std::string(1, text_[begin]));
    }
    at_ = end + 1;
    return Token{TokenKind::kText, begin, std::string(text_.substr(begin + 1, end - begin - 1)), 0.0};
  }

  // A word behind a number that is neither a unit nor reserved is an error here, as no rule allows it.
  Result<Token> ReadNumber() {
    Token token{TokenKind::kNumber, at_, {}, 0.0};
    const char* const begin = text_.data() + at_;
    const auto [end, problem] = std::from_chars(begin, text_.data() + text_.size(), token.number);
    if (problem != std::errc() || !std::isfinite(token.number)) {
      return TextError(at_, "found a number that is too large or too small");
    }
    at_ += static_cast<std::size_t>(end - begin);
    std::size_t next = at_;
    while (next < text_.size() && IsSpace(text_[next])) ++next;
    const std::string_view rest = text_.substr(next);
    for (const Unit& unit : kUnits) {  // longer names first, where one begins another
      const std::string_view name = unit.name;
      const bool ends =
          rest.size() == name.size() || (rest.size() > name.size() && !IsWordCharacter(rest[name.size()]));
      if (rest.starts_with(name) && (ends || name == "%")) {
        token.text = name == "tick" ? "ticks" : name;
        at_ = next + name.size();
        return token;
      }
    }
    if (rest.empty() || !IsLetter(rest.front())) return token;
    const std::size_t length =
        static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), IsWordCharacter) - rest.begin());
    const std::string word(rest.substr(0, length));
    const bool is_word = std::find(kReservedWords.begin(), kReservedWords.end(), word) != kReservedWords.end();
    if (is_word) return token;
    std::vector<std::string> names;
    for (const Unit& unit : kUnits) names.emplace_back(unit.name);
    std::string hint = DidYouMean(word, names);
    if (word == "seconds" || word == "sec") hint = "; did you mean 's'?";
    if (word == "meters" || word == "metres" || word == "meter") hint = "; did you mean 'm'?";
    if (word == "degrees") hint = "; did you mean 'deg'?";
    return TextError(next, "found unit '" + word + "', expected a unit such as m, s, ticks, deg, m/s or J" + hint);
  }

  std::string_view text_;
  NameSyntax names_;
  std::size_t at_ = 0;
};

}  // namespace

Result<std::vector<Token>> Tokens(std::string_view text, NameSyntax names) {
  if (text.size() > kMaxExpectationLength) {
    return TextError(0, "found " + std::to_string(text.size()) + " bytes, expected at most " +
                            std::to_string(kMaxExpectationLength));
  }
  return Lexer(text, names).ReadAll();
}

Error TextError(std::size_t offset, std::string message) {
  return {{{}, 1, static_cast<int>(offset) + 1}, std::move(message), ErrorCode::kBadInput};
}

const Unit* FindUnit(std::string_view name) {
  const auto* const found = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
  return found == kUnits.end() ? nullptr : found;
}

}  // namespace troupe
