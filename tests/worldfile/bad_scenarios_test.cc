// Scenarios that must be refused, each with its whole message.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

struct BadScenario {
  const char* name;
  std::string text;
  std::string message;  // behind the scenario's path, and without "error: "
};

// JSON, written with ' in place of ".
std::string Quoted(std::string text) {
  std::replace(text.begin(), text.end(), '\'', '"');
  return text;
}

// The office contains walls, table0.., chair0.., ..., and the defines of worlds/include.
std::string InOffice(const std::string& rest) {
  return Quoted("{'world': '../office.world',\n" + rest + "}");
}

// A world with one robot, without other files.
std::string Alone(const std::string& rest) {
  return Quoted("{'models': [{'model': 'position', 'name': 'r0'}],\n" + rest + "}");
}

std::string Nested(int depth) {
  std::string text = "{\"models\": [";
  for (int i = 0; i < depth; ++i) text += "{\"model\": \"model\", \"children\": [";
  for (int i = 0; i < depth; ++i) text += "]}";
  return text + "]}";
}

// Not JSON.
const BadScenario kNotJson[] = {
    {"Empty", "",
     ":1:1: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', '{', or a "
     "literal"},
    {"OnlyBlanks", " \n\n ",
     ":3:2: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', '{', or a "
     "literal"},
    {"NoQuotes", "{world: 1}",
     ":1:2: not valid JSON: syntax error while parsing object key - invalid literal; expected string literal"},
    {"TrailingComma", Quoted("{\n  'seed': 1,\n}"),
     ":3:1: not valid JSON: syntax error while parsing object key - unexpected '}'; expected string literal"},
    {"Comment", "{\n  // a comment\n}",
     ":2:3: not valid JSON: syntax error while parsing object key - invalid literal; expected string literal"},
    {"MissingComma", Quoted("{'seed': 1\n 'ticks': 2}"),
     ":2:2: not valid JSON: syntax error while parsing object - unexpected string literal; expected '}'"},
    {"NotClosed", Quoted("{'robots': [{'name': 'a'}"),
     ":1:26: not valid JSON: syntax error while parsing array - unexpected end of input; expected ']'"},
    {"TextBehindTheEnd", "{}\n{}",
     ":2:1: not valid JSON: syntax error while parsing value - unexpected '{'; expected end of input"},
    {"NotANumber", Quoted("{'seed': NaN}"),
     ":1:10: not valid JSON: syntax error while parsing value - invalid literal"},
    {"NumberTooLarge", Quoted("{'agent_deadline':\n  1e999}"),
     ":2:3: found a number that is too large, expected at most 1.8e308"},
    {"NotUtf8", "{\"name\": \"caf\xe9\"}",
     ":1:14: not valid JSON: syntax error while parsing value - invalid string: ill-formed UTF-8 byte"},
    {"KeyTwice", Quoted("{'seed': 1,\n 'ticks': 5, 'seed': 2}"), ":2:14: found the key 'seed' again, expected it once"},
    {"KeyTwiceInside", Quoted("{'robots': [{'name': 'a', 'pose': [0, 0, 0],\n 'name': 'b'}]}"),
     ":2:2: found the key 'name' again, expected it once"},
    {"TooDeep", Nested(40), ":1:1005: found deeper nesting, expected at most 64 objects and arrays inside each other"},
    {"DeepNonsense", std::string(1'000'000, '{'),
     ":1:2: not valid JSON: syntax error while parsing object key - unexpected '{'; expected string literal"},
    {"DeepArrays", std::string(1'000'000, '['),
     ":1:65: found deeper nesting, expected at most 64 objects and arrays inside each other"},
};

