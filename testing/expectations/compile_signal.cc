#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/text.h"
#include "testing/expectations/compiler.h"

namespace troupe {
namespace {

// Signals that have other names now.
constexpr std::pair<std::string_view, std::string_view> kRenamed[] = {
    {"turn_rate", "wz"}, {"joint", "position"}, {"joint_speed", "velocity"}};

// Letters of SignalInfo::parameters: r robot, o object, m robot or sensor, t any thing, others a body.
std::vector<std::size_t> KindsOf(char parameter) {
  if (parameter == 'r') return {RobotKind()};
  if (parameter == 'o') return {ObjectKind()};
  if (parameter == 'm') return {RobotKind(), KindOf("sensors")};
  if (parameter != 't') return {RobotKind(), ObjectKind(), PersonKind()};
  std::vector<std::size_t> kinds;
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    if (!StateTables()[kind].varies) kinds.push_back(kind);
  }
  return kinds;
}

// The kinds of things that are parts of robots.
std::vector<std::size_t> KindsOfParts(std::vector<std::size_t> kinds) {
  std::erase_if(kinds, [](std::size_t kind) { return !StateTables()[kind].of_robots; });
  return kinds;
}

}  // namespace

// Functions, then signals of the run, then signals of tables.
TypedValue Compiler::Call(const Syntax& syntax) {
  if (syntax.kind == SyntaxKind::kCall && IsFunction(syntax.name)) return Function(syntax);
  if (const SignalInfo* const run_signal = FindRunSignal(syntax.name)) return RunSignal(syntax, *run_signal);
  const Kinds kinds = KindsWith(syntax.name);
  return kinds.empty() ? UnknownName(syntax) : TableSignal(syntax, kinds);
}

// The most helpful message first: a variable without a signal, an old name, a similar name.
TypedValue Compiler::UnknownName(const Syntax& syntax) {
  const bool is_variable =
      std::any_of(scoped_.begin(), scoped_.end(), [&](const Scoped& scoped) { return scoped.name == syntax.name; });
  if (is_variable) {
    return Fail(syntax, "found the variable '" + syntax.name + "' alone, expected a signal of it, such as x(" +
                            syntax.name + ")");
  }
  for (const auto& [before, now] : kRenamed) {
    if (syntax.name != before) continue;
    return Fail(syntax, "found '" + syntax.name + "', expected its present name '" + std::string(now) + "'");
  }
  std::vector<std::string> names = SignalNames();
  for (const Shorthand& shorthand : Shorthands()) names.emplace_back(shorthand.name);
  return Fail(syntax, "found '" + PlainLine(syntax.name, 40) +
                          "', expected a signal or a function (docs/testing.md lists them)" +
                          DidYouMean(syntax.name, names));
}

TypedValue Compiler::Function(const Syntax& syntax) {
  const std::string& name = syntax.name;
  const std::vector<Syntax>& arguments = syntax.children;
  const std::size_t count = name == "min" || name == "max" ? 2 : 1;
  if (arguments.size() != count) {
    return Fail(syntax, "found " + std::to_string(arguments.size()) + " arguments of '" + name + "', expected " +
                            std::to_string(count));
  }
  if (name == "count") return Count(arguments[0]);
  std::vector<TypedValue> values;
  for (const Syntax& argument : arguments) {
    values.push_back(Expression(argument));
    if (error_) return {};
    if (values.back().type != ValueType::kNumber) {
      return Fail(argument, "found " + NameOf(values.back()) + ", expected a number for '" + name + "'");
    }
  }
  TypedValue value = values[0];
  if (name == "abs") {
    value.node = Make(Op::kAbsolute, {value.node});
  } else if (name == "sqrt") {
    return SquareRoot(syntax, std::move(value));
  } else {
    RequireSameUnit(syntax, values[0], values[1], "beside");
    if (values[0].is_plain) value.dimension = values[1].dimension;
    value.is_plain = values[0].is_plain && values[1].is_plain;
    value.node = Make(name == "min" ? Op::kSmaller : Op::kLarger, {values[0].node, values[1].node});
  }
  return value;
}

