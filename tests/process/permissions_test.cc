// Requests of other processes can open only files and libraries that the owner of a run has allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class PermissionsTest : public testing::Test {
 protected:
  PermissionsTest() {
    std::filesystem::create_directory(folder_.Path("foreign"));
    setenv("TROUPE_TEST_MARK", folder_.Path("mark").c_str(), 1);
    Write("foreign/evil.json", R"({"robots": [{"name": "x", "model": "position", "pose": [0, 0, 0, 0],
        "controller": ")" + std::string(MARKING_LIBRARY) +
                                   "\"}]}");
    Write("foreign/plain.json", R"({"robots": [{"name": "x", "model": "position", "pose": [0, 0, 0, 0]}]})");
  }
  ~PermissionsTest() override { unsetenv("TROUPE_TEST_MARK"); }

  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_.Path(name)) << text; }
  bool LibraryWasOpened() const { return std::filesystem::exists(folder_.Path("mark")); }

  void Start(std::vector<std::string> permissions) {
    permissions.insert(permissions.end(), {"--paused", "--session", session_});
    run_.emplace(RunPen(permissions));
    run_->WaitForLine("ready");
  }
  Finished Ctl(const std::vector<std::string>& action) const { return test::Ctl(session_, action); }
  std::string Refusal(const std::vector<std::string>& action) const { return OutputOf(Ctl(action), 3); }
  void ExpectSteps() { OutputOf(Ctl({"step", "3"})); }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("permissions");
  std::optional<Program> run_;
};

TEST_F(PermissionsTest, AForeignFileIsNeitherLoadedNorSpawned) {
  Start({});
  for (const char* command : {"load", "spawn"}) {
    for (const char* file : {"foreign/evil.json", "foreign/plain.json", "missing.world"}) {
      EXPECT_THAT(Refusal({command, folder_.Path(file)}),
                  AllOf(HasSubstr(file), HasSubstr("expected a file that the owner of the run has allowed "
                                                   "(--allow-files)")));
    }
  }
  EXPECT_FALSE(LibraryWasOpened());
  ExpectSteps();
  run_->Interrupt();
}

TEST_F(PermissionsTest, AnAllowedFileCannotNameAForeignLibrary) {
  Start({"--allow-files", folder_.Path("foreign")});
  for (const char* command : {"load", "spawn"}) {
    EXPECT_THAT(Refusal({command, folder_.Path("foreign/evil.json")}),
                HasSubstr(std::string("robot x: controller library ") + MARKING_LIBRARY + " is not allowed"));
  }
  EXPECT_FALSE(LibraryWasOpened());
  ExpectSteps();
  OutputOf(Ctl({"load", folder_.Path("foreign/plain.json")}));
  ExpectSteps();
  run_->Interrupt();
}

TEST_F(PermissionsTest, IncludesAndImagesOfAnAllowedFileMustBeAllowed) {
  std::filesystem::create_directory(folder_.Path("own"));
  Write("foreign/robots.inc", "define rover position ()");
  std::filesystem::create_symlink(folder_.Path("foreign/robots.inc"), folder_.Path("own/link.inc"));
  Write("foreign/map.pgm", "P2 1 1 255 0");
  Write("own/include.world", "include \"../foreign/robots.inc\"\nposition (name \"r0\")");
  Write("own/link.world", "include \"link.inc\"\nposition (name \"r0\")");
  Write("own/image.world", "model (name \"m\" bitmap \"../foreign/map.pgm\")");
  Write("own/map.yaml",
        "image: ../foreign/map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.2\n");
  Write("own/world.json", R"({"world": "../foreign/robots.inc"})");
  Start({"--allow-files", folder_.Path("own")});
  for (const char* file : {"include.world", "link.world", "image.world", "map.yaml", "world.json"}) {
    EXPECT_THAT(Refusal({"load", folder_.Path(std::string("own/") + file)}), HasSubstr("(--allow-files)")) << file;
  }
  ExpectSteps();
  run_->Interrupt();
}

// A service that is not the owner's could send the agents any description.
TEST_F(PermissionsTest, AnAgentOpensNoLibraryThatItsOwnerHasNotAllowed) {
  const auto agent = [&](std::vector<std::string> more) {
    return Finish(Program(Words("% --robot x --session % --domain %",
                                {ProgramPath("robot-agent"), session_, std::to_string(TestDomain())}) +
                          more));
  };
  Program service({ProgramPath("world-service"), folder_.Path("foreign/evil.json"), "--session", session_, "--domain",
                   std::to_string(TestDomain())});
  EXPECT_THAT(OutputOf(agent({}), 2), HasSubstr("is not allowed"));
  EXPECT_FALSE(LibraryWasOpened());
  const Finished allowed = agent({"--allow-controllers", MARKING_LIBRARY});
  EXPECT_THAT(allowed.output, HasSubstr("is not a controller"));
  EXPECT_TRUE(LibraryWasOpened());
  service.Signal(SIGINT);
  service.Wait();
}

// The owner's own file needs no permission.
TEST_F(PermissionsTest, TheRunsOwnFileMayNameLibraries) {
  const Finished run = Finish(Troupe({"run", folder_.Path("foreign/evil.json"), "--headless", "--ticks", "3",
                                      "--domain", std::to_string(TestDomain())}));
  EXPECT_TRUE(LibraryWasOpened()) << run.output;
  EXPECT_THAT(run.output, HasSubstr("is not a controller"));
}

// It may be that of a robot that is spawned into a world in which no robot has it yet.
TEST_F(PermissionsTest, TheControllerOfTheCommandLineIsAllowedForSpawnedRobots) {
  Write("foreign/empty.world", "define rover position ()");
  run_.emplace(Troupe({"run", folder_.Path("foreign/empty.world"), "--headless", "--paused", "--controller",
                       MARKING_LIBRARY, "--domain", std::to_string(TestDomain()), "--session", session_}));
  run_->WaitForLine("ready");
  // It would wait for the robot's agent, which ends because the library is no controller.
  const Program spawn =
      Troupe({"ctl", "--domain", std::to_string(TestDomain()), "--session", session_, "spawn", "rover"});
  EXPECT_NE(run_->WaitForLine("is not a controller"), "") << "the agent has opened it";
  EXPECT_TRUE(LibraryWasOpened());
  run_->Signal(SIGINT);
  run_->Wait();
}

}  // namespace
}  // namespace troupe::test
