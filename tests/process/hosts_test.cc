// Runs over several hosts. Each of them is this computer, reached through a `start` command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json HostHere(const std::string& name) {
  return {{"name", name}, {"address", "127.0.0.1"}, {"start", "{command}"}};
}

class Hosts : public testing::Test {
 protected:
  // A scenario of pen.world on these hosts.
  std::string Scenario(const json& hosts) {
    const std::string path = folder_.Path("scenario.json");
    std::ofstream(path) << json{{"world", WorldPath("pen.world")}, {"hosts", hosts}}.dump();
    return path;
  }
  Program Run(const json& hosts, std::vector<std::string> arguments) {
    return Troupe(Words("run % --domain % --headless --controller wander --interface lo",
                        {Scenario(hosts), std::to_string(TestDomain())}) +
                  arguments);
  }

  // Kills the `troupe host` that has started the process with this word in its command line.
  static void KillHostOf(const Program& run, const std::string& part) {
    for (const pid_t process : DescendantsOf(run.pid())) {
      if (CommandLineOf(process).find(part) == std::string::npos) continue;
      std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
      pid_t host = 0;
      std::string word;
      stat >> word >> word >> word >> host;
      kill(host, SIGKILL);
    }
  }

  TemporaryFolder folder_;
};

TEST_F(Hosts, GiveTheSameFilesAsOneHost) {
  for (bool remote_service : {false, true}) {
    SCOPED_TRACE(remote_service ? "service on a host" : "service here");
    json first = HostHere("first");
    first["service"] = remote_service;
    json second = HostHere("second");
    second["robots"] = {"r1", "r3"};
    std::vector<std::string> kinds = {"hash-log", "poses", "record", "scans"};
    std::vector<std::string> remote = {"--ticks", "50", "--security", "on"};
    std::vector<std::string> near = {"run",          WorldPath("pen.world"), "--ticks",      "50",
                                     "--in-process", "--headless",           "--controller", "wander"};
    for (const std::string& kind : kinds) {
      remote.insert(remote.end(), {"--" + kind, folder_.Path("remote-" + kind)});
      near.insert(near.end(), {"--" + kind, folder_.Path("local-" + kind)});
    }
    remote.insert(remote.end(), {"--summary", folder_.Path("summary")});
    EXPECT_THAT(OutputOf(Run({first, second}, remote)), HasSubstr("4 robots in 4 agent processes on 2 hosts"));
    ASSERT_EQ(Finish(Troupe(near)).exit_status, 0);
    for (const std::string& kind : std::vector<std::string>{"hash-log", "poses", "scans"}) {
      EXPECT_FALSE(folder_.Read("remote-" + kind).empty()) << kind;
      EXPECT_EQ(folder_.Read("remote-" + kind), folder_.Read("local-" + kind)) << kind;
    }
    EXPECT_FALSE(folder_.Read("remote-record").empty());
    const json summary = json::parse(folder_.Read("summary"));
    EXPECT_EQ(summary["processes"], 5);
    for (const json& slow : summary["slowest_robots"]) {
      const bool named = slow["robot"] == "r1" || slow["robot"] == "r3";
      EXPECT_EQ(slow["host"], named ? "second" : "first");
    }
  }
}

TEST_F(Hosts, AreReachedBySshByDefault) {
  // Like ssh: the arguments after the host are a command for a shell there.
  const std::string ssh = folder_.Path("ssh");
  std::ofstream(ssh) << "#!/bin/sh\necho \"$@\" >> " << folder_.Path("calls")
                     << "\nfor word; do command=$word; done\nexec /bin/sh -c \"$command\"\n";
  std::filesystem::permissions(ssh, std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (std::filesystem::path(ssh).parent_path().string() + ":" + path).c_str(), 1);
  Finished run = Finish(Run(json::array({"127.0.0.1"}), {"--ticks", "20"}));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(run.exit_status, 0) << run.output;
  EXPECT_THAT(folder_.Read("calls"),
              testing::AllOf(HasSubstr("-o BatchMode=yes"), HasSubstr(" 127.0.0.1 "), HasSubstr("/troupe host")));
}

TEST_F(Hosts, StopInOrderOnASignal) {
  json service = HostHere("s");
  service["service"] = true;
  Program run = Run({service, HostHere("a")}, {"--speed", "5"});
  run.WaitForLine("4 robots in 4 agent processes on 2 hosts, ready");
  std::vector<pid_t> processes = DescendantsOf(run.pid());
  EXPECT_GE(processes.size(), 7u);  // 2 hosts, 5 programs
  run.Interrupt();
  EXPECT_THAT(run.output(), HasSubstr("stopped before its end"));
  for (pid_t process : processes) EXPECT_TRUE(IsGoneSoon(process)) << CommandLineOf(process);
}

