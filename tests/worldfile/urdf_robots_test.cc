// Robots of URDF: footprints, drives, sensors, frames, actuators; and a run with one.
#include <cstdlib>

#include "tests/worldfile/gazebo_files.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string UrdfLink(const std::string& name, const std::string& geometry, const std::string& origin = "0 0 0",
                     const std::string& rpy = "0 0 0") {
  return "<link name=\"" + name + "\"><collision><origin xyz=\"" + origin + "\" rpy=\"" + rpy + "\"/><geometry>" +
         geometry + "</geometry></collision></link>\n";
}

std::string UrdfJoint(const std::string& name, const std::string& type, const std::string& parent,
                      const std::string& child, const std::string& xyz, const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><origin xyz=\"" + xyz + "\"/>" + more + "</joint>\n";
}

// A robot on two wheels and a caster, with a lidar that sees all around, a camera and an IMU.
const std::string kRover =
    "<robot name=\"rover\"><link name=\"base_footprint\"/>\n" +
    UrdfLink("base_link", "<box size=\"0.4 0.3 0.1\"/>", "0 0 0.05") +
    UrdfJoint("base_joint", "fixed", "base_footprint", "base_link", "0 0 0.05") +
    UrdfLink("left", "<cylinder radius=\"0.08\" length=\"0.04\"/>", "0 0 0", "1.57 0 0") +
    UrdfLink("right", "<cylinder radius=\"0.08\" length=\"0.04\"/>", "0 0 0", "1.57 0 0") +
    UrdfJoint("left_joint", "continuous", "base_link", "left", "0 0.17 0.03",
              "<axis xyz=\"0 1 0\"/><limit velocity=\"10\" effort=\"1\"/>") +
    UrdfJoint("right_joint", "continuous", "base_link", "right", "0 -0.17 0.03",
              "<axis xyz=\"0 1 0\"/><limit velocity=\"10\" effort=\"1\"/>") +
    UrdfLink("caster", "<sphere radius=\"0.02\"/>") +
    UrdfJoint("caster_joint", "fixed", "base_link", "caster", "-0.15 0 -0.03") +
    "<link name=\"laser\"/><link name=\"eye\"/><link name=\"eye_optical\"/>\n" +
    UrdfJoint("laser_joint", "fixed", "base_link", "laser", "0.1 0 0.15") +
    UrdfJoint("eye_joint", "fixed", "base_link", "eye", "0.2 0 0.1") +
    "<joint name=\"optical\" type=\"fixed\"><parent link=\"eye\"/><child link=\"eye_optical\"/>"
    "<origin rpy=\"-1.5707963 0 -1.5707963\"/></joint>"
    "<gazebo reference=\"laser\"><sensor name=\"lidar\" "
    "type=\"gpu_lidar\"><topic>scan</topic><update_rate>10</update_rate>"
    "<ray><scan><horizontal><samples>360</samples><min_angle>0</min_angle><max_angle>6.28</max_angle></horizontal></"
    "scan>"
    "<range><min>0.1</min><max>12</max></range><noise><stddev>0.01</stddev></noise></ray></sensor></gazebo>"
    "<gazebo reference=\"eye\"><sensor name=\"cam\" type=\"depth\"><topic>front/image_raw</topic><camera>"
    "<horizontal_fov>1.0</horizontal_fov><image><width>64</width><height>48</height></image>"
    "<clip><near>0.1</near><far>5</far></clip></camera></sensor>"
    "<sensor name=\"gps\" type=\"navsat\"/></gazebo>"
    "<gazebo reference=\"base_link\"><sensor name=\"imu\" type=\"imu\"/></gazebo></robot>";

class UrdfRobots : public testing::Test {
 protected:
  LoadedWorld Load(const std::string& urdf) {
    folder_.Write("r.urdf", urdf);
    return folder_.Load("r.urdf");
  }
  std::string ErrorOf(const std::string& urdf) {
    folder_.Write("r.urdf", urdf);
    return folder_.ErrorOf("r.urdf");
  }

