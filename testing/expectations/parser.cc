#include <algorithm>
#include <array>
#include <utility>

#include "common/base/text.h"
#include "testing/expectations/lexer.h"

namespace troupe {
namespace {

constexpr std::array<std::string_view, 5> kNumberBinders{"min", "max", "sum", "mean", "count"};

// Recursive descent, a function for each level of precedence; docs/testing.md lists the operators. The first error ends
// the parse, and its position is that of the token.
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
  // The limit protects the stack of parser, compiler and printer, which are recursive.
  class Depth {
   public:
    explicit Depth(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > kMaxExpectationDepth) parser_.Fail("fewer operators inside each other");
    }
    ~Depth() { --parser_.depth_; }

   private:
    Parser& parser_;
  };

  // "->" is the weakest operator, and associates to the right.
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

  // Associates to the right, as usual for temporal operators.
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

  // Prefix operators bind more than until, and less than comparisons.
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

  // min, max and count are functions before '(' and quantifiers before a variable.
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
    if (!is_region_test &&
        std::find(kReservedWords.begin(), kReservedWords.end(), token.text) != kReservedWords.end()) {
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

  // The formula behind ':' reaches as far as possible.
  Syntax Bound() {
    Syntax bound = Combine(SyntaxKind::kBound, tokens_[at_++], {});
    do {
      if (!bound.variables.empty()) ++at_;  // the comma
      const bool is_name = Now().kind == TokenKind::kWord &&
                           std::find(kReservedWords.begin(), kReservedWords.end(), Now().text) == kReservedWords.end();
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
      bound.domain_offset = bound.pattern_offset = Now().offset;
      const bool names_domain = Now().kind == TokenKind::kWord;
      if (names_domain) bound.domain = tokens_[at_++].text;
      if (Now().kind == TokenKind::kText) {
        bound.pattern_offset = Now().offset;
        bound.pattern = tokens_[at_++].text;
      } else if (!names_domain) {
        Fail("robots, objects, people, doors or the like, or names as a text such as \"scout*\"");
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

}  // namespace

Result<Syntax> ParseFormula(std::string_view text, NameSyntax names) {
  Result<std::vector<Token>> tokens = Tokens(text, names);
  if (!tokens.ok()) return tokens.error();
  return Parser(std::move(tokens).value()).Whole();
}

Result<MetricSyntax> ParseMetric(std::string_view text) {
  Result<std::vector<Token>> tokens = Tokens(text);
  if (!tokens.ok()) return tokens.error();
  return Parser(std::move(tokens).value()).WholeMetric();
}

}  // namespace troupe
