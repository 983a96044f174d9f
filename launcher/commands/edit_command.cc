#include <fmt/format.h>
#include <poll.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/process/process.h"
#include "viewer/editor/edit_link.h"
#include "viewer/gateway/access.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {
namespace {

struct EditOptions {
  std::string file;
  std::string listen;                // text for ParseListen; empty: the default
  std::vector<std::string> allowed;  // files and folders
  bool view_only = false;
};

// The token is always there: the page can write files of this user.
int EditCommand(const EditOptions& options) {
  SignalWatch signals;
  try {
    Result<std::unique_ptr<Editor>> editor = Editor::Open(options.file, options.allowed);
    if (!editor.ok()) return Fail(editor.error());
    const std::string file = editor.value()->path();
    if (file != options.file) {
      PrintPlain(stdout, "{} stays as it is: its edits are kept in the scenario {}\n", options.file, file);
    }
    EditLink link(std::move(editor).value());
    ViewerGatewayOptions gateway_options;
    gateway_options.session = std::filesystem::path(file).filename().string();
    gateway_options.token = MakeToken();
    gateway_options.editor = true;
    gateway_options.view_only = options.view_only;
    if (const std::optional<ListenAddress> listen = ParseListen(options.listen)) {
      gateway_options.address = listen->address;
      gateway_options.port = listen->port;
      gateway_options.any_port = false;
    }
    const Result<std::unique_ptr<ViewerGateway>> gateway = ViewerGateway::Start(gateway_options, link);
    if (!gateway.ok()) return Fail(gateway.error());
    fmt::print("editor: {}\n", gateway.value()->Address());
    std::fflush(stdout);
    pollfd waited = {signals.descriptor(), POLLIN, 0};
    while (!signals.ReadStopRequest()) poll(&waited, 1, -1);
    if (link.has_unsaved_edits()) PrintPlain(stderr, "{}: warning: the last edits were not saved\n", file);
    return kExitDone;
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace

void AddEditCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("edit", "Edit a world, a scenario or models in a browser");
  const auto options = std::make_shared<EditOptions>();  // lives as long as the command
  command
      ->add_option("FILE", options->file,
                   "A Stage world (.world), models (.inc) or a JSON scenario (.json), new if it does not exist; or a "
                   "world of another format, whose edits are kept in a scenario beside it")
      ->required()
      ->check(NotEmpty());
  AddListenOption(*command, options->listen);
  command
      ->add_option(
          "--allow-files", options->allowed,
          "A file or folder that the edited text may name, beside the folders of FILE and of the files that it "
          "names already, and the installed models; may be repeated")
      ->check(NotEmpty())
      ->type_name("PATH")
      ->allow_extra_args(false);
  command->add_flag("--view-only", options->view_only, "Refuse requests that change the file");
  command->final_callback([options, &exit_status] { exit_status = EditCommand(*options); });
}

}  // namespace troupe