// Units have whole exponents, so that only squares have a root.
TypedValue Compiler::SquareRoot(const Syntax& syntax, TypedValue value) {
  const Dimension& squared = value.dimension;
  if (squared.metre % 2 != 0 || squared.second % 2 != 0 || squared.radian % 2 != 0 || squared.joule % 2 != 0) {
    return Fail(syntax, "found the square root of " + NameOf(value) + ", expected a square such as m^2");
  }
  value.dimension = {static_cast<std::int8_t>(squared.metre / 2), static_cast<std::int8_t>(squared.second / 2),
                     static_cast<std::int8_t>(squared.radian / 2), static_cast<std::int8_t>(squared.joule / 2)};
  value.node = Make(Op::kSquareRoot, {value.node});
  return value;
}

// A table's rows, or events of a type since the start.
TypedValue Compiler::Count(const Syntax& argument) {
  if (argument.kind == SyntaxKind::kName) {
    for (std::size_t table = 0; table < StateTables().size(); ++table) {
      if (StateTables()[table].name != argument.name) continue;
      Node node;
      node.op = Op::kSignal;
      node.signal.kind = SignalKind::kRows;
      node.signal.table = table;
      return {Add(std::move(node)), ValueType::kNumber};
    }
  }
  if (!argument.Is(SyntaxKind::kCall, "event")) {
    return Fail(argument,
                "found no event in 'count(...)', expected count(event(TYPE)) or count(TABLE); 'count r: ...' counts "
                "robots");
  }
  const TypedValue value = Call(argument);
  if (error_) return {};
  Node counting = Now(value.node);  // the formula may name the event itself, too
  counting.signal.kind = SignalKind::kEventCount;
  counting.recorded = false;
  return {Add(std::move(counting)), ValueType::kNumber};
}

// A signal that a thing has not (NaN in the placed state) is an error of the text, and not a value at run time.
TypedValue Compiler::TableSignal(const Syntax& syntax, const Kinds& kinds) {
  const std::string& name = syntax.name;
  const Kinds kinds_of_parts = KindsOfParts(kinds);
  const bool names_part = syntax.children.size() == 2 && !kinds_of_parts.empty();
  if (syntax.children.size() != 1 && !names_part) {
    return Fail(syntax, "found " + std::to_string(syntax.children.size()) + " arguments of '" + name + "', expected " +
                            name + "(" + StateTables()[kinds.front()].singular + ")");
  }
  ThingArgument thing = Thing(syntax.children[0], names_part ? Kinds{RobotKind()} : kinds);
  if (error_) return {};
  Node node;
  node.op = Op::kSignal;
  node.signal.kind = SignalKind::kTable;
  SetLanes({thing}, node);
  if (!error_ && names_part) thing.kind = FindParts(syntax.children[1], kinds_of_parts, node.signal.subjects);
  if (error_) return {};
  const StateTable& table = StateTables()[thing.kind];
  const troupe::Signal& column = *table.Find(name);
  node.signal.column = &column;
  node.signal.first = names_.things().first(thing.kind);
  TypedValue value{0, column.type, DimensionOf(column.unit)};
  if (column.type == ValueType::kText) {
    if (column.possible) value.possible = column.possible(names_.world());
    value.read = std::make_shared<const Node>(std::move(node));
    return value;
  }
  if (table.name == "joints") SetUnitOfJoints(syntax.children.back(), node.signal.subjects, value.dimension);
  const SignalView view{names_.things(), names_.world(), names_.placed()};
  for (const ThingId subject : node.signal.subjects) {
    if (error_ || !std::isnan(column.number(view, subject - node.signal.first))) continue;
    Fail(syntax, "found '" + name + "' of " + table.singular + " " + names_.things().name(subject) +
                     ", which has none, expected " + table.name + " that have one");
  }
  if (error_) return {};
  value.node = Add(std::move(node));
  return value;
}