// Not after the schema.
const BadScenario kAgainstTheSchema[] = {
    {"NoObject", "[1, 2]", ":1:1: found an array of 2, expected an object with the keys of a scenario"},
    {"UnknownKey", Quoted("{'wolrd': 'office.world'}"),
     ":1:2: found the key 'wolrd', expected one of $schema, agent_deadline, controller, cover, design, events, expect, "
     "flows, heat, hosts, "
     "include, metrics, mode, models, name, network, on_agent_loss, override, people, places, properties, "
     "recorded_people, "
     "regions, restart_agents, robots, robots_per_process, ros, ros_lockstep, ros_no_hit, scenario, seed, spawn, "
     "speed, ticks, "
     "vary, where, without, world, zones; did you mean 'world'?"},
    {"UnknownKeyOfARobot", Alone("'robots': [{'name': 'r0',\n  'position': [0, 0, 0]}]"),
     ":3:3: found the key 'position', expected one of children, controller, model, name, pose, properties, ros_domain, "
     "ros_lockstep"},
    {"UnknownKeyOfAController", Alone("'controller': {'name': 'idle', 'speed': 1}"),
     ":2:32: found the key 'speed', expected one of name, parameters"},
    {"HostWithoutAddress", Alone("'hosts': [{'name': 'h1'}]"),
     ":2:11: found no 'address' in this object, expected an IPv4 address or the name of a host"},
    {"StartOfAHostWithoutCommand", Alone("'hosts': [{'address': 'h1', 'start': 'ssh h1'}]"),
     ":2:38: found no '{command}' in this text, expected one, or '{command_text}'"},
    {"TwoHostsOfOneName", Alone("'hosts': ['h1', {'address': '10.0.0.1', 'name': 'h1'}]"),
     ":2:17: found a second host 'h1', expected another name"},
    {"TwoHostsWithTheService",
     Alone("'hosts': [{'address': 'a', 'service': true},\n  {'address': 'b', 'service': true}]"),
     ":3:31: found a second host with the world service, expected it on one host"},
    {"WorldIsNumber", Quoted("{'world': 7}"),
     ":1:11: found the number 7, expected the path of a .world or .yaml file, from the scenario's folder"},
    {"WorldIsEmpty", Quoted("{'world': ''}"),
     ":1:11: found the string '', expected the path of a .world or .yaml file, from the scenario's folder"},
    {"SeedIsNegative", Alone("'seed': -1"),
     ":2:9: found the number -1, expected an integer from 0 to 9223372036854775807"},
    {"SeedIsFraction", Alone("'seed': 1.5"),
     ":2:9: found the number 1.5, expected an integer from 0 to 9223372036854775807"},
    {"SeedIsText", Alone("'seed': '1'"),
     ":2:9: found the string '1', expected an integer from 0 to 9223372036854775807"},
    {"SeedIsBeyond64Bits", Alone("'seed': 18446744073709551616"),
     ":2:9: found the number 1.8446744073709552e+19, expected an integer from 0 to 9223372036854775807"},
    {"TicksAreZero", Alone("'ticks': 0"),
     ":2:10: found the number 0, expected a number of ticks, an integer of at least 1"},
    {"TicksAreNull", Alone("'ticks': null"), ":2:10: found null, expected a number of ticks, an integer of at least 1"},
    {"UnknownMode", Alone("'mode': 'real-time'"),
     ":2:9: found the string 'real-time', expected 'lockstep' or 'realtime'"},
    {"SpeedIsZero", Alone("'speed': 0"),
     ":2:10: found the number 0, expected a multiple of real time above 0, or 'max'"},
    {"SpeedIsAnotherWord", Alone("'speed': 'fas'"),
     ":2:10: found the string 'fas', expected a multiple of real time above 0, or 'max'"},
    {"SpeedIsLongWord", Alone("'speed': 'maximum'"),
     ":2:10: found the string 'maximum', expected a multiple of real time above 0, or 'max'"},
    {"UnknownLossPolicy", Alone("'on_agent_loss': 'restart'"),
     ":2:18: found the string 'restart', expected 'freeze', 'pause', 'abort' or 'rebuild'"},
    {"NoRobotsPerProcess", Alone("'robots_per_process': 0"),
     ":2:23: found the number 0, expected an integer of at least 1"},
    {"RestartsAreNegative", Alone("'restart_agents': -1"),
     ":2:19: found the number -1, expected an integer from 0 to 1000000"},
    {"DeadlineIsNegative", Alone("'agent_deadline': -0.5"),
     ":2:19: found the number -0.5, expected a number of seconds above 0"},
    {"ControllerIsNumber", Alone("'controller': 3"),
     ":2:15: found the number 3, expected the name of a controller, or an object with 'name' and 'parameters'"},
    {"ControllerWithoutName", Alone("'controller': {'parameters': {}}"),
     ":2:15: found no 'name' in this object, expected the name of a controller"},
    {"ParametersAreAList", Alone("'controller': {'name': 'idle', 'parameters': [1]}"),
     ":2:46: found an array of 1, expected an object of the controller's parameters"},
    {"PoseIsText", Alone("'robots': [{'name': 'r0', 'pose': 'left'}]"),
     ":2:35: found the string 'left', expected [x, y, heading] or [x, y, z, heading], in metres and degrees"},
    {"PoseTooShort", Alone("'robots': [{'name': 'r0', 'pose': [1, 2]}]"),
     ":2:35: found an array of 2, expected [x, y, heading] or [x, y, z, heading], in metres and degrees"},
    {"PoseTooLong", Alone("'robots': [{'name': 'r0', 'pose': [1, 2, 3, 4, 5]}]"),
     ":2:35: found an array of 5, expected [x, y, heading] or [x, y, z, heading], in metres and degrees"},
    {"PoseHoldsText", Alone("'robots': [{'name': 'r0',\n 'pose': [1, '2', 3]}]"),
     ":3:14: found the string '2', expected a number from -1e6 to 1e6"},
    {"PoseFarAway", Alone("'robots': [{'name': 'r0', 'pose': [1e300, 2, 3]}]"),
     ":2:36: found the number 1e+300, expected a number from -1e6 to 1e6"},
    {"NameIsEmpty", Quoted("{'models': [{'model': 'model', 'name': ''}]}"),
     ":1:40: found the string '', expected a name of 1 to 100 bytes"},
    {"ModelWithoutModel", Quoted("{'models': [{'name': 'a'}]}"),
     ":1:13: found no 'model' in this object, expected the name of a define or of a model type"},
    {"PropertyIsObject", Quoted("{'models': [{'model': 'model', 'properties': {'size': {'x': 1}}}]}"),
     ":1:55: found an object, expected a number, a string, true, false, or an array of numbers and strings"},
    {"PropertyIsNestedList", Quoted("{'models': [{'model': 'model', 'properties': {'size': [[1, 2, 3]]}}]}"),
     ":1:56: found an array of 3, expected a number or a string"},
    {"PropertyIsNull", Quoted("{'models': [{'model': 'model', 'properties': {'color': null}}]}"),
     ":1:56: found null, expected a number, a string, true, false, or an array of numbers and strings"},
    {"CountIsZero", Alone("'spawn': [{'model': 'position', 'count': 0, 'region': [0, 0, 1, 1]}]"),
     ":2:42: found the number 0, expected an integer from 1 to 10000"},
    {"CountIsHuge", Alone("'spawn': [{'model': 'position', 'count': 1000000, 'region': [0, 0, 1, 1]}]"),
     ":2:42: found the number 1000000, expected an integer from 1 to 10000"},
    {"SpawnWithoutRegion", Alone("'spawn': [{'model': 'position', 'count': 1}]"),
     ":2:11: found no 'region' in this object, expected [xmin, ymin, xmax, ymax], or a polygon [[x, y], [x, y], [x, "
     "y], ...], in metres"},
    {"SpacingIsNegative", Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [0, 0, 1, 1], 'spacing': -1}]"),
     ":2:80: found the number -1, expected a distance in metres, at least 0"},
    {"OverrideWithoutMatch", Alone("'override': [{'properties': {'color': 'red'}}]"),
     ":2:14: found no 'match' in this object, expected an object with 'name', 'type' or both"},
    {"OverrideOfNothing", Alone("'override': [{'match': {}, 'properties': {'color': 'red'}}]"),
     ":2:24: found an empty object, expected an object with 'name', 'type' or both"},
    {"RosNoHitIsUnknown", Alone("'ros_no_hit': 'nan'"), ":2:15: found the string 'nan', expected 'inf' or 'range-max'"},
    {"RosLockstepHasNoNames", Alone("'ros_lockstep': {'period': 2}"),
     ":2:17: found no 'names' in this object, expected an array of at most 1000 names"},
    {"RosLockstepOfANameWithASpace", Alone("'ros_lockstep': ['driver', 'a b']"),
     ":2:28: found 'a b', expected a topic such as '/anna/cmd_vel' or '~/cmd_vel', or the name of a node"},
    {"RosLockstepOfARobotWithoutASlash", Alone("'robots': [{'name': 'r0', 'ros_lockstep': ['~cmd_vel']}]"),
     ":2:44: found '~cmd_vel', expected a topic such as '/anna/cmd_vel' or '~/cmd_vel', or the name of a node"},
    {"RosLockstepOfAnUnknownEnd", Alone("'ros_lockstep': {'names': ['driver'], 'at_limit': 'stop'}"),
     ":2:51: found the string 'stop', expected 'end' or 'continue'"},
    {"RosDomainIsTooHigh", Alone("'robots': [{'name': 'r0', 'ros_domain': 231}]"),
     ":2:41: found the number 231, expected a ROS domain from 0 to 230, or {\"each\": the first one}"},
    {"RosDomainOfEachForOneRobot", Alone("'robots': [{'name': 'r0', 'ros_domain': {'each': 1}}]"),
     ":2:41: found 'each' for one robot, expected a ROS domain from 0 to 230"},
    {"RosDomainTwice",
     Alone("'robots': [{'name': 'r0', 'ros_domain': 5},\n{'name': 'r1', 'model': 'position', 'ros_domain': 5}]"),
     ":3:51: found the ROS domain 5 for robot 'r1', which robot 'r0' has already, expected one for each robot"},
    {"RosDomainOfARuleWithSeveralRobots",
     Alone("'spawn': [{'model': 'position', 'count': 3, 'region': [5, 5, 50, 50],\n'ros_domain': 5}]"),
     ":3:15: found one ROS domain for 3 robots, expected {\"each\": 5}"},
    {"RosDomainsOfARuleBeyondTheLast",
     Alone("'spawn': [{'model': 'position', 'count': 3, 'region': [5, 5, 50, 50],\n'ros_domain': {'each': 229}}]"),
     ":3:15: found the ROS domain 231 for robot 'position2', expected at most 230: the ports of a higher one would "
     "exceed 65535"},
    {"RosDomainOfNoRobot",
     Alone("'spawn': [{'model': 'model', 'count': 1, 'region': [5, 5, 50, 50],\n'ros_domain': 5}]"),
     ":3:15: found a ROS domain for a model of type 'model', expected it for robots only: models of type 'position'"},
    {"PlaceTwice", Alone("'places': [{'name': 'dock', 'pose': [0, 0, 0]},\n{'name': 'dock', 'pose': [1, 0, 0]}]"),
     ":3:10: found the place 'dock' again, expected another name"},
    {"PlaceWithoutPose", Alone("'places': [{'name': 'dock'}]"),
     ":2:12: found no 'pose' in this object, expected [x, y, heading] or [x, y, z, heading], in metres and degrees"},
    {"RosIsText", Alone("'ros': 'yes'"), ":2:8: found the string 'yes', expected true or false"},
    {"TwoFaultsTheFirstIsReported", Alone("'ticks': -1, 'robots': [{'pose': 1}], 'foo': 1"),
     ":2:10: found the number -1, expected a number of ticks, an integer of at least 1"},
};

