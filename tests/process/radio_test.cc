// Robots that talk by radio, in every kind of run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/process/output_folder.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

struct Files {
  std::string hashes;
  std::string scans;
  bool operator==(const Files&) const = default;
};

Files FilesOf(std::vector<std::string> arguments) {
  const OutputFolder folder;
  for (const char* name : {"hash-log", "scans"}) {
    arguments.push_back(std::string("--") + name);
    arguments.push_back(folder.Path(name));
  }
  const Finished finished = Finish(Troupe(std::move(arguments)));
  EXPECT_EQ(finished.exit_status, 0) << finished.output;
  return {folder.Read("hash-log"), folder.Read("scans")};
}

// A run of a world with radios.
Files RunOf(const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {"run", WorldPath("../../../worlds/scenarios/radio.json"), "--domain",
                                        std::to_string(TestDomain()), "--headless"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return FilesOf(std::move(arguments));
}

TEST(RadioRun, GivesTheSameFilesInEveryKindOfRun) {
  const OutputFolder folder;
  const Files expected = RunOf({"--in-process"});
  EXPECT_THAT(expected.scans, HasSubstr("\"from\":\"anna\""));
  const std::string recording = folder.Path("run.mcap");
  EXPECT_TRUE(RunOf({"--record", recording}) == expected);
  EXPECT_TRUE(RunOf({"--data-sharing", "off", "--robots-per-process", "3"}) == expected);
  EXPECT_TRUE(RunOf({"--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"}) == expected);
  EXPECT_TRUE(FilesOf({"replay", recording, "--verify"}) == expected);
  EXPECT_TRUE(RunOf({"--in-process", "--seed", "4"}).scans != expected.scans) << "another seed loses other messages";
}

}  // namespace
}  // namespace troupe::test
