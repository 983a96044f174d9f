#include "common/dds/binding/security_config.h"

#include <dds/dds.h>
#include <dlfcn.h>

#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <system_error>

#include "common/base/enclave.h"
#include "common/dds/binding/xml_text.h"

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
  const std::string file = std::string("libdds_security_") + plugin + ".so";
  const fs::path folder = LibraryFolder();
  std::error_code failure;
  for (const fs::path& path : {folder / "libddsc0debian" / file, folder / file}) {
    if (fs::is_regular_file(path, failure)) return path.string();
  }
  return file;
}

std::string LibraryElement(const char* plugin, const std::string& functions) {
  return R"(<Library initFunction="init_)" + functions + R"(" finalizeFunction="finalize_)" + functions +
         R"(" path=")" + XmlText(PluginPath(plugin)) + R"("/>)";
}

std::string FileElement(const std::string& element, const fs::path& folder, const char* file) {
  return "<" + element + ">file://" + XmlText((folder / file).string()) + "</" + element + ">";
}

}  // namespace

std::string SecurityXml(const std::string& enclave) {
  if (enclave.empty()) return {};
  const fs::path folder = fs::absolute(enclave);
  return "<Security><Authentication>" + LibraryElement("auth", "authentication") +
         FileElement("IdentityCA", folder, kIdentityCaFile) +
         FileElement("IdentityCertificate", folder, kCertificateFile) +
         FileElement("PrivateKey", folder, kPrivateKeyFile) + "</Authentication><Cryptographic>" +
         LibraryElement("crypto", "crypto") + "</Cryptographic><AccessControl>" +
         LibraryElement("ac", "access_control") + FileElement("PermissionsCA", folder, kPermissionsCaFile) +
         FileElement("Governance", folder, kGovernanceFile) + FileElement("Permissions", folder, kPermissionsFile) +
         "</AccessControl></Security>";
}

}  // namespace troupe::dds
