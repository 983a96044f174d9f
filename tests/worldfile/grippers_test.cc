// Actuators, grippers and objects of world files.
#include <cmath>

#include "common/model/states.h"
#include "tests/worldfile/world_folder.h"
#include "troupe/world_state.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

// Loads a world that has to be valid: its description is checked, too.
LoadedWorld LoadGood(const std::string& text) {
  LoadedWorld loaded = WorldFolder().LoadText(text);
  const Status status = Validate(loaded.world);
  EXPECT_TRUE(status.ok()) << status.error().message;
  return loaded;
}

ModelId ModelCalled(const WorldDescription& world, const std::string& name) {
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (world.models[i].name == name) return ModelId(i);
  }
  ADD_FAILURE() << "no model " << name;
  return ModelId(0);
}

Pose PoseOf(const WorldDescription& world, const std::string& name) {
  return ModelPoses(world, PlacedState(world))[ModelCalled(world, name).index()];
}

std::vector<std::string> JointNames(const WorldDescription& world) {
  std::vector<std::string> names;
  for (const JointDescription& joint : world.joints) names.push_back(joint.name);
  return names;
}

std::vector<std::string> ObjectNames(const WorldDescription& world) {
  std::vector<std::string> names;
  for (const ModelId object : world.objects) names.push_back(world.model(object).name);
  return names;
}

TEST(Actuators, BecomeJointsOfTheirRobot) {
  const LoadedWorld loaded = LoadGood(
      "model( pose [9 9 0 0] )\n"
      "position( name \"r\" model( name \"arm\" actuator( name \"slide\" axis [0 3 4] max_speed 0.5\n"
      "  min_position -0.1 max_position 0.3 start_position 0.2 pose [1 0 0 90] ) ) )");
  ASSERT_THAT(loaded.world.joints, SizeIs(1));
  const JointDescription& joint = loaded.world.joints[0];
  EXPECT_EQ(joint.name, "arm.slide");
  EXPECT_EQ(joint.robot, RobotId(0));
  EXPECT_EQ(joint.model, ModelCalled(loaded.world, "r.arm.slide"));
  EXPECT_EQ(joint.type, JointType::kPrismatic);
  EXPECT_EQ(joint.axis_xy, Vec2(0.0, 0.6));
  EXPECT_EQ(joint.axis_z, 0.8);
  EXPECT_EQ(joint.position, (Interval{-0.1, 0.3}));
  EXPECT_EQ(joint.start, 0.2);
  EXPECT_EQ(joint.max_speed, 0.5);
  EXPECT_THAT(loaded.warnings, IsEmpty());
}

TEST(Actuators, KeepTheirPoseAlsoWithAStartPosition) {
  const LoadedWorld loaded = LoadGood(
      "position( name \"r\" stack_children 0\n"
      "  actuator( name \"a\" pose [1 2 0.5 90] axis [1 0 0] max_position 5 start_position 0.25 ) )");
  const Pose pose = PoseOf(loaded.world, "r.a");  // its axis points along y
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.25, 1e-12);
  EXPECT_EQ(pose.z, 0.5);
}

TEST(Actuators, RotationalOnesTurnAboutTheVerticalInUnitsOfAngle) {
  const LoadedWorld loaded = LoadGood(
      "position( actuator( type \"rotational\" min_position -90 max_position 90 start_position 45 max_speed 30 ) )");
  const JointDescription& joint = loaded.world.joints[0];
  EXPECT_EQ(joint.type, JointType::kRevolute);
  EXPECT_EQ(joint.axis_z, 1.0);
  EXPECT_NEAR(joint.position.min, -0.5 * kPi, 1e-12);
  EXPECT_NEAR(joint.start, 0.25 * kPi, 1e-12);
  EXPECT_NEAR(joint.max_speed, kPi / 6.0, 1e-12);
}

TEST(Actuators, LengthsAreInTheUnitOfTheFile) {
  const LoadedWorld loaded =
      LoadGood("unit_length \"cm\" position( actuator( axis [0 0 2] max_position 50 max_speed 10 ) )");
  EXPECT_EQ(loaded.world.joints[0].position.max, 0.5);
  EXPECT_EQ(loaded.world.joints[0].max_speed, 0.1);
  EXPECT_EQ(loaded.world.joints[0].axis_z, 1.0);
}

TEST(Actuators, StartAtTheLimitNextToZero) {
  const LoadedWorld loaded = LoadGood("position( actuator( axis [0 0 1] min_position 0.2 ) )");
  EXPECT_EQ(loaded.world.joints[0].start, 0.2);
}

