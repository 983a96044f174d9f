// Errors of users: one line with the text found and the text expected, and the exit status of the manual.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

struct BadUsage {
  std::vector<std::string> arguments;
  std::string message;
};

TEST(Usage, BadUsageEndsWithOneErrorLineAndStatus2) {
  const std::string pen = WorldPath("pen.world");
  const std::vector<BadUsage> cases = {
      {{"help", "rnu"}, "error: found no command 'rnu'; did you mean 'run'?"},
      {{"fly"}, "error: "},
      {{"run"}, "error: FILE is required"},
      {{"run", pen, "--ticks", "soon"}, "error: --ticks: found 'soon', expected a whole number from 1"},
      {{"run", pen, "--ticks", "-3"}, "error: --ticks: found '-3', expected a whole number from 1"},
      {{"run", pen, "--ticks"}, "error: --ticks"},
      {{"run", pen, "--seed", "-1"}, "error: --seed: found '-1', expected a whole number from 0"},
      {{"run", pen, "--speed", "fast"},
       "error: --speed: found 'fast', expected a multiple of real time above 0, or max"},
      {{"run", pen, "--mode", "turbo"}, "error: --mode: found 'turbo', expected one of lockstep, realtime"},
      {{"run", pen, "--robots-per-process", "0"}, "error: --robots-per-process: found '0'"},
      {{"run", pen, "--lease", "1e-300"}, "error: --lease: found '1e-300', expected seconds from 0.01 to 3600"},
      {{"run", pen, "--lease", "1e300"}, "error: --lease: found '1e300', expected seconds from 0.01 to 3600"},
      {{"run", pen, "--domain", "999"}, "error: --domain: found '999', expected a whole number from 0 to 230"},
      {{"run", pen, "--session", "a/b"}, "error: --session: found 'a/b', expected 1 to 64 letters"},
      {{"run", pen, "--on-agent-loss", "weep"}, "error: --on-agent-loss: found 'weep', expected one of freeze"},
      {{"run", pen, "--faults", "gremlins"}, "error: --faults: "},
      {{"run", pen, "--ros", "--ros-distro", "foxy"}, "error: --ros-distro: found 'foxy', expected one of humble"},
      {{"run", pen, "--controller", ""}, "error: --controller: found '', expected a name"},
      {{"snapshot", pen, "-o", "pen.png", "--controller", ""}, "error: --controller: found '', expected a name"},
      {{"run", pen, "--fast"}, "error: "},
      {{"run", pen, pen}, "error: "},
      {{"run", pen, "--poses", "/no/such/folder/poses"},
       "error: --poses: cannot write /no/such/folder/poses: No such file"},
      {{"run", pen, "--hash-log", "/"}, "error: --hash-log: cannot write /: Is a directory"},
      {{"run", "/no/such.world"}, "/no/such.world"},
      {{"run", "/no/such.world", "--in-process"}, "/no/such.world"},
      {{"run", "/etc/passwd"}, "/etc/passwd: error: "},
      {{"check"}, "error: FILE is required"},
      {{"check", "/no/such.world"}, "/no/such.world"},
      {{"top", "--domain", "x"}, "error: --domain: found 'x'"},
      {{"top", "--interface", "none0"},
       "error: --interface: found 'none0', expected auto, or the name or IPv4 address"},
      {{"run", pen, "--interface", "none0"}, "error: --interface: found 'none0', expected auto, or the name or IPv4"},
  };
  for (const BadUsage& usage : cases) {
    const std::string run = OutputOf(Troupe(usage.arguments), 2);
    EXPECT_THAT(run, HasSubstr(usage.message)) << testing::PrintToString(usage.arguments);
    EXPECT_THAT(run, HasSubstr("error: ")) << testing::PrintToString(usage.arguments);
    EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
  }
}

