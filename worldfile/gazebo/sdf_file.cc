#include "worldfile/gazebo/sdf_file.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "worldfile/gazebo/frame_tree.h"
#include "worldfile/gazebo/urdf_file.h"
#include "worldfile/gazebo/xml_values.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxOpenIncludes = 50;
constexpr std::size_t kMaxModels = 20'000;
constexpr std::size_t kMaxLinks = 200'000;

// Elements that concern looks, physics engines or windows; what else is not read gets a warning.
bool IsWithoutEffect(const std::string& name) {
  static const std::set<std::string, std::less<>> known = {"pose",
                                                           "static",
                                                           "self_collide",
                                                           "allow_auto_disable",
                                                           "enable_wind",
                                                           "link",
                                                           "joint",
                                                           "model",
                                                           "include",
                                                           "frame",
                                                           "plugin",
                                                           "sensor",
                                                           "light",
                                                           "physics",
                                                           "scene",
                                                           "gui",
                                                           "gravity",
                                                           "magnetic_field",
                                                           "atmosphere",
                                                           "wind",
                                                           "spherical_coordinates",
                                                           "state",
                                                           "audio",
                                                           "name",
                                                           "placement_frame",
                                                           "kinematic",
                                                           "inertial",
                                                           "collision",
                                                           "visual",
                                                           "must_be_base_link",
                                                           "material",
                                                           "velocity_decay",
                                                           "uri",
                                                           "experimental:params",
                                                           "joints",
                                                           "projector",
                                                           "battery",
                                                           "audio_source",
                                                           "audio_sink",
                                                           "collider",
                                                           "geometry",
                                                           "surface",
                                                           "laser_retro",
                                                           "max_contacts",
                                                           "cast_shadows",
                                                           "transparency",
                                                           "meta",
                                                           "particle_emitter",
                                                           "author",
                                                           "description"};
  return name.starts_with("gz:") || name.starts_with("ignition:") || name.starts_with("drake:") ||
         name.starts_with("experimental:") || known.contains(name);
}

std::string Lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// What a pose is relative to; old versions call the attribute `frame`.
std::string RelativeTo(const XmlElement* pose) {
  if (pose == nullptr) return "";
  const std::string relative_to = XmlValues::Attribute(*pose, "relative_to");
  return relative_to.empty() ? XmlValues::Attribute(*pose, "frame") : relative_to;
}

