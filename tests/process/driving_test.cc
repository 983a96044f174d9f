// `troupe goto` and `troupe teleop` drive robots of real runs; teleop in a terminal of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

// A program in a terminal of its own.
class TerminalProgram {
 public:
  explicit TerminalProgram(std::vector<std::string> command) {
    int slave = -1;
    EXPECT_EQ(openpty(&terminal_, &slave, nullptr, nullptr, nullptr), 0);
    slave_ = slave;
    EXPECT_EQ(tcgetattr(slave_, &before_), 0);
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    login_tty(slave);
    close(terminal_);
    execv(arguments.front(), arguments.data());
    _exit(127);
  }
  ~TerminalProgram() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(slave_);
    close(terminal_);
  }

  pid_t pid() const { return process_; }
  void Type(const std::string& keys) const {
    EXPECT_EQ(write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  bool WaitFor(const std::string& text) {
    for (const auto deadline = Clock::now() + std::chrono::seconds(60); Clock::now() < deadline; Read()) {
      if (output_.find(text) != std::string::npos) return true;
    }
    ADD_FAILURE() << "no '" << text << "' in:\n" << output_;
    return false;
  }
  void Forget() { output_.clear(); }
  const std::string& output() const { return output_; }
  bool is_raw() const {
    termios now{};
    tcgetattr(slave_, &now);
    return (now.c_lflag & (ICANON | ECHO)) == 0;
  }
  bool is_restored() const {
    termios now{};
    tcgetattr(slave_, &now);
    return now.c_lflag == before_.c_lflag && now.c_iflag == before_.c_iflag && now.c_cc[VSUSP] == before_.c_cc[VSUSP];
  }
  // The exit status; 1000 and more: the signal that ended it.
  int Wait() {
    int status = 0;
    for (const auto deadline = Clock::now() + std::chrono::seconds(60); Clock::now() < deadline; Read()) {
      if (waitpid(process_, &status, WNOHANG) != process_) continue;
      process_ = -1;
      Read();
      return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }
    ADD_FAILURE() << "did not end:\n" << output_;
    return -1;
  }

 private:
  void Read() {
    pollfd waited{terminal_, POLLIN, 0};
    if (poll(&waited, 1, 20) <= 0) return;
    char bytes[4096];
    const ssize_t count = read(terminal_, bytes, sizeof bytes);
    if (count > 0) output_.append(bytes, static_cast<std::size_t>(count));
  }

  int terminal_ = -1;
  int slave_ = -1;
  pid_t process_ = -1;
  termios before_{};
  std::string output_;
};

class Driving : public testing::Test {
 protected:
  void Start(const std::vector<std::string>& more = {}, const std::string& file = WorldPath("driving.world")) {
    run_ = std::make_unique<Program>(Troupe(
        Words("run % --domain % --session % --headless", {file, std::to_string(TestDomain()), session_}) + more));
    run_->WaitForLine("ready");
    client_ = std::make_unique<ControlClient>(NetworkOf(session_));
    ASSERT_TRUE(client_->WaitForService(kSeconds).ok());
  }
  void TearDown() override {
    if (!run_) return;
    run_->Interrupt();
  }

  std::vector<std::string> Command(const std::string& tool, const std::vector<std::string>& words) const {
    return Words("% --domain % --session %", {tool, std::to_string(TestDomain()), session_}) + words;
  }
  Finished Goto(const std::vector<std::string>& words) const { return Finish(Troupe(Command("goto", words))); }
  TerminalProgram Teleop(const std::vector<std::string>& words) const {
    std::vector<std::string> all = Command("teleop", words);
    all.insert(all.begin(), ProgramPath("troupe"));
    return TerminalProgram(all);
  }

  EntityReport RobotNow(const std::string& name) {
    control::Entities request{.name = name};
    const Result<ControlReply> reply = client_->Call(request, kSeconds);
    if (!reply.ok() || reply.value().entities.size() != 1) {
      ADD_FAILURE() << "no robot " << name;
      return {};
    }
    return reply.value().entities.front();
  }
  template <typename Condition>
  bool Await(const std::string& robot, Condition condition) {
    for (const auto deadline = Clock::now() + std::chrono::seconds(60); Clock::now() < deadline;) {
      if (condition(RobotNow(robot))) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  static bool Stands(const EntityReport& robot) { return robot.twist.IsZero(); }

  const std::string session_ = TestSession("driving");
  std::unique_ptr<Program> run_;
  std::unique_ptr<ControlClient> client_;
};

TEST_F(Driving, GotoSendsARobotToPointsAndWaitsUntilItIsThere) {
  Start({"--speed", "5"});
  EXPECT_THAT(OutputOf(Goto({"walker", "2,0", "2,-1,90"})), HasSubstr("walker is at "));
  const EntityReport robot = RobotNow("walker");
  EXPECT_LT((robot.X_WE.translation() - Vec2(2.0, -1.0)).norm(), 0.2);
  EXPECT_NEAR(robot.X_WE.heading, 0.5 * kPi, 0.06);
  // Points behind it, and the end of a goal that is not awaited.
  EXPECT_EQ(Goto({"walker", "-50,0", "--no-wait"}).exit_status, 0);
  EXPECT_TRUE(Await("walker", [](const EntityReport& now) { return now.X_WE.x < 1.5; }));
  EXPECT_EQ(Goto({"walker", "--cancel"}).exit_status, 0);
  EXPECT_TRUE(Await("walker", Stands));
}

TEST_F(Driving, GotoLeadsAroundObstaclesOrSaysWhyNot) {
  Start({"--speed", "max"});
  EXPECT_THAT(OutputOf(Goto({"walker", "12.5,0"})), HasSubstr("walker is at ")) << "behind the pen";
  EXPECT_THAT(OutputOf(Goto({"walker", "8,0", "10,0"}), 3),
              HasSubstr("error: 'walker' cannot reach the goal: no way leads to (10.00, 0.00)"));
  EXPECT_THAT(OutputOf(Goto({"walker", "10,1"}), 3),
              HasSubstr("error: 'walker' cannot reach the goal: there is no room for it at (10.00, 1.00)"));
  EXPECT_THAT(OutputOf(Goto({"walker", "10,6"}), 3),
              HasSubstr("error: walker gave up the goal (10.00, 6.00): guard is in the way"));
  // Its last words are in its report, and the next goal is another one.
  EXPECT_THAT(OutputOf(Troupe(Command("ctl", {"get", "walker"}))), HasSubstr("gave up the goal (10.00, 6.00)"));
  EXPECT_THAT(OutputOf(Goto({"walker", "0,0"})), HasSubstr("walker is at "));
}

TEST_F(Driving, GotoCancelsTheGoalWhenItEndsEarly) {
  Start({"--speed", "1"});
  EXPECT_THAT(OutputOf(Goto({"walker", "500,0", "--timeout", "1"}), 3),
              HasSubstr("error: walker has not arrived within 1 s: it is "));
  EXPECT_TRUE(Await("walker", Stands));
  Program tool = Troupe(Command("goto", {"walker", "500,0"}));
  EXPECT_TRUE(Await("walker", [](const EntityReport& robot) { return robot.twist.vx > 0.1; }));
  tool.Interrupt();
  EXPECT_TRUE(Await("walker", Stands));
}

TEST_F(Driving, ToolsNameWhatIsWrong) {
  Start();
  const struct {
    std::vector<std::string> words;
    int exit_status;
    const char* message;
  } cases[] = {
      {{"walker"}, 2, "error: found no point, expected X,Y, X,Y,HEADING or a place"},
      {{"walker", "1,2", "--cancel"}, 2, "error: found points together with --cancel, expected one of them"},
      {{"walker", "1"}, 3, "error: the world has no entity '1'"},
      {{"walkr", "1,2"}, 3, "error: the world has no entity 'walkr'; did you mean 'walker'?"},
      {{"walker", "crate"}, 3, "error: 'crate' is no place"},
      {{"walker", "1,2,x"}, 2, "error: found '1,2,x', expected"},
      {{"walker", "1,nan"}, 2, "error: found '1,nan', expected"},
      {{"walker", "1,2,90", "3,4"}, 2, "error: found '1,2,90', expected X,Y of a point before the last one in metres"},
      {{"missing", "1,2"}, 3, "missing"},
      {{"crate", "1,2"}, 3, "error: 'crate' is no robot"},
      {{"idler", "1,2"}, 3, "error: the controller of 'idler' (idle) accepts no goals"},
  };
  for (const auto& c : cases) {
    EXPECT_THAT(OutputOf(Goto(c.words), c.exit_status), HasSubstr(c.message));
  }
  EXPECT_THAT(OutputOf(Troupe(Command("teleop", {"walker"})), 2),
              HasSubstr("error: the standard input is no terminal, expected one for the keys"));
  TerminalProgram unknown = Teleop({"missing"});
  EXPECT_EQ(unknown.Wait(), 3);
  EXPECT_TRUE(unknown.is_restored());
}

TEST_F(Driving, ToolsNameTheSessionThatIsMeant) {
  Start();
  const std::string meant = "; did you mean '" + session_ + "'?";
  const std::vector<std::string> in_domain = {"--domain", std::to_string(TestDomain())};
  EXPECT_THAT(
      OutputOf(Troupe(std::vector<std::string>{"ctl", "get", "walker", "--session", session_ + "x"} + in_domain), 3),
      HasSubstr("error: no world service found in session '" + session_ + "x'" + meant));
  EXPECT_THAT(
      OutputOf(Troupe(std::vector<std::string>{"goto", "walker", "1,0", "--session", session_ + "x"} + in_domain), 3),
      HasSubstr(meant));
  // The run of a viewer may begin later.
  Program viewer = Troupe(std::vector<std::string>{"view", session_ + "x", "--listen", "127.0.0.1:0"} + in_domain);
  viewer.WaitForLine("waits for session '" + session_ + "x'" + meant);
  viewer.Signal(SIGINT);
  EXPECT_EQ(viewer.Wait(), 0) << viewer.output();
}

TEST_F(Driving, TeleopDrivesByKeysAndRestoresTheTerminal) {
  Start({"--speed", "1"});
  TerminalProgram tool = Teleop({"idler", "--speed", "0.4", "--hold", "30"});
  ASSERT_TRUE(tool.WaitFor("w, up     ahead"));
  ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
  EXPECT_TRUE(tool.is_raw());
  tool.Type("w");
  EXPECT_TRUE(tool.WaitFor("ahead 0.40 m/s"));
  EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.vx == 0.4; }));
  tool.Type("\033[D");  // left
  EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.wz > 0.5 && robot.twist.vx == 0.4; }));
  tool.Type(" ");
  EXPECT_TRUE(Await("idler", Stands));
  tool.Type("+s");
  EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.vx == -0.5; }));
  tool.Type("x");
  EXPECT_EQ(tool.Wait(), 0) << tool.output();
  EXPECT_TRUE(tool.is_restored());
  EXPECT_TRUE(Await("idler", Stands));
}

