// `troupe completions`: what a shell needs to complete command lines of `troupe`, made from the declared commands and
// options, so that it cannot differ from them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command_line/parse_command_line.h"
#include "launcher/commands/commands.h"

namespace troupe {
namespace {

// What a completion needs of an option, in the terms of no shell.
struct OptionInfo {
  std::vector<std::string> names;  // with dashes; empty: a positional argument
  std::string help;
  std::string value;  // the name of its value in the help text; empty: a flag
  std::string words;  // the values, separated by spaces; empty: any
  bool file = false;  // the value is a path
};

struct CommandInfo {
  std::string path;  // "troupe ctl spawn"
  std::string help;
  std::vector<OptionInfo> options;    // also the options of the commands around it
  std::vector<CommandInfo> commands;  // its subcommands
};

// A list of words of OneOf (command_line/parse_command_line.h).
std::string WordsOf(CLI::Option& option) {
  try {
    return option.get_validator(0)->get_name();
  } catch (const CLI::OptionNotFound&) {
    return "";
  }
}

// A value is a path if the help text calls it so: the types of options in CLI11 do not tell.
OptionInfo Describe(CLI::Option& option) {
  OptionInfo info;
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  info.help = option.get_description();
  if (option.get_items_expected_max() == 0) return info;
  info.value = option.get_positional() ? option.get_name() : option.get_type_name();
  info.words = WordsOf(option);
  for (const char* path : {"FILE", "DIR", "PATH", "SOURCE"}) info.file |= info.value.starts_with(path);
  return info;
}

// Options of the commands around it may follow a command with fallthrough, as those of `ctl` follow its actions.
CommandInfo Describe(CLI::App& command, const std::string& around) {
  CommandInfo info{around + command.get_name(), command.get_description(), {}, {}};
  for (CLI::App* app = &command; app != nullptr; app = app->get_fallthrough() ? app->get_parent() : nullptr) {
    for (CLI::Option* option : app->get_options()) {
      if (option->get_group().empty()) continue;  // hidden: it is for programs
      if (app == &command || option->get_name() != "--help") info.options.push_back(Describe(*option));
    }
  }
  for (CLI::App* child : command.get_subcommands([](CLI::App*) { return true; })) {
    info.commands.push_back(Describe(*child, info.path + " "));
  }
  return info;
}

// The last word of its path.
std::string WordOf(const CommandInfo& command) {
  return command.path.substr(command.path.rfind(' ') + 1);
}

bool TakesFiles(const CommandInfo& command) {
  for (const OptionInfo& option : command.options) {
    if (option.names.empty() && option.file) return true;
  }
  return false;
}

void AppendWithChildren(const CommandInfo& command, std::vector<const CommandInfo*>& all) {
  all.push_back(&command);
  for (const CommandInfo& child : command.commands) AppendWithChildren(child, all);
}

std::vector<const CommandInfo*> AllOf(const CommandInfo& command) {
  std::vector<const CommandInfo*> all;
  AppendWithChildren(command, all);
  return all;
}

// The script finds the command by the words before the cursor, then completes the value of the option before it, and
// else the names of options and commands.
std::string Bash(const CommandInfo& troupe) {
  std::vector<std::string> commands;
  std::map<std::string, std::vector<std::string>> options;  // by what completes their values
  std::string words;
  for (const CommandInfo* command : AllOf(troupe)) {
    if (command != &troupe) commands.push_back('"' + command->path + '"');
    std::vector<std::string> choices;
    for (const CommandInfo& child : command->commands) choices.push_back(WordOf(child));
    for (const OptionInfo& option : command->options) {
      if (option.names.empty() && !option.words.empty()) choices.push_back(option.words);
      for (const std::string& name : option.names) {
        choices.push_back(name);
        if (option.value.empty()) continue;
        options[option.file ? "-f" : fmt::format("-W \"{}\"", option.words)].push_back(
            fmt::format("\"{} {}\"", command->path, name));
      }
    }
    words += fmt::format("    \"{}\") words=\"{}\"{} ;;\n", command->path, fmt::join(choices, " "),
                         TakesFiles(*command) ? " files=1" : "");
  }
  std::string values;
  for (const auto& [completion, names] : options) {
    values += fmt::format("    {}) mapfile -t COMPREPLY < <(compgen {} -- \"$current\"); return ;;\n",
                          fmt::join(names, " | "), completion);
  }
  return fmt::format(
      R"(# Completion of troupe for bash: source this file, or install it below bash-completion/completions.
_troupe() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} path=troupe words= files= word
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$path $word" in
      {}) path="$path $word" ;;
    esac
  done
  case "$path $before" in
{}  esac
  case "$path" in
{}  esac
  if [[ -n $files && $current != -* ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}}
complete -o filenames -F _troupe troupe
)",
      fmt::join(commands, " | "), values, words);
}

