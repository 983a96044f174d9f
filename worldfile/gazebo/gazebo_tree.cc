#include "worldfile/gazebo/gazebo_tree.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "worldfile/gazebo/model_node.h"
#include "worldfile/gazebo/sdf_file.h"
#include "worldfile/gazebo/urdf_file.h"
#include "worldfile/gazebo/xacro_expand.h"
#include "worldfile/sites/node_maker.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::string_view kModelFile = "model_file";

std::string EndingOfPath(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

void AddFiles(const std::vector<std::string>& files, WorldTree& tree) {
  for (const std::string& file : files) {
    if (std::find(tree.files.begin(), tree.files.end(), file) == tree.files.end()) tree.files.push_back(file);
  }
}

// The models of a file of any kind.
Result<SdfWorld> ReadModels(const std::string& path, const SourceLocation& where, ModelFiles& files,
                            Diagnostics& diagnostics) {
  const auto root = files.ReadXml(path, where);
  if (!root.ok()) return root.error();
  if (HasXacro(*root.value())) {
    // The program reads files of its own choice: not for a stranger.
    const bool may_run = files.allowed().Resolve("/").has_value();
    const Result<std::optional<std::string>> text = may_run ? RunXacro(path) : std::optional<std::string>();
    if (!text.ok()) return text.error();
    Result<XmlElement> expanded =
        text.value() ? ParseXml(*text.value(), path) : ExpandXacro(*root.value(), path, files);
    if (!expanded.ok()) return expanded.error();
    files.ReplaceXml(path, std::move(expanded).value());
  }
  return ReadSdf(path, files, diagnostics);
}

// Reads models of files, each file once.
class ModelReaderOfFiles {
 public:
  ModelReaderOfFiles(const AllowedPaths& allowed, WorldTree& tree) : files_(allowed), tree_(tree) {}

  // The node of the file's one model.
  Result<WorldNode> Read(const std::string& path, ModelUse use, const SourceLocation& where) {
    const FileUnits units = UnitsOf(tree_.world);
    if (units.metres != 1.0 || units.radians == 1.0) {
      return Error{where, "found a model of a file in a world whose units are not metres and degrees, expected these"};
    }
    const std::pair key(path, use);
    if (const auto found = nodes_.find(key); found != nodes_.end()) return found->second;
    Diagnostics diagnostics;
    const Result<SdfWorld> world = ReadModels(path, where, files_, diagnostics);
    if (!world.ok()) return world.error();
    if (world.value().models.size() != 1) {
      return Error{where, "found " + CountText(world.value().models.size(), "model") + " in " + QuotedPath(path) +
                              ", expected one"};
    }
    RigidModel model = world.value().models.front();
    model.T_PM = {};
    std::optional<WorldNode> node = ModelNode(model, use, diagnostics);
    if (diagnostics.failed()) return *diagnostics.error();
    if (!node) return Error{where, "found a model without a body in " + QuotedPath(path) + ", expected one"};
    for (Warning& warning : diagnostics.warnings()) tree_.warnings.push_back(std::move(warning));
    AddFiles(files_.files(), tree_);
    nodes_.emplace(key, *node);
    return std::move(*node);
  }

 private:
  ModelFiles files_;
  WorldTree& tree_;
  std::map<std::pair<std::string, ModelUse>, WorldNode> nodes_;
};

// A URDF is a robot, and so is what the caller wants as one.
ModelUse UseOf(const std::string& path, bool is_robot) {
  const std::string ending = EndingOfPath(path);
  return is_robot || ending == ".urdf" || ending == ".xacro" ? ModelUse::kRobot : ModelUse::kAsWritten;
}

// The node or define with the model of the file that its property names; its own properties count before the file's.
template <typename NodeOrDefine>
Status Expand(NodeOrDefine& node, std::string& type, const std::string& directory, ModelReaderOfFiles& reader) {
  const auto property = std::find_if(node.properties.begin(), node.properties.end(),
                                     [](const Property& candidate) { return candidate.name == kModelFile; });
  if (property == node.properties.end()) return Status();
  const std::string* const name = std::get_if<std::string>(&property->value.content);
  if (name == nullptr) return Error{property->where, "found a 'model_file' that is no text, expected a path"};
  const SourceLocation where = property->value.where;
  const std::string path = FindFile(*name, directory, where.file);
  Result<WorldNode> read = reader.Read(path, UseOf(path, type == "position"), where);
  if (!read.ok()) return read.error();
  WorldNode& file = read.value();
  std::vector<Property> properties = std::move(file.properties);
  // The name and the place in the file are those of its own world.
  std::erase_if(properties, [](const Property& each) { return each.name == "name" || each.name == "pose"; });
  for (const Property& own : node.properties) {
    if (own.name != kModelFile) properties.push_back(own);
  }
  node.properties = LastOfEachName(std::move(properties));
  ChildNodes children = std::move(file.children);
  children.Add(node.children);
  node.children = std::move(children);
  node.draft = file.draft;
  type = file.type;
  return Status();
}

Status ExpandNode(WorldNode& node, const std::string& directory, ModelReaderOfFiles& reader);

bool NamesModelFile(const WorldNode& node) {
  return node.Find(kModelFile) != nullptr || std::any_of(node.children.begin(), node.children.end(), NamesModelFile);
}

Status ExpandChildren(ChildNodes& children, const std::string& directory, ModelReaderOfFiles& reader) {
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (!NamesModelFile(children[i])) continue;
    if (Status status = ExpandNode(children.Change(i), directory, reader); !status.ok()) return status;
  }
  return Status();
}