TEST(Actuators, OnNoRobotDoNotMove) {
  EXPECT_THAT(WorldFolder().WarningsOf("actuator( axis [0 0 1] type \"rotational\" max_speed 2 )"),
              ElementsAre("w.world:1:1: warning: this actuator is on no robot, so it does not move"));
}

// Stage's: 0.2 x 0.3 x 0.2 m, paddles of 0.132 x 0.03 x 0.08 m in front.
class StageGripper : public testing::Test {
 protected:
  const LoadedWorld loaded_ =
      LoadGood("position( name \"r\" size [0.4 0.4 0.3] gripper( name \"hand\" pose [0.3 0 -0.3 0] color \"blue\" ) )");
  const WorldDescription& world_ = loaded_.world;

  Rectangle BoundsOf(const std::string& name) const {
    Rectangle bounds = Rectangle::Nothing();
    const ModelDescription& model = world_.model(ModelCalled(world_, name));
    for (const Block& block : world_.shape(model.shape).blocks) {
      for (const Vec2& corner : block.outline) bounds.Extend(Transform2(PoseOf(world_, name)) * corner);
    }
    return bounds;
  }
};

TEST_F(StageGripper, HasALiftAndTwoPaddles) {
  EXPECT_THAT(loaded_.warnings, IsEmpty());
  EXPECT_THAT(JointNames(world_), ElementsAre("hand.lift", "hand.left_paddle", "hand.right_paddle"));
  ASSERT_THAT(world_.grippers, SizeIs(1));
  const GripperDescription& gripper = world_.grippers[0];
  EXPECT_EQ(gripper.name, "hand");
  EXPECT_EQ(world_.model(gripper.model).name, "r.hand.lift");
  EXPECT_EQ(world_.joint(gripper.left).name, "hand.left_paddle");
  EXPECT_EQ(world_.joint(gripper.right).name, "hand.right_paddle");
  EXPECT_EQ(world_.model(gripper.left_pad).name, "r.hand.left_paddle");
  EXPECT_EQ(world_.joint(*gripper.lift).name, "hand.lift");
  EXPECT_FALSE(gripper.autosnatch);
}

TEST_F(StageGripper, ItsBodyIsBehindThePaddlesAndBesideTheRobot) {
  const auto expect_near = [](const Rectangle& found, const Rectangle& expected) {
    EXPECT_NEAR(found.min_x, expected.min_x, 1e-12);
    EXPECT_NEAR(found.min_y, expected.min_y, 1e-12);
    EXPECT_NEAR(found.max_x, expected.max_x, 1e-12);
    EXPECT_NEAR(found.max_y, expected.max_y, 1e-12);
  };
  expect_near(BoundsOf("r.hand"), {0.2, -0.15, 0.268, 0.15});
  expect_near(BoundsOf("r.hand.left_paddle"), {0.268, 0.12, 0.4, 0.15});
  expect_near(BoundsOf("r.hand.right_paddle"), {0.268, -0.15, 0.4, -0.12});
  EXPECT_EQ(world_.model(ModelCalled(world_, "r.hand.left_paddle")).color, (Color{0, 0, 1, 1}));
}

TEST_F(StageGripper, ClosesUntilThePaddlesTouchAndLiftsToItsTopInTwoSeconds) {
  WorldState state = PlacedState(world_);
  for (std::size_t i = 0; i < world_.joints.size(); ++i) state.joints[i].position = world_.joints[i].position.max;
  const std::vector<Pose> X_WM = ModelPoses(world_, state);
  EXPECT_NEAR(X_WM[ModelCalled(world_, "r.hand.left_paddle").index()].y, 0.015, 1e-12);
  EXPECT_NEAR(X_WM[ModelCalled(world_, "r.hand.right_paddle").index()].y, -0.015, 1e-12);
  EXPECT_NEAR(X_WM[ModelCalled(world_, "r.hand.left_paddle").index()].z, 0.12, 1e-12);
  for (const JointDescription& joint : world_.joints) {
    EXPECT_NEAR(joint.position.max / joint.max_speed, 2.0, 1e-12) << joint.name;
    EXPECT_EQ(joint.start, 0.0) << joint.name;
  }
}

