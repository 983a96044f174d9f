// The functions of viewer/module/standard/charconv: from_chars and to_chars of doubles, which libc++ 13 lacks.
//
// The texts must be equal to those of libstdc++, because logs of the module are compared with those of the host line by
// line: shortest digits that read back to the same bits, and the same choice between plain and scientific form.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace std {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

const char* SkipDigits(const char* at, const char* last) {
  return find_if_not(at, last, IsDigit);
}

bool StartsWith(const char* at, const char* last, string_view lower_case) {
  return static_cast<size_t>(last - at) >= lower_case.size() &&
         equal(lower_case.begin(), lower_case.end(), at, [](char expected, char found) {
           return found == expected || (found >= 'A' && found <= 'Z' && found - 'A' + 'a' == expected);
         });
}

// The end of the number that begins at `first`; `first` itself if there is none.
const char* EndOfNumber(const char* first, const char* last) {
  const char* const digits = first != last && *first == '-' ? first + 1 : first;
  for (const string_view word : {"infinity", "inf", "nan"}) {
    if (StartsWith(digits, last, word)) return digits + word.size();
  }
  const char* at = SkipDigits(digits, last);
  auto count = at - digits;
  if (at != last && *at == '.') {
    const char* const end = SkipDigits(at + 1, last);
    count += end - (at + 1);
    at = end;
  }
  if (count == 0) return first;
  if (at != last && (*at == 'e' || *at == 'E')) {
    const char* power = at + 1;
    if (power != last && (*power == '+' || *power == '-')) ++power;
    if (const char* const end = SkipDigits(power, last); end != power) at = end;
  }
  return at;
}

}  // namespace

// strtod accepts more than from_chars does (leading blanks, hexadecimal digits), so that the end is found first.
from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* const end = EndOfNumber(first, last);
  if (end == first) return {first, errc::invalid_argument};
  const string text(first, end);
  const double read = strtod(text.c_str(), nullptr);
  const bool is_word = text.find_first_of("iInN") != string::npos;
  const bool is_zero = text.substr(0, text.find_first_of("eE")).find_first_of("123456789") == string::npos;
  if (!is_word && (isinf(read) || (read == 0.0 && !is_zero))) return {end, errc::result_out_of_range};
  value = read;
  return {end, errc()};
}

to_chars_result to_chars(char* first, char* last, double value) {
  string text;
  if (!isfinite(value)) {
    text = isnan(value) ? (signbit(value) ? "-nan" : "nan") : (value < 0.0 ? "-inf" : "inf");
  } else if (value == 0.0) {
    text = signbit(value) ? "-0" : "0";
  } else {
    // From digits that fmt finds: the shortest of all that are read as the value.
    const string shortest = fmt::format("{}", abs(value));
    string digits;
    int exponent = 0;  // of the first digit
    const size_t power = shortest.find('e');
    const string mantissa = shortest.substr(0, power);
    const size_t point = mantissa.find('.');
    for (const char c : mantissa) {
      if (c != '.') digits += c;
    }
    exponent = static_cast<int>(point == string::npos ? mantissa.size() : point) - 1;
    if (power != string::npos) exponent += atoi(shortest.c_str() + power + 1);
    const size_t zeros = min(digits.find_first_not_of('0'), digits.size());
    digits.erase(0, zeros);
    exponent -= static_cast<int>(zeros);
    while (digits.size() > 1 && digits.back() == '0') digits.pop_back();

    string with_power = digits.substr(0, 1);
    if (digits.size() > 1) with_power += '.' + digits.substr(1);
    with_power += fmt::format("e{}{:02}", exponent < 0 ? '-' : '+', std::abs(exponent));
    const int count = static_cast<int>(digits.size());
    string fixed;
    if (exponent < 0) {
      fixed = "0." + string(static_cast<size_t>(-exponent - 1), '0') + digits;
    } else if (exponent + 1 >= count) {
      fixed = fmt::format("{:.0f}", abs(value));  // all digits of a whole number
    } else {
      fixed =
          digits.substr(0, static_cast<size_t>(exponent) + 1) + '.' + digits.substr(static_cast<size_t>(exponent) + 1);
    }
    text = (value < 0.0 ? "-" : "") + (fixed.size() <= with_power.size() ? fixed : with_power);
  }
  if (static_cast<size_t>(last - first) < text.size()) return {last, errc::value_too_large};
  memcpy(first, text.data(), text.size());
  return {first + text.size(), errc()};
}

}  // namespace std
