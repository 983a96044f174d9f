// A node of ROS for the matrix of features: prints each topic with a writer, as `topic /r0/odom`, until its input ends,
// and answers the ticks that wait for it.
//     matrix_ros_node DOMAIN NAME
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/wire.h"

namespace troupe {
namespace {

constexpr int kPeriod = 5;  // ms between two looks at the network

void PrintTopics(const dds::Entity& reader, std::set<std::string>& known) {
  constexpr std::size_t kMaxSamples = 1000;
  for (;;) {
    std::vector<void*> samples(kMaxSamples, nullptr);
    std::vector<dds_sample_info_t> infos(kMaxSamples);
    const dds_return_t count = dds_take(reader.handle(), samples.data(), infos.data(), kMaxSamples, kMaxSamples);
    if (count <= 0) return;
    for (dds_return_t i = 0; i < count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (!infos[index].valid_data) continue;
      const std::string name = static_cast<const dds_builtintopic_endpoint_t*>(samples[index])->topic_name;
      if (!name.starts_with("rt/") || !known.insert(name).second) continue;
      fmt::print("topic {}\n", name.substr(2));
      std::fflush(stdout);
    }
    dds_return_loan(reader.handle(), samples.data(), count);
  }
}

// Whether the input has ended; waits for a period.
bool HasEnded() {
  pollfd input = {STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, kPeriod) <= 0) return false;
  char byte = 0;
  return read(STDIN_FILENO, &byte, 1) <= 0;
}

int Main(int argc, const char* const* argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: matrix_ros_node DOMAIN NAME\n");
    return 2;
  }
  ros::RosNetwork network;
  network.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  network.network_interface = "lo";
  network.service_clients = ros::ServiceClients::kCyclone;
  ros::RosParticipant participant(network);
  const dds::Entity reader(dds::Check(
      dds_create_reader(participant.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "reading the graph"));
  const ros::RosNode node = ros::MakeNode(participant, "/", argv[2]);
  ros::RosReader<ros::Header> ticks(node, "/world/tick", ros::Latched());
  ros::RosWriter<ros::Header> answers(node, "/world/tick_done", ros::Stream(10));
  participant.Announce();
  std::set<std::string> known;
  std::optional<ros::Time> open;  // a tick without an answer
  while (!HasEnded()) {
    PrintTopics(reader, known);
    ticks.Drain([&open](const ros::Header& tick) { open = tick.stamp; });
    if (!open || !answers.wanted()) continue;
    dds::WireArena arena;
    ros::Header answer{};
    answer.stamp = *open;
    answer.frame_id = arena.Copy(argv[2]);
    answers.Write(answer);
    open.reset();
  }
  return 0;
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  return troupe::Main(argc, argv);
}
