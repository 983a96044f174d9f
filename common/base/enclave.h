// An enclave: the folder with the keys of a DDS participant. Its files have the names that ROS 2's own tools use.
#pragma once

#include <array>
#include <string>

#include "troupe/result.h"

namespace troupe {

inline constexpr const char* kIdentityCaFile = "identity_ca.cert.pem";
inline constexpr const char* kPermissionsCaFile = "permissions_ca.cert.pem";
inline constexpr const char* kCertificateFile = "cert.pem";
inline constexpr const char* kPrivateKeyFile = "key.pem";
inline constexpr const char* kGovernanceFile = "governance.p7s";
inline constexpr const char* kPermissionsFile = "permissions.p7s";

inline constexpr std::array kEnclaveFiles = {kIdentityCaFile, kPermissionsCaFile, kCertificateFile,
                                             kPrivateKeyFile, kGovernanceFile,    kPermissionsFile};

// Fails with the name of the first file that is missing, empty or not readable. Does not look at the contents.
Status CheckEnclave(const std::string& folder);

}  // namespace troupe
