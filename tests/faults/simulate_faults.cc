// Simulates runs with faults, one for each seed; docs/fault-simulation.md describes it.
//   simulate_faults [--seeds N] [--first S]      N seeds from S on; default: 1000 from 1 on
//   simulate_faults --seed X                     one seed, with the events of its run
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "tests/faults/fault_simulation.h"

namespace troupe::faults {
namespace {

struct Totals {
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;
  double seconds = 0.0;
  std::uint64_t violations = 0;
};

volatile std::sig_atomic_t seed_is_known = 0;
char seed_line[80];  // for the handler below

// A crash names its seed too.
void PrintSeed(int signal) {
  if (seed_is_known != 0) static_cast<void>(!write(STDOUT_FILENO, seed_line, std::strlen(seed_line)));
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void Simulate(std::uint64_t seed, bool with_log, Totals& totals) {
  seed_is_known = 0;
  fmt::format_to_n(seed_line, sizeof seed_line - 1, "scripts/simulate-faults --seed {}    # a crash\n{}", seed, '\0');
  seed_is_known = 1;
  const auto print = [](const std::string& line) { fmt::print("{}\n", line); };
  const std::function<void(const std::string&)> log = with_log ? print : std::function<void(const std::string&)>();
  const SimulationResult result = FaultSimulation(MakePlan(seed), log).Run();
  totals.ticks += result.ticks;
  totals.lost += result.lost;
  totals.seconds += result.seconds;
  if (result.violation.empty()) return;
  ++totals.violations;
  fmt::print("scripts/simulate-faults --seed {}    # {}\n", seed, result.violation);
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  std::uint64_t seeds = 1000;
  std::uint64_t first = 1;
  std::optional<std::uint64_t> seed;
  CLI::App app("Simulates runs with faults, one for each seed", "simulate_faults");
  app.add_option("--seeds", seeds, "Number of seeds (default: 1000)");
  app.add_option("--first", first, "The first seed (default: 1)");
  app.add_option("--seed", seed, "This seed only");
  CLI11_PARSE(app, argc, argv);
  if (seed) {
    first = *seed;
    seeds = 1;
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, PrintSeed);
  const auto begin = std::chrono::steady_clock::now();
  Totals totals;
  for (std::uint64_t i = 0; i < seeds; ++i) Simulate(first + i, seed.has_value(), totals);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  fmt::print("{} seeds, {} ticks, {:.0f} virtual s, {} losses of agents: {} violations; {:.1f} s, {:.0f} seeds/s\n",
             seeds, totals.ticks, totals.seconds, totals.lost, totals.violations, wall,
             static_cast<double>(seeds) / wall);
  return totals.violations == 0 ? 0 : 1;
}

}  // namespace
}  // namespace troupe::faults

int main(int argc, char** argv) {
  try {
    return troupe::faults::Main(argc, argv);
  } catch (const std::exception& exception) {
    fmt::print(stderr, "error: {}\n", exception.what());
    return 3;
  }
}
