#include "viewer/gateway/page_request.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "common/base/json.h"
#include "transport/protocol/message_texts.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMaxPosition = std::uint64_t{1} << 53;

Error Malformed(const std::string& found, const std::string& expected) {
  return {{}, "found " + found + ", expected " + expected};
}

// Empty if the object has no text of that name.
std::string TextIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  return member != object.end() && member->is_string() ? member->get<std::string>() : std::string();
}

std::optional<std::uint64_t> WholeNumberIn(const Json& object, const char* key) {
  const auto member = object.find(key);
  if (member == object.end() || !member->is_number_unsigned()) return std::nullopt;
  return member->get<std::uint64_t>();
}

// A model of the run's world file, and no file.
bool IsModelName(const std::string& source) {
  if (source.empty() || source.find_first_of("/#") != std::string::npos) return false;
  for (const char* ending : {".world", ".inc", ".json", ".yaml", ".yml"}) {
    if (source.ends_with(ending)) return false;
  }
  return true;
}

// Reads rows of requests from JSON, by their fields: a pose, a twist and a point are lists of their numbers, another
// row is an object. Its texts, flags, lists and optional values may be missing.
class FieldReader {
 public:
  template <typename Row>
  Status Read(const Json& object, Row& row) {
    if (ReadMembers(object, row)) return {};
    return Malformed("no valid '" + path_ + "'", expected_);
  }

 private:
  template <typename Part>
  static constexpr bool kIsNumbers = std::is_same_v<Part, Pose> || std::is_same_v<Part, Twist>;
  // A goal is numbered by the service. A light is switched on or off by no default.
  template <typename Row, typename Part>
  static constexpr bool kIsRequired =
      kIsNumbers<Part> || std::is_same_v<Part, double> ||
      (std::is_same_v<Part, bool> && std::is_same_v<Row, control::Light>) || std::is_same_v<Part, std::uint64_t> ||
      (std::is_same_v<Part, std::size_t> && !std::is_same_v<Row, Goal>);

  template <typename Row>
  bool ReadMembers(const Json& object, Row& row) {
    return std::apply(
        [&](const auto&... field) {
          return (... && (ReadMember(object, field, row) || FailAt(std::string(field.name))));
        },
        kFields<Row>);
  }

  template <typename Row, typename Part>
  bool ReadMember(const Json& object, const Field<Row, Part>& field, Row& row) {
    const auto member = object.find(std::string(field.name));
    if (member != object.end()) return ReadValue(*member, field.Of(row));
    return !kIsRequired<Row, Part> || Expect("a value");
  }

  template <typename Value>
  bool ReadValue(const Json& json, Value& value) {
    if constexpr (kIsOptional<Value>) {
      return ReadValue(json, value.emplace());
    } else if constexpr (kIsNumbers<Value>) {
      constexpr std::size_t kCount = kMemberCount<Value>;
      if (!json.is_array() || json.size() != kCount) return Expect(std::to_string(kCount) + " numbers");
      std::size_t next = 0;
      return std::apply([&](const auto&... field) { return (... && ReadValue(json[next++], field.Of(value))); },
                        kFields<Value>);
    } else if constexpr (std::is_same_v<Value, Vec2>) {
      if (!json.is_array() || json.size() != 2) return Expect("two coordinates");
      return ReadValue(json[0], value.x()) && ReadValue(json[1], value.y());
    } else if constexpr (HasFields<Value>) {
      return json.is_object() ? ReadMembers(json, value) : Expect("an object");
    } else if constexpr (kIsList<Value>) {
      if (!json.is_array()) return Expect("a list");
      value.resize(json.size());
      for (std::size_t i = 0; i < value.size(); ++i) {
        if (!ReadValue(json[i], value[i])) return FailAt(std::to_string(i));
      }
      return true;
    } else if constexpr (std::is_same_v<Value, std::string>) {
      if (!json.is_string()) return Expect("a text");
      value = json.get<std::string>();
      return true;
    } else if constexpr (std::is_same_v<Value, bool>) {
      if (!json.is_boolean()) return Expect("true or false");
      value = json.get<bool>();
      return true;
    } else if constexpr (std::is_same_v<Value, double>) {
      if (!json.is_number() || !std::isfinite(json.get<double>())) return Expect("a finite number");
      value = json.get<double>();
      return true;
    } else {
      constexpr std::uint64_t kMax = std::min<std::uint64_t>(std::numeric_limits<Value>::max(), kMaxPosition);
      if (!json.is_number_unsigned() || json.get<std::uint64_t>() > kMax) return Expect("a whole number");
      value = static_cast<Value>(json.get<std::uint64_t>());
      return true;
    }
  }

  bool Expect(std::string expected) {
    expected_ = std::move(expected);
    return false;
  }
  bool FailAt(const std::string& part) {
    path_ = part + (path_.empty() ? "" : ".") + path_;
    return false;
  }

  std::string path_;
  std::string expected_;
};

template <typename Request, typename... Listed>
constexpr bool kIsAmong = (... || std::is_same_v<Request, Listed>);

// The requests that the page may send: none that names files or libraries, which only the owner of the run does. A new
// request is not of the page until it stands here.
template <typename Request>
constexpr bool kMayPageSend =
    kIsAmong<Request, control::GetStatus, control::Pause, control::Play, control::Step, control::Reset, control::Spawn,
             control::Delete, control::SetPose, control::Entities, control::Spawnables, control::Speed,
             control::CommandRobot, control::Restore, control::Rewind, control::Door, control::Lift, control::Light>;

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
Status ReadRequest(const Json& object, control::Speed& speed) {
  if (TextIn(object, "speed") == "max") return {};
  const Status read = FieldReader().Read(object, speed);
  return speed.speed ? read : Status(Malformed("no speed", "a number or \"max\""));
}
template <typename Request>
Status ReadRequest(const Json& object, Request& request) {
  const Status read = FieldReader().Read(object, request);
  return read.ok() ? RestrictToPage(request) : read;
}