  WorldFolder folder_;
};

TEST_F(UrdfRobots, HasItsSizeDriveAndSensors) {
  const LoadedWorld loaded = Load(kRover);
  ASSERT_THAT(loaded.world.robots, SizeIs(1));
  const RobotDescription& robot = loaded.world.robots[0];
  EXPECT_EQ(robot.name, "rover");
  ExpectExtent(ExtentOf(loaded.world, "rover"), {-0.2, -0.19, 0.2, 0.19}, {0, 0.16}, 0.002);
  EXPECT_EQ(robot.drive.type, DriveType::kDifferential);
  EXPECT_NEAR(robot.drive.velocity.x.max, 0.8, 0.01);  // 10 rad/s of wheels of 0.08 m
  ASSERT_THAT(robot.sensors, SizeIs(3));
  // In the order of the links.
  EXPECT_EQ(robot.sensors[0].name, "imu");
  EXPECT_EQ(robot.sensors[1].name, "scan");
  EXPECT_EQ(robot.sensors[1].frame, "laser");
  const auto& ranger = std::get<RangerParameters>(robot.sensors[1].parameters);
  EXPECT_EQ((*ranger.ray_sensors)[0].samples, 360U);
  EXPECT_NEAR((*ranger.ray_sensors)[0].noise_variance, 1e-4, 1e-12);
  EXPECT_EQ(robot.sensors[2].name, "front");
  EXPECT_EQ(std::get<CameraParameters>(robot.sensors[2].parameters).width, 64U);
  // The lying wheels are bands of heights.
  ASSERT_THAT(loaded.warnings, SizeIs(2));
  EXPECT_THAT(loaded.warnings[0].message, HasSubstr("a shape that is not upright in 'rover'"));
  EXPECT_THAT(loaded.warnings[1].message, HasSubstr("a sensor of type 'navsat' is left out"));
}

TEST_F(UrdfRobots, KeepsTheFramesOfItsLinks) {
  const RobotDescription robot = Load(kRover).world.robots[0];
  std::vector<std::string> names;
  for (const MountedFrame& frame : robot.frames) names.push_back(frame.name);
  EXPECT_THAT(names,
              ElementsAre("base_footprint", "base_link", "left", "right", "caster", "laser", "eye", "eye_optical"));
  EXPECT_EQ(robot.frames[0].X_MF, Pose());
  EXPECT_NEAR(robot.frames[1].X_MF.z, 0.05, 1e-9);
  EXPECT_NEAR(robot.frames[5].X_MF.x, 0.1, 1e-9);
  EXPECT_NEAR(robot.frames[5].X_MF.z, 0.2, 1e-9);
  EXPECT_NEAR(robot.frames[7].roll, -1.5707963, 1e-6);
  EXPECT_NEAR(robot.frames[7].X_MF.heading, -1.5707963, 1e-6);
}

// Of a robot whose root is not on the floor, the base is below it.
TEST_F(UrdfRobots, StandsOnItsLowestCollision) {
  const LoadedWorld loaded =
      Load("<robot name=\"r\">" + UrdfLink("base_link", "<box size=\"0.4 0.4 0.2\"/>") + "</robot>");
  ExpectExtent(ExtentOf(loaded.world, "r"), {-0.2, -0.2, 0.2, 0.2}, {0, 0.2});
  const RobotDescription& robot = loaded.world.robots[0];
  EXPECT_EQ(robot.frames[0].name, "base_footprint");
  EXPECT_EQ(robot.frames[1].name, "base_link");
  EXPECT_NEAR(robot.frames[1].X_MF.z, 0.1, 1e-9);
  ASSERT_THAT(loaded.warnings, SizeIs(1));
  EXPECT_THAT(loaded.warnings[0].message, HasSubstr("found no wheels and no drive plugin"));
}