Status ExpandNode(WorldNode& node, const std::string& directory, ModelReaderOfFiles& reader) {
  if (Status status = ExpandChildren(node.children, directory, reader); !status.ok()) return status;
  return Expand(node, node.type, directory, reader);
}

// "x,y" or "x,y,heading".
std::optional<std::vector<double>> ParsePlace(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::optional<LeadingNumber> number = ReadLeadingNumber(text.substr(begin, end - begin));
    if (!number || !number->is_all) return std::nullopt;
    numbers.push_back(number->value);
    begin = end + 1;
  }
  if (numbers.size() == 2) numbers.push_back(0.0);
  return numbers.size() == 3 ? std::optional(numbers) : std::nullopt;
}

}  // namespace

bool IsModelFile(std::string_view name) {
  return name.ends_with(".urdf") || name.ends_with(".xacro") || name.ends_with(".sdf");
}

std::string NameOfModelFile(std::string_view path) {
  const std::filesystem::path file(path);
  const std::string name = file.stem().stem().string();
  return name == "model" && file.has_parent_path() ? file.parent_path().filename().string() : name;
}

bool IsGazeboPath(const std::string& path, const AllowedPaths& allowed) {
  if (IsModelFile(path)) return true;
  if (!path.ends_with(".world")) return false;
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  return text.ok() && IsSdfText(text.value());
}

Result<WorldTree> ReadGazeboTree(const std::string& path, const AllowedPaths& allowed) {
  ModelFiles files(allowed);
  Diagnostics diagnostics;
  const Result<SdfWorld> read = ReadModels(path, {path}, files, diagnostics);
  if (!read.ok()) return read.error();
  const SdfWorld& world = read.value();
  WorldTree tree;
  tree.world.type = "world";
  tree.world.where = {path, 1, 1};
  tree.directory = DirectoryOf(path);
  NodeMaker maker("world", tree.world.where);
  if (!world.name.empty()) maker.Text("name", world.name);
  if (world.gravity) maker.Number("gravity", *world.gravity);
  for (const RigidModel& model : world.models) {
    const ModelUse use = world.is_world ? ModelUse::kAsWritten : UseOf(path, false);
    std::optional<WorldNode> node = ModelNode(model, use, diagnostics);
    if (diagnostics.failed()) return *diagnostics.error();
    if (node) maker.Child(std::move(*node));
  }
  tree.world = std::move(maker.node);
  tree.files = {path};
  AddFiles(files.files(), tree);
  tree.warnings = std::move(diagnostics.warnings());
  return tree;
}

Status DefineModelFile(const std::string& name, const std::string& path, const SourceLocation& where,
                       const AllowedPaths& allowed, WorldTree& tree) {
  if (tree.defines.contains(name)) return Status();
  ModelReaderOfFiles reader(allowed, tree);
  Result<WorldNode> read = reader.Read(path, UseOf(path, false), where);
  if (!read.ok()) return read.error();
  WorldNode& node = read.value();
  std::erase_if(node.properties, [](const Property& each) { return each.name == "name" || each.name == "pose"; });
  tree.defines.emplace(name,
                       Define{node.type, std::move(node.properties), std::move(node.children), where, node.draft});
  return Status();
}

Status ExpandModelFiles(const AllowedPaths& allowed, WorldTree& tree) {
  ModelReaderOfFiles reader(allowed, tree);
  for (auto& [name, define] : tree.defines) {
    if (Status status = ExpandChildren(define.children, tree.directory, reader); !status.ok()) return status;
    if (Status status = Expand(define, define.base, tree.directory, reader); !status.ok()) return status;
  }
  return ExpandChildren(tree.world.children, tree.directory, reader);
}

Status AddRobots(const std::vector<std::string>& robots, const AllowedPaths& allowed, WorldTree& tree) {
  if (robots.empty()) return Status();
  FreeNames names;
  for (const std::string& name : ChildNames(tree.world)) names.Add(name);
  for (const std::string& text : robots) {
    const std::size_t at = text.rfind('@');
    const std::string path = text.substr(0, at);
    const SourceLocation where{"--robot " + text, 0, 0};
    std::vector<double> place = {0, 0, 0};
    if (at != std::string::npos) {
      const std::optional<std::vector<double>> parsed = ParsePlace(text.substr(at + 1));
      if (!parsed)
        return Error{where, "found the place " + Quoted(text.substr(at + 1)) + ", expected X,Y or X,Y,HEADING"};
      place = *parsed;
    }
    if (Status status = DefineModelFile(path, path, where, allowed, tree); !status.ok()) return status;
    Result<WorldNode> made = Instantiate(tree, path, where);
    if (!made.ok()) return made.error();
    NodeMaker maker(made.value().type, where);
    maker.node = std::move(made).value();
    if (maker.node.type != "position") {
      return Error{where, "found a model that does not drive in " + QuotedPath(path) + ", expected a robot"};
    }
    maker.Text("name", names.Add(NameOfModelFile(path)));
    maker.Numbers("pose", {place[0], place[1], 0.0, place[2]});
    tree.world.children.Add(std::move(maker.node));
  }
  return Status();
}

}  // namespace troupe