TEST_F(Hosts, TerminateAllProcessesWhenTheLauncherIsKilled) {
  json service = HostHere("s");
  service["service"] = true;
  Program run = Run({service, HostHere("a")}, {"--speed", "5"});
  run.WaitForLine("4 robots in 4 agent processes on 2 hosts, ready");
  std::vector<pid_t> processes = DescendantsOf(run.pid());
  run.Signal(SIGKILL);
  run.Wait();
  for (pid_t process : processes) EXPECT_TRUE(IsGoneSoon(process)) << CommandLineOf(process);
}

TEST_F(Hosts, ThatAreLostLoseOnlyTheirRobots) {
  json lost = HostHere("lost");
  lost["robots"] = {"r2"};
  lost["start"] = "mkdir " + folder_.Path("started") + " && exec {command}";  // once
  Program run = Run({HostHere("kept"), lost}, {"--speed", "5", "--ticks", "200", "--lease", "0.5", "--scans",
                                               folder_.Path("scans"), "--summary", folder_.Path("summary")});
  run.WaitForLine("ready after");
  KillHostOf(run, "--robot=r2");
  run.WaitForLine("host lost: the connection is lost");
  const auto lost_at = std::chrono::steady_clock::now();
  EXPECT_EQ(run.Wait(), 5) << run.output();
  // 4 s at this speed; a wait for the files of the host took 30 s more.
  EXPECT_LT(std::chrono::steady_clock::now() - lost_at, std::chrono::seconds(25));
  EXPECT_THAT(run.output(), HasSubstr("without an agent at the end: r2"));
  EXPECT_THAT(run.output(), HasSubstr("missing: --scans of r2 until host lost was lost"));
  const json summary = json::parse(folder_.Read("summary"));
  EXPECT_EQ(summary["missing_files"], json::array({"--scans of r2 until host lost was lost"}));
  EXPECT_EQ(summary["ticks"], 200);
  EXPECT_THAT(folder_.Read("scans"), HasSubstr(R"({"tick":199,"robot":"r0")"));
}

TEST_F(Hosts, OfTheWorldServiceEndTheRunAtOnceWhenTheyAreLost) {
  json service = HostHere("s");
  service["service"] = true;
  service["robots"] = 0;
  Program run = Run({service, HostHere("a")},
                    {"--speed", "5", "--scans", folder_.Path("scans"), "--hash-log", folder_.Path("hashes")});
  run.WaitForLine("ready after");
  KillHostOf(run, "/world-service");
  run.WaitForLine("host s: the connection is lost");
  const auto lost_at = std::chrono::steady_clock::now();
  EXPECT_EQ(run.Wait(), 3) << run.output();
  EXPECT_LT(std::chrono::steady_clock::now() - lost_at, std::chrono::seconds(25));
}

// With keys, which the host has lost with its folder.
TEST_F(Hosts, ThatReturnAreConnectedAgain) {
  json far = HostHere("far");
  far["robots"] = {"r2"};
  Program run =
      Run({HostHere("near"), far}, {"--speed", "5", "--ticks", "100", "--on-agent-loss", "rebuild", "--security", "on",
                                    "--hash-log", folder_.Path("hashes"), "--summary", folder_.Path("summary")});
  run.WaitForLine("ready after");
  KillHostOf(run, "--robot=r2");
  run.WaitForLine("host far: connected again; its 1 agent is started again");
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("without an agent at the end")));
  EXPECT_EQ(json::parse(folder_.Read("summary"))["agents_restarted"], 0);
  OutputOf(Troupe({"run", WorldPath("pen.world"), "--ticks", "100", "--in-process", "--headless", "--controller",
                   "wander", "--hash-log", folder_.Path("alone")}));
  EXPECT_EQ(folder_.Read("hashes"), folder_.Read("alone"));
}

// The keys of a run count from a day before it on.
TEST_F(Hosts, WhoseClockDoesNotFitTheKeysAreNamed) {
#ifdef TROUPE_SANITIZED
  GTEST_SKIP() << "a sanitizer has to be loaded before all other libraries";
#endif
  for (const auto& [days, text] :
       {std::pair(-3, "error: the keys count from "), std::pair(4000, "error: the keys count until ")}) {
    json far = HostHere("far");
    far["robots"] = {"r1", "r3"};
    far["start"] = "env LD_PRELOAD=" SHIFTED_CLOCK " CLOCK_SHIFT=" + std::to_string(days * 86400) + " {command}";
    Program run = Run({HostHere("near"), far}, {"--ticks", "5", "--security", "on"});
    EXPECT_EQ(run.Wait(), 3) << run.output();
    EXPECT_THAT(run.output(), HasSubstr(text));
    EXPECT_THAT(run.output(), testing::ContainsRegex("far: agent of r[13]: .*, but the clock of host .* says "));
  }
}

