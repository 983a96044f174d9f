#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "common/base/text.h"
#include "testing/expectations/syntax.h"

namespace troupe {
namespace {

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

// Words that are no names.
constexpr std::array<std::string_view, 13> kWords{"and",  "or",           "not",   "always", "eventually", "finally",
                                                  "once", "historically", "until", "since",  "forall",     "exists",
                                                  "in"};
constexpr std::array<std::string_view, 5> kNumberBinders{"min", "max", "sum", "mean", "count"};

enum class TokenKind : std::uint8_t { kEnd, kNumber, kText, kWord, kSign };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::size_t offset = 0;
  std::string text;  // of a text: without quotes; of a number: its unit
  double number = 0.0;
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

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

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
    if (IsLetter(c)) {
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

  std::string ReadWord() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && IsWordCharacter(text_[at_])) ++at_;
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
    const bool is_word = std::find(kWords.begin(), kWords.end(), word) != kWords.end();
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
  std::size_t at_ = 0;
};

class Parser {
 public:
  explicit Parser(std::vector<Token> tokens) : tokens_(std::move(tokens)) {}

  Result<Syntax> Whole() {
    Syntax syntax = Formula();
    if (!error_ && Now().kind != TokenKind::kEnd) {
      Fail(IsComparison(Now()) ? "'and' between two comparisons" : "an operator or the end of the expectation");
    }
    if (error_) return *error_;
    return syntax;
  }

  Result<MetricSyntax> WholeMetric() {
    MetricSyntax metric;
    if (IsWord("time") && IsWordAt(1, "of")) {
      at_ += 2;
      if (IsWord("first")) {
        metric.kind = MetricKind::kFirst;
      } else if (IsWord("last")) {
        metric.kind = MetricKind::kLast;
      } else {
        Fail("'first' or 'last' after 'time of'");
        return *error_;
      }
      ++at_;
    } else {
      constexpr std::array<std::pair<std::string_view, MetricKind>, 4> kKinds{{{"min", MetricKind::kMin},
                                                                               {"max", MetricKind::kMax},
                                                                               {"mean", MetricKind::kMean},
                                                                               {"final", MetricKind::kFinal}}};
      for (const auto& [word, kind] : kKinds) {
        if (!IsWord(word) || !IsWordAt(1, "of")) continue;
        metric.kind = kind;
        at_ += 2;
        break;
      }
    }
    Result<Syntax> of = Whole();
    if (!of.ok()) return of.error();
    metric.of = std::move(of).value();
    return metric;
  }

 private:
  const Token& Now() const { return tokens_[at_]; }
  const Token& Ahead(std::size_t count) const { return tokens_[std::min(at_ + count, tokens_.size() - 1)]; }
  bool IsWord(std::string_view word) const { return IsWordAt(0, word); }
  bool IsWordAt(std::size_t count, std::string_view word) const {
    return Ahead(count).kind == TokenKind::kWord && Ahead(count).text == word;
  }
  bool IsSign(std::string_view sign) const { return Now().kind == TokenKind::kSign && Now().text == sign; }
  static bool IsComparison(const Token& token) {
    return token.kind == TokenKind::kSign && (token.text == "<" || token.text == "<=" || token.text == ">" ||
                                              token.text == ">=" || token.text == "==" || token.text == "!=");
  }
  static bool IsNumberBinder(const std::string& word) {
    return std::find(kNumberBinders.begin(), kNumberBinders.end(), word) != kNumberBinders.end();
  }

  // "found X, expected `expected`"; the first error counts.
  void Fail(const std::string& expected) {
    if (error_) return;
    const Token& token = Now();
    std::string found = "'" + PlainLine(token.text, 40) + "'";
    if (token.kind == TokenKind::kEnd) found = "the end";
    if (token.kind == TokenKind::kNumber) found = "a number";
    if (token.kind == TokenKind::kText) found = "the text " + found;
    error_ = TextError(token.offset, "found " + found + ", expected " + expected);
  }
  void Expect(std::string_view sign, const std::string& after) {
    if (error_) return;
    if (!IsSign(sign)) {
      Fail("'" + std::string(sign) + "' " + after);
      return;
    }
    ++at_;
  }

  static Syntax Combine(SyntaxKind kind, const Token& token, std::vector<Syntax> children) {
    Syntax syntax;
    syntax.kind = kind;
    syntax.offset = token.offset;
    syntax.name = token.text;
    syntax.children = std::move(children);
    return syntax;
  }

  // Each rule returns anything once there is an error.
  class Depth {
   public:
    explicit Depth(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > kMaxExpectationDepth) parser_.Fail("fewer operators inside each other");
    }
    ~Depth() { --parser_.depth_; }

