#include "transport/dds/binding/domain_participant.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <map>
#include <mutex>
#include <utility>

#include "common/base/enclave.h"
#include "transport/dds/binding/exception.h"
#include "transport/dds/binding/free_ports.h"
#include "transport/dds/binding/security_properties.h"

namespace troupe::dds {
namespace {

constexpr std::uint32_t kDomains = 231;

std::string Starting(const DomainConfig& config) {
  return "starting DDS domain " + std::to_string(config.domain) + " on network interface '" + config.network_interface +
         "'";
}

bool HasFreeIndex(const DomainConfig& config) {
  for (std::uint32_t index = 0; index < config.indices_tried; ++index) {
    if (PortsAreFree(config.domain, index)) return true;
  }
  return false;
}

// The result of dds_create_domain. Of many participants, the last ones find no free index.
dds_entity_t TryToCreate(std::uint32_t number, DomainConfig config) {
  if (HasFreeIndex(config)) {
    const dds_entity_t handle = dds_create_domain(number, ToXml(config).c_str());
    if (handle >= 0 || HasFreeIndex(config)) return handle;
  }
  config.indices_tried = 0;
  return dds_create_domain(number, ToXml(config).c_str());
}

// Cyclone knows a domain by one number in a process and by another one on the network. Any free number will do in the
// process, so that several participants, each with a configuration of its own, can be in one domain. The highest ones
// come first: low ones are those of ROS domains, which can need theirs.
SharedDomain CreateDomain(const DomainConfig& config) {
  for (std::uint32_t number = kDomains; number-- > 0;) {
    const dds_entity_t handle = TryToCreate(number, config);
    if (handle == DDS_RETCODE_PRECONDITION_NOT_MET) continue;
    return {std::make_shared<const Entity>(Check(handle, Starting(config))), number};
  }
  throw Exception(DDS_RETCODE_OUT_OF_RESOURCES, Starting(config));
}

// The domains of this process that have their number on the network.
struct NumberedDomain {
  std::weak_ptr<const Entity> entity;
  std::string xml;
};
std::mutex numbered_mutex;
std::map<std::uint32_t, NumberedDomain> numbered_domains;  // guarded by the mutex

// Participants of such a domain share it.
SharedDomain OpenNumberedDomain(const DomainConfig& config) {
  const std::string xml = ToXml(config);
  std::shared_ptr<const Entity> open;  // released after the lock, which the end of the domain needs
  const std::lock_guard lock(numbered_mutex);
  NumberedDomain& domain = numbered_domains[config.domain];
  open = domain.entity.lock();
  if (open) {
    if (domain.xml == xml) return {std::move(open), config.domain};
    throw Exception(DDS_RETCODE_PRECONDITION_NOT_MET, Starting(config) + " (this process has it with other settings)");
  }
  const auto close = [](const Entity* entity) {
    const std::lock_guard closing(numbered_mutex);  // until it is closed, no other can have the number
    delete entity;
  };
  const dds_entity_t handle = Check(TryToCreate(config.domain, config), Starting(config));
  const std::shared_ptr<const Entity> created(new Entity(handle), close);
  domain = {created, xml};
  return {created, config.domain};
}

// Cyclone ends the process where it cannot start a thread, as with a limit of the address space.
void CheckRoomForThreads(const DomainConfig& config) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  constexpr std::size_t kRoom = std::size_t{96} << 20;  // bytes, for about ten threads
  void* const room = mmap(nullptr, kRoom, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) {
    throw Exception(DDS_RETCODE_OUT_OF_RESOURCES,
                    Starting(config) + " (expected 96 MiB more of address space: ulimit -v)");
  }
  munmap(room, kRoom);
}

SharedDomain OpenDomain(const DomainConfig& config) {
  CheckRoomForThreads(config);
  if (config.domain >= kDomains) throw Exception(DDS_RETCODE_BAD_PARAMETER, Starting(config) + " (expected 0 to 230)");
  if (!config.security_enclave.empty()) {
    const Status enclave = CheckEnclave(config.security_enclave);
    if (!enclave.ok()) throw Exception(DDS_RETCODE_BAD_PARAMETER, Starting(config) + ": " + enclave.error().ToString());
  }
  return config.numbered_as_on_network ? OpenNumberedDomain(config) : CreateDomain(config);
}

}  // namespace

DomainParticipant::DomainParticipant(const DomainConfig& config, const Qos& qos)
    : domain_(OpenDomain(config)), describes_types_(config.describes_types) {
  const Qos secured = config.security_enclave.empty() ? qos : WithSecurity(qos, config.security_enclave);
  participant_ =
      Entity(Check(dds_create_participant(domain_.number, secured.get(), nullptr), "creating a participant"));
}

GuidPrefix DomainParticipant::guid_prefix() const {
  dds_guid_t guid;
  Check(dds_get_guid(participant_.handle(), &guid), "reading the identity of a participant");
  return PrefixOf(guid);
}

}  // namespace troupe::dds