// Inside single quotes of a shell. zsh also takes brackets and colons of a description for its own.
std::string Quoted(const std::string& text, const std::string& special = "") {
  std::string quoted;
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      if (special.find(c) != std::string::npos) quoted += '\\';
      quoted += c;
    }
  }
  return quoted;
}

constexpr const char* kZshSpecial = "[]:\\";

// One function for each command, named for its path; zsh calls it by the word of the subcommand.
std::string ZshFunction(const CommandInfo& command) {
  std::string name = "_" + command.path;
  for (char& c : name) c = c == ' ' ? '_' : c;
  std::string text = fmt::format("{}() {{\n", name);
  if (!command.commands.empty()) {
    text += "  local -a commands=(\n";
    for (const CommandInfo& child : command.commands) {
      text += fmt::format("    '{}:{}'\n", WordOf(child), Quoted(child.help, kZshSpecial));
    }
    text += "  )\n";
  }
  text += "  _arguments -S -C";
  for (const OptionInfo& option : command.options) {
    if (option.names.empty() && !option.words.empty()) {
      text += fmt::format(" \\\n    ':{}:({})'", option.value, option.words);
    }
    for (const std::string& flag : option.names) {
      text += fmt::format(" \\\n    '{}[{}]", flag, Quoted(option.help, kZshSpecial));
      if (!option.value.empty()) {
        const std::string action = option.file ? "_files" : option.words.empty() ? " " : "(" + option.words + ")";
        text += fmt::format(":{}:{}", Quoted(option.value, kZshSpecial), action);
      }
      text += "'";
    }
  }
  if (command.commands.empty()) {
    if (TakesFiles(command)) text += " \\\n    '*:file:_files'";
    return text + "\n}\n";
  }
  text += " \\\n    '1:command:->command' '*::argument:->arguments'\n  case $state in\n";
  text +=
      fmt::format("    command) _describe command commands ;;\n    arguments) {}_${{words[1]}} ;;\n  esac\n}}\n", name);
  return text;
}

std::string Zsh(const CommandInfo& troupe) {
  std::string text = "#compdef troupe\n# Completion of troupe for zsh: as a file _troupe in a folder of fpath.\n";
  for (const CommandInfo* command : AllOf(troupe)) text += ZshFunction(*command);
  return text + "_troupe \"$@\"\n";
}

// True on a command line that has the words of the command's path, and none of its subcommands yet.
std::string FishCondition(const CommandInfo& command) {
  std::string condition;
  for (std::size_t at = command.path.find(' '); at != std::string::npos;) {
    const std::size_t end = command.path.find(' ', at + 1);
    condition += fmt::format("{}__fish_seen_subcommand_from {}", condition.empty() ? "" : "; and ",
                             command.path.substr(at + 1, end == std::string::npos ? end : end - at - 1));
    at = end;
  }
  if (command.commands.empty()) return condition;
  std::vector<std::string> names;
  for (const CommandInfo& child : command.commands) names.push_back(WordOf(child));
  return fmt::format("{}not __fish_seen_subcommand_from {}", condition.empty() ? "" : condition + "; and ",
                     fmt::join(names, " "));
}

std::string Fish(const CommandInfo& troupe) {
  std::string text = "# Completion of troupe for fish: as troupe.fish in a folder of fish_complete_path.\n";
  text += "complete -c troupe -f\n";
  for (const CommandInfo* command : AllOf(troupe)) {
    const std::string condition = FishCondition(*command);
    for (const CommandInfo& child : command->commands) {
      text += fmt::format("complete -c troupe -n '{}' -a {} -d '{}'\n", condition, WordOf(child), Quoted(child.help));
    }
    for (const OptionInfo& option : command->options) {
      if (option.names.empty()) {
        if (!option.words.empty()) text += fmt::format("complete -c troupe -n '{}' -a '{}'\n", condition, option.words);
        continue;
      }
      text += fmt::format("complete -c troupe -n '{}'", condition);
      for (const std::string& name : option.names) {
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (!option.value.empty()) text += option.file ? " -r -F" : fmt::format(" -x -a '{}'", option.words);
      text += fmt::format(" -d '{}'\n", Quoted(option.help));
    }
    if (TakesFiles(*command)) text += fmt::format("complete -c troupe -n '{}' -F\n", condition);
  }
  return text;
}

}  // namespace

void AddCompletionsCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("completions", "Print the completions of command lines for a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(OneOf({"bash", "zsh", "fish"}));
  command->final_callback([shell, &app, &exit_status] {
    const CommandInfo troupe = Describe(app, "");
    std::fputs((*shell == "bash" ? Bash(troupe) : *shell == "zsh" ? Zsh(troupe) : Fish(troupe)).c_str(), stdout);
    exit_status = kExitDone;
  });
}

}  // namespace troupe