TEST_F(StageGripper, HasTwoBeamsAcross) {
  const std::vector<BreakBeam>& beams = world_.grippers[0].beams;
  ASSERT_THAT(beams, SizeIs(2));
  const double back = -0.1 + 0.34 * 0.2;
  for (const auto& [beam, part] : {std::pair(beams[0], 0.25), std::pair(beams[1], 0.75)}) {
    EXPECT_NEAR(beam.from.x(), back + part * 0.132, 1e-12);
    EXPECT_NEAR(beam.to.x(), back + part * 0.132, 1e-12);
    EXPECT_NEAR(beam.from.y(), 0.12, 1e-12);
    EXPECT_NEAR(beam.to.y(), -0.12, 1e-12);
    EXPECT_NEAR(beam.z, 0.04, 1e-12);
  }
}

TEST(Grippers, StartAsPaddleStateSays) {
  const LoadedWorld loaded =
      LoadGood("position( gripper( paddle_state [\"closed\" \"up\"] autosnatch 1 size [0.4 0.3 0.2] ) )");
  for (const JointDescription& joint : loaded.world.joints) EXPECT_EQ(joint.start, joint.position.max) << joint.name;
  EXPECT_TRUE(loaded.world.grippers[0].autosnatch);
}

TEST(Grippers, HeightsAreThoseOfThePaddlesAboveTheRobotsBase) {
  const LoadedWorld loaded = LoadGood(
      "position( name \"r\" pose [0 0 5 0] size [1 1 0.5]\n"
      "  gripper( name \"g\" pose [1 0 -0.3 0] min_height 0.05 max_height 0.85 vDistanceDivision 40 ) )");
  EXPECT_NEAR(PoseOf(loaded.world, "r.g").z, 5.2, 1e-12);
  EXPECT_NEAR(PoseOf(loaded.world, "r.g.left_paddle").z, 5.05, 1e-12);
  const JointDescription& lift = loaded.world.joint(*loaded.world.grippers[0].lift);
  EXPECT_EQ(lift.position.min, 0.0);
  EXPECT_NEAR(lift.position.max, 0.8, 1e-12);
  EXPECT_NEAR(lift.max_speed, 0.2, 1e-12);  // 40 updates of 100 ms
}

TEST(Grippers, SpeedsDoNotDependOnTheTick) {
  const auto speeds = [](const std::string& world, const std::string& gripper) {
    std::vector<double> found;
    for (const JointDescription& joint : LoadGood(world + " position( gripper( " + gripper + " ) )").world.joints) {
      found.push_back(std::round(joint.max_speed * 1e9) / 1e9);
    }
    return found;
  };
  EXPECT_EQ(speeds("interval_sim 50", ""), speeds("", ""));
  EXPECT_THAT(speeds("", "vDistanceDivision 10"), ElementsAre(0.12, 0.06, 0.06));
  EXPECT_THAT(speeds("", "update_interval 50"), ElementsAre(0.12, 0.12, 0.12));
  EXPECT_THAT(speeds("", "paddle_speed 0.25 lift_speed 0.5"), ElementsAre(0.5, 0.25, 0.25));
  EXPECT_THAT(speeds("unit_length \"cm\"", "size [20 30 20] paddle_speed 25 lift_speed 50"),
              ElementsAre(0.5, 0.25, 0.25));
}

TEST(Grippers, BlocksOfTheFileAreTheirBody) {
  const LoadedWorld loaded = LoadGood(
      "position( name \"r\" gripper( name \"g\" size [1 1 1] paddle_size [0.5 0.1 0.4]\n"
      "  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] ) ) )");
  const Shape& body = loaded.world.shape(loaded.world.model(ModelCalled(loaded.world, "r.g")).shape);
  ASSERT_THAT(body.blocks, SizeIs(1));
  EXPECT_THAT(body.blocks[0].outline, SizeIs(3));
  EXPECT_EQ(BoundingBox(body.blocks[0].outline), (Rectangle{-0.5, -0.5, 0.0, 0.5}));
}

TEST(Grippers, OriginMovesThemAsAWhole) {
  const LoadedWorld loaded =
      LoadGood("position( name \"r\" stack_children 0 gripper( name \"g\" origin [0.1 0 0 0] ) )");
  EXPECT_NEAR(PoseOf(loaded.world, "r.g.left_paddle").x, 0.134, 1e-12);
}