TEST_F(UrdfRobots, SteeredWheelsMakeACarAndMecanumOnesAHolonomicDrive) {
  std::string car = "<robot name=\"car\">" + UrdfLink("base", "<box size=\"1 0.5 0.2\"/>", "0 0 0.2");
  for (const char* side : {"l", "r"}) {
    const std::string s = side;
    const std::string y = s == "l" ? " 0.25 0.1" : " -0.25 0.1";
    car += "<link name=\"knuckle_" + s + "\"/>" +
           UrdfJoint("steer_" + s, "revolute", "base", "knuckle_" + s, "0.35" + y,
                     "<axis xyz=\"0 0 1\"/><limit lower=\"-0.5\" upper=\"0.5\"/>") +
           UrdfLink("front_" + s, "<sphere radius=\"0.1\"/>") +
           UrdfJoint("roll_" + s, "continuous", "knuckle_" + s, "front_" + s, "0 0 0", "<axis xyz=\"0 1 0\"/>") +
           UrdfLink("back_" + s, "<sphere radius=\"0.1\"/>") +
           UrdfJoint("drive_" + s, "continuous", "base", "back_" + s, "-0.3" + y, "<axis xyz=\"0 1 0\"/>");
  }
  const DriveDescription drive = Load(car + "</robot>").world.robots[0].drive;
  EXPECT_EQ(drive.type, DriveType::kCar);
  EXPECT_NEAR(drive.wheelbase, 0.65, 1e-9);
  EXPECT_NEAR(drive.velocity.heading.max, 0.5, 1e-9);

  std::string omni = "<robot name=\"omni\">" + UrdfLink("base", "<box size=\"1 0.5 0.2\"/>", "0 0 0.2");
  for (const char* name : {"mecanum_a", "mecanum_b", "mecanum_c", "mecanum_d"}) {
    omni += UrdfLink(name, "<sphere radius=\"0.1\"/>") +
            UrdfJoint(std::string(name) + "_joint", "continuous", "base", name, "0.3 0.2 0.1", "<axis xyz=\"0 1 0\"/>");
  }
  EXPECT_EQ(Load(omni + "</robot>").world.robots[0].drive.type, DriveType::kOmni);
}

TEST_F(UrdfRobots, PrismaticJointsAreActuatorsThatCarryTheirLinks) {
  const LoadedWorld loaded =
      Load("<robot name=\"lifter\">" + UrdfLink("base", "<box size=\"0.6 0.4 0.2\"/>", "0 0 0.1") +
           UrdfLink("fork", "<box size=\"0.4 0.3 0.02\"/>") +
           UrdfJoint("mast", "prismatic", "base", "fork", "0.5 0 0.05",
                     "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1.2\" velocity=\"0.3\"/>") +
           "<link name=\"tip\"/>" + UrdfJoint("tip_joint", "fixed", "fork", "tip", "0.2 0 0.01") + "</robot>");
  ASSERT_THAT(loaded.world.joints, SizeIs(1));
  const JointDescription& joint = loaded.world.joints[0];
  EXPECT_EQ(joint.name, "mast");
  EXPECT_EQ(joint.axis_z, 1.0);
  EXPECT_EQ(joint.position.max, 1.2);
  EXPECT_EQ(joint.max_speed, 0.3);
  const ModelDescription& mast = loaded.world.model(joint.model);
  EXPECT_EQ(mast.X_PM, (Pose{0.5, 0, 0.05, 0}));
  const RobotDescription& robot = loaded.world.robots[0];
  ASSERT_THAT(robot.frames, SizeIs(3));
  EXPECT_EQ(robot.frames[2].name, "tip");
  EXPECT_EQ(robot.frames[2].model, joint.model);
  EXPECT_NEAR(robot.frames[2].X_MF.x, 0.2, 1e-9);
}

