#include "robot-agent/controller/controller_table.h"

#include <limits>

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kAnything = std::numeric_limits<double>::infinity();

constexpr ParameterHelp kSpeedHelp{"speed", "number", "m/s", "0.4", 0.0, 100.0, "Ahead"};
constexpr ParameterHelp kTurnRateHelp{"turn_rate", "number", "rad/s", "0.8", 0.0, 100.0, "When it turns"};
constexpr ParameterHelp kClearanceHelp{"clearance",
                                       "number",
                                       "m",
                                       "0.4",
                                       0.0,
                                       100.0,
                                       "From the robot's origin to obstacles that it passes, where there is room"};
constexpr ParameterHelp kDistanceHelp{"distance", "number", "m", "1.5", 0.05, 1000.0, "Between neighbours"};
constexpr ParameterHelp kMapSizeHelp{
    "map_size", "number", "m", "40", 1.0, 10000.0, "The side of the square around its start that is mapped"};
constexpr ParameterHelp kCellHelp{"cell", "number", "m", "0.2", 0.02, 10.0, "The side of a cell of the map"};
constexpr ParameterHelp kWaypointsHelp{
    "waypoints", "json", "m", "", 0.0, 0.0, "[[x, y], ...]; without them it waits for goals"};
constexpr ParameterHelp kToleranceHelp{
    "tolerance", "number", "m", "0.1", 0.001, 100.0, "A waypoint within it is reached"};
constexpr ParameterHelp kPlanHelp{
    "plan", "flag", "", "false", 0.0, 0.0, "Search ways to its own waypoints, too, not only to goals"};
constexpr ParameterHelp kSourceHelp{"source", "json", "", "1", 0.0, 0.0, "A point [x, y] in m, or the id of a mark"};
constexpr ParameterHelp kSinkHelp{"sink", "json", "", "2", 0.0, 0.0, "A point [x, y] in m, or the id of a mark"};
constexpr ParameterHelp kReachHelp{"reach", "number", "m", "1", 0.05, 100.0, "The robot is at a place within it"};
constexpr ParameterHelp kLoadTimeHelp{"load_time", "number", "s", "3", 0.0, 3600.0, "That it stands at a place"};
constexpr ParameterHelp kChargerHelp{"charger", "json", "", "", 0.0, 0.0, "A point [x, y] in m, or the id of a mark"};
constexpr ParameterHelp kChargeBelowHelp{
    "charge_below", "number", "", "0.3", 0.0, 1.0, "Of the store's capacity: below it the robot drives to the charger"};
constexpr ParameterHelp kChargeToHelp{
    "charge_to", "number", "", "0.95", 0.0, 1.0, "Of the store's capacity: from it on the robot continues its task"};

constexpr ParameterHelp kDynamicParameters[] = {
    {"distance", "number", "m", "2", 0.01, 10000.0, "Of each way; an obstacle ends it, too"},
    kSpeedHelp,
    {"pause", "number", "s", "1", 0.0, 1e6, "Between two ways"}};
constexpr ParameterHelp kExpandParameters[] = {
    kSpeedHelp,
    {"turn_gain", "number", "1/s", "1", 0.0, 100.0, "Turn rate for each radian to the direction with most room"},
    {"clear_distance", "number", "m", "0.6", 0.0, 1000.0, "The front is clear if no obstacle there is nearer"},
    {"clear_angle", "number", "rad", "0.5", 0.0, kPi, "The front is within this angle of the heading"},
    {"clearance", "number", "m", "0", 0.0, 100.0, "It keeps a circle of this radius about its origin clear; 0: none"}};
constexpr ParameterHelp kFasrParameters[] = {kSourceHelp,      kSinkHelp,     kReachHelp,     kLoadTimeHelp,
                                             kSpeedHelp,       kTurnRateHelp, kClearanceHelp, kChargerHelp,
                                             kChargeBelowHelp, kChargeToHelp};
