// Lexer: the first step of reading an expectation or constraint, from bytes to tokens. It knows numbers with their
// units, texts in quotes, words and signs; whether a word is an operator, a function or a name is the parser's
// decision, except for the reserved words.
//
// Each token keeps the byte offset of its beginning, since every later error is told at a place of the text as the user
// wrote it. Pure functions without state: any thread may call them. Cost: one pass over at most kMaxExpectationLength
// bytes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "testing/expectations/syntax.h"
#include "troupe/result.h"

namespace troupe {

// Words that no robot, place or signal may be called without quotes, so that a formula reads in one way whatever the
// world contains. Functions and aggregates (min, count, ...) are not reserved: they are told from names by the bracket
// or variable that follows.
inline constexpr std::array<std::string_view, 13> kReservedWords{
    "and",          "or",    "not",   "always", "eventually", "finally", "once",
    "historically", "until", "since", "forall", "exists",     "in"};
enum class TokenKind : std::uint8_t { kEnd, kNumber, kText, kWord, kSign };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::size_t offset = 0;
  std::string text;  // of a text: without quotes; of a number: its unit
  double number = 0.0;
};

// The last one is kEnd. An error for a byte, number or unit that the language does not have, and for a text that is too
// long.
Result<std::vector<Token>> Tokens(std::string_view text, NameSyntax names = NameSyntax::kWord);

}  // namespace troupe