TEST_F(Hosts, DeleteTheFoldersOfThoseThatWereKilled) {
  const std::string temporary = folder_.Path("temporary");
  std::filesystem::create_directory(temporary);
  const auto left = [&temporary] {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(temporary)) {
      const std::string name = entry.path().filename();
      if (name.starts_with("troupe-host-")) names.push_back(name);
    }
    return names;
  };
  json far = HostHere("far");
  far["start"] = "TMPDIR=" + temporary + " {command}";
  Program run = Run(json::array({far}), {"--speed", "5"});
  run.WaitForLine("ready after");
  for (const pid_t process : DescendantsOf(run.pid())) {
    if (CommandLineOf(process).ends_with("/troupe host ")) kill(process, SIGKILL);
  }
  run.WaitForLine("host far: the connection is lost");
  run.Interrupt();
  EXPECT_EQ(left().size(), 1u);
  OutputOf(Run(json::array({far}), {"--ticks", "5"}));
  EXPECT_EQ(left(), std::vector<std::string>());
}

TEST_F(Hosts, StartAKilledAgentAgain) {
  json far = HostHere("far");
  far["robots"] = {"r2"};
  Program run = Run({HostHere("near"), far}, {"--speed", "5", "--ticks", "100", "--lease", "0.5"});
  run.WaitForLine("ready after");
  for (pid_t process : DescendantsOf(run.pid())) {
    if (CommandLineOf(process).find("--robot=r2") != std::string::npos) kill(process, SIGKILL);
  }
  EXPECT_EQ(run.Wait(), 5) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("robot r2: the agent (on host far, process "));
  EXPECT_THAT(run.output(), HasSubstr("; restart 1 of 3"));
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("without an agent at the end")));
}

TEST(LocalHostTest, StartsProgramsWithMoreArgumentsThanTheSystemTakes) {
  std::vector<std::string> arguments =
      Words("--session none --session-timeout 0.1 --domain %", {std::to_string(TestDomain())});
  for (int i = 0; i < 100'000; ++i) arguments.push_back("--robot=robot-" + std::to_string(i));
  LocalHost host;
  Result<std::unique_ptr<Child>> started = host.Start("robot-agent", arguments, false);
  ASSERT_TRUE(started.ok()) << started.error().message;
  ASSERT_TRUE(Eventually([&] { return started.value()->Poll(); }));
  EXPECT_EQ(started.value()->end()->exit_code, 3);
  EXPECT_THAT(host.ReadOutput(),
              testing::Contains(HasSubstr("agent of robot-0 and 99999 more: error: no world service")));
}

TEST_F(Hosts, WithoutProgramsAreNamed) {
  json bad = HostHere("bad");
  bad["programs"] = "/no/such/folder";
  const std::string run = OutputOf(Run({HostHere("good"), bad}, {"--ticks", "5"}), 3);
  EXPECT_THAT(run, HasSubstr("host bad: `/no/such/folder/troupe host` ended with exit status 127"));
  EXPECT_THAT(run, HasSubstr("not found"));
}

TEST_F(Hosts, WithAnotherVersionAreNamed) {
  json bad = HostHere("old");
  bad["start"] = R"(: {command}; echo '{"host":"0.0.1","folder":"/tmp","programs":"/tmp"}'; cat)";
  const std::string run = OutputOf(Run(json::array({bad}), {"--ticks", "5"}), 3);
  EXPECT_THAT(run, HasSubstr("host old: "));
  EXPECT_THAT(run, HasSubstr("has version 0.0.1 of Troupe, expected "));
}

TEST_F(Hosts, WithIpv6OnlyAreRefusedAtOnce) {
  json host = HostHere("six");
  host["address"] = "fd35::1";
  const std::string run = OutputOf(Run(json::array({host}), {"--ticks", "5"}), 2);
  EXPECT_THAT(run, HasSubstr("scenario.json:1:"));
  EXPECT_THAT(run, HasSubstr("found host 'fd35::1', which has IPv6 addresses only"));
}

TEST_F(Hosts, WithoutRoomForAllRobotsAreAnErrorInTheScenario) {
  json host = HostHere("small");
  host["robots"] = 3;
  const std::string run = OutputOf(Run(json::array({host}), {"--ticks", "5"}), 2);
  EXPECT_THAT(run, HasSubstr("scenario.json:1:"));
  EXPECT_THAT(run, HasSubstr("hosts for 3 of 4 robots"));
}

}  // namespace
}  // namespace troupe::test