// Faults that a schema cannot express.
const BadScenario kBeyondTheSchema[] = {
    {"TestOfAnotherScenario", Alone("'scenario': 'other.json'"),
     ":2:13: found a test of another scenario, expected a scenario: 'troupe test' runs tests"},
    {"TwoRegionsOfOneName",
     Alone("'regions': [{'name': 'a', 'region': [0, 0, 1, 1]},\n{'name': 'a', 'region': [0, 0, 2, 2]}]"),
     ":3:10: found the region 'a' again, expected another name"},
    {"RegionOfThreeNumbers", Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [0, 0, 1]}]"),
     ":2:55: found 3 numbers, expected [xmin, ymin, xmax, ymax]"},
    {"RegionUpsideDown", Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [0, 1, 1, 0]}]"),
     ":2:65: found a ymax that is not above ymin, expected one that is"},
    {"RegionMixed", Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [0, 1, [1, 1], 2]}]"),
     ":2:62: found an array of 2, expected a number as before it"},
    {"RegionWithoutArea", Alone("'spawn': [{'model': 'position', 'count': 1,\n  'region': [[0, 0], [1, 1], [2, 2]]}]"),
     ":3:13: found a region that is no simple polygon: the outline has no area"},
    {"RegionCrossesItself",
     Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [[0, 0], [2, 2], [2, 0], [0, 1]]}]"),
     ":2:55: found a region that is no simple polygon: edges of the outline cross each other"},
    {"HeadingIsAnotherWord",
     Alone("'spawn': [{'model': 'position', 'count': 1, 'region': [0, 0, 1, 1], 'heading': 'north'}]"),
     ":2:80: found the string 'north', expected a heading in degrees, or 'random'"},
    {"TooManyInAll",
     Alone("'spawn': [{'model': 'position', 'count': 9999, 'region': [0, 0, 9, 9]},\n{'model': 'position', 'count': "
           "9999, 'region': [0, 0, 9, 9]},\n{'model': 'position', 'count': 9999, 'region': [0, 0, 9, 9]}]"),
     ":4:32: found 29997 models to spawn in all, expected at most 20000"},
    {"NameAmongProperties", Quoted("{'models': [{'model': 'model', 'properties': {'name': 'a'}}]}"),
     ":1:55: found the property 'name', which is expected as a key of the model itself"},
    {"OverrideOfNames", Alone("'override': [{'match': {'name': '*'}, 'properties': {'name': 'x'}}]"),
     ":2:62: found the property 'name', which no rule can change"},
    {"UnknownController", Alone("'robots': [{'name': 'r0',\n  'controller': 'wonder'}]"),
     ":3:17: unknown controller 'wonder', expected idle"},
    {"UnknownDefaultController", Alone("'controller': {'name': 'wonder'}"),
     ":2:15: unknown controller 'wonder', expected idle"},
};

