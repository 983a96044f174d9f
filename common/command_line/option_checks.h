// Checks for values on the command line: each says what was found and what was expected.
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

// A multiple of real time above zero, or "max".
CLI::Validator SpeedValue();

CLI::Validator OneOf(std::vector<std::string> words);

// Letters, digits, '.', '-' and '_', at most 64: a DDS partition that matches only itself.
CLI::Validator SessionName();

// Those for which Cyclone has ports.
CLI::Validator DdsDomain();

// A network profile (common/dds/domain_config.h).
CLI::Validator NetworkName();

// What ParseFaults (common/protocol/faulty_transport.h) takes.
CLI::Validator FaultsValue();

// What ParseTraceTicks (common/trace/tick_trace.h) takes.
CLI::Validator TraceTicksValue();

}  // namespace troupe
