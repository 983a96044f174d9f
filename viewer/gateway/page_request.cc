#include "viewer/gateway/page_request.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "common/base/json.h"
#include "transport/protocol/message_texts.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMaxPosition = std::uint64_t{1} << 53;  // all integers up to it are doubles

Error Malformed(const std::string& found, const std::string& expected) {
  return {{}, "found " + found + ", expected " + expected};
}

// A model of the run's world file, and no file.
// By its form: a name that could be a path or a file is refused, whether or not the file exists.
bool IsModelName(const std::string& source) {
  if (source.empty() || source.find_first_of("/#") != std::string::npos) return false;
  for (const char* ending : {".world", ".inc", ".json", ".yaml", ".yml"}) {
    if (source.ends_with(ending)) return false;
  }
  return true;
}

// Texts, flags, lists and optional values may be missing; numbers and poses may not. A light is switched on or off by
// no default.
template <typename Row, typename Part>
constexpr bool kIsRequired = std::is_same_v<Part, Pose> || std::is_same_v<Part, Twist> ||
                             std::is_same_v<Part, double> || std::is_same_v<Part, std::uint64_t> ||
                             (std::is_same_v<Part, bool> &&
                              (std::is_same_v<Row, control::Light> || std::is_same_v<Row, control::Zone>));

// The members of a request follow from its list of fields.
template <typename Row>
void ReadRow(const JsonReader& object, Row& row) {
  ForEachField<Row>([&]<typename Part>(const Field<Row, Part>& field) {
    if (kIsRequired<Row, Part> && !object.Has(field.name)) object.FailWithout(field.name, "a value");
  });
  object.To(row);
}

template <typename Request, typename... Listed>
constexpr bool kIsAmong = (... || std::is_same_v<Request, Listed>);

// The requests that the page may send: none that names files or libraries, which only the owner of the run does. A new
// request is not of the page until it stands here.
template <typename Request>
constexpr bool kMayPageSend =
    kIsAmong<Request, control::GetStatus, control::Pause, control::Play, control::Step, control::Reset, control::Spawn,
             control::Delete, control::SetPose, control::Entities, control::Spawnables, control::Speed,
             control::CommandRobot, control::Restore, control::Rewind, control::Door, control::Lift, control::Light,
             control::Lane, control::Zone>;

Status RestrictToPage(control::Spawn& spawn) {
  if (!IsModelName(spawn.source)) return Malformed("source '" + spawn.source + "'", "a model of the world file");
  if (NamesLibrary(spawn.controller)) return Malformed("a library as controller", "the name of a built-in one");
  // The name and the identity in ROS are those of the source.
  spawn = {.source = spawn.source, .pose = spawn.pose, .rename = true, .controller = spawn.controller};
  return {};
}
Status RestrictToPage(control::Reset& reset) {
  reset.scopes = kResetAll;
  return {};
}
Status RestrictToPage(control::Restore& restore) {
  if (restore.source.empty() || restore.name.empty()) return Malformed("no names", "source and name");
  return {};
}
Status RestrictToPage(control::Step& step) {
  return step.ticks > 0 && step.ticks <= kMaxCommandTicks ? Status() : Status(Malformed("no ticks", "1 to 1000000"));
}
Status RestrictToPage(control::CommandRobot& command) {
  if (command.twist || !command.grippers.empty() || command.goal) return {};
  return Malformed("an empty command", "a twist, grippers or a goal");
}
template <typename Request>
Status RestrictToPage(Request&) {
  return {};
}

// The page has "max" for no speed.
Status ReadRequest(const JsonReader& object, control::Speed& speed) {
  const std::optional<JsonReader> value = object.Find("speed");
  if (value && value->node().text == "max" && value->node().is_string()) return {};
  ReadRow(object, speed);
  if (!speed.speed) object.FailWithout("speed", "a number or \"max\"");
  return object.status();
}
template <typename Request>
Status ReadRequest(const JsonReader& object, Request& request) {
  ReadRow(object, request);
  return object.ok() ? RestrictToPage(request) : object.status();
}

template <std::size_t... I>
Status ReadNamed(const std::string& name, const JsonReader& object, control::Request& request,
                 std::index_sequence<I...>) {
  Status outcome = Malformed("command '" + name + "'", "a command of the page");
  const auto read_if = [&]<typename Request>(std::type_identity<Request>) {
    if constexpr (kMayPageSend<Request>) {
      if (name != Request::kName) return;
      outcome = ReadRequest(object, request.emplace<Request>());
      if (outcome.ok()) outcome = control::CheckRequest(request);
    }
  };
  (read_if(std::type_identity<std::variant_alternative_t<I, control::Request>>()), ...);
  return outcome;
}

// Commands of the page have the names of the requests (transport/protocol).
Result<PageControl> DecodeControl(std::uint64_t id, const std::string& name, const JsonReader& object) {
  PageControl control{id, {}};
  constexpr auto kRequests = std::make_index_sequence<std::variant_size_v<control::Request>>();
  if (Status malformed = ReadNamed(name, object, control.request, kRequests); !malformed.ok()) return malformed.error();
  return control;
}

SelectRequest ReadSelect(const JsonReader& object) {
  SelectRequest select;
  object.Read("pictures", select.pictures);
  object.Read("traffic", select.traffic);
  const std::optional<JsonReader> robots = object.Find("robots");
  if (!robots) {
    object.FailWithout("robots", "names, or \"all\"");
  } else if (robots->node().is_string() && robots->node().text == "all") {
    select.all = true;
  } else {
    robots->Items(kMaxSelected);
    robots->To(select.robots);
  }
  return select;
}