// A mast that carries a palm with two fingers.
std::string Picker(const std::string& left, const std::string& right) {
  return "<robot name=\"picker\">" + UrdfLink("base", "<box size=\"0.4 0.3 0.1\"/>", "0 0 0.05") +
         UrdfLink("palm", "<box size=\"0.04 0.3 0.1\"/>") +
         UrdfJoint("mast", "prismatic", "base", "palm", "0.22 0 0.06",
                   "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"0.6\" velocity=\"0.3\"/>") +
         UrdfLink("a", "<box size=\"0.2 0.02 0.08\"/>", "0.12 0.01 0") +
         UrdfLink("b", "<box size=\"0.2 0.02 0.08\"/>", "0.12 -0.01 0") +
         UrdfJoint("a_joint", "prismatic", "palm", "a", "0 0 0", left) +
         UrdfJoint("b_joint", "prismatic", "palm", "b", "0 0 0", right) + "</robot>";
}

constexpr const char* kFingerTravel = "<limit lower=\"0\" upper=\"0.1\" velocity=\"0.05\"/>";

// Files count fingers either way; those of Troupe close upwards, and start where the file's position is 0.
TEST_F(UrdfRobots, OpposedPrismaticJointsAreAGripperWithItsLift) {
  const std::string apart = kFingerTravel;
  const std::string together = "<limit lower=\"-0.1\" upper=\"0\" velocity=\"0.05\"/>";
  const struct {
    std::string left, right;
  } ways[] = {
      {"<axis xyz=\"0 1 0\"/>" + apart, "<axis xyz=\"0 -1 0\"/>" + apart},
      {"<axis xyz=\"0 -1 0\"/>" + together, "<axis xyz=\"0 1 0\"/>" + together},
      {"<axis xyz=\"0 1 0\"/>" + apart, "<axis xyz=\"0 1 0\"/>" + together},
      {"<axis xyz=\"0 1 0\"/>" + apart, "<axis xyz=\"0 -1 0\"/>" + apart + "<mimic joint=\"a_joint\"/>"},
      {"<axis xyz=\"0 1 0\"/>" + apart,
       "<axis xyz=\"0 1 0\"/><limit velocity=\"0.05\"/><mimic joint=\"a_joint\" multiplier=\"-1\"/>"},
  };
  for (const auto& way : ways) {
    const WorldDescription world = Load(Picker(way.left, way.right)).world;
    ASSERT_THAT(world.grippers, SizeIs(1)) << way.left << way.right;
    const GripperDescription& gripper = world.grippers[0];
    EXPECT_EQ(gripper.name, "mast.gripper");
    ASSERT_TRUE(gripper.lift);
    EXPECT_EQ(world.joint(*gripper.lift).name, "mast");
    const JointDescription& left = world.joint(gripper.left);
    const JointDescription& right = world.joint(gripper.right);
    EXPECT_EQ(left.name, "mast.gripper.a_joint");
    EXPECT_EQ(right.name, "mast.gripper.b_joint");
    EXPECT_NEAR(left.axis_xy.y(), -1.0, 1e-12);  // it closes to the right
    EXPECT_NEAR(right.axis_xy.y(), 1.0, 1e-12);
    for (const JointDescription* const finger : {&left, &right}) {
      EXPECT_NEAR(finger->position.max - finger->position.min, 0.1, 1e-12);
      EXPECT_NEAR(finger->start, finger->position.max, 1e-12);  // closed, as at 0 in the file
      EXPECT_EQ(finger->max_speed, 0.05);
    }
    const RobotDescription& robot = world.robots[0];
    EXPECT_EQ(robot.frames.back().name, "b");
    EXPECT_EQ(robot.frames.back().model, right.model);
  }
}

