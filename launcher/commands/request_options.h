// The command line of a request of `troupe ctl`: an argument or option for each of its fields, with the name, the
// documentation and the limits of the field's line in transport/protocol/control_request.h.
//
// A type of values that no request had so far needs an overload of Add. The request must outlive the parsing.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "command_line/parse_command_line.h"
#include "common/run/run_settings.h"
#include "launcher/commands/commands.h"
#include "transport/protocol/control_request.h"

namespace troupe {

// "set_pose": "set-pose".
inline std::string WithDashes(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', '-');
  return text;
}

class RequestOptions {
 public:
  // `has_height`: becomes true if a pose of the command line has a height.
  RequestOptions(CLI::App& app, bool& has_height) : app_(app), has_height_(has_height) {}

  template <typename Request>
  void AddAll(Request& request) {
    ForEachField<Request>([&](const auto& field) { AddField(request, field, PlaceOf(field), WordOf(field)); });
  }

 private:
  template <typename Value>
  static constexpr bool kIsNumber = std::is_same_v<Value, std::optional<std::uint32_t>> ||
                                    (std::is_unsigned_v<Value> && !std::is_same_v<Value, bool>);

  template <typename Request, typename Part>
  void AddField(Request& request, const Field<Request, Part>& field, CtlPlace place, const std::string& word) {
    if (place == CtlPlace::kNone) return;
    const bool is_option = place == CtlPlace::kOption || std::is_same_v<Part, Pose>;
    const std::string name = is_option ? "--" + WithDashes(field.name) : word;
    CLI::Option* const option = Add(name, field.Of(request), field);
    option->description(HelpOf(field));
    if (place == CtlPlace::kRequired) option->required();
    if constexpr (std::is_same_v<Part, std::string> || kIsNumber<Part>) option->type_name(is_option ? word : "");
  }

  template <typename Request, typename Part>
  static CtlPlace PlaceOf(const Field<Request, Part>&) {
    return CtlPlace::kOption;
  }
  template <typename Request, typename Part>
  static CtlPlace PlaceOf(const RequestField<Request, Part>& field) {
    return field.place;
  }

  static std::string Capitals(std::string_view name) {
    std::string text(name);
    for (char& letter : text) letter = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    return text;
  }

  template <typename Request, typename Part>
  static std::string WordOf(const Field<Request, Part>& field) {
    return Capitals(field.name.substr(field.name.rfind('_') + 1));
  }
  template <typename Request, typename Part>
  static std::string WordOf(const RequestField<Request, Part>& field) {
    return field.word.empty() ? WordOf(static_cast<const Field<Request, Part>&>(field)) : std::string(field.word);
  }

  static std::string HelpOf(const FieldInfo& field) {
    const std::string help = Capitals(field.documentation.substr(0, 1)) + std::string(field.documentation.substr(1));
    return field.unit.empty() ? help : help + ", " + std::string(field.unit);
  }

  CLI::Option* Add(const std::string& name, std::string& value, const FieldInfo&) {
    return app_.add_option(name, value);
  }

  CLI::Option* Add(const std::string& name, Pose& value, const FieldInfo&) {
    const auto read = [name, &value, &has_height = has_height_](const std::string& text) {
      const Result<PoseText> pose = ParsePoseText(text);
      if (!pose.ok()) throw CLI::ValidationError(name, pose.error().message);
      value = pose.value().X_WE;
      has_height = pose.value().has_height;
    };
    return app_.add_option_function<std::string>(name, read)->type_name("X,Y[,Z],HEADING");
  }

  CLI::Option* Add(const std::string& name, bool& value, const FieldInfo&) {
    if (name.starts_with("--")) return app_.add_flag(name, value);
    const auto read = [&value](const std::string& text) { value = text == "on"; };
    return app_.add_option_function<std::string>(name, read)->check(OneOf({"on", "off"}))->type_name("on|off");
  }

  template <typename Value>
  requires std::unsigned_integral<Value> || std::same_as<Value, std::optional<std::uint32_t>> CLI::Option* Add(
      const std::string& name, Value& value, const FieldInfo& field) {
    const FieldLimits& limits = field.limits;
    const auto min = limits.has_min() ? static_cast<std::uint64_t>(limits.min) : 0;
    const auto max =
        limits.has_max() ? static_cast<std::uint64_t>(limits.max) : std::numeric_limits<std::uint64_t>::max();
    return app_.add_option(name, value)->check(WholeNumber(min, max));
  }

  // Of a speed: none is "max".
  CLI::Option* Add(const std::string& name, std::optional<double>& value, const FieldInfo&) {
    const auto read = [&value](const std::string& text) { value = ParseSpeed(text).value(); };
    return app_.add_option_function<std::string>(name, read)->check(SpeedValue())->type_name("X|max");
  }

  // The words for a closed and an open door or lane.
  CLI::Option* Add(const std::string& name, double& value, const FieldInfo& field) {
    if (field.name == "speed_limit") return AddLimit(name, value, field);
    const bool has_words = field.name == "opening";
    const auto number_in = [has_words, limits = field.limits](const std::string& text) -> std::optional<double> {
      if (has_words && text == "close") return limits.min;
      if (has_words && text == "open") return limits.max;
      double number = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      const bool is_number = error == std::errc() && end == text.data() + text.size() && limits.Contain(number);
      return is_number ? std::optional(number) : std::nullopt;
    };
    std::string expected = has_words ? "open, close or a number" : "a number";
    if (field.limits.has_min())
      expected += (field.limits.is_min_excluded ? " above " : " from ") + Text(field.limits.min);
    if (field.limits.has_max()) expected += " to " + Text(field.limits.max);
    const auto check = [number_in, expected](const std::string& text) {
      return number_in(text) ? std::string() : fmt::format("found '{}', expected {}", text, expected);
    };
    const auto read = [&value, number_in](const std::string& text) { value = number_in(text).value_or(value); };
    CLI::Option* const option = app_.add_option_function<std::string>(name, read);
    option->check(CLI::Validator(check, "", has_words ? "open close" : ""));
    return has_words ? option->type_name("open|close|0..1") : option->type_name("NUMBER");
  }

  // Of a lane: 0 is closed, and below 0 there is none.
  CLI::Option* AddLimit(const std::string& name, double& value, const FieldInfo& field) {
    const auto limit_in = [limits = field.limits](const std::string& text) -> std::optional<double> {
      if (text == "close") return 0.0;
      if (text == "open") return -1.0;
      double number = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      const bool is_number = error == std::errc() && end == text.data() + text.size();
      return is_number && number > 0.0 && limits.Contain(number) ? std::optional(number) : std::nullopt;
    };
    const auto check = [limit_in](const std::string& text) {
      return limit_in(text) ? std::string()
                            : fmt::format("found '{}', expected open, close or a speed above 0 m/s", text);
    };
    const auto read = [&value, limit_in](const std::string& text) { value = limit_in(text).value_or(value); };
    CLI::Option* const option = app_.add_option_function<std::string>(name, read);
    option->check(CLI::Validator(check, "", "open close"));
    return option->type_name("open|close|SPEED");
  }

  static std::string Text(double number) { return fmt::format("{}", number); }

  CLI::App& app_;
  bool& has_height_;
};

}  // namespace troupe
