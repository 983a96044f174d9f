#include "command_line/parse_command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "command_line/exit_status.h"
#include "common/base/closest_name.h"
#include "common/base/utf8.h"

namespace troupe {
namespace {

// The command of the command line that was recognized last: the program itself, or one of its (sub)commands.
const CLI::App& InnermostCommand(const CLI::App& app) {
  const CLI::App* innermost = &app;
  while (!innermost->get_subcommands().empty()) innermost = innermost->get_subcommands().back();
  return *innermost;
}

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

// "--name" of all options of the command, and of the commands around it.
std::vector<std::string> OptionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

bool IsOption(const std::string& argument) {
  return argument.size() > 1 && argument.front() == '-';
}

std::string UnknownOptions(const CLI::App& command, const std::vector<std::string>& options) {
  std::string text;
  for (const std::string& option : options) {
    const std::string name = option.substr(0, option.find('='));
    const auto closest = ClosestName(name, OptionNames(command));
    text += (text.empty() ? "" : ", ") + name + (closest ? " (did you mean " + *closest + "?)" : "");
  }
  std::string path = command.get_name();
  for (const CLI::App* app = command.get_parent(); app != nullptr; app = app->get_parent()) {
    path.insert(0, app->get_name() + " ");
  }
  return fmt::format("found the unknown {} {}; {} --help lists the options", options.size() == 1 ? "option" : "options",
                     text, path);
}

// Arguments that no command expects, in the order of the command line.
std::string UnknownArguments(const CLI::App& command, const std::vector<std::string>& unknown) {
  const std::vector<std::string> commands = CommandNames(command);
  if (commands.empty()) {
    return fmt::format("found '{}', expected no further argument", fmt::join(unknown, "' '"));
  }
  return fmt::format("found the command '{}', expected one of {}{}", unknown.front(), fmt::join(commands, ", "),
                     DidYouMean(unknown.front(), commands));
}

// An unknown option is the likely cause of other errors: its value looks like a further argument.
std::string MessageOf(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining(true);
  std::vector<std::string> options = unknown;
  std::erase_if(options, [](const std::string& argument) { return !IsOption(argument); });
  if (!options.empty()) return UnknownOptions(InnermostCommand(app), options);
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const bool extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if ((missing || extra) && !unknown.empty()) return UnknownArguments(InnermostCommand(app), unknown);
  return error.what();
}

}  // namespace

std::optional<int> ParseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << PlainLine(MessageOf(app, error)) << "\n";
    return kExitBadInput;
  }
}

int RunProgram(int (*run)(int argc, const char* const* argv), int argc, const char* const* argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit fails, as on a full disk
  try {
    return run(argc, argv);
  } catch (const std::exception& exception) {
    std::cerr << FailureOf(exception).ToString() << "\n";
    return kExitFailed;
  }
}

}  // namespace troupe