TEST_F(UrdfRobots, JointsThatDoNotFaceEachOtherAreNoGripper) {
  const std::string apart = kFingerTravel;
  // In one direction, each with its own body behind the other's height; and across each other.
  EXPECT_THAT(Load(Picker("<axis xyz=\"0 1 0\"/>" + apart, "<axis xyz=\"1 0 0\"/>" + apart)).world.grippers, IsEmpty());
  EXPECT_THAT(Load(Picker("<axis xyz=\"0 0 1\"/>" + apart, "<axis xyz=\"0 0 -1\"/>" + apart)).world.grippers,
              IsEmpty());
  const WorldDescription world =
      Load("<robot name=\"r\">" + UrdfLink("base", "<box size=\"0.4 0.3 0.1\"/>", "0 0 0.05") +
           UrdfLink("low", "<box size=\"0.2 0.1 0.04\"/>", "0 0.1 0.1") +
           UrdfLink("high", "<box size=\"0.2 0.1 0.04\"/>", "0 -0.1 0.3") +
           UrdfJoint("l", "prismatic", "base", "low", "0 0 0", "<axis xyz=\"0 1 0\"/>" + apart) +
           UrdfJoint("h", "prismatic", "base", "high", "0 0 0", "<axis xyz=\"0 -1 0\"/>" + apart) + "</robot>")
          .world;
  EXPECT_THAT(world.grippers, IsEmpty());
  EXPECT_THAT(world.joints, SizeIs(2));
}

// Exporters write no limit as a large one.
TEST_F(UrdfRobots, MayHaveLimitsThatAreNone) {
  const WorldDescription world =
      Load("<robot name=\"r\">" + UrdfLink("base", "<box size=\"0.4 0.3 0.1\"/>", "0 0 0.05") + "<link name=\"arm\"/>" +
           UrdfJoint("j", "revolute", "base", "arm", "0 0 0.1",
                     "<limit lower=\"-1e+16\" upper=\"1e+16\" velocity=\"1e16\"/>") +
           "</robot>")
          .world;
  EXPECT_THAT(world.joints, IsEmpty());
  EXPECT_EQ(world.robots[0].frames.back().name, "arm");
}

TEST_F(UrdfRobots, TheirGripperCarriesABoxOntoAShelf) {
  Simulation simulation =
      Simulation::Load(std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/gazebo/picking.json").value();
  simulation.Step(900);
  const WorldDescription& world = simulation.world();
  const WorldState& state = simulation.state();
  std::size_t boxes = 0;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.model(world.objects[i]).name != "box") continue;
    ++boxes;
    EXPECT_NEAR(state.objects[i].X_WO.z, 0.45, 1e-9);
    EXPECT_NEAR(state.objects[i].X_WO.x, 2.85, 0.01);
    EXPECT_NEAR(state.objects[i].X_WO.y, 0.0, 0.01);
  }
  EXPECT_EQ(boxes, 1U);
}

struct BadUrdf {
  std::string text;
  std::string message;
};

const BadUrdf kBadUrdfs[] = {
    {"<robot name=\"r\"/>", "r.urdf:1:1: error: found a robot without links, expected one"},
    {"<robot><link name=\"a\"/>\n<link name=\"a\"/></robot>",
     "r.urdf:2:1: error: found the link 'a' again, expected another name"},
    {"<robot><link name=\"a\"/>\n<link name=\"b\"/></robot>",
     "r.urdf:2:1: error: found link 'b' without a joint above it beside 'a', expected one root"},
    {"<robot><link name=\"a\"/>\n" + UrdfJoint("j", "fixed", "a", "b", "0 0 0") + "</robot>",
     "r.urdf:2:1: error: found the link 'b' in joint 'j', expected a link of the robot"},
    {"<robot><link name=\"a\"/><link name=\"b\"/>\n" + UrdfJoint("j", "fixed", "a", "b", "0 0 0") +
         UrdfJoint("k", "fixed", "b", "a", "0 0 0") + "</robot>",
     "r.urdf:1:1: error: found joints that go in a circle, expected a root link"},
    {"<robot><link name=\"a\"/>\n<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/></joint></robot>",
     "r.urdf:2:1: error: found a joint without a 'child', expected the name of a link"},
    {"<robot>" + UrdfLink("a", "<box size=\"1 x 1\"/>") + "</robot>",
     "r.urdf:1:82: error: found 'x' in 'size', expected a number"},
    {"<robot>" + UrdfLink("a", "<mesh filename=\"package://robot/a.stl\"/>") + "</robot>", "found no file for"},
};

TEST_F(UrdfRobots, RefusesWhatIsNoRobot) {
  for (const BadUrdf& bad : kBadUrdfs) EXPECT_THAT(ErrorOf(bad.text), HasSubstr(bad.message));
}