// As of a variable of the shell that is not set.
TEST(Usage, AnEmptyNameOfAFileIsRefused) {
  const std::string pen = WorldPath("pen.world");
  std::vector<std::vector<std::string>> cases = {{"check", ""},
                                                 {"run", "", "--in-process"},
                                                 {"replay", ""},
                                                 {"snapshot", pen, "-o", ""},
                                                 {"export-map", pen, "-o", ""},
                                                 {"edit", ""}};
  for (const char* option : {"--hash-log", "--poses", "--scans", "--record", "--summary", "--trace", "--journal",
                             "--allow-files", "--allow-controllers"}) {
    cases.push_back({"run", pen, "--ticks", "1", option, ""});
    cases.push_back({"run", pen, "--ticks", "1", std::string(option) + "="});
  }
  for (const char* option : {"--hash-log", "--poses", "--scans"}) cases.push_back({"replay", "x.mcap", option, ""});
  for (const std::vector<std::string>& arguments : cases) {
    const std::string run = OutputOf(Troupe(arguments), 2);
    EXPECT_EQ(run.find("error: "), 0u);
    EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
  }
}

// Each would wait for another program for ever, and a device is no recording.
TEST(Usage, ANamedPipeIsNoFile) {
  TemporaryFolder folder;
  const std::string pipe = folder.Path("pipe");
  const std::string recording = folder.Path("pipe.mcap");
  for (const std::string& path : {pipe, recording, folder.Path("pipe.png"), folder.Path("pipe.world")}) {
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  }
  const std::string pen = WorldPath("pen.world");
  std::vector<std::vector<std::string>> cases = {{"check", recording},
                                                 {"check", folder.Path("pipe.world")},
                                                 {"replay", recording},
                                                 {"snapshot", recording, "-o", folder.Path("out.png")},
                                                 {"snapshot", pen, "-o", folder.Path("pipe.png")},
                                                 {"view", recording},
                                                 {"run", recording, "--headless"},
                                                 {"run", recording, "--in-process"}};
  for (const char* option : {"--hash-log", "--poses", "--scans", "--record", "--summary", "--trace", "--journal"}) {
    cases.push_back({"run", pen, "--ticks", "1", "--headless", option, pipe});
    if (option == std::string("--journal")) continue;  // of processes
    cases.push_back({"run", pen, "--ticks", "1", "--in-process", option, pipe});
  }
  cases.push_back({"run", pen, "--ticks", "1", "--in-process", "--record", recording});
  for (const std::vector<std::string>& arguments : cases) {
    const std::string run = OutputOf(Troupe(arguments), 2);
    EXPECT_THAT(run, HasSubstr("regular file")) << testing::PrintToString(arguments);
    EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
  }
}

TEST(Usage, OutputGoesToAnOpenPipe) {
  const std::string command =
      ProgramPath("troupe") + " run " + WorldPath("pen.world") +
      " --ticks 3 --in-process --headless --hash-log /dev/stdout 2>/dev/null | grep -c '^[0-3] [0-9a-f]*$'";
  EXPECT_EQ(Finish(Program({"/bin/sh", "-c", command})).output, "4\n");
}

TEST(Usage, LostStandardOutputIsAFailure) {
  const std::string command = ProgramPath("troupe") + " check " + WorldPath("pen.world");
  const std::string full = OutputOf(Program({"/bin/sh", "-c", command + " > /dev/full"}), 3);
  EXPECT_EQ(full, "error: cannot write to standard output: No space left on device\n");
  EXPECT_EQ(Finish(Program({"/bin/sh", "-c", command + " >&-"})).exit_status, 0);
}

TEST(Usage, NamesDoNotCommandTheTerminal) {
  TemporaryFolder folder;
  const std::string world = folder.Path("a\x1b[2Jb.world");
  std::ofstream(world) << "position ( name \"r\x1b]0;x\x07\nstatus\" ctrl \"idle\" )\n";
  const std::string missing = folder.Path("none\x1b[2J.world");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"check", world},
           {"check", missing},
           {"run", world, "--in-process", "--ticks", "2"},
           {"check", world, "\x1b"},
           {"run", world, "--headless", "--ticks", "2", "--domain", std::to_string(TestDomain())}}) {
    const Finished run = Finish(Troupe(arguments));
    EXPECT_EQ(run.output.find_first_of("\x1b\x07"), std::string::npos) << run.output;
    EXPECT_THAT(run.output, testing::Not(HasSubstr("\nstatus"))) << "a line of its own: " << run.output;
  }
}

