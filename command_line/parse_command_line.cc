#include "command_line/parse_command_line.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ifaddrs.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <set>
#include <string_view>

#include "common/base/text.h"
#include "common/run/run_settings.h"
#include "common/trace/tick_trace.h"
#include "transport/protocol/faulty_transport.h"
#include "troupe/check.h"

namespace troupe {
namespace {

// The command of the command line that was recognized last: the program itself, or one of its (sub)commands.
const CLI::App& InnermostCommand(const CLI::App& app) {
  const CLI::App* innermost = &app;
  while (!innermost->get_subcommands().empty()) innermost = innermost->get_subcommands().back();
  return *innermost;
}

// "--name" of all options of the command, and of the commands around it.
std::vector<std::string> OptionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

bool IsOption(const std::string& argument) {
  return argument.size() > 1 && argument.front() == '-';
}

// CLI11 names unknown options without the command that would accept them; a typing error is the usual cause.
std::string UnknownOptions(const CLI::App& command, const std::vector<std::string>& options) {
  std::string text;
  for (const std::string& option : options) {
    const std::string name = option.substr(0, option.find('='));
    const auto closest = ClosestName(name, OptionNames(command));
    text += (text.empty() ? "" : ", ") + name + (closest ? " (did you mean " + *closest + "?)" : "");
  }
  std::string path = command.get_name();
  for (const CLI::App* app = command.get_parent(); app != nullptr; app = app->get_parent()) {
    path.insert(0, app->get_name() + " ");
  }
  return fmt::format("found the unknown {} {}; {} --help lists the options", options.size() == 1 ? "option" : "options",
                     text, path);
}

// Arguments that no command expects, in the order of the command line.
std::string UnknownArguments(const CLI::App& command, const std::vector<std::string>& unknown) {
  const std::vector<std::string> commands = CommandNames(command);
  if (commands.empty()) {
    return fmt::format("found '{}', expected no further argument", fmt::join(unknown, "' '"));
  }
  return fmt::format("found the command '{}', expected one of {}{}", unknown.front(), fmt::join(commands, ", "),
                     DidYouMean(unknown.front(), commands));
}

// An unknown option is the likely cause of other errors: its value looks like a further argument.
std::string MessageOf(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining(true);
  std::vector<std::string> options = unknown;
  std::erase_if(options, [](const std::string& argument) { return !IsOption(argument); });
  if (!options.empty()) return UnknownOptions(InnermostCommand(app), options);
  if (dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr) {
    const std::string text = error.what();  // "A excludes B"
    const std::string verb = " excludes ";
    const std::size_t at = text.find(verb);
    return fmt::format("found {} beside {}, expected one of the two", text.substr(0, at),
                       text.substr(at + verb.size()));
  }
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const bool extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if ((missing || extra) && !unknown.empty()) return UnknownArguments(InnermostCommand(app), unknown);
  return error.what();
}

std::string Mismatch(const std::string& found, const std::string& expected) {
  return "found '" + found + "', expected " + expected;
}

// The whole text, without leading blanks or a plus sign, in any locale.
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

// What is in the file of kArgumentsOption; nothing without that option.
std::optional<std::string> ArgumentsOfFile(int argc, const char* const* argv) {
  const std::string_view option = kArgumentsOption;
  if (argc != 2 || !std::string_view(argv[1]).starts_with(option)) return std::nullopt;
  const std::optional<int> descriptor = ParseAll<int>(argv[1] + option.size());
  if (!descriptor || *descriptor < 0) throw CLI::ValidationError(Mismatch(argv[1], "a descriptor"));
  std::string text;
  char piece[4096];
  ssize_t size = 0;
  while ((size = read(*descriptor, piece, sizeof piece)) > 0) text.append(piece, static_cast<std::size_t>(size));
  if (size < 0) throw CLI::ValidationError(Mismatch(argv[1], "a descriptor that can be read"));
  close(*descriptor);
  return text;
}

}  // namespace

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

// One line for each error, though CLI11 may print several: scripts read the last line.
std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    const std::optional<std::string> text = ArgumentsOfFile(argc, argv);
    std::vector<const char*> arguments(argv, argv + (text ? 1 : argc));
    for (std::size_t begin = 0; text && begin < text->size(); begin += std::strlen(text->c_str() + begin) + 1) {
      arguments.push_back(text->c_str() + begin);
    }
    app.parse(static_cast<int>(arguments.size()), arguments.data());
    return std::nullopt;
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << PlainLine(MessageOf(app, error)) << "\n";
    return kExitBadInput;
  }
}

// Exceptions that arrive here are failures of the system (memory, threads, DDS).
CLI::Option& FindOption(CLI::App& command, const std::string& name) {
  const std::vector<CLI::Option*> found =
      command.get_options([&](const CLI::Option* option) { return option->check_name(name); });
  TROUPE_CHECK(!found.empty());
  return *found.front();
}

int RunProgram(int (*run)(int argc, const char* const* argv), int argc, const char* const* argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit fails, as on a full disk
  try {
    return run(argc, argv);
  } catch (const std::exception& exception) {
    std::cerr << FailureOf(exception).ToString() << "\n";
    return kExitFailed;
  }
}

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
    if (value && *value >= kMinLeaseSeconds && *value <= kMaxLeaseSeconds) return "";
    return Mismatch(text, fmt::format("seconds from {} to {}", kMinLeaseSeconds, kMaxLeaseSeconds));
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

// Checked here, because DDS would start without a usable interface and find no peer.
CLI::Validator InterfaceValue() {
  auto check = [](const std::string& text) -> std::string {
    in_addr address{};
    if (text == kAutomaticInterface || inet_pton(AF_INET, text.c_str(), &address) == 1) return "";
    ifaddrs* first = nullptr;
    if (getifaddrs(&first) != 0) return "";  // DDS looks itself
    std::set<std::string> names;
    bool has_address = false;
    for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
      names.insert(one->ifa_name);
      has_address |= text == one->ifa_name && one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET;
    }
    freeifaddrs(first);
    if (has_address) return "";
    if (names.contains(text))
      return "found '" + text + "', which has no IPv4 address, expected an interface that has one";
    return Mismatch(text, fmt::format("auto, or the name or IPv4 address of an interface of this host: {}",
                                      fmt::join(names, ", ")));
  };
  return CLI::Validator(check, "");
}

CLI::Validator NetworkName() {
  return OneOf({"one-host", "lan", "unicast"});
}

// A GUID prefix of RTPS, 12 bytes.
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