// A robot of macros: arguments, properties, a macro with a block, a condition and an include.
const std::string kMacros =
    "<robot name=\"$(arg name)\"><xacro:arg name=\"name\" default=\"mac\"/><xacro:arg name=\"laser\" "
    "default=\"true\"/>\n"
    "<xacro:include filename=\"parts.xacro\"/><xacro:property name=\"wide\" value=\"${2 * reach}\"/>\n"
    "<xacro:property name=\"reach\" value=\"0.17\"/>\n"
    "<link name=\"base\"><collision><geometry><box size=\"0.4 ${wide - 0.04} 0.1\"/></geometry></collision></link>\n"
    "<xacro:wheel name=\"left\" side=\"1\"><origin xyz=\"0 ${reach} 0\"/></xacro:wheel>\n"
    "<xacro:wheel name=\"right\" side=\"-1\" radius=\"${0.04 + 0.04}\"><origin xyz=\"0 ${-reach} 0\"/></xacro:wheel>\n"
    "<xacro:if value=\"${'$(arg laser)' == 'true'}\"><link name=\"laser\"/><joint name=\"l\" type=\"fixed\"><parent "
    "link=\"base\"/>"
    "<child link=\"laser\"/><origin xyz=\"${sin(radians(30))} 0 ${0.1 if wide > 0.3 else 0}\"/></joint></xacro:if>\n"
    "<xacro:unless value=\"${reach == 0.17}\"><link name=\"none\"/></xacro:unless></robot>";
const std::string kParts =
    "<robot><xacro:macro name=\"wheel\" params=\"name side radius:=0.08 *origin\">\n"
    "<link name=\"${name}\"><collision><origin rpy=\"${pi/2} 0 0\"/><geometry><cylinder radius=\"${radius}\" "
    "length=\"0.04\"/>"
    "</geometry></collision></link>\n<joint name=\"${name}_joint\" type=\"continuous\"><parent link=\"base\"/>"
    "<child link=\"${name}\"/><xacro:insert_block name=\"origin\"/><axis xyz=\"0 ${side} "
    "0\"/></joint></xacro:macro></robot>";

// Names of xacro: macros see those of their callers, `scope` sets one of the caller, a property keeps the value of its
// first use, and includes with `ns` have names of their own.
TEST_F(UrdfRobots, NamesOfMacrosHaveScopes) {
  folder_.Write("own.xacro",
                "<robot><xacro:property name=\"size\" value=\"0.5\"/>"
                "<xacro:macro name=\"inner\" params=\"\"><box size=\"${size} ${size} ${size}\"/></xacro:macro>"
                "<xacro:macro name=\"part\" params=\"name\"><link name=\"${name}\"><collision><geometry><xacro:inner/>"
                "</geometry></collision></link></xacro:macro></robot>");
  folder_.Write("r.xacro",
                "<robot name=\"r\"><xacro:include filename=\"own.xacro\" ns=\"own\"/>\n"
                "<xacro:property name=\"size\" value=\"9\"/>\n"
                "<xacro:own.part name=\"base\"/>\n"  // 0.5
                "<xacro:macro name=\"set\" params=\"to name\">"
                "<xacro:property name=\"${name}\" value=\"${to}\" scope=\"parent\"/></xacro:macro>\n"
                "<xacro:macro name=\"leg\" params=\"\"><link name=\"leg\"><collision><geometry>"
                "<box size=\"${length} ${twice} ${own.size / 5}\"/></geometry></collision></link></xacro:macro>\n"
                "<xacro:macro name=\"legs\" params=\"\"><xacro:property name=\"length\" value=\"0.2\"/>"
                "<xacro:property name=\"twice\" value=\"${2 * length}\"/>"
                "<xacro:if value=\"${twice == 0.4}\"><xacro:set to=\"0.3\" name=\"length\"/></xacro:if><xacro:leg/>"
                "</xacro:macro>\n<xacro:legs/>\n"
                "<xacro:property name=\"gone\" value=\"1\"/><xacro:property name=\"gone\" remove=\"true\"/>"
                "<xacro:property name=\"gone\" default=\"0.75\"/>"
                "<joint name=\"j\" type=\"fixed\"><parent link=\"base\"/><child link=\"leg\"/>"
                "<origin xyz=\"${gone} 0 0.2\"/></joint></robot>");
  const std::string before = std::getenv("PATH");
  setenv("PATH", folder_.Path("none").c_str(), 1);
  const LoadedWorld loaded = folder_.Load("r.xacro");
  setenv("PATH", before.c_str(), 1);
  ASSERT_THAT(loaded.world.robots, SizeIs(1));
  // The base of 0.5 m, and a leg of 0.3 x 0.4 x 0.1 m that begins 0.1 m higher than its middle.
  ExpectExtent(ExtentOf(loaded.world, "r"), {-0.25, -0.25, 0.9, 0.25}, {0, 0.5}, 0.002);
}