constexpr ParameterHelp kFasr2Parameters[] = {
    {"tasks", "json", "", "", 0.0, 0.0, "[[source, sink], ...] in turn; without them one, by source and sink"},
    kSourceHelp,
    kSinkHelp,
    {"patience", "number", "s", "60", 0.0, 1e6, "Without a unit for so long it turns to the next task; 0: never"},
    kReachHelp,
    kLoadTimeHelp,
    kSpeedHelp,
    kTurnRateHelp,
    kClearanceHelp,
    kChargerHelp,
    kChargeBelowHelp,
    kChargeToHelp};
constexpr ParameterHelp kFasrPlanParameters[] = {kSourceHelp,      kSinkHelp,     kReachHelp,     kLoadTimeHelp,
                                                 kSpeedHelp,       kTurnRateHelp, kClearanceHelp, kChargerHelp,
                                                 kChargeBelowHelp, kChargeToHelp, kMapSizeHelp,   kCellHelp};
constexpr ParameterHelp kFetchParameters[] = {
    {"steps", "json", "", R"([{"take": [1, 0, 0, 0]}, {"put": [0, 1, 0, 0]}])", 0.0, 0.0,
     "Each an object with one key: take, put, go_to, turn_to, ...", true},
    {"places", "json", "", "", 0.0, 0.0, R"([{"name": "shelf", "at": [x, y, heading, lift]}, ...])"},
    {"speed", "number", "m/s", "0.4", 0.0, kAnything, "Ahead"},
    {"turn_rate", "number", "rad/s", "1", 0.0, kAnything, "When it turns"},
    {"reach", "number", "m", "0.4", 0.0, kAnything, "From the robot's origin to the centre of the held object"},
    {"approach", "number", "m", "0.5", 0.0, kAnything, "The straight path into a place and out of it"},
    {"raise", "number", "%", "5", 0.0, 100.0,
     "The lift above that of the place, after gripping and before setting down"},
    {"travel", "number", "%", "5", 0.0, 100.0, "The lift between places"},
    {"repeat", "flag", "", "false", 0.0, 0.0, "Begins again at the end"}};
constexpr ParameterHelp kFlockParameters[] = {
    kDistanceHelp,
    {"radius", "number", "m", "5", 0.05, 100000.0, "Robots farther away are no neighbours"},
    {"memory", "number", "s", "1", 0.0, 3600.0, "Without a message, until a neighbour is forgotten"},
    kSpeedHelp,
    kTurnRateHelp,
    kClearanceHelp};
constexpr ParameterHelp kFollowParameters[] = {
    {"id", "number", "", "0", -1e9, 1e9, "The fiducial_return of the model; 0: the nearest of all"},
    {"distance", "number", "m", "1", 0.0, 1000.0, "That it keeps"},
    kSpeedHelp,
    kTurnRateHelp};
constexpr ParameterHelp kGoToParameters[] = {
    kWaypointsHelp, {"heading", "number", "rad", "", -2.0 * kPi, 2.0 * kPi, "At the last waypoint"},
    kSpeedHelp,     kTurnRateHelp,
    kToleranceHelp, kPlanHelp};
constexpr ParameterHelp kPatrolParameters[] = {
    {"waypoints", "json", "m", "[[0, 0], [1, 0]]", 0.0, 0.0, "[[x, y], ...], at least two", true},
    kSpeedHelp,
    kTurnRateHelp,
    kToleranceHelp,
    kPlanHelp};
