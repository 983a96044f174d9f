// Feeds any bytes to the readers of SDF, URDF, xacro and meshes, and to that of masks of Nav2. They read files, so the
// bytes are written into a folder of this process, which has a few files that they may name, and no other is allowed.
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "fuzz/checks.h"
#include "fuzz/process_folder.h"
#include "fuzz/targets.h"
#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/map/zone_mask.h"

namespace troupe::fuzz {
namespace {

constexpr const char* kModel =
    "<sdf version='1.9'><model name='inner'><frame name='f'><pose>1 0 0 0 0 1</pose></frame><link name='l'><collision "
    "name='c'><geometry><mesh><uri>m.obj</uri></mesh></geometry></collision></link></model></sdf>";
constexpr const char* kLoop = "<sdf version='1.9'><model name='m'><include><uri>loop.sdf</uri></include></model></sdf>";
constexpr const char* kMacros =
    "<robot xmlns:xacro='x'><xacro:property name='r' value='0.1'/><xacro:macro name='wheel' params='n y:=0.2 *o'><link "
    "name='${n}'><collision><xacro:insert_block name='o'/><geometry><sphere radius='${r}'/></geometry></collision>"
    "</link></xacro:macro></robot>";
constexpr const char* kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

const std::filesystem::path& Folder() {
  static const struct FilledFolder : ProcessFolder {
    FilledFolder() : ProcessFolder("troupe-gazebo") {
      WriteText(path() / "model.sdf", kModel);
      WriteText(path() / "loop.sdf", kLoop);
      WriteText(path() / "macros.xacro", kMacros);
      WriteText(path() / "m.obj", kMesh);
    }
  } folder;
  return folder.path();
}

// Nothing else may be read, and the program xacro is not started.
const AllowedPaths& Allowed() {
  static const AllowedPaths allowed = [] {
    AllowedPaths paths;
    paths.Add(Folder().string());
    return paths;
  }();
  return allowed;
}

void CheckFile(const std::filesystem::path& path) {
  const Result<WorldTree> tree = ReadGazeboTree(path.string(), Allowed());
  if (!tree.ok()) return CheckError(tree.error());
  for (const Warning& warning : tree.value().warnings) Check(!warning.message.empty());
  CheckBuilt(tree.value(), false);
}

}  // namespace

void Gazebo(Bytes bytes) {
  const std::string text = TextOf(bytes);
  const std::string ending = text.find("<robot") == std::string::npos   ? "sdf"
                             : text.find("xacro:") == std::string::npos ? "urdf"
                                                                        : "xacro";
  WriteText(Folder() / ("w." + ending), text);
  CheckFile(Folder() / ("w." + ending));
}

// COLLADA if it begins with "<", OBJ if with a letter of its lines, else STL.
void Mesh(Bytes bytes) {
  const std::string text = TextOf(bytes);
  const char first = text.empty() ? ' ' : text.front();
  const std::string ending = first == '<' ? "dae" : first == 'v' || first == 'o' || first == '#' ? "obj" : "stl";
  WriteText(Folder() / ("x." + ending), text);
  for (const char* const is_static : {"true", "false"}) {
    WriteText(Folder() / "mesh.sdf",
              std::string("<sdf version='1.9'><world name='w'><model name='m'><static>") + is_static +
                  "</static><link name='l'><collision name='c'><pose>0 0 0 0.1 0 0</pose><geometry><mesh><uri>x." +
                  ending + "</uri></mesh></geometry></collision></link></model></world></sdf>");
    CheckFile(Folder() / "mesh.sdf");
  }
}

// The YAML of a mask, and behind a zero byte its image, which it has to name "m.pgm".
void ZoneMask(Bytes bytes) {
  const std::string text = TextOf(bytes);
  const std::size_t end = text.find('\0');
  WriteText(Folder() / "mask.yaml", text.substr(0, end));
  WriteText(Folder() / "m.pgm", end == std::string::npos ? std::string() : text.substr(end + 1));
  for (const bool full : {true, false}) {
    const auto areas = ReadZoneMask((Folder() / "mask.yaml").string(), {"s.json", 1, 1}, Allowed(), full);
    if (!areas.ok()) {
      CheckError(areas.error());
      continue;
    }
    for (const MaskArea& area : areas.value()) {
      Check(area.outline.size() >= 4 && area.outline.size() <= kMaxMaskCorners);
      Check(area.number >= 1 && area.number <= 100);
    }
  }
}

}  // namespace troupe::fuzz