TEST_F(UrdfRobots, MacrosAreAppliedWithoutTheProgram) {
  folder_.Write("parts.xacro", kParts);
  folder_.Write("r.xacro", kMacros);
  const std::string before = std::getenv("PATH");
  setenv("PATH", folder_.Path("none").c_str(), 1);
  const LoadedWorld loaded = folder_.Load("r.xacro");
  ASSERT_THAT(loaded.world.robots, SizeIs(1));
  const RobotDescription& robot = loaded.world.robots[0];
  EXPECT_EQ(robot.name, "mac");
  EXPECT_EQ(robot.drive.type, DriveType::kDifferential);
  ExpectExtent(ExtentOf(loaded.world, "mac"), {-0.2, -0.19, 0.2, 0.19}, {0, 0.16}, 0.002);
  ASSERT_THAT(robot.frames, SizeIs(5));
  EXPECT_EQ(robot.frames[4].name, "laser");
  EXPECT_NEAR(robot.frames[4].X_MF.x, 0.5, 1e-9);
  EXPECT_NEAR(robot.frames[4].X_MF.z, 0.18, 1e-3);
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"<xacro:other/>", "r.xacro:2:1: error: found 'xacro:other', expected a macro of the file"},
           {"<link name=\"${1 / 0}\"/>", "r.xacro:2:1: error: found a division by 0 in ${1 / 0}"},
           {"<link name=\"${a.b}\"/>", "found the name 'a.b', expected a property or an argument"},
           {"<link name=\"${load_yaml('x')}\"/>", "found a call of 'load_yaml', which only the program 'xacro' knows"},
           {"<xacro:property name=\"a\" value=\"${b}\"/><xacro:property name=\"b\" value=\"${a}\"/><link "
            "name=\"${a}\"/>",
            "found properties that refer to each other"},
           {"<xacro:macro name=\"m\" params=\"\"><xacro:m/></xacro:macro><xacro:m/>",
            "found macros or includes too deep inside each other"},
           {"<xacro:macro name=\"m\" params=\"a\"/><xacro:m/>", "found no value for 'a', expected the attribute"}}) {
    folder_.Write("r.xacro", "<robot><xacro:arg name=\"x\" default=\"1\"/>\n" + text + "</robot>");
    EXPECT_THAT(folder_.ErrorOf("r.xacro"), HasSubstr(message));
  }
  // Properties that double: an error in bounded time.
  std::string doubling = "<robot><xacro:property name=\"p0\" value=\"xx\"/>";
  for (int i = 1; i < 50; ++i) {
    const std::string last = "${p" + std::to_string(i - 1) + "}";
    doubling += "<xacro:property name=\"p" + std::to_string(i) + "\" value=\"" + last + last + "\"/>";
  }
  folder_.Write("r.xacro", doubling + "<link name=\"${p49}\"/></robot>");
  EXPECT_THAT(folder_.ErrorOf("r.xacro"), HasSubstr("expected"));
  setenv("PATH", before.c_str(), 1);
}

