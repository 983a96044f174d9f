#include "transport/dds/tools/session_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/dds_domain.h"
#include "transport/dds/transport/dds_transport.h"

namespace troupe {
namespace {

using test::Eventually;

struct RunningService {
  std::unique_ptr<Transport> transport;
  std::unique_ptr<ServiceEndpoint> endpoint;
  StatusMessage status;
};

TEST(SessionMonitorTest, ListsTheSessionsOfADomainWithTheirStatus) {
  DdsOptions options;
  options.domain = test::TestDomain();
  const std::string prefix = test::TestSession("monitor");
  SessionMonitor monitor(options);
  std::map<std::string, RunningService> services;
  // Sessions of other tests may exist.
  std::vector<SessionInfo> seen;
  const auto sees = [&](std::size_t count) {
    return Eventually([&] {
      // Again and again, as a run does: a status that arrives before its session is ignored.
      for (const auto& [name, service] : services) service.endpoint->SendStatus(service.status);
      monitor.WaitForChange(0.1);
      seen = monitor.Sessions();
      seen.erase(std::remove_if(seen.begin(), seen.end(),
                                [&](const SessionInfo& info) { return info.session.rfind(prefix, 0) != 0; }),
                 seen.end());
      return seen.size() == count &&
             std::all_of(seen.begin(), seen.end(), [](const SessionInfo& info) { return info.status.has_value(); });
    });
  };
  const auto start = [&](const std::string& name, RunId run) {
    options.session = prefix + name;
    RunningService& service = services[name];
    service.transport = MakeDdsServiceTransport(options).transport;
    service.endpoint = service.transport->MakeServiceEndpoint();
    SessionMessage session{.run = run, .host = "machine", .pid = 77};
    session.world.name = "world of " + name;
    service.endpoint->SendSession(session);
    service.status.run = run;
    service.status.tick = 10 * run;
  };
  start("b", 1);
  start("a", 2);
  ASSERT_TRUE(sees(2));
  EXPECT_EQ(prefix + "a", seen[0].session);
  EXPECT_EQ(2u, seen[0].run);
  EXPECT_EQ("machine", seen[0].host);
  EXPECT_EQ(77u, seen[0].pid);
  EXPECT_EQ("world of a", seen[0].world);
  EXPECT_EQ(20u, seen[0].status->tick);
  EXPECT_EQ(prefix + "b", seen[1].session);

  services["a"].status.tick = 21;
  services["a"].status.waiting_for = {"r7"};
  EXPECT_TRUE(Eventually([&] { return sees(2) && seen[0].status->tick == 21; }));
  EXPECT_EQ(std::vector<std::string>{"r7"}, seen[0].status->waiting_for);

  services.erase("a");
  ASSERT_TRUE(sees(1));
  EXPECT_EQ(prefix + "b", seen[0].session);
}

}  // namespace
}  // namespace troupe
