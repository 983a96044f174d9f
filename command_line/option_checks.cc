#include "command_line/option_checks.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ifaddrs.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "common/run/network_settings.h"
#include "common/run/run_settings.h"
#include "common/trace/tick_trace.h"
#include "transport/protocol/faulty_transport.h"

namespace troupe {
namespace {

std::string Mismatch(const std::string& found, const std::string& expected) {
  return "found '" + found + "', expected " + expected;
}

template <typename T>
std::optional<T> ParseAll(const std::string& text) {
  T value{};
  auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool IsPositive(const std::string& text) {
  std::optional<double> value = ParseAll<double>(text);
  return value && std::isfinite(*value) && *value > 0.0;
}

bool IsNameCharacter(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' || c == '_';
}

}  // namespace

CLI::Validator WholeNumber(std::uint64_t min, std::uint64_t max) {
  std::string expected = "a whole number from " + std::to_string(min);
  if (max != std::numeric_limits<std::uint64_t>::max()) expected += " to " + std::to_string(max);
  auto check = [=](const std::string& text) -> std::string {
    std::optional<std::uint64_t> value = ParseAll<std::uint64_t>(text);
    return value && *value >= min && *value <= max ? "" : Mismatch(text, expected);
  };
  return CLI::Validator(check, "");
}

CLI::Validator PositiveNumber() {
  return CLI::Validator(
      [](const std::string& text) { return IsPositive(text) ? "" : Mismatch(text, "a number above 0"); }, "");
}

CLI::Validator LeaseValue() {
  auto check = [](const std::string& text) -> std::string {
    const std::optional<double> value = ParseAll<double>(text);
    if (value && *value >= kShortestLeaseSeconds && *value <= kLongestLeaseSeconds) return "";
    return Mismatch(text, fmt::format("seconds from {} to {}", kShortestLeaseSeconds, kLongestLeaseSeconds));
  };
  return CLI::Validator(check, "");
}

CLI::Validator NumberFromZero() {
  auto check = [](const std::string& text) {
    return IsPositive(text) || ParseAll<double>(text) == 0.0 ? "" : Mismatch(text, "a number from 0");
  };
  return CLI::Validator(check, "");
}

CLI::Validator SpeedValue() {
  auto check = [](const std::string& text) {
    const Result<Speed> parsed = ParseSpeed(text);
    return parsed.ok() ? std::string() : parsed.error().message;
  };
  return CLI::Validator(check, "");
}

CLI::Validator OneOf(std::vector<std::string> words) {
  const std::string name = fmt::format("{}", fmt::join(words, " "));
  auto check = [words = std::move(words)](const std::string& text) -> std::string {
    std::string expected;
    for (const std::string& word : words) {
      if (word == text) return "";
      expected += (expected.empty() ? "" : ", ") + word;
    }
    return Mismatch(text, "one of " + expected);
  };
  return CLI::Validator(check, "", name);
}

CLI::Validator NotEmpty() {
  return CLI::Validator([](const std::string& text) { return text.empty() ? Mismatch(text, "a name") : ""; }, "");
}

CLI::Validator SessionName() {
  auto check = [](const std::string& text) -> std::string {
    bool good = !text.empty() && text.size() <= 64;
    for (char c : text) good = good && IsNameCharacter(c);
    return good ? "" : Mismatch(text, "1 to 64 letters, digits, '.', '-' or '_'");
  };
  return CLI::Validator(check, "");
}

CLI::Validator DdsDomain() {
  return WholeNumber(0, kMaxDomain);
}

CLI::Validator InterfaceValue() {
  auto check = [](const std::string& text) -> std::string {
    in_addr address{};
    if (text == kAutomaticInterface || inet_pton(AF_INET, text.c_str(), &address) == 1) return "";
    ifaddrs* first = nullptr;
    if (getifaddrs(&first) != 0) return "";  // DDS looks itself
    std::set<std::string> names;
    for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) names.insert(one->ifa_name);
    freeifaddrs(first);
    if (names.contains(text)) return "";
    return Mismatch(text, fmt::format("auto, or the name or IPv4 address of an interface of this host: {}",
                                      fmt::join(names, ", ")));
  };
  return CLI::Validator(check, "");
}

CLI::Validator NetworkName() {
  return OneOf({"one-host", "lan", "unicast"});
}

CLI::Validator ParticipantValue() {
  auto check = [](const std::string& text) {
    constexpr std::size_t kDigits = 24;
    const bool valid = text.size() == kDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
    return valid ? std::string() : "found '" + text + "', expected 24 hexadecimal digits in lower case";
  };
  return CLI::Validator(check, "");
}

CLI::Validator FaultsValue() {
  auto check = [](const std::string& text) {
    Result<Faults> parsed = ParseFaults(text);
    return parsed.ok() ? std::string() : parsed.error().message;
  };
  return CLI::Validator(check, "");
}

CLI::Validator TraceTicksValue() {
  auto check = [](const std::string& text) {
    Result<TraceOptions> parsed = ParseTraceTicks(text);
    return parsed.ok() ? std::string() : parsed.error().message;
  };
  return CLI::Validator(check, "");
}

}  // namespace troupe