TEST(Usage, LimitsOfTheProcessAreToldInOneLine) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers need more addresses than a limit leaves";
  const std::string run = ProgramPath("troupe") + " run " + WorldPath("pen.world") + " --headless --ticks 3 --domain " +
                          std::to_string(TestDomain());
  for (const char* limit : {"ulimit -n 5; ", "ulimit -n 6; ", "ulimit -v 60000; ", "ulimit -v 100000; "}) {
    const std::string limited = OutputOf(Program({"/bin/sh", "-c", limit + run}), 3);
    EXPECT_THAT(limited, HasSubstr("error: ")) << limit;
    EXPECT_EQ(std::count(limited.begin(), limited.end(), '\n'), 1) << limit << limited;
  }
  OutputOf(Program({"/bin/sh", "-c", "ulimit -s 64; " + run}));
}

TEST(Usage, AServiceWithoutKeysOnANetworkSaysSo) {
  Program service({ProgramPath("world-service"), WorldPath("pen.world"), "--interface", "auto", "--session", "no-keys",
                   "--domain", std::to_string(TestDomain())});
  EXPECT_THAT(service.WaitForLine("warning: no keys"), HasSubstr("--security"));
  service.Signal(SIGTERM);
  EXPECT_EQ(service.Wait(), 130);
}

TEST(Usage, AnUnknownControllerIsReportedOnceForAllRobots) {
  TemporaryFolder folder;
  std::ofstream(folder.Path("two.world")) << "position ( name \"a\" )\nposition ( name \"b\" pose [3 0 0 0] )\n";
  const std::vector<BadUsage> cases = {{{"--controller", "dance"}, "dance"},
                                       {{"--controller", "./no-such-library.so"}, "no-such-library.so"}};
  for (const BadUsage& usage : cases) {
    for (const std::vector<std::string>& mode : {std::vector<std::string>{}, {"--in-process"}}) {
      std::vector<std::string> arguments = Words("run % --ticks 5 --headless", {folder.Path("two.world")}) + mode;
      arguments.insert(arguments.end(), usage.arguments.begin(), usage.arguments.end());
      const std::string run = OutputOf(Troupe(arguments), 2);
      EXPECT_THAT(run, HasSubstr(usage.message));
      EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
    }
  }
}

TEST(Usage, AFullDiskFailsTheRun) {
  for (const char* output : {"--hash-log", "--poses", "--record", "--scans", "--summary"}) {
    for (const char* mode : {"--headless", "--in-process"}) {
      const std::string run = OutputOf(RunPen({"--ticks", "50", "--speed", "max", mode, output, "/dev/full"}), 3);
      EXPECT_THAT(run, HasSubstr("/dev/full: error: ")) << output << " " << mode;
      EXPECT_THAT(run, HasSubstr("No space left on device")) << output << " " << mode;
    }
  }
}

TEST(Usage, BadOutputIsRefusedBeforeAnythingIsWritten) {
  TemporaryFolder folder;
  EXPECT_THAT(OutputOf(RunPen({"--ticks", "5", "--poses", folder.Path("same"), "--record", folder.Path("same")}), 2),
              HasSubstr("--poses and --record name the same file"));
  EXPECT_EQ(folder.size(), 0u);
}

TEST(Usage, OneFileIsNotTwoOutputsByWhateverPaths) {
  TemporaryFolder folder;
  std::ofstream(folder.Path("file")) << "kept";
  std::filesystem::create_symlink("file", folder.Path("link"));
  std::filesystem::create_hard_link(folder.Path("file"), folder.Path("other"));
  std::filesystem::create_directory(folder.Path("sub"));
  for (const char* name : {"link", "other", "sub/../file"}) {
    EXPECT_THAT(OutputOf(RunPen({"--ticks", "5", "--scans", folder.Path("file"), "--trace", folder.Path(name)}), 2),
                HasSubstr("--scans and --trace name the same file"))
        << name;
  }
  OutputOf(RunPen({"--ticks", "5", "--poses", folder.Path("new"), "--trace", folder.Path("sub/../new")}), 2);
  EXPECT_EQ(folder.Read("file"), "kept");
  EXPECT_FALSE(std::filesystem::exists(folder.Path("new")));
}

// A scenario with a world, and an include in the world.
void WriteScenario(const TemporaryFolder& folder) {
  std::ofstream(folder.Path("own.json")) << R"({"world": "own.world", "ticks": 5})";
  std::ofstream(folder.Path("own.world")) << "include \"own.inc\"\nposition ( name \"a\" )\n";
  std::ofstream(folder.Path("own.inc")) << "define box model ( size [1 1 1] )\n";
  std::filesystem::create_symlink("own.world", folder.Path("link"));
}

