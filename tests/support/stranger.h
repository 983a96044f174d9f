// A stranger: a DDS participant without any part in a run, as any program of the network can make one.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/support/dds_domain.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/qos_profiles.h"

namespace troupe::test {

struct Stranger {
  // `peers`: "host:port" of further processes that it announces itself to.
  explicit Stranger(const std::string& session, std::vector<std::string> peers = {},
                    const std::string& interface = "lo")
      : participant(Config(std::move(peers), interface)),
        publisher(participant, dds::qos_profiles::Session(session)),
        agent_publisher(participant, dds::qos_profiles::Agent(session, "stranger")) {}

  // At an index that agents look for their service at, so that those without its port discover it.
  static dds::DomainConfig Config(std::vector<std::string> peers, const std::string& interface) {
    dds::DomainConfig config = TestConfig();
    config.network_interface = interface;
    config.participant_index = dds::kPeerPortsTried - 1;
    config.peers = std::move(peers);
    return config;
  }

  dds::DomainParticipant participant;
  dds::Publisher publisher;        // where the service writes, and tools
  dds::Publisher agent_publisher;  // where agents write
};

// A writer of a stranger's.
template <typename Wire>
class Forger {
 public:
  Forger(const Stranger& stranger, const dds::Publisher& publisher, const char* topic, const dds::Qos& qos)
      : topic_(stranger.participant, topic), writer_(publisher, topic_, qos) {}

  std::int32_t readers() { return writer_.publication_matched_status().current_count; }
  bool Found(double seconds = 20.0) {
    return Eventually([this] { return readers() > 0; }, seconds);
  }
  template <typename Message>
  void Send(const Message& message) {
    dds::WireArena arena;
    writer_.write(dds::ToWire(message, arena));
  }
  bool Delivered() { return writer_.wait_for_acknowledgments(20.0); }

 private:
  dds::Topic<Wire> topic_;
  dds::DataWriter<Wire> writer_;
};

}  // namespace troupe::test
