#include "common/dds/binding/domain_participant.h"

#include "common/base/enclave.h"
#include "common/dds/binding/exception.h"

namespace troupe::dds {
namespace {

constexpr std::uint32_t kDomains = 231;

// Cyclone knows a domain by one number in a process and by another one on the network. Any free number will do in the
// process, so that several participants, each with a configuration of its own, can be in one domain.
Entity CreateDomain(const DomainConfig& config, dds_domainid_t& local_id) {
  const std::string doing = "starting DDS domain " + std::to_string(config.domain) + " on network interface '" +
                            config.network_interface + "'";
  if (config.domain >= kDomains) throw Exception(DDS_RETCODE_BAD_PARAMETER, doing + " (expected 0 to 230)");
  if (!config.security_enclave.empty()) {
    const Status enclave = CheckEnclave(config.security_enclave);
    if (!enclave.ok()) throw Exception(DDS_RETCODE_BAD_PARAMETER, doing + ": " + enclave.error().ToString());
  }
  const std::string xml = ToXml(config);
  for (std::uint32_t attempt = 0; attempt < kDomains; ++attempt) {
    local_id = (config.domain + attempt) % kDomains;
    const dds_entity_t handle = dds_create_domain(local_id, xml.c_str());
    if (handle != DDS_RETCODE_PRECONDITION_NOT_MET) return Entity(Check(handle, doing));
  }
  throw Exception(DDS_RETCODE_OUT_OF_RESOURCES, doing);
}

}  // namespace

DomainParticipant::DomainParticipant(const DomainConfig& config, const Qos& qos) {
  dds_domainid_t local_id = 0;
  domain_ = CreateDomain(config, local_id);
  participant_ = Entity(Check(dds_create_participant(local_id, qos.get(), nullptr), "creating a participant"));
}

GuidPrefix DomainParticipant::guid_prefix() const {
  dds_guid_t guid;
  Check(dds_get_guid(participant_.handle(), &guid), "reading the identity of a participant");
  return PrefixOf(guid);
}

}  // namespace troupe::dds
