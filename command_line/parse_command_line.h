// Command lines of all programs: parsing, exit statuses, and checks of values.
//
// Every program ends in the same way: 0 done, 2 for wrong input with one line with `error: ` on standard error, 3 for
// failures, 130 after Ctrl-C; scripts and the launcher rely on these numbers. Checks are validators of CLI11, so that
// help texts, completions for shells and errors have one source. A check knows the text alone; what depends on a file
// is checked when the file is read.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace troupe {

// The names of the (sub)commands of a program or command.
std::vector<std::string> CommandNames(const CLI::App& app);

// With a number of a descriptor, in place of all arguments of a program: they are in that file, each with a zero behind
// it. For more arguments than the system takes.
inline constexpr const char* kArgumentsOption = "--arguments-fd=";

// Parses into the variables with which the options were declared. Nothing: the program continues. An exit status: the
// program ends with it; its help, its version, or an error of one line has been printed.
std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv);

// The option of this name. REQUIRES: the command has it. The search of CLI11 itself cannot fail for want of memory, and
// would end the program.
CLI::Option& FindOption(CLI::App& command, const std::string& name);

// The exit status of a program: that of `run`, or that of a failure, which is printed as one line, if it throws.
int RunProgram(int (*run)(int argc, const char* const* argv), int argc, const char* const* argv);

inline constexpr int kExitDone = 0;
inline constexpr int kExitBadInput = 2;  // of files or usage
inline constexpr int kExitFailed = 3;
inline constexpr int kExitOutputFailed = 4;  // of an agent whose output file cannot be written (a full disk)
inline constexpr int kExitRobotsLost = 5;    // of a run that is done, but in which robots had no agent for some ticks
inline constexpr int kExitInterrupted = 130;

// The exit status of a program that ends with this error.
inline int ExitStatusOf(const Error& error) {
  const bool is_bad_input = error.code == ErrorCode::kBadInput || error.code == ErrorCode::kMalformed;
  return is_bad_input ? kExitBadInput : kExitFailed;
}

// Checks of values on the command line. The message of each states the text found and the text expected.

CLI::Validator WholeNumber(std::uint64_t min, std::uint64_t max = std::numeric_limits<std::uint64_t>::max());

// Seconds or factors: finite, and above zero unless zero is allowed.
CLI::Validator PositiveNumber();
CLI::Validator NumberFromZero();

// As NetworkSettings::lease_seconds.
CLI::Validator LeaseValue();

// A multiple of real time above zero, or "max".
CLI::Validator SpeedValue();

// Its name is the words, separated by spaces, from which completions for shells are made.
CLI::Validator OneOf(std::vector<std::string> words);

CLI::Validator NotEmpty();

// 1 to 64 letters, digits, '.', '-' and '_': a DDS partition without wildcards.
CLI::Validator SessionName();

// 0 to kMaxDomain (common/run/run_settings.h).
CLI::Validator DdsDomain();

// The identity of a DDS participant: 24 hexadecimal digits.
CLI::Validator ParticipantValue();

// "auto", or the name or IPv4 address of an interface of this host.
CLI::Validator InterfaceValue();

// A network profile (transport/dds/binding/domain_config.h).
CLI::Validator NetworkName();

// Text for ParseFaults (transport/protocol/faulty_transport.h).
CLI::Validator FaultsValue();

// Text for ParseTraceTicks (common/trace/tick_trace.h).
CLI::Validator TraceTicksValue();

}  // namespace troupe
