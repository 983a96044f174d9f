// Calls ROS services on Fast DDS, as programs on rmw_fastrtps_cpp do. Prints JSON lines. DOMAIN: "5" on the loopback
// interface, "5@10.0.0.1" on the interface with this address, "5@localhost" as Jazzy in that range.
//   fastdds_caller DOMAIN states N SECONDS   calls /world/get_simulation_state N times, each with this timeout
//   fastdds_caller DOMAIN parameters /NODE   lists the parameters of a node
//   fastdds_caller DOMAIN leaves /NODE       the same, and waits until the service is gone
//   fastdds_caller DOMAIN describe N         asks N times for the description of a large type
//   fastdds_caller DOMAIN simulate N         sends the goal of N steps to the action simulate_steps of a paused run
//   fastdds_caller DOMAIN step N             has a paused run make N steps, by the service
//   fastdds_caller DOMAIN endpoints          counts the servers' endpoints that a client of each service can match;
//                                            ends by a signal
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "nodePubSubTypes.h"
#include "parametersPubSubTypes.h"
#include "peer.h"
#include "service_client.h"
#include "simulate_stepsPubSubTypes.h"
#include "simulationPubSubTypes.h"
#include "stdPubSubTypes.h"

namespace {

namespace action = simulation_interfaces::action::dds_;
namespace rcl = rcl_interfaces::srv::dds_;
namespace srv = simulation_interfaces::srv::dds_;
namespace types = type_description_interfaces::srv::dds_;

void CallForStates(Peer& peer, int calls, int seconds) {
  Client<srv::GetSimulationState_Request_PubSubType, srv::GetSimulationState_Response_PubSubType> client(
      peer, "/world/get_simulation_state");
  client.WaitForService();
  Print({{"topic", "calling"}, {"matched", client.Matched()}});
  int answered = 0;
  for (int i = 0; i < calls; ++i) {
    const std::int64_t number = client.Send({});
    if (client.IsAnswered(number, seconds)) {
      answered += client.Await(number).result().result() == 1;
    } else {
      Print({{"topic", "timeout"}, {"call", i}});
      client.WaitForService();
    }
    for (int quarter = 1; quarter < 4; ++quarter) {
      if (i + 1 == quarter * calls / 4) Print({{"topic", "quarter"}, {"number", quarter}});
    }
  }
  Print({{"topic", "called"}, {"calls", calls}, {"answered", answered}, {"repeated", client.repeated()}});
}

void ListParameters(Peer& peer, const std::string& node, bool until_gone) {
  Client<rcl::ListParameters_Request_PubSubType, rcl::ListParameters_Response_PubSubType> client(
      peer, node + "/list_parameters");
  client.WaitForService();
  Print({{"topic", "parameters"}, {"names", client.Call({}).result().names()}});
  if (!until_gone) return;
  Until([&] { return client.Matched() == std::pair(0, 0); });
  Print({{"topic", "gone"}});
}

void Describe(Peer& peer, int calls) {
  Client<types::GetTypeDescription_Request_PubSubType, types::GetTypeDescription_Response_PubSubType> client(
      peer, "/world/get_type_description");
  client.WaitForService();
  types::GetTypeDescription_Request_ request;
  request.type_name("visualization_msgs/msg/MarkerArray");
  // A refusal ends with the hash that the request lacks.
  const std::string refusal = client.Call(request).failure_reason();
  request.type_hash(refusal.substr(refusal.find_last_of(' ') + 1));
  int found = 0;
  std::size_t parts = 0;
  for (int i = 0; i < calls; ++i) {
    const auto response = client.Call(request);
    found += response.successful();
    parts = response.type_description().referenced_type_descriptions().size();
  }
  Print({{"topic", "described"}, {"found", found}, {"parts", parts}, {"repeated", client.repeated()}});
}

void Simulate(Peer& peer, std::uint64_t steps) {
  const std::string name = "/world/simulate_steps/_action/";
  Client<action::SimulateSteps_SendGoal_Request_PubSubType, action::SimulateSteps_SendGoal_Response_PubSubType>
      send_goal(peer, name + "send_goal");
  Client<action::SimulateSteps_GetResult_Request_PubSubType, action::SimulateSteps_GetResult_Response_PubSubType>
      get_result(peer, name + "get_result");
  std::atomic<std::uint64_t> feedback = 0;
  peer.Read<action::SimulateSteps_FeedbackMessage_PubSubType>(
      name + "feedback", [&](const action::SimulateSteps_FeedbackMessage_& message) {
        feedback = std::max<std::uint64_t>(feedback, message.feedback().completed_steps());
      });
  send_goal.WaitForService();
  get_result.WaitForService();
  AwaitSampleOf<rosgraph_msgs::msg::dds_::Clock_PubSubType>(peer, "/clock");
  action::SimulateSteps_SendGoal_Request_ goal;
  goal.goal_id().uuid()[0] = 1;
  goal.goal().steps(steps);
  const bool accepted = send_goal.Call(goal).accepted();
  action::SimulateSteps_GetResult_Request_ ask;
  ask.goal_id(goal.goal_id());
  std::int64_t asked = get_result.Send(ask);
  Print({{"topic", "asked"}});
  while (!get_result.IsAnswered(asked, 1)) {  // its server may have died
    get_result.WaitForService();
    asked = get_result.Send(ask);
  }
  const auto ended = get_result.Await(asked);
  Until([&] { return feedback == steps; });
  Print({{"topic", "simulated"},
         {"accepted", accepted},
         {"status", ended.status()},
         {"result", ended.result().result().result()},
         {"feedback", feedback.load()}});
  peer.Close();
}

void Step(Peer& peer, std::uint64_t steps) {
  Client<srv::StepSimulation_Request_PubSubType, srv::StepSimulation_Response_PubSubType> client(
      peer, "/world/step_simulation");
  client.WaitForService();
  srv::StepSimulation_Request_ request;
  request.steps(steps);
  const std::int64_t number = client.Send(request);
  Print({{"topic", "asked"}});
  const int result = client.Await(number).result().result();
  Print({{"topic", "stepped"}, {"result", result}, {"repeated", client.repeated()}});
}

// The endpoints of servers: readers of requests and writers of responses.
class Endpoints final : public DomainParticipantListener {
 public:
  void on_subscriber_discovery(DomainParticipant*, eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override {
    const bool gone = info.status == eprosima::fastrtps::rtps::ReaderDiscoveryInfo::REMOVED_READER;
    if (info.info.topicName().to_string().starts_with("rq/")) Note(info.info, gone);
  }
  void on_publisher_discovery(DomainParticipant*, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override {
    const bool gone = info.status == eprosima::fastrtps::rtps::WriterDiscoveryInfo::REMOVED_WRITER;
    if (info.info.topicName().to_string().starts_with("rr/")) Note(info.info, gone);
  }

 private:
  template <typename Data>
  void Note(const Data& data, bool gone) {
    std::string partitions;
    for (const auto& partition : data.m_qos.m_partition) partitions += partition.name();
    std::string user_data;
    for (const auto octet : data.m_qos.m_userData.getValue()) user_data += static_cast<char>(octet);
    Print({{"topic", gone ? "left" : "found"},
           {"on", data.topicName().to_string()},
           {"partitions", partitions},
           {"type", data.typeName().to_string()},
           {"user_data", user_data}});
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string what = argv[2];
  const std::string where = argv[1];
  const std::size_t at = where.find('@');
  Endpoints endpoints;
  Peer peer(static_cast<std::uint32_t>(std::stoul(where)), what == "endpoints" ? &endpoints : nullptr,
            at == std::string::npos ? "127.0.0.1" : where.substr(at + 1));
  try {
    if (what == "endpoints") {
      pause();
    } else if (argc < 4) {
      return 2;
    } else if (what == "states") {
      CallForStates(peer, std::atoi(argv[3]), argc > 4 ? std::atoi(argv[4]) : kSeconds);
    } else if (what == "parameters" || what == "leaves") {
      ListParameters(peer, argv[3], what == "leaves");
    } else if (what == "describe") {
      Describe(peer, std::atoi(argv[3]));
    } else if (what == "simulate") {
      Simulate(peer, std::strtoull(argv[3], nullptr, 10));
    } else if (what == "step") {
      Step(peer, std::strtoull(argv[3], nullptr, 10));
    }
    peer.Close();
  } catch (const std::exception& exception) {
    Print({{"topic", "failed"}, {"why", exception.what()}});
    std::_Exit(1);
  }
  Print({{"topic", "done"}});
  return 0;
}