   private:
    Parser& parser_;
  };

  Syntax Formula() {
    const Depth depth(*this);
    if (error_) return {};
    Syntax left = Chain("or");
    if (error_ || !IsSign("->")) return left;
    const Token sign = tokens_[at_++];
    std::vector<Syntax> children;
    children.push_back(std::move(left));
    children.push_back(Formula());
    return Combine(SyntaxKind::kOperator, sign, std::move(children));
  }

  // Operands of "or", or of "and"; a chain of one operator is one node, so that a long one is not deep.
  Syntax Chain(std::string_view word) {
    Syntax first = word == "or" ? Chain("and") : Until();
    if (error_ || !IsWord(word)) return first;
    const Token token = Now();
    std::vector<Syntax> children;
    children.push_back(std::move(first));
    while (!error_ && IsWord(word)) {
      ++at_;
      children.push_back(word == "or" ? Chain("and") : Until());
    }
    return Combine(SyntaxKind::kOperator, token, std::move(children));
  }

  Syntax Until() {
    const Depth depth(*this);
    if (error_) return {};
    Syntax left = Unary();
    if (error_ || (!IsWord("until") && !IsWord("since"))) return left;
    const Token word = tokens_[at_++];
    std::optional<IntervalSyntax> interval;
    if (word.text == "until") interval = ReadInterval();
    std::vector<Syntax> children;
    children.push_back(std::move(left));
    children.push_back(Until());
    Syntax syntax = Combine(SyntaxKind::kTemporal, word, std::move(children));
    syntax.interval = interval;
    return syntax;
  }

  Syntax Unary() {
    const Depth depth(*this);
    if (error_) return {};
    if (IsWord("not")) {
      const Token word = tokens_[at_++];
      std::vector<Syntax> children;
      children.push_back(Unary());
      return Combine(SyntaxKind::kOperator, word, std::move(children));
    }
    for (const std::string_view name : {"always", "eventually", "historically", "once", "finally"}) {
      if (!IsWord(name)) continue;
      const Token word = tokens_[at_++];
      std::optional<IntervalSyntax> interval;
      if (name != "finally") interval = ReadInterval();
      std::vector<Syntax> children;
      children.push_back(Unary());
      Syntax syntax = Combine(SyntaxKind::kTemporal, word, std::move(children));
      syntax.interval = interval;
      return syntax;
    }
    return Comparison();
  }

  Syntax Comparison() {
    Syntax left = Sum("+", "-");
    if (error_ || !IsComparison(Now())) return left;
    const Token sign = tokens_[at_++];
    std::vector<Syntax> children;
    children.push_back(std::move(left));
    children.push_back(Sum("+", "-"));
    return Combine(SyntaxKind::kOperator, sign, std::move(children));
  }

  // Left-associative: each link makes the tree one deeper.
  Syntax Sum(std::string_view one, std::string_view other) {
    const bool is_sum = one == "+";
    Syntax left = is_sum ? Sum("*", "/") : Factor();
    std::size_t links = 0;
    while (!error_ && (IsSign(one) || IsSign(other))) {
      if (depth_ + ++links > kMaxExpectationDepth) Fail("fewer terms");
      const Token sign = tokens_[at_++];
      std::vector<Syntax> children;
      children.push_back(std::move(left));
      children.push_back(is_sum ? Sum("*", "/") : Factor());
      left = Combine(SyntaxKind::kOperator, sign, std::move(children));
    }
    return left;
  }

  Syntax Factor() {
    const Depth depth(*this);
    if (error_) return {};
    const Token token = Now();
    if (IsSign("-")) {
      ++at_;
      std::vector<Syntax> children;
      children.push_back(Factor());
      return Combine(SyntaxKind::kOperator, token, std::move(children));
    }
    if (IsSign("(")) {
      ++at_;
      Syntax inner = Formula();
      Expect(")", "after what '(' opened");
      return inner;
    }
    if (token.kind == TokenKind::kNumber) {
      ++at_;
      Syntax syntax;
      syntax.offset = token.offset;
      syntax.number = {token.number, token.text};
      return syntax;
    }
    if (token.kind == TokenKind::kText) {
      ++at_;
      return Combine(SyntaxKind::kText, token, {});
    }
    if (token.kind != TokenKind::kWord) {
      Fail("a signal, a number or '('");
      return {};
    }
    const bool binds_number = IsNumberBinder(token.text) && Ahead(1).kind == TokenKind::kWord && !IsWordAt(1, "in");
    if (token.text == "forall" || token.text == "exists" || binds_number) return Bound();
    const bool is_region_test = token.text == "in" && Ahead(1).kind == TokenKind::kSign && Ahead(1).text == "(";
    if (!is_region_test && std::find(kWords.begin(), kWords.end(), token.text) != kWords.end()) {
      const bool is_prefix = token.text == "not" || token.text == "always" || token.text == "eventually" ||
                             token.text == "finally" || token.text == "once" || token.text == "historically";
      Fail(is_prefix ? "a signal, a number or '(': '" + token.text + " ...' needs parentheses here"
                     : "a signal, a number or '('");
      return {};
    }
    ++at_;
    if (!IsSign("(")) return Combine(SyntaxKind::kName, token, {});
    ++at_;
    std::vector<Syntax> arguments;
    if (!IsSign(")")) {
      arguments.push_back(Formula());
      while (!error_ && IsSign(",")) {
        ++at_;
        arguments.push_back(Formula());
      }
    }
    Expect(")", "or ',' after an argument of '" + token.text + "'");
    return Combine(SyntaxKind::kCall, token, std::move(arguments));
  }

