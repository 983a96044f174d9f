#include "transport/dds/binding/security_properties.h"

#include <dds/dds.h>
#include <dlfcn.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <system_error>

#include "common/base/enclave.h"

namespace troupe::dds {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

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

}  // namespace troupe::dds
