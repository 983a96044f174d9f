// A folder of world files that a test writes, loads and leaves behind empty.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/files.h"
#include "worldfile/load_world.h"

namespace troupe {

// Loads a world that has to be valid.
LoadedWorld LoadValid(const std::string& path, const LoadOverrides& overrides = {});

class WorldFolder : public test::TemporaryFolder {
 public:
  // Has the files that the tables of bad worlds name: bad.inc, open.inc, loop.inc, back.inc, text.png, cut.pgm,
  // bomb.pgm, map.pgm and a folder.
  WorldFolder();

  // The whole message of the error, with paths from the folder on; "" without an error.
  std::string ErrorOf(const std::string& name) const;
  // LoadValid of a file in it. Warnings are checked with WarningsOf.
  LoadedWorld Load(const std::string& name, const LoadOverrides& overrides = {}) const;
  // Writes the text as "w.world" and loads it.
  LoadedWorld LoadText(const std::string& text, const LoadOverrides& overrides = {}) const;
  // The warnings of such a text, with paths from the folder on.
  std::vector<std::string> WarningsOf(const std::string& text) const;

 private:
  std::string WithoutPath(std::string text) const;
};

}  // namespace troupe