  Syntax Bound() {
    Syntax bound = Combine(SyntaxKind::kBound, tokens_[at_++], {});
    do {
      if (!bound.variables.empty()) ++at_;  // the comma
      const bool is_name =
          Now().kind == TokenKind::kWord && std::find(kWords.begin(), kWords.end(), Now().text) == kWords.end();
      if (!is_name) {
        Fail("the name of a variable");
        return {};
      }
      if (std::find(bound.variables.begin(), bound.variables.end(), Now().text) != bound.variables.end()) {
        Fail("another name: each variable once");
        return {};
      }
      if (bound.variables.size() == 4) {
        Fail("at most 4 variables");
        return {};
      }
      bound.variables.push_back(tokens_[at_++].text);
    } while (IsSign(","));
    if (IsWord("in")) {
      ++at_;
      bound.pattern_offset = Now().offset;
      bool names_domain = false;
      if (IsWord("robots") || IsWord("objects")) {
        bound.domain = IsWord("objects") ? DomainKind::kObjects : DomainKind::kRobots;
        names_domain = true;
        ++at_;
      }
      if (Now().kind == TokenKind::kText) {
        bound.pattern_offset = Now().offset;
        bound.pattern = tokens_[at_++].text;
      } else if (!names_domain) {
        Fail("robots, objects, or names as a text such as \"scout*\"");
        return {};
      }
    }
    Expect(":", "after the variables of '" + bound.name + "'");
    bound.children.push_back(Formula());
    return bound;
  }

  NumberSyntax ReadTime() {
    if (Now().kind != TokenKind::kNumber) {
      Fail("a time such as 10 s or 5 ticks");
      return {};
    }
    const Token& token = tokens_[at_++];
    return {token.number, token.text};
  }

  std::optional<IntervalSyntax> ReadInterval() {
    if (error_ || !IsSign("[")) return std::nullopt;
    IntervalSyntax interval;
    interval.offset = tokens_[at_++].offset;
    interval.from = ReadTime();
    Expect(",", "between the two times of an interval");
    if (IsWord("end")) {
      ++at_;
    } else if (!error_) {
      interval.to = ReadTime();
    }
    Expect("]", "after an interval");
    return interval;
  }

  std::vector<Token> tokens_;  // the last one is kEnd
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::optional<Error> error_;
};

Result<std::vector<Token>> Tokens(std::string_view text) {
  if (text.size() > kMaxExpectationLength) {
    return TextError(0, "found " + std::to_string(text.size()) + " bytes, expected at most " +
                            std::to_string(kMaxExpectationLength));
  }
  return Lexer(text).ReadAll();
}

std::string NumberText(double value) {
  std::array<char, 32> buffer{};
  const auto [end, problem] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  static_cast<void>(problem);  // the shortest text of any double fits
  return {buffer.data(), end};
}

std::string TextOf(const NumberSyntax& number) {
  return NumberText(number.value) + (number.unit.empty() || number.unit == "%" ? "" : " ") + number.unit;
}

std::string Quoted(const std::string& text) {
  const char quote = text.find('"') == std::string::npos ? '"' : '\'';
  return quote + text + quote;
}

// How strongly a node binds: the levels of the grammar.
int Level(const Syntax& syntax) {
  if (syntax.kind == SyntaxKind::kBound) return 0;
  if (syntax.kind == SyntaxKind::kTemporal) return syntax.children.size() == 2 ? 4 : 5;
  if (syntax.kind != SyntaxKind::kOperator) return 10;
  const std::string& name = syntax.name;
  if (name == "->") return 1;
  if (name == "or") return 2;
  if (name == "and") return 3;
  if (name == "not") return 5;
  if (name == "+" || (name == "-" && syntax.children.size() == 2)) return 7;
  if (name == "*" || name == "/") return 8;
  if (name == "-") return 9;
  return 6;
}

