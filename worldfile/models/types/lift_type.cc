// `lift`: a cabin that moves between floors, with doors of the file.
//
// The blocks of the model are the cabin, an object without a parent; the shaft is up to the world. Heights of floors
// are z in W of the cabin's floor, m. The lift starts at the floor whose height is its own z, exactly: a start between
// floors is an error.
//
// The doors are models of the file; a lift takes them over, so that nothing else opens them: no request and no robot
// nearby. A door that is a child of the lift is named as the lift names it, and stands at the height of its floor, so
// that one define has the lift with the doors of all its landings.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "worldfile/models/types/field_properties.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

class LiftReader : public ModelReader {
 public:
  // The body of the cabin.
  Shape ReadShape(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) override {
    cabin_ = ListedForMotion(reader, ModelReader::ReadShape(reader, draft, context));
    return {};
  }

  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    where_ = draft.node.where;
    const auto fail = [&](const char* property, const std::string& message) {
      if (!context.diagnostics.failed()) context.diagnostics.Fail(reader.Where(property), message);
    };
    if (cabin_.empty()) fail("block", "found a 'lift' without blocks, expected those of its cabin: a floor and walls");
    draft_ = draft.node.DraftOf<LiftDraft>();
    if (reader.node().Find("floors") != nullptr || reader.node().Find("heights") != nullptr || draft_.floors.empty()) {
      if (!ReadFloors(reader)) {
        return fail("floors",
                    "found a 'lift' without 'floors', expected their names, and as many numbers in 'heights'");
      }
    }
    for (const LiftDraft::Floor& floor : draft_.floors) {
      lift_.floors.push_back({floor.name, floor.z, {}});
      if (floor.z == draft.X_WM.z) lift_.floor = static_cast<std::uint32_t>(lift_.floors.size() - 1);
    }
    if (lift_.floors[lift_.floor].z != draft.X_WM.z) {
      return fail("pose", "found a 'lift' at none of its 'heights', expected its z to be one of them");
    }
    if (draft_.speed > 0.0) lift_.speed = draft_.speed;
    ReadFields(reader, lift_);
    if (reader.node().Find("cabin_doors") != nullptr) draft_.cabin_doors = reader.Texts("cabin_doors");
    if (reader.node().Find("floor_doors") != nullptr) ReadFloorDoors(reader);
    if (draft.robot || draft.model.gripper_return) {
      fail("name", "found a 'lift' on a robot, or that can be gripped, expected one at a place of the world");
    }
  }

  void AddParts(const ModelDraft& draft, BuildContext& context) override {
    if (context.diagnostics.failed()) return;
    ModelDescription model = draft.model;
    model.name += ".cabin";
    model.type = "lift_cabin";
    model.parent.reset();
    model.X_PM = draft.X_WM;
    model.shape = context.shapes.Add(std::move(cabin_));
    model.power = {};
    model.fiducial_return = 0;
    lift_.model = draft.id;
    lift_.cabin = ObjectId(context.world.objects.size());
    context.names.AddPart(where_, model.name, context.diagnostics);
    context.world.objects.emplace_back(context.world.models.size());
    context.world.models.push_back(std::move(model));
  }

  // The doors may be anywhere in the file.
  void Complete(BuildContext& context) override {
    for (const std::string& name : draft_.cabin_doors) {
      if (const auto door = DoorOf(name, context)) lift_.cabin_doors.push_back(*door);
    }
    for (std::size_t i = 0; i < lift_.floors.size(); ++i) {
      for (const std::string& name : draft_.floors[i].doors) {
        const auto door = DoorOf(name, context);
        if (!door) continue;
        lift_.floors[i].doors.push_back(*door);
        if (IsChild(*door, context.world)) Raise(context.world.doors[*door], lift_.floors[i].z, context.world);
      }
    }
    // A door of a lift moves by it alone.
    for (LiftFloor& floor : lift_.floors) {
      for (const std::size_t door : floor.doors) {
        context.world.doors[door].is_operated = false;
        context.world.doors[door].detection_radius = 0.0;
        context.world.doors[door].sensor_depth = 0.0;
        context.world.doors[door].reopens = false;
      }
    }
    context.world.lifts.push_back(std::move(lift_));
  }

 private:
  // A floor of a name that the draft has keeps its doors.
  bool ReadFloors(PropertyReader& reader) {
    const std::vector<LiftDraft::Floor> before = std::move(draft_.floors);
    draft_.floors.clear();
    std::vector<std::string> names = reader.Texts("floors");
    if (names.empty()) {
      for (const LiftDraft::Floor& floor : before) names.push_back(floor.name);
    }
    const auto heights = reader.Numbers("heights", names.size());
    if (names.empty() || !heights) return false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      LiftDraft::Floor& floor = draft_.floors.emplace_back();
      floor.name = names[i];
      floor.z = (*heights)[i] * reader.units().length;
      for (const LiftDraft::Floor& other : before) {
        if (other.name == floor.name) floor.doors = other.doors;
      }
    }
    return true;
  }

  // Pairs of a floor and a door.
  void ReadFloorDoors(PropertyReader& reader) {
    const std::vector<std::string> pairs = reader.Texts("floor_doors");
    const auto fail = [&](const std::string& message) {
      reader.diagnostics().Fail(reader.Where("floor_doors"), message);
    };
    if (pairs.size() % 2 != 0) fail("found a floor without a door, expected pairs of a floor and a door");
    for (LiftDraft::Floor& floor : draft_.floors) floor.doors.clear();
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
      const auto floor = std::find_if(draft_.floors.begin(), draft_.floors.end(),
                                      [&](const LiftDraft::Floor& each) { return each.name == pairs[i]; });
      if (floor == draft_.floors.end()) {
        return fail("found no floor " + Quoted(pairs[i]) + " of the lift, expected one of 'floors'");
      }
      floor->doors.push_back(pairs[i + 1]);
    }
  }

  // A child of the lift before any other door.
  std::optional<std::size_t> DoorOf(const std::string& name, BuildContext& context) const {
    std::optional<std::size_t> door = FindDoor(context.world, context.world.model(lift_.model).name + "." + name);
    if (!door) door = FindDoor(context.world, name);
    if (!door) context.diagnostics.Fail(where_, "found no door " + Quoted(name) + ", expected a 'door' for the lift");
    return door;
  }

  bool IsChild(std::size_t door, const WorldDescription& world) const {
    return world.model(world.doors[door].model).parent == lift_.model;
  }

  // To `z` (m, W), with its leaves as they stand at load.
  static void Raise(DoorDescription& door, double z, WorldDescription& world) {
    ModelDescription& model = world.models[door.model.index()];
    model.X_PM.z = z - world.model(*model.parent).X_PM.z;
    for (DoorLeaf& leaf : door.leaves) {
      leaf.X_WH.z = z;
      world.models[world.objects[leaf.object.index()].index()].X_PM = leaf.X_WH_at(door.opening);
    }
  }

  SourceLocation where_;
  Shape cabin_;
  LiftDescription lift_;
  LiftDraft draft_;
};

}  // namespace

ModelType LiftType() {
  ModelType type;
  type.name = "lift";
  type.has_body = false;
  type.size = {2.0, 2.0, 2.5};
  type.color = {0.7, 0.75, 0.85, 1.0};
  type.make_reader = MakeReader<LiftReader>;
  return type;
}

}  // namespace troupe
