// A client of a ROS service, for tests, and what its messages have.
// It writes the header of rmw_cyclonedds by itself, so that the format on the wire is tested and not only a library's
// agreement with itself.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/messages.h"
#include "tests/support/dds_domain.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "troupe/ids.h"

namespace troupe::test {

// Results of simulation_interfaces/Result.
inline constexpr std::uint8_t kOk = 1;
inline constexpr std::uint8_t kNotFound = 2;
inline constexpr std::uint8_t kFailed = 4;

// s, for a call on the slowest machine.
inline constexpr double kClientSeconds = 60.0;

// The tick of pen.world, with ten ticks in a second.
inline Tick TickOf(const ros::Time& stamp) {
  return static_cast<Tick>(stamp.sec) * 10 + stamp.nanosec / 100'000'000;
}

// For a field of a message that is only sent.
inline char* Text(const char* text) {
  return const_cast<char*>(text);
}

// Calls a service as rmw_cyclonedds does.
template <typename Request, typename Response>
class Client {
 public:
  // `id` tells clients of one service apart.
  Client(const ros::RosParticipant& participant, const std::string& service, std::uint64_t id = 4711)
      : id_(id),
        request_topic_(participant.participant(), "rq" + service + "Request"),
        response_topic_(participant.participant(), "rr" + service + "Reply"),
        writer_(participant.publisher(), request_topic_, ros::ToDds(ros::Service())),
        reader_(participant.subscriber(), response_topic_, ros::ToDds(ros::Service())) {}

  // Sends the request, waits for its response and passes that to `check`.
  template <typename Check>
  void Call(const Request& request, const Check& check) {
    Send(request);
    ASSERT_TRUE(Eventually([&] { return Receive(check); }, kClientSeconds));
  }

  // The result of a service of simulation_interfaces.
  std::uint8_t ResultOf(const Request& request) {
    std::uint8_t result = 0;
    Call(request, [&](const auto& response) { result = response.result.result; });
    return result;
  }

  // Sends the request without waiting for a response.
  void Send(Request request) {
    ASSERT_TRUE(Eventually(
        [&] {
          return writer_.publication_matched_status().current_count > 0 &&
                 reader_.subscription_matched_status().current_count > 0;
        },
        kClientSeconds));
    request.client_guid = id_;
    request.sequence_number = ++calls_;
    writer_.write(request);
  }

  // Waits until the request has reached the server's process: up to a heartbeat long.
  void AwaitArrival() { ASSERT_TRUE(writer_.wait_for_acknowledgments(kClientSeconds)); }

  // Passes the response to `check` if it has arrived; returns whether it has.
  template <typename Check>
  bool Receive(const Check& check) {
    bool answered = false;
    for (const auto sample : reader_.take()) {
      if (sample.data().client_guid != id_) continue;  // for another client
      EXPECT_EQ(sample.data().sequence_number, calls_);
      check(sample.data());
      answered = true;
    }
    return answered;
  }

 private:
  const std::uint64_t id_;
  dds::Topic<Request> request_topic_;
  dds::Topic<Response> response_topic_;
  dds::DataWriter<Request> writer_;
  dds::DataReader<Response> reader_;
  std::int64_t calls_ = 0;
};

// For a service of simulation_interfaces.
#define TROUPE_SIMULATION_CLIENT(name) \
  Client<simulation_interfaces_srv_dds__##name##_Request_, simulation_interfaces_srv_dds__##name##_Response_>

template <typename Request, typename Response>
void StepBy(Client<Request, Response>& client, std::uint64_t ticks) {
  Request request{};
  request.steps = ticks;
  EXPECT_EQ(client.ResultOf(request), kOk);
}

}  // namespace troupe::test
