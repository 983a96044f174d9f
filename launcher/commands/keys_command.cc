#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "command_line/exit_status.h"
#include "command_line/option_checks.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "transport/protocol/agent_name.h"
#include "transport/security/key_authority.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

struct KeysOptions {
  std::string folder;
  std::vector<std::string> robots;               // each alone in its agent
  std::vector<std::vector<std::string>> agents;  // the robots of each
};

struct Holder {
  std::string name;  // for people
  Role role;
};

std::vector<Holder> HoldersOf(const KeysOptions& options) {
  std::vector<Holder> holders = {
      {"service", Role::Service()}, {"operator", Role::Operator()}, {"observer", Role::Observer()}};
  std::vector<std::vector<std::string>> agents = options.agents;
  for (const std::string& robot : options.robots) agents.push_back({robot});
  for (const std::vector<std::string>& robots : agents) {
    holders.push_back({fmt::format("agent of {}", fmt::join(robots, ", ")), Role::Agent(AgentName(robots))});
  }
  return holders;
}

void Print(const std::string& name, const fs::path& path, bool made) {
  PrintPlain(stdout, "{}: {}{}\n", name, path.string(), made ? "" : " (kept)");
}

// The authority of the folder, which is made if the folder is new or empty.
Result<KeyAuthority> AuthorityOf(const fs::path& folder) {
  const fs::path path = folder / "authority";
  std::error_code failure;
  if (fs::exists(path, failure)) {
    Result<KeyAuthority> loaded = KeyAuthority::Load(path.string());
    if (loaded.ok()) Print("authority", path, false);
    return loaded;
  }
  if (fs::exists(folder, failure) && !(fs::is_directory(folder, failure) && fs::is_empty(folder, failure))) {
    return Error{{folder.string()}, "found no authority in it, expected a new folder or one of 'troupe keys make'"};
  }
  Result<KeyAuthority> made = KeyAuthority::Create();
  if (!made.ok()) return made;
  if (Status saved = made.value().Save(path.string()); !saved.ok()) return saved.error();
  Print("authority", path, true);
  return made;
}

int MakeKeys(const KeysOptions& options) {
  const fs::path folder(options.folder);
  const Result<KeyAuthority> authority = AuthorityOf(folder);
  if (!authority.ok()) return Fail(authority.error());
  for (const Holder& holder : HoldersOf(options)) {
    const fs::path path = folder / KeyFolder(holder.role);
    std::error_code failure;
    const bool kept = fs::exists(path, failure);
    if (!kept) {
      const Status written = authority.value().WriteIdentity(path.string(), holder.role);
      if (!written.ok()) return Fail(written.error());
    }
    Print(holder.name, path, !kept);
  }
  return kExitDone;
}

}  // namespace

void AddKeysCommand(CLI::App& app, int& exit_status) {
  CLI::App* keys = app.add_subcommand("keys", "Make the keys of secured runs");
  keys->require_subcommand(1);
  CLI::App* make = keys->add_subcommand(
      "make", "Make keys for a service, an operator, an observer and agents; in a folder with keys, the missing ones");
  auto options = std::make_shared<KeysOptions>();
  make->add_option("DIR", options->folder, "Folder of the keys; a program that can read it can join the runs")
      ->required()
      ->check(NotEmpty())
      ->type_name("");
  make->add_option("--robots", options->robots, "Robots that each have an agent process of their own")
      ->delimiter(',')
      ->allow_extra_args(false)  // which would be DIR
      ->check(NotEmpty())
      ->type_name("NAME[,NAME]");
  make->add_option_function<std::vector<std::string>>(
          "--agent",
          [options](const std::vector<std::string>& values) {
            for (const std::string& robots : values) options->agents.push_back(CLI::detail::split(robots, ','));
          },
          "Robots of one agent process, in their order; repeatable")
      ->allow_extra_args(false)
      ->check(NotEmpty())
      ->type_name("NAME[,NAME]");
  make->final_callback([options, &exit_status] { exit_status = MakeKeys(*options); });
}

}  // namespace troupe
