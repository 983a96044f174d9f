// The least cost of lockstep over UDP: a datagram of a frame's size to each of N processes, and one of a
// proposal's size back from each. Prints a JSON object.
//   udp_barrier [agents=100] [ticks=1000]
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>

#include "benchmarks/barrier_processes.h"

namespace troupe::bench {
namespace {

// The most agents whose answers fit the socket's buffer: lost datagrams are not resent here.
constexpr std::size_t kAnswersAtATime = 100;

// Answers until it receives a datagram of one byte.
void RunAgent(const sockaddr_in& service) {
  std::vector<char> buffer(65536);
  const int agent = socket(AF_INET, SOCK_DGRAM, 0);
  if (connect(agent, reinterpret_cast<const sockaddr*>(&service), sizeof(service)) != 0) return;
  if (send(agent, "hello", 5, 0) != 5) return;
  const auto bytes = static_cast<ssize_t>(kProposalBytes);
  while (recv(agent, buffer.data(), buffer.size(), 0) > 1) {
    if (send(agent, buffer.data(), kProposalBytes, 0) != bytes) return;
  }
}

int Run(const BarrierOptions& options) {
  const std::size_t frame_bytes = FrameBytes(options.agents);
  std::vector<char> buffer(65536);
  const int service = socket(AF_INET, SOCK_DGRAM, 0);
  const timeval patience{.tv_sec = 10, .tv_usec = 0};
  setsockopt(service, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  if (bind(service, reinterpret_cast<sockaddr*>(&address), length) != 0) return std::perror("bind"), 3;
  getsockname(service, reinterpret_cast<sockaddr*>(&address), &length);
  std::vector<pid_t> children;
  std::vector<sockaddr_in> agents(static_cast<std::size_t>(options.agents));
  for (sockaddr_in& agent : agents) {
    children.push_back(Fork([&address] { RunAgent(address); }));
    length = sizeof(agent);
    recvfrom(service, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&agent), &length);
  }
  const auto send_to = [&](const sockaddr_in& agent, std::size_t bytes) {
    sendto(service, buffer.data(), bytes, 0, reinterpret_cast<const sockaddr*>(&agent), sizeof(agent));
  };
  const double used_before = ProcessorTime(children);
  const auto begin = Clock::now();
  bool lost = false;
  for (std::uint64_t tick = 0; tick < options.ticks && !lost; ++tick) {
    for (std::size_t first = 0; first < agents.size(); first += kAnswersAtATime) {
      const std::size_t end = std::min(agents.size(), first + kAnswersAtATime);
      for (std::size_t i = first; i < end; ++i) send_to(agents[i], frame_bytes);
      for (std::size_t i = first; i < end && !lost; ++i) lost = recv(service, buffer.data(), buffer.size(), 0) < 0;
    }
  }
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  const double wall = Since(begin) * share;
  const double processor = (ProcessorTime(children) - used_before) * share;
  for (const sockaddr_in& agent : agents) send_to(agent, 1);
  if (lost) {
    for (const pid_t pid : children) kill(pid, SIGKILL);
  }
  WaitForAll(children);
  if (lost) return std::fprintf(stderr, "an answer was lost\n"), 3;
  std::printf("{\"processes\": %d, \"ticks\": %lu, \"wall_us\": %.3f, \"processor_us\": %.3f}\n", options.agents,
              options.ticks, wall, processor);
  return 0;
}

}  // namespace
}  // namespace troupe::bench

int main(int argc, char** argv) {
  return troupe::bench::Run(troupe::bench::ParseBarrierOptions(argc, argv));
}