constexpr ParameterHelp kLanesParameters[] = {
    {"places", "json", "", "", 0.0, 0.0, "The names of places to visit; without them it waits for goals"},
    {"repeat", "flag", "", "true", 0.0, 0.0, "Begin again after the last place"},
    {"wait", "number", "s", "3", 0.0, 1e6, "That it stands at each place"},
    {"speed", "number", "m/s", "", 0.01, 100.0, "On lanes; without it that of the drive, at most 1 m/s"},
    {"dock_speed", "number", "m/s", "0.2", 0.01, 100.0, "On the last metre to a place with a dock"},
    {"turn_rate", "number", "rad/s", "0.8", 0.01, 100.0, "When it turns"},
    {"tolerance", "number", "m", "0.1", 0.02, 1.0, "A vertex within it is reached"},
    {"gap", "number", "m", "0.3", 0.02, 10.0, "That it keeps to robots and things ahead"},
    {"charge_below", "number", "", "0.3", 0.0, 1.0,
     "Of the store's capacity: below it the robot drives to the nearest charger"},
    kChargeToHelp,
    {"close_doors", "flag", "", "true", 0.0, 0.0, "Close doors behind it"},
    {"planned", "flag", "", "true", 0.0, 0.0, "Take part in the planned traffic of the lanes"},
    {"goods", "flag", "", "false", 0.0, 0.0, "Bring the goods of the flows of a scenario"},
    {"keep_place", "flag", "", "false", 0.0, 0.0, "Without repeat: go back to the last place after making room"},
    {"delay_probability", "number", "", "0", 0.0, 1.0, "In the planned traffic: to stand for a while before a move"},
    {"delay_min", "number", "s", "1", 0.0, 1e6, "The shortest of these delays"},
    {"delay_max", "number", "s", "5", 0.0, 1e6, "The longest of these delays"},
    {"graph", "number", "", "", 0.0, 1e6, "The number of a graph of lanes; without it that nearest to its start"}};
constexpr ParameterHelp kLaserNoiseParameters[] = {
    {"samples", "number", "", "100", 2.0, 1e6, "Readings for each report"}};
constexpr ParameterHelp kPioneerFlockingParameters[] = {kDistanceHelp, kSpeedHelp, kTurnRateHelp, kClearanceHelp};
constexpr ParameterHelp kRasterizeParameters[] = {kSpeedHelp, kTurnRateHelp, kClearanceHelp, kMapSizeHelp, kCellHelp};
constexpr ParameterHelp kScriptParameters[] = {
    {"commands", "json", "", R"([{"at": 0, "vx": 0.3}])", 0.0, 0.0,
     R"([{"at": seconds, "vx": m/s, "wz": rad/s, ...}, ...], in the order of time)", true},
    {"repeat", "flag", "", "false", 0.0, 0.0, "Begins again at the end"},
    {"period", "number", "s", "", 0.0, kAnything, "With repeat: the time of the restart"}};
constexpr ParameterHelp kSlotcarParameters[] = {
    {"fleet", "json", "", "", 0.0, 0.0,
     R"("name": in /fleet_states, else that of its place's tag or its model's type)"},
    {"speed", "number", "m/s", "0.7", 0.0, 100.0, "Within the bounds of the drive, and those of the path"},
    {"turn_rate", "number", "rad/s", "0.6", 0.0, 100.0, "When it turns in place"},
    {"stop_distance", "number", "m", "0.75", 0.0, 100.0, "It waits for robots and people near the point so far ahead"},
    {"stop_radius", "number", "m", "0.75", 0.0, 100.0, "Near: within this distance; 0: it waits for none"}};
constexpr ParameterHelp kStationParameters[] = {
    {"interval", "number", "s", "5", 0.0, 1e6, "In which a source makes a unit, or a sink uses one up; 0: at once"},
    {"capacity", "number", "", "1", 1.0, 1e9, "Units in stock"},
    {"reach", "number", "m", "1.5", 0.0, 1000.0, "A visitor is nearer"},
    {"load_time", "number", "s", "2.5", 0.0, 3600.0, "Of a visit for one unit"}};
