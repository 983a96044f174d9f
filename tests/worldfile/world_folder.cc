#include "tests/worldfile/world_folder.h"

namespace troupe {

LoadedWorld LoadValid(const std::string& path, const LoadOverrides& overrides) {
  Result<LoadedWorld> world = LoadWorld(path, overrides);
  if (!world.ok()) {
    ADD_FAILURE() << world.error().ToString();
    return {};
  }
  const Status fault = Validate(world.value().world);
  if (!fault.ok()) ADD_FAILURE() << fault.error().ToString();
  return std::move(world).value();
}

WorldFolder::WorldFolder() {
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

std::string WorldFolder::WithoutPath(std::string text) const {
  for (std::size_t i = text.find(Path("")); i != std::string::npos; i = text.find(Path(""))) {
    text.erase(i, path().size() + 1);
  }
  return text;
}

std::string WorldFolder::ErrorOf(const std::string& name) const {
  const Result<LoadedWorld> world = LoadWorld(Path(name));
  return world.ok() ? "" : WithoutPath(world.error().ToString());
}

LoadedWorld WorldFolder::Load(const std::string& name, const LoadOverrides& overrides) const {
  return LoadValid(Path(name), overrides);
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
