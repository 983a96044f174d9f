// SimulationPage: shows a simulation of this process in a browser while it steps. The program `troupe` of the same
// version serves the page, as a child process that ends with this one: what a browser does slows no step.
//
// The page follows the newest state, at most 60 times a second; steps in between are not shown. It changes nothing.
//
// Threads: Show as the simulation, the others on any.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "troupe/result.h"
#include "troupe/simulation.h"

namespace troupe {

struct SimulationPageOptions {
  std::string address =
      "127.0.0.1";         // IPv4 to listen on; another one than this is open to other machines, with a token
  std::uint16_t port = 0;  // 0: any
  // The program `troupe`. Empty: that beside the library's folder (PREFIX/bin), else that of the variable PATH.
  std::string program = {};
};

class SimulationPage {
 public:
  // Returns when the page can be opened. The error is a program that is not found or is of another version, or an
  // address in use.
  static Result<SimulationPage> Open(const Simulation& simulation, const SimulationPageOptions& options = {});

  SimulationPage(SimulationPage&& other) noexcept;
  SimulationPage& operator=(SimulationPage&& other) noexcept;
  ~SimulationPage();  // the page shows the last state, and that the run is over

  const std::string& address() const;  // the URL of the page
  bool is_open() const;                // false: the program has ended
  // After steps, and after a snapshot was restored. Does not wait.
  void Show(const Simulation& simulation);

 private:
  struct Impl;
  explicit SimulationPage(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;  // null only after a move
};

}  // namespace troupe
