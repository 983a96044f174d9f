// Paths: files that may be opened on behalf of another process, folders of the installation, and folders of keys.
//
// A service opens files that another process names; AllowedPaths limits these to what the owner of the run has allowed.
// Links are resolved before the comparison, and the resolved path is what gets opened.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// AllowedPaths: the files that may be opened on behalf of another process.
class AllowedPaths {
 public:
  // Allows nothing.
  AllowedPaths() = default;
  // Allows every path.
  static AllowedPaths All();

  // Allows a file, or a folder with everything below it. Links are resolved now; a relative path starts at the working
  // directory.
  void Add(const std::string& path);

  // The path to open in place of `path`, with all links resolved; nothing if it is not allowed. A file that does not
  // exist may be allowed.
  std::optional<std::string> Resolve(const std::string& path) const;

  // Resolved, in the order of Add.
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  bool all_ = false;
  std::vector<std::string> paths_;
};

// The folders of the installation that the running program belongs to.

// Where the running program is.
Result<std::string> ProgramFolder();

// "PREFIX/share/troupe/NAME" for a program in PREFIX/bin, or for the library libtroupe if that has the folder and the
// program has not. It may not be there; empty if the program's is unknown.
std::string InstalledFolder(const std::string& name);

// The folder "worlds" of the installation; empty if there is none.
std::string InstalledWorldsFolder();

// An enclave: the folder with the keys of a DDS participant. Its files have the names that ROS 2's own tools use.

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
