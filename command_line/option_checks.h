// Checks of values on the command line. The message of each states the text found and the text expected.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace CLI {
class Validator;
}

namespace troupe {

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

// 0 to kMaxDomain (common/run/network_settings.h).
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