template <std::size_t... I>
Status ReadNamed(const std::string& name, const Json& object, control::Request& request, std::index_sequence<I...>) {
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

Result<PageControl> DecodeControl(std::uint64_t id, const std::string& name, const Json& object) {
  PageControl control{id, {}};
  constexpr auto kRequests = std::make_index_sequence<std::variant_size_v<control::Request>>();
  if (Status malformed = ReadNamed(name, object, control.request, kRequests); !malformed.ok()) return malformed.error();
  return control;
}

Result<PageRequest> ParseSelect(const Json& object) {
  SelectRequest select;
  select.pictures = TextIn(object, "pictures");
  const auto robots = object.find("robots");
  if (robots == object.end()) return Malformed("no robots", "names, or \"all\"");
  if (robots->is_string() && robots->get<std::string>() == "all") {
    select.all = true;
    return PageRequest(std::move(select));
  }
  if (!robots->is_array() || robots->size() > kMaxSelected) return Malformed("no list of robots", "up to 64 names");
  for (const Json& robot : *robots) {
    if (!robot.is_string()) return Malformed("a robot without a name", "a text");
    select.robots.push_back(robot.get<std::string>());
  }
  return PageRequest(std::move(select));
}

Result<PageRequest> ParseEdit(const Json& object) {
  const auto id = WholeNumberIn(object, "id");
  if (!id || TextIn(object, "op").empty()) return Malformed("an edit", "an id and an op");
  return PageRequest(PageEdit{*id, DecodeEditOperation(object)});
}

Result<PageRequest> ParseSeek(const Json& object) {
  const SeekRequest seek{WholeNumberIn(object, "position"), WholeNumberIn(object, "tick")};
  if (seek.position.has_value() == seek.tick.has_value()) return Malformed("a seek", "a position or a tick");
  PageRequest request;
  request.emplace<SeekRequest>(seek);
  return request;
}

Result<PageRequest> ParseSeries(const Json& object) {
  SeriesRequest series;
  const auto id = WholeNumberIn(object, "id");
  const auto from = WholeNumberIn(object, "from");
  const auto to = WholeNumberIn(object, "to");
  const auto every = WholeNumberIn(object, "every");
  if (!id || !from || !to || !every || *every == 0 || *from > kMaxPosition || *every > kMaxPosition) {
    return Malformed("a series", "an id, from, to and every");
  }
  series.id = *id;
  series.from = *from;
  series.to = *to;
  series.every = *every;
  const auto signals = object.find("signals");
  if (signals == object.end() || !signals->is_array() || signals->size() > kMaxSignals) {
    return Malformed("no signals", "a list of up to 32");
  }
  for (const Json& signal : *signals) {
    const bool is_pair = signal.is_array() && signal.size() == 2 && signal[0].is_string() && signal[1].is_string();
    if (!is_pair) return Malformed("a signal", "the names of a thing and of its signal");
    series.signals.push_back({signal[0].get<std::string>(), signal[1].get<std::string>()});
  }
  return PageRequest(std::move(series));
}

}  // namespace

Result<PageRequest> ParsePageRequest(std::string_view text, std::size_t longest) {
  if (text.size() > longest) return Malformed("a long text", std::to_string(longest) + " bytes at most");
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return Malformed("a text", "a JSON object");
  const std::string type = TextIn(object, "type");
  if (type == "edit") return ParseEdit(object);
  if (text.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  if (type == "select") return ParseSelect(object);
  if (type == "control") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    Result<PageControl> control = DecodeControl(*id, TextIn(object, "command"), object);
    if (!control.ok()) return control.error();
    return PageRequest(std::move(control).value());
  }
  if (type == "seek") return ParseSeek(object);
  if (type == "live") {
    PageRequest live;
    live.emplace<LiveRequest>();
    return live;
  }
  if (type == "series") return ParseSeries(object);
  if (type == "totals") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    return PageRequest(TotalsRequest{*id});
  }
  if (type == "expectations") {
    const auto id = WholeNumberIn(object, "id");
    if (!id) return Malformed("no id", "a whole number");
    return PageRequest(ExpectationsRequest{*id});
  }
  if (type == "run_again") {
    const auto id = WholeNumberIn(object, "id");
    const auto seed = WholeNumberIn(object, "seed");
    if (!id || (object.contains("seed") && !seed)) return Malformed("a new run", "an id, and a whole number as seed");
    RunAgainRequest again{*id, seed};
    if (const auto values = object.find("values"); values != object.end()) {
      again.values.emplace();
      if (!values->is_array()) return Malformed("a new run", "an array of values");
      for (const Json& value : *values) {
        if (!value.is_array() || value.size() != 2 || !value[0].is_string()) {
          return Malformed("a new run", "values as arrays of a path and a value");
        }
        again.values->emplace_back(value[0].get<std::string>(), value[1].dump());
      }
    }
    return PageRequest(std::move(again));
  }
  return Malformed("type '" + type + "'", "select, control, seek, live, series, totals, expectations or run_again");
}

Result<PageControl> ParseControl(std::uint64_t id, const std::string& command, std::string_view json) {
  if (json.size() > kMaxPageRequest) return Malformed("a long text", "at most 8192 bytes");
  Json object = Json::parse(json, nullptr, false);
  if (!object.is_object()) object = Json::object();
  return DecodeControl(id, command, object);
}

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
    }
    text["entities"] = std::move(entities);
  }
  return {id, done, problem, JsonText(text)};
}

Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

}  // namespace troupe
