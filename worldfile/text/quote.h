// Text of a user's file, escaped for messages.
#pragma once

#include <string>
#include <string_view>

#include "common/base/utf8.h"

namespace troupe {

// 'text', cut to `longest` bytes, with control characters and bytes that are not UTF-8 written as \xNN.
std::string Quoted(std::string_view text, std::size_t longest = 40);

// The same for a path, which is rarely cut.
inline std::string QuotedPath(std::string_view path) {
  return Quoted(path, 500);
}

// "1 value", "3 values".
std::string CountText(std::size_t count, const std::string& noun);

// A number in its usual form: "5", "0.25".
std::string NumberText(double value);

}  // namespace troupe
