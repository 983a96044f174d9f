#include "common/dds/domain_config.h"

namespace troupe::dds {
namespace {

// As text inside a quoted attribute. Cyclone expands ${...} in values, which a name from the command line never means.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '$') {
      escaped += "\\$";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string NetworkInterface(const DomainConfig& config) {
  if (config.network_interface == "auto") return R"(<NetworkInterface autodetermine="true"/>)";
  // Cyclone takes the loopback interface for one without multicast unless told.
  const char* multicast = config.network_interface == "lo" ? R"( multicast="true")" : "";
  return R"(<NetworkInterface name=")" + Escaped(config.network_interface) + "\"" + multicast + "/>";
}

// A datagram on the loopback interface may be 64 KiB long; elsewhere Cyclone's default, which fits an Ethernet packet,
// keeps the network from cutting datagrams up.
std::string MessageSizes(const DomainConfig& config) {
  if (config.network_interface != "lo") return "";
  return "<MaxMessageSize>65000B</MaxMessageSize><FragmentSize>64000B</FragmentSize>";
}

std::string Multicast(const DomainConfig& config) {
  if (config.data_multicast) return config.discovery_multicast ? "spdp,asm" : "asm";
  return config.discovery_multicast ? "spdp" : "false";
}

std::string Peers(const DomainConfig& config) {
  std::string peers;
  for (const std::string& peer : config.peers) peers += R"(<Peer address=")" + Escaped(peer) + R"("/>)";
  return peers.empty() ? "" : "<Peers>" + peers + "</Peers>";
}

}  // namespace

DomainConfig ToolConfig(std::uint32_t domain, const std::string& network_interface,
                        const std::string& service_address) {
  DomainConfig config;
  config.domain = domain;
  config.network_interface = network_interface;
  config.peers = {service_address.empty() ? "127.0.0.1" : service_address};
  return config;
}

std::uint16_t DiscoveryPort(std::uint32_t domain, std::uint32_t participant_index) {
  return static_cast<std::uint16_t>(7400 + 250 * domain + 10 + 2 * participant_index);
}

std::string ToXml(const DomainConfig& config) {
  const std::string index = config.participant_index ? std::to_string(*config.participant_index) : "none";
  const std::string lease = std::to_string(config.lease_seconds) + "s";
  std::string xml = R"(<CycloneDDS><Domain Id="any">)";
  xml += "<General><Interfaces>" + NetworkInterface(config) + "</Interfaces>";
  xml += "<AllowMulticast>" + Multicast(config) + "</AllowMulticast>";
  xml += MessageSizes(config) + "</General>";
  xml += "<Discovery><ExternalDomainId>" + std::to_string(config.domain) + "</ExternalDomainId>";
  xml += "<ParticipantIndex>" + index + "</ParticipantIndex>";
  xml += "<MaxAutoParticipantIndex>" + std::to_string(kPeerPortsTried - 1) + "</MaxAutoParticipantIndex>";
  xml += Peers(config) + "<LeaseDuration>" + lease + "</LeaseDuration></Discovery>";
  // In lockstep the next message acknowledges the one before, so heartbeats may be rare: they cost a datagram from each
  // agent. They must not be too rare either, because a lost message is only noticed by the next one. The watermark of
  // what is not acknowledged is out of reach: a write must never wait for the thread that it may itself be running on.
  xml +=
      "<Internal>"
      R"(<HeartbeatInterval min="20ms" minsched="100ms" max="1s">100ms</HeartbeatInterval>)"
      "<AckDelay>10ms</AckDelay>"
      "<NackDelay>10ms</NackDelay>"
      "<MultipleReceiveThreads>true</MultipleReceiveThreads>"
      "<Watermarks><WhcHigh>64MB</WhcHigh><WhcHighInit>64MB</WhcHighInit><WhcAdaptive>false</WhcAdaptive></Watermarks>"
      "</Internal>";
  // Smaller than Cyclone's defaults: an agent's memory counts once for each robot.
  xml += "<Sizing><ReceiveBufferSize>256KiB</ReceiveBufferSize>";
  xml += "<ReceiveBufferChunkSize>128KiB</ReceiveBufferChunkSize></Sizing>";
  xml += "</Domain></CycloneDDS>";
  return xml;
}

}  // namespace troupe::dds