// Faults that depend on the world.
const BadScenario kOfTheWorld[] = {
    {"WorldIsMissing", Quoted("{\n  'world': '../no.world'}"),
     ":2:12: cannot read 'no.world' (No such file or directory), expected a readable file"},
    {"WorldIsAFolder", Quoted("{'world': '../include'}"), ":1:11: found 'include', expected a regular file"},
    {"IncludeIsMissing", Quoted("{'include': ['../include/robots.inc',\n '../include/no.inc']}"),
     ":2:2: cannot read 'include/no.inc' (No such file or directory), expected a readable file"},
    {"UnknownModel", InOffice("'robots': [{'model': 'scuot', 'pose': [0, 0, 0]}]"),
     ":2:22: found model type 'scuot', expected the name of a define (building, cart, carton, chair, furniture, "
     "meeting_table, parcel, porter, scanner, scout, scout_with_mast, shelf, sonar, sonar_ring, table), or one of "
     "model position ranger actuator blinkenlight blobfinder bumper camera contact door fiducial gripper imu lift "
     "lightindicator "
     "radio; did you mean 'scout'?"},
    {"UnknownChild", InOffice("'models': [{'model': 'table',\n 'children': [{'model': 'vase'}]}]"),
     ":3:25: found model type 'vase', expected the name of a define (building, cart, carton, chair, furniture, "
     "meeting_table, parcel, porter, scanner, scout, scout_with_mast, shelf, sonar, sonar_ring, table), or one of "
     "model position ranger actuator blinkenlight blobfinder bumper camera contact door fiducial gripper imu lift "
     "lightindicator "
     "radio"},
    {"UnknownSpawnModel", InOffice("'spawn': [{'model': 'scuot', 'count': 1, 'region': [0, 0, 1, 1]}]"),
     ":2:21: found model type 'scuot', expected the name of a define (building, cart, carton, chair, furniture, "
     "meeting_table, parcel, porter, scanner, scout, scout_with_mast, shelf, sonar, sonar_ring, table), or one of "
     "model position ranger actuator blinkenlight blobfinder bumper camera contact door fiducial gripper imu lift "
     "lightindicator "
     "radio; did you mean 'scout'?"},
    {"SensorByItself", InOffice("'models': [{'model': 'sensor'}]"),
     ":2:22: found 'sensor' by itself, expected it in the 'children' of a model"},
    {"SpawnOfBlocks", InOffice("'spawn': [{'model': 'block', 'count': 1, 'region': [0, 0, 1, 1]}]"),
     ":2:21: found 'block', expected a model"},
    {"RobotIsATable", InOffice("'robots': [{'model': 'table', 'name': 't'}]"),
     ":2:22: found a model of type 'model', expected a robot: a model of type 'position'"},
    {"RobotIsATableOfTheWorld", InOffice("'robots': [{'name': 'table0', 'controller': 'idle'}]"),
     ":2:21: found a model of type 'model', expected a robot: a model of type 'position'"},
    {"RobotOfTheWorldIsMissing", InOffice("'robots': [{'name': 'r99', 'pose': [0, 0, 0]}]"),
     ":2:21: found no model 'r99' in the world, expected one, or 'model' to add a new one"},
    {"RobotWithoutNameAndModel", InOffice("'robots': [{'pose': [0, 0, 0]}]"),
     ":2:12: found a robot with neither 'model' nor 'name', expected 'model' for a new one or 'name' for one of the "
     "world"},
    {"NameTwice", InOffice("'robots': [{'name': 'a', 'model': 'scout'},\n {'name': 'a', 'model': 'scout'}]"),
     ":3:11: found the name 'a' again, expected one that is not in the world yet"},
    {"NameOfTheWorldTwice", InOffice("'models': [{'name': 'table0', 'model': 'table'}]"),
     ":2:21: found the name 'table0' again, expected one that is not in the world yet"},
    {"SpawnedNameTwice",
     InOffice("'robots': [{'name': 'scout1', 'model': 'scout'}],\n'spawn': [{'model': 'scout', 'count': 2, 'region': "
              "[0, 0, 1, 1], 'name_prefix': 'scout'}]"),
     ":3:81: found the name 'scout1' again, expected one that is not in the world yet"},
    {"ControllerOfATable",
     InOffice("'spawn': [{'model': 'table', 'count': 1, 'region': [0, 0, 1, 1], 'controller': 'idle'}]"),
     ":2:80: found a controller for a model of type 'model', expected it for robots only: models of type 'position'"},
    {"NoRoom", InOffice("'spawn': [\n {'model': 'scout', 'count': 50, 'region': [0, 0, 1, 1]}]"),
     ":3:2: found room for 7 of 50 'scout', expected room for all: enlarge the region or reduce count or spacing"},
    {"NoRoomForTheSpacing",
     InOffice("'spawn': [{'model': 'scout', 'count': 9, 'region': [-8, -1, 8, 1], 'spacing': 9}]"),
     ":2:11: found room for 2 of 9 'scout', expected room for all: enlarge the region or reduce count or spacing"},
    {"OverrideMatchesNoName", InOffice("'override': [{'match': {'name': 'desk*'}, 'properties': {'color': 'red'}}]"),
     ":2:24: found no model with the name 'desk*', expected one of the names 'walls', 'table0', 'chair0', 'table1', "
     "'chair1', 'shelf0', 'table2', 'table3', 'chair2', 'chair3', 'shelf1', 'carton0' and 17 more or of the types "
     "'building', 'carton', 'chair', 'furniture', 'meeting_table', 'model', 'parcel', 'shelf', 'table'"},
    {"OverrideMatchesNoType", Alone("'override': [{'match': {'type': 'wall'}, 'properties': {'color': 'red'}}]"),
     ":2:24: found no model with the type 'wall', expected one of the names 'r0' or of the types 'position'"},
    {"OverrideMatchesNotBoth",
     InOffice("'override': [{'match': {'name': 'walls',\n 'type': 'chair'}, 'properties': {'color': 'red'}}]"),
     ":2:24: found no model with the name 'walls' and the type 'chair', expected one of the names 'walls', 'table0', "
     "'chair0', 'table1', 'chair1', 'shelf0', 'table2', 'table3', 'chair2', 'chair3', 'shelf1', 'carton0' and 17 more "
     "or of the types 'building', 'carton', 'chair', 'furniture', 'meeting_table', 'model', 'parcel', 'shelf', "
     "'table'"},
    {"SizeOfTwoNumbers", Quoted("{'models': [{'model': 'model',\n  'properties': {'size': [1, 2]}}]}"),
     ":2:26: found 2 values for 'size', expected 3"},
    {"SizeIsText", Quoted("{'models': [{'model': 'model', 'properties': {'size': 'big'}}]}"),
     ":1:55: found 1 value for 'size', expected 3"},
    {"BitmapIsMissing", Quoted("{'models': [{'model': 'model', 'properties': {'bitmap': 'no.png'}}]}"),
     ":1:57: bitmap 'scenarios/no.png': cannot read the image (No such file or directory), expected a readable file"},
};

