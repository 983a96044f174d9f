#include "tests/worldfile/world_folder.h"

#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "troupe/check.h"

namespace troupe {

WorldFolder::WorldFolder() {
  path_ = testing::TempDir() + "troupe_world_XXXXXX";
  TROUPE_CHECK(mkdtemp(path_.data()) != nullptr);
  std::filesystem::create_directory(Path("folder"));
  Write("bad.inc", "model( )\n\nmodel( color )\n");
  Write("open.inc", "model( color \"red\"\n");
  Write("close.inc", ")\n");
  Write("loop.inc", "model( )\ninclude \"back.inc\"\n");
  Write("back.inc", "include \"loop.inc\"\n");
  Write("text.png", "not an image");
  Write("cut.pgm", "P5 10 10 255\nabc");
  Write("bomb.pgm", "P5 60000 60000 255\nabc");
  Write("map.pgm", "P2 3 2 255\n0 127 255\n205 0 254\n");
}

WorldFolder::~WorldFolder() {
  std::filesystem::remove_all(path_);
}

void WorldFolder::Write(const std::string& name, const std::string& content) const {
  std::filesystem::create_directories(std::filesystem::path(Path(name)).parent_path());
  std::ofstream(Path(name), std::ios::binary) << content;
}

std::string WorldFolder::WithoutPath(std::string text) const {
  for (std::size_t i = text.find(path_ + "/"); i != std::string::npos; i = text.find(path_ + "/")) {
    text.erase(i, path_.size() + 1);
  }
  return text;
}

std::string WorldFolder::ErrorOf(const std::string& name) const {
  const Result<LoadedWorld> world = LoadWorld(Path(name));
  return world.ok() ? "" : WithoutPath(world.error().ToString());
}

LoadedWorld WorldFolder::Load(const std::string& name, const LoadOverrides& overrides) const {
  Result<LoadedWorld> world = LoadWorld(Path(name), overrides);
  if (!world.ok()) {
    ADD_FAILURE() << world.error().ToString();
    return {};
  }
  const Status fault = Validate(world.value().world);
  if (!fault.ok()) ADD_FAILURE() << fault.error().ToString();
  return std::move(world).value();
}

LoadedWorld WorldFolder::LoadText(const std::string& text, const LoadOverrides& overrides) const {
  Write("w.world", text);
  return Load("w.world", overrides);
}

std::vector<std::string> WorldFolder::WarningsOf(const std::string& text) const {
  std::vector<std::string> warnings;
  for (const Warning& warning : LoadText(text).warnings) warnings.push_back(WithoutPath(warning.ToString()));
  return warnings;
}

}  // namespace troupe
