// SessionKeys: where the programs of a user find the keys of the runs on this host. A world service publishes the
// folder of its keys (KeyFolder has the layout) under the name of its session, in a folder that only its user
// can read, so that the tools of that user alone find the keys of a run by its session.
//
// Only the user's own programs can look here: the folder is refused if another user owns it or could read it, because
// another user who can write it could give a tool false keys. A killed service leaves names; they are removed by the
// next one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/locked_folder.h"
#include "transport/security/run_token.h"
#include "troupe/result.h"

namespace troupe {

// Role: the part that a participant has in the simulation domain. Its permissions follow from it.
struct Role {
  enum class Kind : std::uint8_t { kService, kAgent, kOperator, kObserver };

  static Role Service() { return {Kind::kService, {}}; }
  // REQUIRES: IsAgentName(name)
  static Role Agent(std::string name) { return {Kind::kAgent, std::move(name)}; }
  static Role Operator() { return {Kind::kOperator, {}}; }  // reads all that a run publishes, and controls it
  static Role Observer() { return {Kind::kObserver, {}}; }  // reads only

  Kind kind = Kind::kObserver;
  std::string agent_name;  // of an agent: see AgentName; else empty
};

// Other names could match the names of other agents, because permissions are patterns: 1 to 64 of [0-9a-z].
bool IsAgentName(const std::string& name);

// "service", "operator", "observer", "agents/NAME": the folder of its keys in a folder of all keys.
std::string KeyFolder(const Role& role);

// A value of NetworkSettings::security of a launcher: keys of DDS Security for its run alone. "auto" means the same on
// every interface but loopback, where the handshakes of a hundred agents would take longer than their start: there it
// means a token (RunToken).
inline constexpr const char* kSecurityOn = "on";

// The folder of this user's sessions: $XDG_RUNTIME_DIR/troupe or, without that variable, troupe-<user id> in the
// temporary folder. Made if it is missing (mode 0700). Fails if another user owns it or could read it.
Result<std::string> SessionsFolder();

// A run's keys under the name of its session, as long as this object lives.
class PublishedKeys {
 public:
  PublishedKeys() = default;  // publishes nothing
  // Replaces what an earlier run of the session has left, and deletes the names of keys that are gone; without `keys`,
  // a run without security publishes nothing. REQUIRES: no other service of the session runs on this host.
  static Result<PublishedKeys> Publish(std::uint32_t domain, const std::string& session, const std::string& keys);

  PublishedKeys(PublishedKeys&& other) noexcept;
  PublishedKeys& operator=(PublishedKeys&& other) noexcept;
  ~PublishedKeys();

 private:
  std::string link_;
};

// The names that killed services have left, of keys that are gone.
void DeleteNamesOfDeletedKeys();

struct SessionKeys {
  std::string session;
  std::string keys;  // the folder
};

// The sessions with keys in a domain, by name.
std::vector<SessionKeys> FindSessionKeys(std::uint32_t domain);

// The keys of a participant: of DDS Security, or the token of the run, or none.
struct ParticipantKeys {
  std::string enclave;  // the folder; empty: without DDS Security
  std::optional<RunToken> token;

  bool operator==(const ParticipantKeys&) const = default;
};

// `security`: "auto" or "on" (the keys that this user's run of that session has published; "on" fails if there are
// none, with "auto" a participant is without), "off" (none), or a folder of keys. Fails if the folder lacks the keys of
// the role.
Result<ParticipantKeys> FindKeys(const std::string& security, std::uint32_t domain, const std::string& session,
                                 const Role& role);

// RunKeysFolder: the folder for the keys of one run, which this process makes and deletes.
class RunKeysFolder {
 public:
  // In SessionsFolder(), of mode 0700. Deletes the folders of killed processes.
  static Result<RunKeysFolder> Make();

  // The same with a token in it.
  static Result<RunKeysFolder> MakeWithToken();

  RunKeysFolder() = default;  // none
  RunKeysFolder(RunKeysFolder&& other) noexcept;
  RunKeysFolder& operator=(RunKeysFolder&& other) noexcept;
  ~RunKeysFolder();

  const std::string& path() const { return folder_.path(); }  // empty: none

 private:
  LockedFolder folder_;
};

}  // namespace troupe