std::vector<BadScenario> BadScenarios() {
  std::vector<BadScenario> all;
  const auto add = [&all](const auto& group) { all.insert(all.end(), std::begin(group), std::end(group)); };
  add(kNotJson);
  add(kAgainstTheSchema);
  add(kBeyondTheSchema);
  add(kOfTheWorld);
  return all;
}

class BadScenarioTest : public testing::TestWithParam<BadScenario> {};

TEST_P(BadScenarioTest, IsRefusedWithItsPlaceAndTheExpectedText) {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  ASSERT_NE(source, nullptr);
  const std::string path = std::string(source) + "/worlds/scenarios/bad.json";
  LoadOverrides overrides;
  overrides.check_controller = [](const std::string& name, const std::string&) -> Status {
    if (name == "idle" || name.ends_with(".so")) return Status();
    return Error{{}, "unknown controller '" + name + "', expected idle"};
  };
  const Result<LoadedWorld> loaded = LoadScenarioText(GetParam().text, path, overrides);
  ASSERT_FALSE(loaded.ok());
  const Error& error = loaded.error();
  EXPECT_EQ(error.where.file, path);
  std::string message = error.ToString();
  for (const std::string& folder : {path, std::string(source) + "/worlds/"}) {
    for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder)) {
      message.erase(at, folder.size());
    }
  }
  const std::size_t space = GetParam().message.find(' ');
  EXPECT_EQ(message, GetParam().message.substr(0, space) + " error:" + GetParam().message.substr(space));
}

INSTANTIATE_TEST_SUITE_P(Table, BadScenarioTest, testing::ValuesIn(BadScenarios()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(HundredMegabytesOfNonsense, AreRefused) {
  const Result<LoadedWorld> loaded = LoadScenarioText(std::string(100'000'000, 'x'), "bad.json", {});
  ASSERT_FALSE(loaded.ok());
  EXPECT_EQ(loaded.error().ToString(), "bad.json: error: found 100000000 bytes, expected at most 16777216");
}

}  // namespace
}  // namespace troupe
