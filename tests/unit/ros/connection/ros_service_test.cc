#include <gtest/gtest.h>

#include <atomic>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/topic_types.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::ros {
namespace {

using Request = simulation_interfaces_srv_dds__GetSimulationState_Request_;
using Response = simulation_interfaces_srv_dds__GetSimulationState_Response_;
using StateClient = test::Client<Request, Response>;

class RosServiceTest : public testing::Test {
 protected:
  std::atomic<int> calls_ = 0;
  test::HostParticipant host_;
  std::unique_ptr<HostConnection> server_ = host_.Connect();
  RosNode node_ = MakeNode(*server_, "/", "node");
  RosService<Request, Response> service_{node_, "/state", [this](const RosCaller& caller, const Request&) {
                                           ++calls_;
                                           Response response{};
                                           response.result.error_message = const_cast<char*>("");
                                           response.result.result = 1;
                                           service_.Respond(caller, response);
                                         }};
};

void ExpectAnswer(const Response& response) {
  EXPECT_EQ(response.result.result, 1);
}

// The client shares the service with others, which continue to call it.
TEST_F(RosServiceTest, AResponseThatIsLostIsSentAgain) {
  const RosParticipant unlucky(test::TestRosNetwork());
  const RosParticipant lucky(test::TestRosNetwork());
  StateClient client(unlucky, "/state");
  StateClient other(lucky, "/state", 4712);
  client.Call({}, ExpectAnswer);
  other.Call({}, ExpectAnswer);
  dds::Check(dds_domain_set_deafmute(unlucky.participant().handle(), true, false, DDS_INFINITY), "losing packets");
  client.Send({});
  ASSERT_TRUE(test::Eventually([&] { return calls_ == 3; }));
  for (int i = 0; i < 100; ++i) other.Call({}, ExpectAnswer);
  EXPECT_FALSE(client.Receive(ExpectAnswer));
  dds::Check(dds_domain_set_deafmute(unlucky.participant().handle(), false, false, DDS_INFINITY), "losing none");
  EXPECT_TRUE(test::Eventually([&] { return client.Receive(ExpectAnswer); }));
}

}  // namespace
}  // namespace troupe::ros
