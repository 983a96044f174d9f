#include <gtest/gtest.h>

#include <fstream>

#include "launcher/commands/check_command.h"

namespace troupe {
namespace {

std::string Fault(const std::string& file, const std::optional<std::string>& controller = {}) {
  const Status fault = CheckControllers(file, controller);
  return !fault.ok() ? fault.error().ToString() : "";
}

TEST(CheckControllers, NamesTheLineOfAScenariosController) {
  const std::string path = testing::TempDir() + "check_controllers_test.json";
  std::ofstream(path) << "{\"robots\": [\n  {\"model\": \"position\", \"controller\": \"wonder\"}]}";
  EXPECT_EQ(
      Fault(path),
      path +
          ":2:39: error: unknown controller 'wonder', expected one of: dynamic, expand, fasr, fasr2, fasr_plan, fetch, "
          "flock, follow, go_to, idle, lasernoise, patrol, pioneer_flocking, rasterize, script, sink, source, wander, "
          "or the path of a shared library (.so); did you mean 'wander'?");
}

TEST(CheckControllers, ChecksParametersToo) {
  const std::string path = testing::TempDir() + "check_controllers_test.json";
  std::ofstream(path) << R"({"controller": {"name": "script", "parameters": {"commands": []}}})";
  EXPECT_EQ(Fault(path).substr(path.size()),
            ":1:16: error: script: 'commands' is missing or empty, expected a list of {\"at\": seconds, ...}");
}

// Whatever follows the name is ignored in Stage, and a warning of the loader here.
TEST(CheckControllers, LeavesAWorldsControllersToItsLoader) {
  const std::string path = testing::TempDir() + "check_controllers_test.world";
  std::ofstream(path) << "position( ctrl \"wander -1\" )\n";
  EXPECT_EQ(Fault(path), "");
}

TEST(CheckControllers, ChecksTheOption) {
  EXPECT_EQ(Fault("some.world", "idle"), "");
  EXPECT_EQ(Fault("some.world", "wonder").substr(0, 52), "error: option --controller: unknown controller 'wond");
  EXPECT_EQ(Fault("some.world", "").substr(0, 49), "error: option --controller: unknown controller ''");
}

}  // namespace
}  // namespace troupe
