#include "transport/dds/binding/domain_participant.h"

#include <dds/dds.h>
#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <mutex>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "common/base/paths.h"
#include "transport/dds/binding/network_log.h"

namespace troupe::dds {
namespace {

namespace fs = std::filesystem;

// DDS Security for a participant: Cyclone's three plugins, and the participant's keys.

// Debian installs the plugins in a folder beside Cyclone's library, where the loader does not search.
fs::path LibraryFolder() {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_domain), &library) == 0) return {};
  std::error_code failure;
  const fs::path resolved = fs::canonical(library.dli_fname, failure);
  return failure ? fs::path() : resolved.parent_path();
}

// A plugin that is not found is left to the loader, and Cyclone reports it.
std::string PluginPath(const char* plugin) {
  std::string file = std::string("libdds_security_") + plugin + ".so";
  const fs::path folder = LibraryFolder();
  std::error_code failure;
  for (const fs::path& path : {folder / "libddsc0debian" / file, folder / file}) {
    if (fs::is_regular_file(path, failure)) return path.string();
  }
  return file;
}

// `functions`: in the names of the functions that start and end the plugin.
void AddPlugin(Qos& qos, const std::string& property, const char* plugin, const std::string& functions) {
  const std::string library = "dds.sec." + property + ".library.";
  qos << Property{library + "path", PluginPath(plugin)} << Property{library + "init", "init_" + functions}
      << Property{library + "finalize", "finalize_" + functions};
}

void AddFile(Qos& qos, const std::string& property, const fs::path& folder, const char* file) {
  qos << Property{"dds.sec." + property, "file://" + (folder / file).string()};
}

// `enclave`: a folder as in common/base/paths.h, whose files are not looked at.
Qos WithSecurity(Qos participant, const std::string& enclave) {
  const fs::path folder = fs::absolute(enclave);
  AddPlugin(participant, "auth", "auth", "authentication");
  AddFile(participant, "auth.identity_ca", folder, kIdentityCaFile);
  AddFile(participant, "auth.identity_certificate", folder, kCertificateFile);
  AddFile(participant, "auth.private_key", folder, kPrivateKeyFile);
  AddPlugin(participant, "crypto", "crypto", "crypto");
  AddPlugin(participant, "access", "ac", "access_control");
  AddFile(participant, "access.permissions_ca", folder, kPermissionsCaFile);
  AddFile(participant, "access.governance", folder, kGovernanceFile);
  AddFile(participant, "access.permissions", folder, kPermissionsFile);
  return participant;
}

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
// come first: low ones are the numbers of ROS domains, which can need theirs.
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
    LeaveOutEarlyParticipants();
  }
  return config.numbered_as_on_network ? OpenNumberedDomain(config) : CreateDomain(config);
}

dds_topic_descriptor_t WithoutTypeInformation(const dds_topic_descriptor_t& type) {
  return {.m_size = type.m_size,
          .m_align = type.m_align,
          .m_flagset = type.m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
          .m_nkeys = type.m_nkeys,
          .m_typename = type.m_typename,
          .m_keys = type.m_keys,
          .m_nops = type.m_nops,
          .m_ops = type.m_ops,
          .m_meta = type.m_meta,
          .type_information = {},
          .type_mapping = {},
          .restrict_data_representation = type.restrict_data_representation};
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

void Publisher::AwaitAcknowledgments(double seconds) const noexcept {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  std::vector<dds_entity_t> writers;
  try {
    writers.resize(static_cast<std::size_t>(std::max(0, dds_get_children(handle(), nullptr, 0))));
  } catch (const std::bad_alloc&) {  // destructors wait, too
    return;
  }
  dds_get_children(handle(), writers.data(), writers.size());
  for (const dds_entity_t writer : writers) {
    const double left = std::chrono::duration<double>(end - Clock::now()).count();
    dds_wait_for_acks(writer, ToDuration(std::max(0.0, left)));
  }
}

dds_entity_t CreateTopic(const DomainParticipant& participant, const dds_topic_descriptor_t& type,
                         const std::string& name) {
  const dds_topic_descriptor_t undescribed = WithoutTypeInformation(type);
  const dds_topic_descriptor_t* const announced = participant.describes_types() ? &type : &undescribed;
  return Check(dds_create_topic(participant.handle(), announced, name.c_str(), nullptr, nullptr),
               "creating topic '" + name + "'");
}

}  // namespace troupe::dds
