#include "launcher/supervise/run_again.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "command_line/parse_command_line.h"
#include "common/base/print.h"

namespace troupe {
namespace {

constexpr std::string_view kRunAgain = "run again";
// Of the environment, which other users cannot read, as the address has the token.
constexpr const char* kPageVariable = "TROUPE_PAGE_OF_PREVIOUS_RUN";

template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string RunAgainLine(std::optional<std::uint64_t> seed) {
  return std::string(kRunAgain) + (seed ? " with seed " + std::to_string(*seed) : "");
}

std::optional<std::optional<std::uint64_t>> ParseRunAgainLine(std::string_view line) {
  if (line == kRunAgain) return std::optional<std::uint64_t>();
  const std::string start = std::string(kRunAgain) + " with seed ";
  if (!line.starts_with(start)) return std::nullopt;
  const std::optional<std::uint64_t> seed = ParseNumber<std::uint64_t>(line.substr(start.size()));
  if (!seed) return std::nullopt;
  return seed;
}

// From the system and not from main's arguments, which CLI11 may have changed and which are not known here.
std::vector<std::string> OwnCommandLine() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

// Both forms of the option, "--seed N" and "--seed=N"; the new one is last.
std::vector<std::string> WithSeed(const std::vector<std::string>& words, std::uint64_t seed) {
  std::vector<std::string> result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--seed") {
      ++i;  // its value
    } else if (!words[i].starts_with("--seed=")) {
      result.push_back(words[i]);
    }
  }
  result.push_back("--seed=" + std::to_string(seed));
  return result;
}

int StartAgain(const NewRun& run) {
  std::vector<std::string> words = OwnCommandLine();
  if (run.seed) words = WithSeed(words, *run.seed);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  setenv(kPageVariable, run.page.c_str(), 1);
  execv("/proc/self/exe", arguments.data());
  PrintPlain(stderr, "error: cannot start the run again: {}\n", std::strerror(errno));
  return kExitFailed;
}

// "http://HOST:PORT/" with "?token=TOKEN" behind it, or without.
std::optional<PageAddress> ParsePageAddress(const std::string& address) {
  constexpr std::string_view kToken = "/?token=";
  const std::size_t slash = address.find('/', address.find("//") + 2);
  const std::size_t colon = address.rfind(':', slash);
  if (slash == std::string::npos || colon == std::string::npos) return std::nullopt;
  const std::string_view text = address;
  const std::optional<std::uint16_t> port = ParseNumber<std::uint16_t>(text.substr(colon + 1, slash - colon - 1));
  if (!port) return std::nullopt;
  const std::string_view rest = text.substr(slash);
  return PageAddress{*port, rest.starts_with(kToken) ? std::string(rest.substr(kToken.size())) : ""};
}

std::optional<PageAddress> PageOfPreviousRun() {
  const char* const address = std::getenv(kPageVariable);
  return address == nullptr ? std::nullopt : ParsePageAddress(address);
}

}  // namespace troupe