TEST(Grippers, UseThePartsThatTheirPropertiesName) {
  const LoadedWorld loaded = LoadGood(
      "define part actuator( size [0.2 0.02 0.1] stack_children 0 max_position 0.1 )\n"
      "position( name \"r\" stack_children 0\n"
      "  gripper( name \"g\" stack_children 0 lift \"up\" left_finger \"up.l\" right_finger \"up.r\" right_pad "
      "\"up.r.pad\"\n"
      "    part( name \"up\" axis [0 0 1] noblocks 1\n"
      "      part( name \"r\" axis [0 1 0] pose [0 -0.2 0 0] model( name \"pad\" size [0.2 0.02 0.1] ) )\n"
      "      part( name \"l\" axis [0 -1 0] pose [0 0.2 0 0] ) ) ) )");
  EXPECT_THAT(loaded.warnings, IsEmpty());
  const WorldDescription& world = loaded.world;
  ASSERT_THAT(world.grippers, SizeIs(1));
  const GripperDescription& gripper = world.grippers[0];
  EXPECT_THAT(JointNames(world), ElementsAre("g.up", "g.up.r", "g.up.l"));
  EXPECT_EQ(world.model(gripper.model).name, "r.g.up");
  EXPECT_EQ(world.joint(gripper.left).name, "g.up.l");
  EXPECT_EQ(world.joint(gripper.right).name, "g.up.r");
  EXPECT_EQ(world.model(gripper.left_pad).name, "r.g.up.l");
  EXPECT_EQ(world.model(gripper.right_pad).name, "r.g.up.r.pad");
  EXPECT_TRUE(world.shape(world.model(ModelCalled(world, "r.g")).shape).blocks.empty());
  ASSERT_THAT(gripper.beams, SizeIs(2));
  EXPECT_NEAR(gripper.beams[0].from.x(), -0.05, 1e-12);
  EXPECT_NEAR(gripper.beams[0].from.y(), 0.19, 1e-12);
  EXPECT_NEAR(gripper.beams[1].to.y(), -0.19, 1e-12);
}

TEST(Grippers, AreWrittenInJsonAlike) {
  const WorldFolder folder;
  folder.Write("s.json", R"({"robots": [{"name": "r", "model": "position", "children": [
    {"model": "gripper", "properties": {"left_finger": "l", "right_finger": "r", "autosnatch": true}, "children": [
      {"name": "l", "model": "actuator", "properties": {"axis": [0, -1, 0], "max_position": 0.1}},
      {"name": "r", "model": "actuator", "properties": {"axis": [0, 1, 0], "max_position": 0.1}}]},
    {"name": "hand", "model": "gripper", "properties": {"paddle_state": ["closed", "down"], "max_height": 2}}]}]})");
  const WorldDescription world = folder.Load("s.json").world;
  EXPECT_TRUE(Validate(world).ok());
  EXPECT_THAT(JointNames(world),
              ElementsAre("gripper:0.l", "gripper:0.r", "hand.lift", "hand.left_paddle", "hand.right_paddle"));
  ASSERT_THAT(world.grippers, SizeIs(2));
  EXPECT_TRUE(world.grippers[0].autosnatch);
  EXPECT_EQ(world.model(world.grippers[0].model).name, "r.gripper:0");
  EXPECT_EQ(world.joint(world.grippers[1].left).start, world.joint(world.grippers[1].left).position.max);
}

TEST(Grippers, HaveALiftThatCarriesThemIfItIsNamed) {
  const LoadedWorld loaded = LoadGood(
      "position( name \"r\" actuator( name \"mast\" axis [0 0 1]\n"
      "  gripper( name \"g\" lift \"mast\" ) ) )");
  EXPECT_THAT(JointNames(loaded.world), ElementsAre("mast", "mast.g.left_paddle", "mast.g.right_paddle"));
  EXPECT_EQ(loaded.world.model(loaded.world.grippers[0].model).name, "r.mast.g");
  EXPECT_EQ(loaded.world.grippers[0].lift, JointId(0));
}

TEST(Grippers, OnNoRobotAreBodies) {
  EXPECT_THAT(WorldFolder().WarningsOf("gripper( autosnatch 1 paddle_size [0.5 0.1 0.3] )"),
              ElementsAre("w.world:1:1: warning: this gripper is on no robot, so it is only a body"));
}

TEST(Grippers, PropertiesWithoutEffectAreNamed) {
  EXPECT_THAT(
      WorldFolder().WarningsOf(
          "define part actuator( axis [0 1 0] )\n"
          "position( gripper( lift_speed 1 vDistanceDivision 9 gripper_return 1 )\n"
          "  gripper( left_finger \"actuator:0\" right_finger \"actuator:1\" paddle_speed 1 max_height 2\n"
          "    part( obstacle_return 0 ) part( axis [0 -1 0] ) ) )\n"),
      ElementsAre("w.world:2:68: warning: property 'gripper_return' has no effect on a robot: none of its parts can be "
                  "gripped",
                  "w.world:2:33: warning: property 'vDistanceDivision' has no effect beside 'lift_speed'",
                  "w.world:3:63: warning: property 'paddle_speed' has no effect in a 'gripper'",
                  "w.world:3:78: warning: property 'max_height' has no effect in a 'gripper'",
                  "w.world:3:3: warning: pad 'position:0.gripper:1.actuator:0' touches nothing, so this gripper never "
                  "grips: its 'obstacle_return' is 0"));
}

