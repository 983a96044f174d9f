// Running again: a run that is started once more from its page: the viewer writes a line to the launcher, which
// replaces itself by a new launcher with the same command line. The new viewer has the address of the one before, so
// that open pages connect to it by themselves.
//
// By exec, and not by a second run in this process: so all state of the run before is gone, and the terminal, the
// process id and the shell's job remain the same. Port and token of the page travel in an environment variable, which
// other users cannot read, unlike a command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

// The line of a viewer whose page asks for the run again, with its own seed or another one.
std::string RunAgainLine(std::optional<std::uint64_t> seed);
// Nothing for any other line.
std::optional<std::optional<std::uint64_t>> ParseRunAgainLine(std::string_view line);

struct NewRun {
  std::optional<std::uint64_t> seed;  // nothing: that of the run before
  std::string page;                   // address of the page of the run before
};

// The words of the command line of this process.
std::vector<std::string> OwnCommandLine();
// The same command line with another seed.
std::vector<std::string> WithSeed(const std::vector<std::string>& words, std::uint64_t seed);

// Replaces this process by one with its command line. Returns, with an exit status, only if the system refuses.
int StartAgain(const NewRun& run);

struct PageAddress {
  std::uint16_t port = 0;
  std::string token;  // empty: none
};
// Of an address as ViewerGateway::Address has it.
std::optional<PageAddress> ParsePageAddress(const std::string& address);
// In a process of a run that was started again.
std::optional<PageAddress> PageOfPreviousRun();

}  // namespace troupe