TEST(Usage, AnOutputIsNeverAFileThatTheRunReads) {
  TemporaryFolder folder;
  WriteScenario(folder);
  for (const char* option : {"--hash-log", "--poses", "--scans", "--summary", "--record", "--trace"}) {
    for (const char* name : {"own.json", "own.world", "own.inc", "link"}) {
      const std::string run =
          OutputOf(Troupe({"run", folder.Path("own.json"), option, folder.Path(name), "--in-process"}), 2);
      EXPECT_THAT(run, HasSubstr(std::string("error: ") + option + ": found " + folder.Path(name) +
                                 ", which the command reads"));
      EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
    }
  }
  EXPECT_EQ(folder.Read("own.json"), R"({"world": "own.world", "ticks": 5})");
  EXPECT_THAT(folder.Read("own.world"), HasSubstr("position"));
  EXPECT_THAT(folder.Read("own.inc"), HasSubstr("define"));
  for (int overwritten = 0; overwritten < 2; ++overwritten) {
    OutputOf(Troupe({"run", folder.Path("own.json"), "--poses", folder.Path("poses"), "--in-process"}));
  }
}

TEST(Usage, UnknownWordsAreNamedInOrderWithTheLikelyOnes) {
  const std::string pen = WorldPath("pen.world");
  const std::vector<BadUsage> cases = {
      {{"run", pen, "--sped", "2", "--tikcs=5", "--zzzzzz"},
       "error: found the unknown options --sped (did you mean --speed?), --tikcs (did you mean --ticks?), --zzzzzz; "
       "troupe run --help lists the options\n"},
      {{"run", "--rcord", "x"},
       "error: found the unknown option --rcord (did you mean --record?); troupe run --help lists the options\n"},
      {{"run", pen, "second", "third"}, "error: found 'second' 'third', expected no further argument\n"},
      {{"rnu", pen}, "error: found the command 'rnu', expected one of run, replay, test, sweep, check, "},
      {{"rnu", pen}, "; did you mean 'run'?\n"},
      {{"ctl", "stpe"}, "error: found the command 'stpe', expected one of status, pause, play, step, "},
      {{"ctl", "stpe"}, "; did you mean 'step'?\n"},
      {{"ctl", "step", "--sesion", "x"},
       "error: found the unknown option --sesion (did you mean --session?); troupe ctl step --help lists the options"},
      {{"--verson"}, "error: found the unknown option --verson (did you mean --version?); troupe --help lists"},
      {{"run", pen, "--controller", "wandr"}, "; did you mean 'wander'?\n"},
  };
  for (const BadUsage& usage : cases) {
    EXPECT_THAT(OutputOf(Troupe(usage.arguments), 2), HasSubstr(usage.message))
        << testing::PrintToString(usage.arguments);
  }
  for (const char* program : {"world-service", "robot-agent"}) {
    EXPECT_THAT(OutputOf(Program({ProgramPath(program), "--sesion", "x"}), 2),
                HasSubstr("--sesion (did you mean --session?); " + std::string(program) + " --help"));
  }
}

TEST(Usage, EveryCommandHasHelp) {
  EXPECT_THAT(Finish(Troupe({"--version"})).output, testing::MatchesRegex("troupe [0-9.]+\n"));
  const std::vector<BadUsage> cases = {{{"--help"}, "Run a world"},
                                       {{}, "Run a world"},
                                       {{"help", "ctl", "spawn"}, "Usage: troupe ctl spawn"},
                                       {{"run", "--help"}, "--hash-log FILE"},
                                       {{"check", "--help"}, "FILE"},
                                       {{"top", "--help"}, "--once"}};
  for (const BadUsage& usage : cases) {
    EXPECT_THAT(OutputOf(Troupe(usage.arguments)), HasSubstr(usage.message));
  }
}

TEST(Usage, CheckDescribesAWorldWithoutRunningIt) {
  const std::string check = OutputOf(Troupe({"check", WorldPath("pen.world")}));
  EXPECT_THAT(check, HasSubstr("world: pen"));
  EXPECT_THAT(check, HasSubstr("robots: 4\n"));
  EXPECT_THAT(check, HasSubstr("r1: differential drive, controller expand, ranger:0 (3 sensors, 3 rays)"));
  EXPECT_THAT(check, HasSubstr("warnings: 0"));
}

}  // namespace
}  // namespace troupe::test