SeekRequest ReadSeek(const JsonReader& object) {
  const SeekRequest seek{object.Optional<std::uint64_t>("position"), object.Optional<Tick>("tick")};
  if (seek.position.has_value() == seek.tick.has_value()) object.Fail("either a position or a tick");
  return seek;
}

SeriesRequest ReadSeries(const JsonReader& object, std::uint64_t id) {
  SeriesRequest series{
      id, {}, object.Get<std::uint64_t>("from"), object.Get<std::uint64_t>("to"), object.Get<std::uint64_t>("every")};
  if (series.every == 0 || series.every > kMaxPosition || series.from > kMaxPosition) object.Fail("positions in range");
  const std::optional<JsonReader> signals = object.Find("signals");
  if (!signals) object.FailWithout("signals", "a list of pairs");
  for (const JsonReader& signal : signals ? signals->Items(kMaxSignals) : std::vector<JsonReader>()) {
    std::vector<std::string> names;
    if (signal.To(names) && names.size() != 2) signal.Fail("the names of a thing and of its signal");
    if (object.ok()) series.signals.push_back({names[0], names[1]});
  }
  return series;
}

RunAgainRequest ReadRunAgain(const JsonReader& object, std::uint64_t id) {
  RunAgainRequest again{id, object.Optional<std::uint64_t>("seed")};
  const std::optional<JsonReader> values = object.Find("values");
  if (!values) return again;
  again.values.emplace();
  for (const JsonReader& value : values->Items()) {
    const std::vector<JsonReader> pair = value.Items();
    if (pair.size() != 2 || !pair[0].node().is_string()) {
      value.Fail("a path and a value");
    } else {
      again.values->emplace_back(pair[0].node().text, ToJson(pair[1].node()).dump());
    }
  }
  return again;
}

// A request with an id of the page.
Result<PageRequest> ReadWithId(const std::string& type, const JsonReader& object) {
  PageRequest request;
  const auto id = object.Get<std::uint64_t>("id");
  if (type == "control") {
    Result<PageControl> control = DecodeControl(id, object.Get<std::string>("command"), object);
    if (!control.ok()) return control.error();
    request = std::move(control).value();
  } else if (type == "series") {
    request = ReadSeries(object, id);
  } else if (type == "totals") {
    request = TotalsRequest{id};
  } else if (type == "expectations") {
    request = ExpectationsRequest{id};
  } else if (type == "vehicle") {
    request = VehicleRequest{id, object.Get<std::string>("robot"), object.Get<std::uint64_t>("position")};
  } else if (type == "run_again") {
    request = ReadRunAgain(object, id);
  } else {
    return Malformed("type '" + type + "'",
                     "select, control, seek, live, series, totals, expectations, vehicle or run_again");
  }
  return request;
}

Result<PageRequest> ReadPageRequest(const std::string& type, const JsonReader& object) {
  if (type == "select") return PageRequest(ReadSelect(object));
  if (type == "seek") return PageRequest(ReadSeek(object));
  if (type == "live") return PageRequest(LiveRequest());
  return ReadWithId(type, object);
}

}  // namespace

// The length is checked before the text is parsed.
Result<PageRequest> ParsePageRequest(std::string_view text, std::size_t longest) {
  if (text.size() > longest) return Malformed("a long text", std::to_string(longest) + " bytes at most");
  const JsonReader object = JsonReader::OfText(text);
  const auto type = object.Get<std::string>("type");
  if (type == "edit") {
    const auto id = object.Get<std::uint64_t>("id");
    if (object.Get<std::string>("op").empty()) object.FailWithout("op", "an operation");
    if (!object.ok()) return object.status().error();
    return PageRequest(PageEdit{id, DecodeEditOperation(object)});
  }
  if (text.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  Result<PageRequest> request = ReadPageRequest(type, object);
  if (!object.ok()) return object.status().error();
  return request;
}

Result<PageControl> ParseControl(std::uint64_t id, const std::string& command, std::string_view json) {
  if (json.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  return DecodeControl(id, command, JsonReader::OfText(json.empty() ? "{}" : json));
}

// `conflict`: the page offers to overwrite the file.
PageReply ReplyToEdit(std::uint64_t id, const Result<Json>& reply) {
  Json text = reply.ok() ? reply.value() : Json::object();
  const std::string problem = reply.ok() ? "" : reply.error().message;
  text["type"] = "reply";
  text["id"] = id;
  text["done"] = reply.ok();
  text["problem"] = problem;
  if (!reply.ok()) text["conflict"] = reply.error().code == ErrorCode::kNoRoom;
  return {id, reply.ok(), problem, JsonText(text)};
}

PageReply ReplyToControl(std::uint64_t id, const Result<ControlReply>& reply) {
  const bool done = reply.ok() && reply.value().done;
  const std::string& problem = reply.ok() ? reply.value().problem : reply.error().message;
  Json text = {{"type", "reply"}, {"id", id}, {"done", done}, {"problem", problem}};
  if (reply.ok()) {
    text["state"] = NameOf(reply.value().state);
    text["tick"] = reply.value().tick;
    Json entities = Json::array();
    for (const EntityReport& entity : reply.value().entities) {
      Json& listed = entities.emplace_back(Json{{"name", entity.name}, {"type", entity.type}});
      if (entity.agent) listed["agent"] = FieldsToJson<Json>(*entity.agent);
      if (!entity.signals.empty()) listed["signals"] = entity.signals;
    }
    text["entities"] = std::move(entities);
  }
  return {id, done, problem, JsonText(text)};
}

Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

}  // namespace troupe
