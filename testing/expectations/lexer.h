// The words of the language of expectations: from a text to tokens.
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

// Words that are no names.
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
