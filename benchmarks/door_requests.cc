// Asks a run ten times a second to open or close its door "gate", from its first tick until it has ended. Prints a JSON
// object with the number of requests that were done.
//   door_requests SESSION DOMAIN
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "transport/dds/tools/control_client.h"

namespace troupe::bench {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);
constexpr double kStartSeconds = 60.0;
constexpr double kReplySeconds = 10.0;

int Run(const NetworkSettings& network) {
  ControlClient client(network);
  if (const Status status = client.WaitForService(kStartSeconds); !status.ok()) {
    return std::fprintf(stderr, "%s\n", status.error().message.c_str()), 3;
  }
  int done = 0;
  auto next = std::chrono::steady_clock::now();
  for (bool open = true;; open = !open) {
    const Result<ControlReply> reply = client.Call(control::Door{"gate", open ? 1.0 : 0.0}, kReplySeconds);
    if (!reply.ok() || !reply.value().done) break;  // the run has ended
    ++done;
    next += kPeriod;
    std::this_thread::sleep_until(next);
  }
  std::printf("{\"requests\": %d}\n", done);
  return 0;
}

}  // namespace
}  // namespace troupe::bench

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: door_requests SESSION DOMAIN\n"), 2;
  troupe::NetworkSettings network;
  network.session = argv[1];
  network.domain = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
  return troupe::bench::Run(network);
}