TEST_F(UrdfRobots, XacroIsExpandedByTheProgramIfItIsInstalled) {
  folder_.Write("r.xacro", kMacros);
  const std::string before = std::getenv("PATH");
  const std::string program = folder_.Write("bin/xacro", "#!/bin/sh\ncat \"${1%.xacro}.expanded\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  setenv("PATH", (folder_.Path("bin") + ":" + before).c_str(), 1);
  EXPECT_THAT(folder_.ErrorOf("r.xacro"), HasSubstr("'xacro' failed, expected URDF: 'cat:"));
  folder_.Write("r.expanded", kRover);
  EXPECT_THAT(folder_.Load("r.xacro").world.robots, SizeIs(1));
  // Not for a stranger, whose file may name any other.
  LoadOverrides overrides;
  overrides.allowed = AllowedPaths();
  overrides.allowed.Add(folder_.path());
  folder_.Write("parts.xacro", kParts);
  const Result<LoadedWorld> own = LoadWorld(folder_.Path("r.xacro"), overrides);
  ASSERT_TRUE(own.ok()) << own.error().ToString();
  EXPECT_EQ(own.value().world.robots[0].name, "mac");
  setenv("PATH", before.c_str(), 1);
}

TEST_F(UrdfRobots, OptionsAndScenariosAddThem) {
  folder_.Write("robots/rover.urdf", kRover);
  folder_.Write("w.sdf", SdfWorldText(SdfModelText("wall", "2 0 0.5 0 0 0", SdfBox("0.2 4 1"))));
  LoadOverrides overrides;
  overrides.robots = {folder_.Path("robots/rover.urdf"), folder_.Path("robots/rover.urdf") + "@-2,1,90"};
  const LoadedWorld added = folder_.Load("w.sdf", overrides);
  ASSERT_THAT(added.world.robots, SizeIs(2));
  EXPECT_EQ(added.world.robots[1].name, "rover:2");
  EXPECT_NEAR(added.world.model(added.world.robots[1].root).X_PM.x, -2.0, 1e-12);
  folder_.Write("s.json",
                R"({"world": "w.sdf", "robots": [{"model": "robots/rover.urdf", "name": "a", "pose": [-1, 0, 0]}],
    "spawn": [{"model": "robots/rover.urdf", "count": 3, "region": [-9, -9, -3, 9], "spacing": 1}]})");
  const LoadedWorld loaded = folder_.Load("s.json", overrides);
  std::vector<std::string> names;
  for (const RobotDescription& robot : loaded.world.robots) names.push_back(robot.name);
  EXPECT_THAT(names, ElementsAre("rover", "rover:2", "a", "rover0", "rover1", "rover2"));
  overrides.robots = {folder_.Path("robots/rover.urdf") + "@1"};
  const Result<LoadedWorld> refused = LoadWorld(folder_.Path("w.sdf"), overrides);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("expected X,Y or X,Y,HEADING"));
}

TEST_F(UrdfRobots, DriveInAWorldOfSdfAndMeasureIt) {
  folder_.Write("rover.urdf", kRover);
  folder_.Write("w.sdf", SdfWorldText(SdfModelText("wall", "2 0 0.5 0 0 0", SdfBox("0.2 4 1"))));
  const std::string scenario =
      folder_.Write("s.json", R"({"world": "w.sdf", "robots": [{"model": "rover.urdf", "name": "a"}]})");
  Result<Simulation> made = Simulation::Load(scenario);
  ASSERT_TRUE(made.ok()) << made.error().ToString();
  Simulation& simulation = made.value();
  const RobotId robot = *simulation.FindRobot("a");
  // The lidar is 0.1 m ahead, the wall's face at 1.9 m. The middle ray of 360 is half a step beside the axis.
  const auto reading = simulation.Measure(robot, 1);
  const RangerReading* const ranges = reading.As<RangerReading>();
  ASSERT_NE(ranges, nullptr);
  EXPECT_NEAR(ranges->scan(0).ranges[180], 1.8, 0.05);
}

}  // namespace
}  // namespace troupe
