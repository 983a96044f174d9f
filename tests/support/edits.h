// Edits of a run's world, for tests.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "transport/protocol/messages.h"
#include "worldfile/load_world.h"

namespace troupe::test {

inline WorldDescription Scenario(const std::string& name) {
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + name;
  Result<LoadedWorld> loaded = LoadWorld(path, {});
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  return std::move(loaded.value().world);
}

// A world file that defines a robot, for as long as it is there.
class DefinitionFile {
 public:
  DefinitionFile() { std::ofstream(path_) << "define scout position ( size [0.3 0.3 0.2] ctrl \"wander\" )\n"; }
  ~DefinitionFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  const std::string path_ =
      (std::filesystem::temp_directory_path() / ("definitions-" + std::to_string(getpid()) + ".world")).string();
};

}  // namespace troupe::test