// An inner variable hides an outer one, and a variable hides a thing of its name.
std::optional<Compiler::ThingArgument> Compiler::FindThing(const Syntax& argument, const Kinds& kinds) {
  const auto check = [&](std::size_t kind) {
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return;
    Fail(argument,
         "found '" + argument.name + "', which is " + NameOfKinds({kind}) + ", expected " + NameOfKinds(kinds));
  };
  if (argument.kind == SyntaxKind::kName) {
    for (auto scoped = scoped_.rbegin(); scoped != scoped_.rend(); ++scoped) {
      if (scoped->name != argument.name) continue;
      check(scoped->kind);
      return ThingArgument{scoped->variable, 0, scoped->kind};
    }
  }
  if (argument.kind != SyntaxKind::kName && argument.kind != SyntaxKind::kText) return std::nullopt;
  for (const Kinds& some : {kinds, KindsOf('t')}) {
    for (const std::size_t kind : some) {
      const std::optional<ThingId> thing = names_.things().Find(argument.name, kind);
      if (!thing) continue;
      check(kind);
      return ThingArgument{{}, *thing, kind};
    }
  }
  return std::nullopt;
}

Compiler::ThingArgument Compiler::Thing(const Syntax& argument, const Kinds& kinds) {
  if (const std::optional<ThingArgument> found = FindThing(argument, kinds)) return *found;
  std::vector<std::string> names;
  for (const Scoped& scoped : scoped_) names.push_back(scoped.name);
  for (std::string& name : names_.NamesOf(kinds)) names.push_back(std::move(name));
  Fail(WorldNames::Unknown(argument, "a variable or " + NameOfKinds(kinds), names));
  return {};
}

void Compiler::PlainArgument(const Syntax& argument, char parameter, SignalUse& signal) {
  const bool is_named = argument.kind == SyntaxKind::kName || argument.kind == SyntaxKind::kText;
  if (parameter == 'l') {
    const Unit* const unit = argument.number.unit.empty() ? nullptr : FindUnit(argument.number.unit);
    const bool is_length =
        argument.kind == SyntaxKind::kNumber && (unit == nullptr || unit->dimension == Dimension{1, 0, 0, 0});
    if (!is_length) Fail(argument, "found something else, expected a length such as 0.2 m");
    signal.number = argument.number.value * (unit == nullptr ? 1.0 : unit->factor);
    return;
  }
  if (parameter == 'p') {
    const NamedPlace* const place = is_named ? names_.FindPlace(argument.name) : nullptr;
    if (place == nullptr) {
      Fail(WorldNames::Unknown(argument, "a place", names_.PlaceNames()));
      return;
    }
    signal.point = place->X_WN.translation();
    signal.floor = names_.FloorAt(place->X_WN.z);
    return;
  }
  if (parameter == 'g') {
    const NamedRegion* const region = is_named ? names_.FindRegion(argument.name) : nullptr;
    if (region == nullptr) {
      Fail(WorldNames::Unknown(argument, "a region", names_.RegionNames()));
      return;
    }
    signal.region = region->outline;
    if (region->z) signal.floor = names_.FloorAt(*region->z);
    return;
  }
  if (parameter == 'e') {
    EventArgument(argument, signal);
    return;
  }
  if (argument.kind != SyntaxKind::kText) {
    Fail(argument, "found something else, expected a text in quotes");
    return;
  }
  if (parameter == 'x') signal.text = argument.name;
}

void Compiler::EventArgument(const Syntax& argument, SignalUse& signal) {
  const auto type = argument.kind == SyntaxKind::kNumber ? std::nullopt : FindByName<EventType>(argument.name);
  if (type) {
    signal.event = *type;
  } else {
    Fail(WorldNames::Unknown(argument, "a type of event", AllNames<EventType>()));
  }
}

