#include "fleet/order_message.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace troupe::fleet {
namespace {

constexpr std::int64_t kMillisecondsInADay = 86'400'000;

// Days since 1970-01-01 of the proleptic Gregorian calendar, and back (Hinnant, "chrono-Compatible Low-Level Date
// Algorithms", 2013).
constexpr std::int64_t DaysOf(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t year_of_era = year - era * 400;
  const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719468;
}

struct Date {
  int year = 1970;
  int month = 1;
  int day = 1;
};

constexpr Date DateOf(std::int64_t days) {
  days += 719468;
  const std::int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const std::int64_t day_of_era = days - era * 146097;
  const std::int64_t year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  const std::int64_t day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const std::int64_t shifted_month = (5 * day_of_year + 2) / 153;
  const std::int64_t month = shifted_month < 10 ? shifted_month + 3 : shifted_month - 9;
  return {static_cast<int>(year_of_era + era * 400 + (month <= 2 ? 1 : 0)), static_cast<int>(month),
          static_cast<int>(day_of_year - (153 * shifted_month + 2) / 5 + 1)};
}

// Reads `count` digits from the front of the text; -1 if they are not there.
int ReadDigits(std::string_view& text, std::size_t count) {
  if (text.size() < count) return -1;
  int number = 0;
  const auto read = std::from_chars(text.data(), text.data() + count, number);
  if (read.ec != std::errc() || read.ptr != text.data() + count || text.front() == '-') return -1;
  text.remove_prefix(count);
  return number;
}

bool ReadCharacter(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<Version> FindVersion(std::string_view text) {
  const std::size_t point = text.find('.');
  int numbers[2] = {-1, -1};
  const std::string_view major = text.substr(0, point);
  const std::string_view rest = point == std::string_view::npos ? "" : text.substr(point + 1);
  const std::string_view minor = rest.substr(0, rest.find('.'));
  std::size_t i = 0;
  for (const std::string_view part : {major, minor}) {
    const auto read = std::from_chars(part.data(), part.data() + part.size(), numbers[i]);
    if (read.ec != std::errc() || read.ptr != part.data() + part.size() || numbers[i] < 0) return std::nullopt;
    ++i;
  }
  if (numbers[0] == 3) return Version::k3_0;
  if (numbers[0] != 2) return std::nullopt;
  return numbers[1] == 0 ? Version::k2_0 : Version::k2_1;
}

std::string VersionText(Version version) {
  return std::string(NameOf(version)) + ".0";
}

std::optional<std::int64_t> ParseTimestamp(std::string_view text) {
  const int year = ReadDigits(text, 4);
  if (year < 0 || !ReadCharacter(text, "-")) return std::nullopt;
  const int month = ReadDigits(text, 2);
  if (month < 1 || month > 12 || !ReadCharacter(text, "-")) return std::nullopt;
  const int day = ReadDigits(text, 2);
  if (day < 1 || day > 31 || !ReadCharacter(text, "Tt ")) return std::nullopt;
  const int hour = ReadDigits(text, 2);
  if (hour < 0 || hour > 24 || !ReadCharacter(text, ":")) return std::nullopt;
  const int minute = ReadDigits(text, 2);
  if (minute < 0 || minute > 59 || !ReadCharacter(text, ":")) return std::nullopt;
  const int second = ReadDigits(text, 2);
  if (second < 0 || second > 60) return std::nullopt;
  std::int64_t milliseconds = 0;
  if (ReadCharacter(text, ".,")) {
    int digits = 0;
    for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; ++digits) {
      if (digits < 3) milliseconds = milliseconds * 10 + (text.front() - '0');
      text.remove_prefix(1);
    }
    if (digits == 0) return std::nullopt;
    for (; digits < 3; ++digits) milliseconds *= 10;
  }
  std::int64_t offset = 0;  // minutes
  if (!text.empty() && !ReadCharacter(text, "Zz")) {
    const bool is_west = text.front() == '-';
    if (!ReadCharacter(text, "+-")) return std::nullopt;
    const int hours = ReadDigits(text, 2);
    ReadCharacter(text, ":");
    const int minutes = text.empty() ? 0 : ReadDigits(text, 2);
    if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59) return std::nullopt;
    offset = (is_west ? -1 : 1) * (std::int64_t{hours} * 60 + minutes);
  }
  if (!text.empty()) return std::nullopt;
  const std::int64_t minutes = (DaysOf(year, month, day) * 24 + hour) * 60 + minute - offset;
  return (minutes * 60 + second) * 1000 + milliseconds;
}

std::string FormatTimestamp(std::int64_t milliseconds, Version version) {
  milliseconds = std::clamp<std::int64_t>(milliseconds, 0, DaysOf(10000, 1, 1) * kMillisecondsInADay - 1);
  const Date date = DateOf(milliseconds / kMillisecondsInADay);
  const int rest = static_cast<int>(milliseconds % kMillisecondsInADay);
  char text[64];
  const int length = std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03d", date.year, date.month,
                                   date.day, rest / 3'600'000, rest / 60'000 % 60, rest / 1000 % 60, rest % 1000);
  return std::string(text, static_cast<std::size_t>(IsBefore3(version) ? length - 1 : length)) + 'Z';
}

const ParameterValue* Action::FindParameter(std::string_view key) const {
  if (!parameters) return nullptr;
  const auto found = std::find_if(parameters->begin(), parameters->end(),
                                  [&](const ActionParameter& parameter) { return parameter.key == key; });
  return found != parameters->end() ? &found->value : nullptr;
}

std::string Action::TextOf(std::string_view key) const {
  const ParameterValue* const value = FindParameter(key);
  return value != nullptr ? value->text : "";
}

bool HaveSameContent(const Order& a, const Order& b) {
  return a.order_id == b.order_id && a.order_update_id == b.order_update_id && a.descriptor == b.descriptor &&
         a.zone_set_id == b.zone_set_id && a.nodes == b.nodes && a.edges == b.edges;
}

}  // namespace troupe::fleet