// The colours of Gazebo's material scripts that worlds use most.
std::optional<Color> ScriptColor(const std::string& name) {
  static const std::map<std::string, Color, std::less<>> known = {{"Red", {1, 0, 0, 1}},
                                                                  {"Green", {0, 1, 0, 1}},
                                                                  {"Blue", {0, 0, 1, 1}},
                                                                  {"Yellow", {1, 1, 0, 1}},
                                                                  {"Orange", {1, 0.55, 0, 1}},
                                                                  {"Purple", {0.6, 0, 0.6, 1}},
                                                                  {"Turquoise", {0, 1, 1, 1}},
                                                                  {"White", {1, 1, 1, 1}},
                                                                  {"Black", {0.05, 0.05, 0.05, 1}},
                                                                  {"Grey", {0.5, 0.5, 0.5, 1}},
                                                                  {"DarkGrey", {0.18, 0.18, 0.18, 1}},
                                                                  {"Wood", {0.65, 0.5, 0.35, 1}},
                                                                  {"Bricks", {0.7, 0.35, 0.25, 1}},
                                                                  {"Gold", {0.8, 0.65, 0.2, 1}},
                                                                  {"Residential", {0.7, 0.7, 0.6, 1}}};
  const auto found = known.find(name.substr(name.rfind('/') + 1));
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

std::optional<Color> ReadMaterial(const XmlElement& visual, const XmlValues& values) {
  const XmlElement* const material = visual.Find("material");
  if (material == nullptr) return std::nullopt;
  if (const XmlElement* const script = material->Find("script")) {
    if (const std::optional<Color> color = ScriptColor(XmlValues::Text(*script, "name"))) return color;
  }
  for (const char* name : {"diffuse", "ambient"}) {
    const XmlElement* const element = material->Find(name);
    if (element == nullptr || element->Trimmed().empty()) continue;
    // Three or four numbers; a fault of a colour is no reason to refuse a world.
    Diagnostics own;
    const XmlValues quiet(values.file(), own);
    std::vector<double> n = quiet.Numbers(*element, {0, 0, 0, 1});
    if (own.failed()) {
      Diagnostics again;
      n = XmlValues(values.file(), again).Numbers(*element, {0, 0, 0});
      n.push_back(1.0);
      if (again.failed()) continue;
    }
    const auto channel = [&](std::size_t i) { return std::clamp(n[i], 0.0, 1.0); };
    return Color{channel(0), channel(1), channel(2), 1.0};
  }
  return std::nullopt;
}

// Both are in nearly every world, and are neither bodies nor always on the disk: those of Gazebo classic and of Fuel,
// perhaps with a version.
bool IsSunOrGround(std::string_view uri) {
  std::string text = Lower(std::string(uri));
  if (text == "model://sun" || text == "model://ground_plane") return true;
  if (!text.starts_with("https://")) return false;
  if (const std::size_t slash = text.find_last_not_of("0123456789"); slash != std::string::npos && text[slash] == '/') {
    text.resize(slash);
  }
  return text.ends_with("/models/sun") || text.ends_with("/models/ground plane") ||
         text.ends_with("/models/ground%20plane");
}

class SdfReader {
 public:
  SdfReader(ModelFiles& files, Diagnostics& diagnostics) : files_(files), diagnostics_(diagnostics) {}

  SdfWorld ReadFile(const std::string& path) {
    SdfWorld world;
    const auto root = files_.ReadXml(path, {path});
    if (!root.ok()) {
      diagnostics_.Fail(root.error().where, root.error().message);
      return world;
    }
    const XmlElement& sdf = *root.value();
    const XmlValues values(path, diagnostics_);
    open_.push_back(path);
    if (sdf.name == "robot") {
      if (std::optional<RigidModel> robot = ReadUrdf(sdf, path, files_, diagnostics_)) {
        world.models.push_back(std::move(*robot));
      }
      return world;
    }
    if (sdf.name != "sdf" && sdf.name != "gazebo") {
      values.Fail(sdf, "found the element " + Quoted(sdf.name) + ", expected 'sdf'");
      return world;
    }
    if (const XmlElement* const element = sdf.Find("world")) {
      world.is_world = true;
      ReadWorld(*element, path, world);
      return world;
    }
    ReadModels(sdf, path, world.models);
    if (world.models.empty() && !diagnostics_.failed()) {
      values.Fail(sdf, "found no world and no model, expected one");
    }
    return world;
  }

 private:
  void ReadWorld(const XmlElement& element, const std::string& path, SdfWorld& world) {
    const XmlValues values(path, diagnostics_);
    world.name = XmlValues::Attribute(element, "name");
    if (const XmlElement* const gravity = element.Find("gravity")) {
      const std::vector<double> g = values.Numbers(*gravity, {0, 0, -9.8});
      world.gravity = std::max(0.0, -g[2]);
    }
    ReadModels(element, path, world.models);
    if (diagnostics_.failed()) return;
    FrameTree frames;
    for (const RigidModel& model : world.models) AddModelFrames(model, frames);
    AddFrames(element, values, frames);
    for (RigidModel& model : world.models) {
      model.T_PM = frames.Resolve(model.name, model.where, diagnostics_);
      model.relative_to.clear();
      model.placement_frame.clear();
    }
    for (const XmlElement& child : element.children) {
      if (child.name == "state" && !diagnostics_.failed()) ApplyState(child, values, world);
    }
  }

  // The models and includes of a world or of a file.
  void ReadModels(const XmlElement& parent, const std::string& path, std::vector<RigidModel>& models) {
    std::set<std::string> names;
    for (const XmlElement& child : parent.children) {
      if (diagnostics_.failed()) return;
      std::optional<RigidModel> model;
      if (child.name == "model") {
        model = ReadModel(child, path);
      } else if (child.name == "include") {
        model = ReadInclude(child, path);
      } else {
        WarnOfUnread(child, path);
      }
      if (!model) continue;
      // Gazebo numbers the includes of one model.
      for (int number = 0; !names.insert(model->name).second; ++number) {
        const std::string base = model->name.substr(0, model->name.rfind('_'));
        model->name = (number == 0 ? model->name : base) + "_" + std::to_string(number);
      }
      models.push_back(std::move(*model));
    }
  }

  void WarnOfUnread(const XmlElement& element, const std::string& path) {
    if (IsWithoutEffect(element.name)) return;
    static const std::map<std::string, const char*, std::less<>> reasons = {
        {"actor", "an 'actor' is left out: people are given by a scenario"},
        {"road", "a 'road' is left out: it has no body"},
        {"population", "a 'population' is left out: Gazebo places it at random"},
        {"gripper", "a 'gripper' of SDF has no effect"}};
    const auto found = reasons.find(element.name);
    const std::string message =
        found != reasons.end() ? found->second : "element " + Quoted(element.name) + " has no effect";
    if (unread_.insert(message).second) diagnostics_.Warn(XmlPlace(element, path), message);
  }

  // A model with its frames in a scope: itself, its links and the like as "model::link".
  void AddModelFrames(const RigidModel& model, FrameTree& frames) {
    Transform3 T = model.T_PM;
    if (!model.placement_frame.empty()) {
      const auto placed = model.frames.find(model.placement_frame);
      if (placed != model.frames.end()) {
        T = T * placed->second.Inverse();
      } else {
        diagnostics_.Fail(model.where, "found the placement frame " + Quoted(model.placement_frame) +
                                           ", expected a frame of model " + Quoted(model.name));
      }
    }
    frames.Add(model.name, T, model.relative_to, model.where);
    for (const auto& [name, T_MF] : model.frames) frames.Add(model.name + "::" + name, T_MF, model.name, model.where);
  }

  // The `frame` elements of a world or a model.
  static void AddFrames(const XmlElement& parent, const XmlValues& values, FrameTree& frames) {
    for (const XmlElement& child : parent.children) {
      if (child.name != "frame") continue;
      const XmlElement* const pose = child.Find("pose");
      std::string relative_to = RelativeTo(pose);
      if (relative_to.empty()) relative_to = XmlValues::Attribute(child, "attached_to");
      frames.Add(XmlValues::Attribute(child, "name"), pose != nullptr ? values.Pose(*pose) : Transform3(), relative_to,
                 values.At(child));
    }
  }

  std::optional<RigidModel> ReadInclude(const XmlElement& include, const std::string& path) {
    const XmlValues values(path, diagnostics_);
    const XmlElement* const uri = include.Find("uri");
    const SourceLocation where = uri != nullptr ? XmlTextPlace(*uri, path) : values.At(include);
    std::string text = XmlValues::Text(include, "uri");
    while (text.ends_with('/')) text.pop_back();
    if (IsSunOrGround(text)) return std::nullopt;
    if (open_.size() > kMaxOpenIncludes) {
      diagnostics_.Fail(
          where, "found more than " + std::to_string(kMaxOpenIncludes) + " includes inside each other, expected fewer");
      return std::nullopt;
    }
    const Result<std::string> file = files_.FindModel(text, path, where);
    if (!file.ok()) {
      diagnostics_.Fail(file.error().where, file.error().message);
      return std::nullopt;
    }
    if (std::find(open_.begin(), open_.end(), file.value()) != open_.end()) {
      diagnostics_.Fail(where, "found an include of " + QuotedPath(text) + " inside itself, expected no include loop");
      return std::nullopt;
    }
    const auto root = files_.ReadXml(file.value(), where);
    if (!root.ok()) {
      diagnostics_.Fail(root.error().where, root.error().message);
      return std::nullopt;
    }
    open_.push_back(file.value());
    std::optional<RigidModel> model;
    if (root.value()->name == "robot") {
      model = ReadUrdf(*root.value(), file.value(), files_, diagnostics_);
    } else if (const XmlElement* const element = root.value()->Find("model")) {
      model = ReadModel(*element, file.value());
    } else if (root.value()->Find("light") == nullptr && root.value()->Find("actor") == nullptr &&
               !diagnostics_.failed()) {
      diagnostics_.Fail(where, "found no model in " + QuotedPath(file.value()) + ", expected one");
    }
    open_.pop_back();
    if (!model) return std::nullopt;
    if (include.Find("name") != nullptr) model->name = XmlValues::Text(include, "name");
    if (const XmlElement* const pose = include.Find("pose")) {
      model->T_PM = values.Pose(*pose);
      model->relative_to = RelativeTo(pose);
    }
    if (const XmlElement* const placement = include.Find("placement_frame")) {
      model->placement_frame = std::string(placement->Trimmed());
    }
    model->is_static = XmlValues::Flag(include, "static", model->is_static);
    model->where = values.At(include);
    AddPlugins(include, path, *model);
    return model;
  }

  static void AddPlugins(const XmlElement& parent, const std::string& path, RigidModel& model) {
    for (const XmlElement& child : parent.children) {
      if (child.name != "plugin") continue;
      const std::string name = XmlValues::Attribute(child, "filename") + " " + XmlValues::Attribute(child, "name");
      model.plugins.push_back({Lower(name), child, path});
    }
  }

  std::optional<RigidModel> ReadModel(const XmlElement& element, const std::string& path) {
    const XmlValues values(path, diagnostics_);
    RigidModel model;
    model.name = XmlValues::Attribute(element, "name");
    model.where = values.At(element);
    if (model.name.empty()) values.Fail(element, "found a model without a name, expected the attribute 'name'");
    if (++models_ > kMaxModels) values.Fail(element, "found more than " + std::to_string(kMaxModels) + " models");
    if (diagnostics_.failed()) return std::nullopt;
    model.is_static = XmlValues::Flag(element, "static", false);
    model.placement_frame = XmlValues::Attribute(element, "placement_frame");
    if (const XmlElement* const pose = element.Find("pose")) {
      model.T_PM = values.Pose(*pose);
      model.relative_to = RelativeTo(pose);
    }
    FrameTree frames;
    std::vector<RigidModel> nested;
    for (const XmlElement& child : element.children) {
      if (diagnostics_.failed()) return std::nullopt;
      if (child.name == "link") {
        ReadLink(child, values, model, frames);
      } else if (child.name == "model") {
        if (std::optional<RigidModel> inner = ReadModel(child, path)) nested.push_back(std::move(*inner));
      } else if (child.name == "include") {
        std::optional<RigidModel> inner = ReadInclude(child, path);
        if (!inner) continue;
        if (XmlValues::Attribute(child, "merge") == "true") {
          Merge(std::move(*inner), frames, model);
        } else {
          nested.push_back(std::move(*inner));
        }
      } else if (child.name != "joint") {
        WarnOfUnread(child, path);
      }
    }
    for (const RigidModel& inner : nested) AddModelFrames(inner, frames);
    AddJointFrames(element, values, frames);
    AddFrames(element, values, frames);
    for (LinkPart& link : model.links) link.T_ML = frames.Resolve(link.name, link.where, diagnostics_);
    ReadJoints(element, values, frames, model);
    AddPlugins(element, path, model);
    for (RigidModel& inner : nested) {
      if (diagnostics_.failed()) return std::nullopt;
      Append(std::move(inner), frames, model);
    }
    if (diagnostics_.failed()) return std::nullopt;
    model.frames = frames.All(diagnostics_);
    return model;
  }

  // The parts of a merged include, without a prefix.
  static void Merge(RigidModel inner, FrameTree& frames, RigidModel& model) {
    for (const auto& [name, T] : inner.frames) frames.Add(name, inner.T_PM * T, inner.relative_to, inner.where);
    for (LinkPart& link : inner.links) model.links.push_back(std::move(link));
    for (JointPart& joint : inner.joints) {
      joint.T_MJ = inner.T_PM * joint.T_MJ;
      joint.axis = inner.T_PM.Rotate(joint.axis);
      model.joints.push_back(std::move(joint));
    }
    std::move(inner.plugins.begin(), inner.plugins.end(), std::back_inserter(model.plugins));
  }

  // The parts of a nested model, behind its name.
  void Append(RigidModel inner, FrameTree& frames, RigidModel& model) {
    const Transform3 T = frames.Resolve(inner.name, inner.where, diagnostics_);
    const std::string prefix = inner.name + "::";
    if (inner.is_static) model.is_static = true;
    for (LinkPart& link : inner.links) {
      link.name = prefix + link.name;
      link.T_ML = T * link.T_ML;
      model.links.push_back(std::move(link));
    }
    for (JointPart& joint : inner.joints) {
      joint.name = prefix + joint.name;
      joint.parent = prefix + joint.parent;
      joint.child = prefix + joint.child;
      if (!joint.mimic.empty()) joint.mimic = prefix + joint.mimic;
      joint.T_MJ = T * joint.T_MJ;
      joint.axis = T.Rotate(joint.axis);
      model.joints.push_back(std::move(joint));
    }
    std::move(inner.plugins.begin(), inner.plugins.end(), std::back_inserter(model.plugins));
  }

  void ReadLink(const XmlElement& element, const XmlValues& values, RigidModel& model, FrameTree& frames) {
    LinkPart link;
    link.name = XmlValues::Attribute(element, "name");
    link.where = values.At(element);
    if (++links_ > kMaxLinks) values.Fail(element, "found more than " + std::to_string(kMaxLinks) + " links");
    const XmlElement* const pose = element.Find("pose");
    frames.Add(link.name, pose != nullptr ? values.Pose(*pose) : Transform3(), RelativeTo(pose), link.where);
    if (const XmlElement* const inertial = element.Find("inertial")) {
      link.mass = std::clamp(values.Number(*inertial, "mass", 1.0), 0.0, kMaxMagnitude);
    }
    for (const XmlElement& child : element.children) {
      if (diagnostics_.failed()) return;
      if (child.name == "collision" || child.name == "visual") {
        ReadSolids(child, values, link);
      } else if (child.name == "sensor") {
        const XmlElement* const at = child.Find("pose");
        link.sensors.push_back({XmlValues::Attribute(child, "name"), at != nullptr ? values.Pose(*at) : Transform3(),
                                child, values.file()});
      } else {
        WarnOfUnread(child, values.file());
      }
    }
    model.links.push_back(std::move(link));
  }

  void ReadSolids(const XmlElement& element, const XmlValues& values, LinkPart& link) {
    const XmlElement* const geometry = element.Find("geometry");
    if (geometry == nullptr) return;
    const XmlElement* const pose = element.Find("pose");
    const Transform3 T_LS = pose != nullptr ? values.Pose(*pose) : Transform3();
    const bool is_visual = element.name == "visual";
    // Looks are read for what nothing else shows, and a fault in them is no reason to refuse a world.
    if (is_visual) {
      Diagnostics own;
      for (SolidShape& solid : ReadGeometry(*geometry, values.file(), files_, own)) {
        link.visuals.push_back({std::move(solid), T_LS, ReadMaterial(element, values), values.At(element)});
      }
      if (own.failed()) link.visual_faults.push_back(*own.error());
      return;
    }
    for (SolidShape& solid : ReadGeometry(*geometry, values.file(), files_, diagnostics_)) {
      link.collisions.push_back({std::move(solid), T_LS, std::nullopt, values.At(element)});
    }
  }

  static void AddJointFrames(const XmlElement& model, const XmlValues& values, FrameTree& frames) {
    for (const XmlElement& joint : model.children) {
      if (joint.name != "joint") continue;
      const XmlElement* const pose = joint.Find("pose");
      std::string relative_to = RelativeTo(pose);
      if (relative_to.empty()) relative_to = XmlValues::Text(joint, "child");
      frames.Add(XmlValues::Attribute(joint, "name"), pose != nullptr ? values.Pose(*pose) : Transform3(), relative_to,
                 values.At(joint));
    }
  }

  void ReadJoints(const XmlElement& model_element, const XmlValues& values, FrameTree& frames, RigidModel& model) {
    for (const XmlElement& element : model_element.children) {
      if (element.name != "joint" || diagnostics_.failed()) continue;
      JointPart joint;
      joint.name = XmlValues::Attribute(element, "name");
      joint.type = XmlValues::Attribute(element, "type");
      joint.parent = XmlValues::Text(element, "parent");
      joint.child = XmlValues::Text(element, "child");
      joint.where = values.At(element);
      joint.T_MJ = frames.Resolve(joint.name, joint.where, diagnostics_);
      if (const XmlElement* const axis = element.Find("axis")) {
        std::vector<double> xyz = {0, 0, 1};
        std::string expressed_in;
        if (const XmlElement* const direction = axis->Find("xyz")) {
          xyz = values.Numbers(*direction, {0, 0, 1});
          expressed_in = XmlValues::Attribute(*direction, "expressed_in");
        }
        const bool in_model = XmlValues::Flag(*axis, "use_parent_model_frame", false) || expressed_in == "__model__";
        const Vec3 v{xyz[0], xyz[1], xyz[2]};
        const double length = Length(v);
        if (length > 0.0) joint.axis = (in_model ? v : joint.T_MJ.Rotate(v)) * (1.0 / length);
        if (const XmlElement* const limit = axis->Find("limit")) {
          joint.lower = values.Number(*limit, "lower", -kMaxMagnitude);
          joint.upper = values.Number(*limit, "upper", kMaxMagnitude);
          joint.velocity = std::max(0.0, values.Number(*limit, "velocity", 0.0));
        } else {
          joint.lower = -kMaxMagnitude;
          joint.upper = kMaxMagnitude;
        }
        if (const XmlElement* const mimic = axis->Find("mimic")) {
          joint.mimic = XmlValues::Attribute(*mimic, "joint");
          joint.mimic_multiplier = values.Number(*mimic, "multiplier", 1.0);
          joint.mimic_offset = values.Number(*mimic, "offset", 0.0);
        }
      }
      if (joint.type == "revolute" && joint.upper - joint.lower > 1e3) joint.type = "continuous";
      model.joints.push_back(std::move(joint));
    }
  }

  // The poses of a classic state replace those of the models; links follow their models.
  void ApplyState(const XmlElement& state, const XmlValues& values, SdfWorld& world) {
    for (const XmlElement& element : state.children) {
      if (element.name == "insertions") {
        ReadModels(element, values.file(), world.models);
        continue;
      }
      if (element.name != "model") continue;
      const std::string name = XmlValues::Attribute(element, "name");
      const auto model = std::find_if(world.models.begin(), world.models.end(),
                                      [&](const RigidModel& candidate) { return candidate.name == name; });
      if (model == world.models.end()) continue;
      if (const XmlElement* const pose = element.Find("pose")) model->T_PM = values.Pose(*pose);
      if (const XmlElement* const scale = element.Find("scale")) {
        const std::vector<double> n = values.Numbers(*scale, {1, 1, 1});
        if (n != std::vector<double>{1, 1, 1}) {
          values.Warn(*scale, "found the scale of a model other than 1, expected 1; it has no effect");
        }
      }
    }
  }

  ModelFiles& files_;
  Diagnostics& diagnostics_;
  std::vector<std::string> open_;  // the files that are being read
  std::set<std::string> unread_;
  std::size_t models_ = 0;
  std::size_t links_ = 0;
};

}  // namespace

bool IsSdfText(std::string_view text) {
  // The first element, behind instructions and comments.
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  for (;;) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return false;
    text.remove_prefix(begin);
    const std::string_view end = text.starts_with("<!--") ? "-->" : text.starts_with("<?") ? "?>" : "";
    if (end.empty()) break;
    const std::size_t found = text.find(end);
    if (found == std::string_view::npos) return false;
    text.remove_prefix(found + end.size());
  }
  return text.starts_with("<");
}

Result<SdfWorld> ReadSdf(const std::string& path, ModelFiles& files, Diagnostics& diagnostics) {
  SdfWorld world = SdfReader(files, diagnostics).ReadFile(path);
  if (diagnostics.failed()) return *diagnostics.error();
  return world;
}

}  // namespace troupe