// Distances are computed to outlines, which a dense bitmap has not.
bool Compiler::IsWholeStaticModel(const Syntax& argument, ModelId model) {
  const WorldDescription& world = names_.world();
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (!IsInTree(world, ModelId(i), model) || !world.shape(world.models[i].shape).area) continue;
    Fail(argument, "found the dense map '" + argument.name + "', expected a model with an outline");
    return false;
  }
  for (const std::size_t kind : KindsOf('b')) {
    const ThingId first = names_.things().first(kind);
    for (ThingId body = first; body < first + names_.things().count(kind); ++body) {
      if (!IsInTree(world, model, names_.things().model(body).value())) continue;
      Fail(argument, "found a part of '" + names_.things().name(body) + "', expected the " +
                         StateTables()[kind].singular + " as a whole");
      return false;
    }
  }
  return true;
}

// The second argument of distance: a body, a static model or a place.
std::optional<Compiler::ThingArgument> Compiler::DistanceTarget(const Syntax& argument, SignalUse& signal) {
  const Kinds bodies = KindsOf('b');
  if (argument.kind == SyntaxKind::kName || argument.kind == SyntaxKind::kText) {
    const bool is_variable =
        argument.kind == SyntaxKind::kName &&
        std::any_of(scoped_.begin(), scoped_.end(), [&](const Scoped& scoped) { return scoped.name == argument.name; });
    if (is_variable) return FindThing(argument, bodies);
    for (const std::size_t kind : bodies) {
      if (const std::optional<ThingId> body = names_.things().Find(argument.name, kind)) {
        return ThingArgument{{}, *body, kind};
      }
    }
    if (const NamedPlace* const place = names_.FindPlace(argument.name)) {
      signal.point = place->X_WN.translation();
      signal.floor = names_.FloorAt(place->X_WN.z);
      return std::nullopt;
    }
    if (const std::optional<ModelId> model = names_.FindStaticModel(argument.name)) {
      if (IsWholeStaticModel(argument, *model)) signal.model = *model;
      return std::nullopt;
    }
  }
  std::vector<std::string> names = names_.NamesOf(bodies);
  for (std::string& name : names_.PlaceNames()) names.push_back(std::move(name));
  for (const ModelDescription& model : names_.world().models) {
    if (!model.removed && !model.parent) names.push_back(model.name);
  }
  Fail(WorldNames::Unknown(argument, "a variable, robot, object, person, model or place", names));
  return std::nullopt;
}

// The letters of the parameters decide how each argument is read; those behind '?' may be missing.
TypedValue Compiler::RunSignal(const Syntax& syntax, const SignalInfo& info) {
  const std::string_view parameters = info.parameters;
  const std::size_t optional = parameters.find('?');
  const std::vector<Syntax>& arguments = syntax.children;
  if (arguments.size() < info.least() || arguments.size() > info.most()) {
    return Fail(syntax, "found " + std::to_string(arguments.size()) + " arguments of '" + syntax.name + "', expected " +
                            info.usage);
  }
  Node node;
  node.op = Op::kSignal;
  node.signal.kind = info.kind;
  if (info.kind == SignalKind::kHash) {
    TypedValue value{0, ValueType::kText};
    value.read = std::make_shared<const Node>(std::move(node));
    return value;
  }
  if (info.kind == SignalKind::kAt) node.signal.number = 0.2;
  std::vector<ThingArgument> things;
  const Syntax* sensor = nullptr;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const char parameter = parameters[i + (i >= optional ? 1 : 0)];
    if (parameter == 'd') {
      if (const std::optional<ThingArgument> body = DistanceTarget(arguments[i], node.signal)) things.push_back(*body);
    } else if (std::string_view("robmt").find(parameter) != std::string_view::npos) {
      things.push_back(Thing(arguments[i], KindsOf(parameter)));
    } else {
      PlainArgument(arguments[i], parameter, node.signal);
      if (parameter == 's') sensor = &arguments[i];
    }
    if (error_) return {};
  }
  SetLanes(things, node);
  if (!error_) FindDevices(syntax, info, sensor, node.signal);
  if (error_) return {};
  return {Add(std::move(node)), info.type, info.dimension};
}

