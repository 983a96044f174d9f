// Measures how long a tool needs for the ROS graph: discovers the writers of a domain as a tool of ROS does, and prints
// the seconds until all robots have their topics.
//     ros_graph DOMAIN INTERFACE ROBOTS TOPIC [SECONDS]
// TOPIC is the end of a topic's name that each robot has once, "/odom". Exit status 1: not all came within the time.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "ros/connection/ros_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// The topics with a writer, of those that end in `ending`.
void AddTopics(const dds::Entity& reader, std::string_view ending, std::set<std::string>& topics) {
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
      if (name.starts_with("rt/") && name.ends_with(ending)) topics.insert(name);
    }
    dds_return_loan(reader.handle(), samples.data(), count);
  }
}

int Main(int argc, const char* const* argv) {
  if (argc < 5) {
    fmt::print(stderr, "usage: ros_graph DOMAIN INTERFACE ROBOTS TOPIC [SECONDS]\n");
    return 2;
  }
  ros::RosNetwork options;
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  options.network_interface = argv[2];
  const auto robots = static_cast<std::size_t>(std::atoi(argv[3]));
  const double limit = argc > 5 ? std::atof(argv[5]) : 60.0;
  const Clock::time_point start = Clock::now();
  const ros::RosParticipant participant(options);
  const dds::Entity reader(dds::Check(
      dds_create_reader(participant.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "reading the graph"));
  std::set<std::string> topics;
  double seconds = 0.0;
  while (topics.size() < robots && seconds < limit) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    AddTopics(reader, argv[4], topics);
    seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }
  fmt::print("{:.2f} s: {} of {} robots\n", seconds, topics.size(), robots);
  return topics.size() < robots ? 1 : 0;
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  return troupe::Main(argc, argv);
}