constexpr ParameterHelp kVda5050Parameters[] = {
    {"version", "json", "", R"("2.1")", 0.0, 0.0, R"("2.0", "2.1" or "3.0")"},
    {"manufacturer", "json", "", R"("Troupe")", 0.0, 0.0, "A level of its topics"},
    {"serial_number", "json", "", "", 0.0, 0.0, "A level of its topics; else the robot's name"},
    {"interface", "json", "", "", 0.0, 0.0, R"(The first level of its topics; else "uagv", in 3.0 "vda5050")"},
    {"map", "json", "", R"("map")", 0.0, 0.0, "The id of the map in orders"},
    {"epoch", "json", "", R"("2026-01-01T00:00:00.000Z")", 0.0, 0.0, "The time of tick 0 in messages"},
    {"speed", "number", "m/s", "1", 0.01, 100.0, "On edges without one, within the bounds of the drive"},
    {"turn_rate", "number", "rad/s", "0.8", 0.01, 100.0, "On edges without one, within the bounds of the drive"},
    {"tolerance", "number", "m", "0.1", 0.01, 100.0, "Of nodes without a deviation"},
    {"heading_tolerance", "number", "rad", "0.05", 0.01, 3.2, "Of nodes with an orientation"},
    {"gap", "number", "m", "0.2", 0.0, 100.0, "Its distance to the next obstacle ahead"},
    {"blocked_after", "number", "s", "3", 0.0, 3600.0, "At rest before an obstacle, until it is an error"},
    {"load_time", "number", "s", "3", 0.0, 3600.0, "Of a hand-over"},
    {"state_interval", "number", "s", "30", 0.1, 30.0, "A state is sent at the latest"},
    {"minimum_state_interval", "number", "s", "0", 0.0, 30.0, "Between two states"},
    {"visualization_interval", "number", "s", "1", 0.0, 3600.0, "Between two visualizations; 0: none"}};
constexpr ParameterHelp kWanderParameters[] = {
    {"speed", "number", "m/s", "0.4", 0.0, 100.0, "Ahead; half of it when it backs off"},
    kTurnRateHelp,
    {"min_distance", "number", "m", "1", 0.0, 1000.0, "It turns for obstacles ahead that are nearer"},
    {"front_angle", "number", "rad", "0.5", 0.0, kPi, "Obstacles within this angle of the heading are ahead"},
    {"back_off_time", "number", "s", "1", 0.0, 3600.0, "How long it backs off after a stall"},
    {"steering_angle", "number", "rad", "0.5", 0.0, 0.5 * kPi, "Cars only: steering in a turn"},
    {"clearance", "number", "m", "0", 0.0, 100.0, "It keeps a circle of this radius about its origin clear; 0: none"}};

constexpr ControllerHelp kControllers[] = {
    {"dynamic", "Drives to and fro: an obstacle that moves", kDynamicParameters},
    {"expand", "Drives where there is most room, so that robots spread out", kExpandParameters},
    {"fasr", "Carries units from a source to a sink", kFasrParameters},
    {"fasr2", "Carries units, with several tasks in turn", kFasr2Parameters},
    {"fasr_plan", "Carries units, and plans its ways on a map", kFasrPlanParameters},
    {"fetch", "Fetches objects with its gripper, step by step", kFetchParameters},
    {"flock", "Moves with the robots that its radio hears", kFlockParameters},
    {"follow", "Drives behind a model that its fiducial finder sees", kFollowParameters},
    {"go_to", "Drives to waypoints, and to goals that users send", kGoToParameters},
    {"idle", "Stands still", {}},
    {"lanes", "Drives along the lanes of a building to places", kLanesParameters},
    {"lasernoise", "Stands, and measures the noise of its ranger", kLaserNoiseParameters},
    {"patrol", "Drives along waypoints, round after round", kPatrolParameters},
    {"pioneer_flocking", "Moves with the robots that its fiducial finder sees", kPioneerFlockingParameters},
    {"rasterize", "Makes a map of all that it can reach", kRasterizeParameters},
    {"script", "Follows a timed list of commands", kScriptParameters},
    {"sink", "A station that receives units", kStationParameters},
    {"slotcar", "Drives along the paths of Open-RMF, and to goals", kSlotcarParameters},
    {"source", "A station that gives units", kStationParameters},
    {"vda5050", "Drives and works as a fleet control orders by VDA 5050", kVda5050Parameters},
    {"wander", "Drives ahead, and turns away from obstacles", kWanderParameters},
};

}  // namespace

std::span<const ControllerHelp> ControllerTable() {
  return kControllers;
}

}  // namespace troupe