// A node has a lane for each combination of the things of its variables; a constant thing is the same in all lanes.
void Compiler::SetLanes(const std::vector<ThingArgument>& things, Node& node) {
  for (const ThingArgument& thing : things) {
    if (thing.variable) node.variables.push_back(*thing.variable);
  }
  std::sort(node.variables.begin(), node.variables.end());
  node.variables.erase(std::unique(node.variables.begin(), node.variables.end()), node.variables.end());
  node.lanes = Lanes(node.variables);
  if (error_) return;
  for (std::size_t i = 0; i < things.size(); ++i) {
    std::vector<ThingId>& by_lane = i == 0 ? node.signal.subjects : node.signal.others;
    if (!things[i].variable) {
      by_lane.assign(node.lanes, things[i].thing);
      continue;
    }
    by_lane = LaneMap(node.variables, {*things[i].variable}, node.lanes);
    for (ThingId& thing : by_lane) thing = program_.variables[*things[i].variable].things[thing];
  }
}

std::size_t Compiler::FindParts(const Syntax& part, const Kinds& kinds, std::vector<ThingId>& robots) {
  if (part.kind != SyntaxKind::kText) {
    Fail(part, "found something else, expected the name of " + NameOfKinds(kinds) + " in quotes");
    return kinds.front();
  }
  std::optional<std::size_t> kind;
  for (ThingId& thing : robots) {
    thing = Checked(names_.FindPart(thing, kind ? Kinds{*kind} : kinds, part));
    if (error_) break;
    kind = names_.things().kind_of(thing);
  }
  return kind.value_or(kinds.front());
}

void Compiler::FindDevices(const Syntax& syntax, const SignalInfo& info, const Syntax* sensor, SignalUse& signal) {
  const bool is_of_sensors = info.kind == SignalKind::kRange || info.kind == SignalKind::kMeanRange ||
                             info.kind == SignalKind::kPressed || info.kind == SignalKind::kHeard;
  if (info.kind != SignalKind::kAlive && !is_of_sensors) return;
  const Things& things = names_.things();
  for (ThingId& subject : signal.subjects) {
    if (error_) return;
    if (info.kind == SignalKind::kAlive) {
      signal.parts.push_back(names_.FindFiniteStore(subject));
    } else if (things.kind_of(subject) == RobotKind()) {
      signal.parts.push_back(Checked(names_.FindSensor(subject, info.kind, sensor, syntax)));
    } else if (sensor != nullptr) {
      Fail(*sensor,
           "found the name of a sensor behind sensor " + things.name(subject) + ", expected it behind a robot");
    } else {
      const SensorPlace place = Checked(names_.FindSensor(subject, info.kind, syntax));
      subject = static_cast<ThingId>(place.robot.index());
      signal.parts.push_back(static_cast<std::uint32_t>(place.sensor));
    }
  }
}

// Joints shift (m) or turn (rad): one signal has one unit.
void Compiler::SetUnitOfJoints(const Syntax& at, const std::vector<ThingId>& joints, Dimension& dimension) {
  if (dimension.metre == 0 || joints.empty()) return;
  const ThingId first = names_.things().first(KindOf("joints"));
  const auto turns = [&](ThingId joint) { return names_.world().joints[joint - first].type == JointType::kRevolute; };
  const bool all_turn = turns(joints.front());
  for (const ThingId joint : joints) {
    if (turns(joint) == all_turn) continue;
    Fail(at, "found joints that turn and joints that shift, expected joints of one unit");
    return;
  }
  if (all_turn) std::swap(dimension.radian, dimension.metre);
}

}  // namespace troupe
