#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/values.h"
#include "tests/unit/controller/controlled_robot.h"

namespace troupe {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Where the build puts the libraries of library_variants.cc.
std::string LibraryFolder() {
  return std::string(TEST_LIBRARY_FOLDER);
}

std::string Library(const std::string& variant) {
  return std::filesystem::path(LibraryFolder()) / ("libcontroller_" + variant + ".so");
}

std::string ErrorOf(const std::string& path, const std::string& parameters = "{}") {
  const RobotDescription robot = MakeRobot(path, parameters);
  const Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  return controller.ok() ? "" : controller.error().message;
}

TEST(LibraryControllerTest, RunsAUsersController) {
  const RobotDescription robot = MakeRobot(Library("good"), "{}");
  EXPECT_EQ(test::ValueOf(CreateFor(robot))->Update(At(0, {})).twist.vx, 0.25);
}

TEST(LibraryControllerTest, ARelativePathCountsFromTheWorkingDirectory) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(LibraryFolder());
  EXPECT_EQ(ErrorOf("libcontroller_good.so"), "");
  EXPECT_EQ(ErrorOf("./libcontroller_good.so"), "");
  EXPECT_THAT(ErrorOf("missing.so"), HasSubstr("no such file: " + LibraryFolder() + "/missing.so"));
  std::filesystem::current_path(before);
}

TEST(LibraryControllerTest, EachFaultHasItsMessage) {
  EXPECT_THAT(ErrorOf("/nowhere/my.so"), StartsWith("controller library /nowhere/my.so: no such file"));
  EXPECT_THAT(ErrorOf(Library("not_one")), HasSubstr("is not a controller"));
  EXPECT_THAT(ErrorOf(Library("wrong_version")),
              HasSubstr("found interface version " + std::to_string(TROUPE_CONTROLLER_ABI + 41) + ", expected " +
                        std::to_string(TROUPE_CONTROLLER_ABI)));
  EXPECT_THAT(ErrorOf(Library("makes_nothing")), EndsWith("made no controller"));
  EXPECT_THAT(ErrorOf(Library("throws_at_start"), R"({"a":1})"), EndsWith("parameters {\"a\":1} are not to my taste"));
}

TEST(LibraryControllerTest, AFileThatIsNoLibraryCannotBeOpened) {
  const std::string path = ::testing::TempDir() + "/troupe_no_library.so";
  std::ofstream(path) << "nonsense";
  EXPECT_THAT(ErrorOf(path), HasSubstr("cannot be opened"));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace troupe