TEST(Objects, AreModelsWithGripperReturnThatAreOnNoRobot) {
  const LoadedWorld loaded = LoadGood(
      "define box model( size [0.2 0.2 0.2] gripper_return 1 )\n"
      "box( name \"b0\" )\n"
      "model( name \"wall\" pose [9 0 0 0] )\n"
      "position( name \"r\" pose [3 0 0 0] box( name \"part\" ) )\n"
      "box( name \"b1\" pose [5 0 0 0] )");
  EXPECT_THAT(ObjectNames(loaded.world), ElementsAre("b0", "b1"));
  EXPECT_EQ(loaded.world.model(ModelCalled(loaded.world, "r.part")).parent, ModelCalled(loaded.world, "r"));
}

TEST(Objects, OnStaticModelsArePlacedInTheWorldWithTheirParts) {
  const LoadedWorld loaded = LoadGood(
      "define box model( size [0.2 0.2 0.2] gripper_return 1 model( name \"lid\" size [0.2 0.2 0.01] ) )\n"
      "model( name \"table\" pose [1 2 0 90] size [1 1 0.7]\n"
      "  box( name \"b\" pose [0.3 0 0 0] box( name \"top\" pose [0 0 0.01 0] ) ) )");
  const WorldDescription& world = loaded.world;
  EXPECT_THAT(ObjectNames(world), ElementsAre("table.b", "table.b.top"));
  const ModelDescription& box = world.model(ModelCalled(world, "table.b"));
  EXPECT_FALSE(box.parent);
  EXPECT_NEAR(box.X_PM.x, 1.0, 1e-12);
  EXPECT_NEAR(box.X_PM.y, 2.3, 1e-12);
  EXPECT_NEAR(box.X_PM.z, 0.7, 1e-12);
  EXPECT_EQ(world.model(ModelCalled(world, "table.b.lid")).parent, ModelCalled(world, "table.b"));
  EXPECT_NEAR(PoseOf(world, "table.b.top").z, 0.91, 1e-12);
}

TEST(Objects, MoveWithTheSpawnedModelUnderThem) {
  const WorldFolder folder;
  folder.Write("parts.inc",
               "define table model( size [1 1 0.7] model( name \"box\" size [0.2 0.2 0.2] pose [0.3 0 0 0] "
               "gripper_return 1 ) )\n");
  folder.Write("s.json", R"({"include": ["parts.inc"], "spawn": [{"model": "table", "count": 3, "heading": 0,
                            "region": [0, 0, 4, 4]}]})");
  const WorldDescription world = folder.Load("s.json").world;
  ASSERT_THAT(world.objects, SizeIs(3));
  for (const std::string name : {"table0", "table1", "table2"}) {
    const Pose table = PoseOf(world, name);
    const Pose box = PoseOf(world, name + ".box");
    EXPECT_NEAR(box.x - table.x, 0.3, 1e-9);
    EXPECT_NEAR(box.y, table.y, 1e-9);
    EXPECT_NEAR(box.z, 0.7, 1e-9);
  }
}

TEST(Objects, ThatStartInsideSomethingAreNamed) {
  EXPECT_THAT(WorldFolder().WarningsOf("define box model( size [0.2 0.2 0.2] gripper_return 1 )\n"
                                       "position( pose [9 9 0 0] )\n"
                                       "model( name \"wall\" )\n"
                                       "box( name \"a\" pose [0.2 0 0 0] )\n"
                                       "box( name \"b\" pose [0 0 1 0] )\n"
                                       "box( name \"c\" pose [0 0.1 1 0] )\n"),
              ElementsAre("w.world: warning: object 'a' starts inside 'wall', so a gripper may not move it",
                          "w.world: warning: object 'b' starts inside 'c', so a gripper may not move it",
                          "w.world: warning: object 'c' starts inside 'b', so a gripper may not move it"));
}

TEST(Gravity, IsAPropertyOfTheWorld) {
  EXPECT_EQ(LoadGood("model( )").world.gravity, 9.81);
  EXPECT_EQ(LoadGood("gravity 0").world.gravity, 0.0);
  EXPECT_EQ(LoadGood("gravity 1.62").world.gravity, 1.62);
}

}  // namespace
}  // namespace troupe