// The child, in parentheses if it binds less than `least`.
std::string Inside(const Syntax& child, int least) {
  const std::string text = ToString(child);
  return Level(child) < least ? "(" + text + ")" : text;
}

std::string TextOf(const std::optional<IntervalSyntax>& interval) {
  if (!interval) return {};
  return "[" + TextOf(interval->from) + ", " + (interval->to ? TextOf(*interval->to) : "end") + "]";
}

}  // namespace

Error TextError(std::size_t offset, std::string message) {
  return {{{}, 1, static_cast<int>(offset) + 1}, std::move(message), ErrorCode::kBadInput};
}

const Unit* FindUnit(std::string_view name) {
  const auto* const found = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
  return found == kUnits.end() ? nullptr : found;
}

std::string ToString(const Dimension& dimension) {
  if (dimension == Dimension{0, -1, 0, 1}) return "W";
  std::string over;
  std::string under;
  const auto add = [&](int exponent, const char* name) {
    std::string& text = exponent > 0 ? over : under;
    if (exponent == 0) return;
    if (!text.empty()) text += "*";
    text += name;
    if (std::abs(exponent) > 1) text += "^" + std::to_string(std::abs(exponent));
  };
  add(dimension.joule, "J");
  add(dimension.metre, "m");
  add(dimension.radian, "rad");
  add(dimension.second, "s");
  if (under.empty()) return over;
  return (over.empty() ? "1" : over) + "/" + (under.find('*') == std::string::npos ? under : "(" + under + ")");
}

Result<Syntax> ParseFormula(std::string_view text) {
  Result<std::vector<Token>> tokens = Tokens(text);
  if (!tokens.ok()) return tokens.error();
  return Parser(std::move(tokens).value()).Whole();
}

Result<MetricSyntax> ParseMetric(std::string_view text) {
  Result<std::vector<Token>> tokens = Tokens(text);
  if (!tokens.ok()) return tokens.error();
  return Parser(std::move(tokens).value()).WholeMetric();
}

std::string ToString(const Syntax& syntax) {
  const std::vector<Syntax>& children = syntax.children;
  switch (syntax.kind) {
    case SyntaxKind::kNumber:
      return TextOf(syntax.number);
    case SyntaxKind::kText:
      return Quoted(syntax.name);
    case SyntaxKind::kName:
      return syntax.name;
    case SyntaxKind::kCall: {
      std::string text = syntax.name + "(";
      for (std::size_t i = 0; i < children.size(); ++i) text += (i > 0 ? ", " : "") + ToString(children[i]);
      return text + ")";
    }
    case SyntaxKind::kOperator: {
      const int level = Level(syntax);
      if (syntax.name == "not") return "not " + Inside(children[0], 5);
      if (children.size() == 1) return syntax.name + Inside(children[0], 9);
      std::string text;
      for (std::size_t i = 0; i < children.size(); ++i) {
        // Sums group to the left, "->" to the right; chains of "and" and "or" are one node.
        const bool groups = (syntax.name == "->" && i == 1) || (level >= 7 && i == 0);
        if (i > 0) text += " " + syntax.name + " ";
        text += Inside(children[i], groups ? level : level + 1);
      }
      return text;
    }
    case SyntaxKind::kTemporal: {
      const std::string name = syntax.name + TextOf(syntax.interval) + " ";
      if (children.size() == 2) return Inside(children[0], 5) + " " + name + Inside(children[1], 4);
      return name + Inside(children[0], 5);
    }
    case SyntaxKind::kBound: {
      std::string text = syntax.name;
      for (std::size_t i = 0; i < syntax.variables.size(); ++i) text += (i > 0 ? ", " : " ") + syntax.variables[i];
      if (syntax.domain == DomainKind::kObjects) text += " in objects";
      if (syntax.pattern) text += (syntax.domain == DomainKind::kObjects ? " " : " in ") + Quoted(*syntax.pattern);
      return text + ": " + ToString(children[0]);
    }
  }
  return {};
}

std::string ToString(const MetricSyntax& metric) {
  constexpr std::array<const char*, 6> kBeginnings{"time of first ", "time of last ", "min of ",
                                                   "max of ",        "mean of ",      "final of "};
  return kBeginnings[static_cast<std::size_t>(metric.kind)] + ToString(metric.of);
}

}  // namespace troupe
