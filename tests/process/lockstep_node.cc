// A node for which ticks wait, as a program, for tests/process/ros_lockstep_load.py; or a tool that reads what a node
// reads.
//     lockstep_node topic|protocol|timer|counter|echo NAME SPACE DELAY SEED DOMAIN INTERFACE
// SPACE: of the topics of its robot, "/r0". DELAY: at most before an answer, ms.
#include "tests/process/lockstep_node.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace troupe::test {
namespace {

int Main(int argc, const char* const* argv) {
  if (argc != 8) {
    std::fprintf(stderr,
                 "usage: lockstep_node topic|protocol|timer|counter|echo NAME SPACE DELAY SEED DOMAIN INTERFACE\n");
    return 2;
  }
  NodeOptions options;
  options.name = argv[2];
  if (std::string_view(argv[3]) != "/") options.space = argv[3];
  options.most_delay = std::atoi(argv[4]);
  options.seed = static_cast<unsigned>(std::atoi(argv[5]));
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[6]));
  options.interface = argv[7];
  options.logs = true;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argv[1] == std::string_view("echo")) {
    ros::RosNetwork network = InDomain(options.domain);
    network.network_interface = options.interface;
    ros::RosParticipant participant(network);
    const ros::RosNode node = ros::MakeNode(participant, "/", options.name);
    const ros::RosReader<ros::LaserScan> scans(node, options.space + "/scan", ros::Stream(10));
    participant.Announce();
    for (;;) pause();
  }
  const auto way = std::find(kWays.begin(), kWays.end(), std::string_view(argv[1]));
  if (way == kWays.end()) {
    std::fprintf(stderr, "lockstep_node: found '%s', expected a way to take part\n", argv[1]);
    return 2;
  }
  options.way = static_cast<Way>(way - kWays.begin());
  const LockstepNode node(options);
  for (;;) pause();
}

}  // namespace
}  // namespace troupe::test

int main(int argc, const char* const* argv) {
  return troupe::test::Main(argc, argv);
}