TEST_F(Driving, AVehicleOfAFleetControlIsManualWhileKeysDriveIt) {
  Start({"--speed", "1"}, std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/vda5050.json");
  const auto is_in_mode = [](const std::string& mode) {
    return [mode](const EntityReport& robot) {
      return robot.signals.find("\"operatingMode\":\"" + mode + "\"") != std::string::npos;
    };
  };
  EXPECT_TRUE(Await("cart_1", is_in_mode("AUTOMATIC")));
  TerminalProgram tool = Teleop({"cart_1", "--hold", "30"});
  ASSERT_TRUE(tool.WaitFor("cart_1: ahead 0.00"));
  tool.Type("w");
  EXPECT_TRUE(Await("cart_1", is_in_mode("MANUAL")));
  EXPECT_TRUE(Await("cart_1", [](const EntityReport& robot) { return robot.twist.vx > 0.0; }));
  tool.Type("x");
  EXPECT_EQ(tool.Wait(), 0) << tool.output();
  EXPECT_TRUE(Await("cart_1", is_in_mode("AUTOMATIC")));
}

TEST_F(Driving, AKeyCountsForAWhileOnly) {
  Start({"--speed", "1"});
  TerminalProgram tool = Teleop({"idler", "--hold", "0.3"});
  ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
  tool.Type("w");
  EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.vx > 0.0; }));
  EXPECT_TRUE(Await("idler", Stands));
  tool.Type("\004");
  EXPECT_EQ(tool.Wait(), 0);
}

TEST_F(Driving, TeleopEndsByEverySignalWithTheTerminalRestored) {
  Start({"--speed", "1"});
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV}) {
    TerminalProgram tool = Teleop({"idler", "--hold", "30"});
    ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
    tool.Type("w");
    EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.vx > 0.0; }));
    kill(tool.pid(), signal);
    const bool is_orderly = signal == SIGINT || signal == SIGTERM || signal == SIGHUP;
    EXPECT_EQ(tool.Wait(), is_orderly ? 130 : 1000 + signal);
    EXPECT_TRUE(tool.is_restored()) << signal;
    EXPECT_TRUE(Await("idler", Stands)) << signal;
  }
  TerminalProgram tool = Teleop({"idler"});
  ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
  tool.Type("\003");  // Ctrl-C
  EXPECT_EQ(tool.Wait(), 130);
  EXPECT_TRUE(tool.is_restored());
}

// Not even the tool's sudden end leaves a robot driving; its controller then continues.
TEST_F(Driving, ARobotStopsWhenTheToolIsKilled) {
  Start({"--speed", "20"});
  TerminalProgram tool = Teleop({"idler", "--hold", "30"});
  ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
  tool.Type("w");
  EXPECT_TRUE(Await("idler", [](const EntityReport& robot) { return robot.twist.vx > 0.0; }));
  kill(tool.pid(), SIGKILL);
  EXPECT_EQ(tool.Wait(), 1000 + SIGKILL);
  EXPECT_TRUE(Await("idler", Stands));
}

TEST_F(Driving, TeleopMovesTheGripper) {
  Start({"--speed", "5"});
  TerminalProgram tool = Teleop({"porter"});
  ASSERT_TRUE(tool.WaitFor("porter: ahead 0.00"));
  tool.Type("cr");
  ASSERT_TRUE(tool.WaitFor("porter: ahead 0.00"));
  tool.Type("x");
  EXPECT_EQ(tool.Wait(), 0) << tool.output();
}

TEST_F(Driving, TeleopEndsWithTheRun) {
  Start({"--speed", "1"});
  TerminalProgram tool = Teleop({"idler"});
  ASSERT_TRUE(tool.WaitFor("idler: ahead 0.00"));
  run_->Interrupt();
  run_.reset();
  EXPECT_EQ(tool.Wait(), 3);
  EXPECT_THAT(tool.output(), HasSubstr("error:"));
  EXPECT_TRUE(tool.is_restored());
}

}  // namespace
}  // namespace troupe::test
