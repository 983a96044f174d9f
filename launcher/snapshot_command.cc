#include "launcher/snapshot_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "common/command_line/exit_status.h"
#include "common/command_line/option_checks.h"
#include "common/picture/draw_picture.h"
#include "common/worldfile/load_world.h"
#include "launcher/check_controllers.h"
#include "launcher/command_failure.h"
#include "launcher/run_to_tick.h"

namespace troupe {
namespace {

Result<PictureFormat> FormatOf(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  const std::string ending = dot == std::string::npos ? "" : name.substr(dot);
  if (ending == ".png") return PictureFormat::kPng;
  if (ending == ".svg") return PictureFormat::kSvg;
  const std::string found = ending.empty() ? "no file ending" : "the file ending '" + ending + "'";
  return Error{{path, 0, 0}, "found " + found + ", expected .png or .svg"};
}

Error CannotWrite(const std::string& path) {
  return {{path, 0, 0}, std::string("cannot write: ") + std::strerror(errno)};
}

// Opens without changing what is there, so that a run that fails later leaves an older picture alone.
Status CheckWritable(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr) return CannotWrite(path);
  std::fclose(file);
  return std::nullopt;
}

Status WriteFile(const std::string& path, const std::string& bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return CannotWrite(path);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const bool closed = std::fclose(file) == 0;
  return written && closed ? Status() : CannotWrite(path);
}

PictureOptions ToPictureOptions(const SnapshotOptions& options, PictureFormat format) {
  PictureOptions picture;
  picture.view = options.view == "side" ? PictureView::kSide : PictureView::kTop;
  picture.format = format;
  picture.width = options.width;
  picture.meters = options.meters;
  if (options.center.size() == 2) picture.center = Vec2(options.center[0], options.center[1]);
  return picture;
}

}  // namespace

void AddSnapshotCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("snapshot", "Draw a world at one tick");
  const auto options = std::make_shared<SnapshotOptions>();  // lives as long as the command
  command->add_option("FILE", options->file, "A Stage .world file, a JSON scenario or a ROS map .yaml")->required();
  command->add_option("-o,--output", options->output, "The picture; its ending, .png or .svg, says which kind")
      ->required()
      ->type_name("FILE");
  command->add_option("--tick", options->tick, "Run to this tick first (default: 0, the world as loaded)")
      ->check(WholeNumber(0))
      ->type_name("N");
  command->add_option("--view", options->view, "top, or side: seen along +y (default: top)")
      ->check(OneOf({"top", "side"}))
      ->type_name("VIEW");
  command->add_flag("--rays", options->rays, "Draw what all rangers measure");

  const char* part = "Part of the world";
  command->add_option("--center", options->center, "Its middle, m (default: the world's middle)")
      ->expected(2)
      ->type_name("X Y")
      ->group(part);
  command->add_option("--meters", options->meters, "Its width, m; a side view shows as much to the front and back")
      ->type_name("W")
      ->group(part);
  command->add_option("--width", options->width, "Width of the picture (default: up to 1000 pixels)")
      ->check(WholeNumber(kMinPictureWidth, kMaxPictureWidth))
      ->type_name("PIXELS")
      ->group(part);

  const char* run = "Run";
  command->add_option("--seed", options->seed, "Seed of all random numbers")
      ->check(WholeNumber(0))
      ->type_name("S")
      ->group(run);
  command->add_option("--controller", options->controller, "Controller of the robots that the file gives none")
      ->type_name("NAME")
      ->group(run);
  command->final_callback([options, &exit_status] { exit_status = SnapshotCommand(*options); });
}

int SnapshotCommand(const SnapshotOptions& options) {
  const Result<PictureFormat> format = FormatOf(options.output);
  if (!format.ok()) return Fail(kExitBadInput, format.error());
  const PictureOptions picture_options = ToPictureOptions(options, format.value());
  if (const Status problem = CheckPictureOptions(picture_options)) return Fail(kExitBadInput, *problem);

  if (const Status problem = CheckControllers(options.file, options.controller)) return Fail(kExitBadInput, *problem);
  LoadOverrides overrides;
  overrides.seed = options.seed;
  if (!options.controller.empty()) overrides.controller = options.controller;
  Result<LoadedWorld> loaded = LoadWorld(options.file, overrides);
  if (!loaded.ok()) return Fail(kExitBadInput, loaded.error());
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());
  if (const Status problem = CheckWritable(options.output)) return Fail(kExitBadInput, *problem);

  const Scene scene(std::move(loaded.value().world));
  std::vector<std::string> failures;
  const Result<WorldState> state = RunToTick(scene, options.tick, failures);
  if (!state.ok()) return Fail(kExitBadInput, state.error());
  for (const std::string& failure : failures) fmt::print(stderr, "warning: {}\n", failure);

  const std::vector<ScanFan> fans = options.rays ? MeasureFans(scene, state.value()) : std::vector<ScanFan>();
  const Result<std::string> bytes = DrawPicture(scene.world(), state.value(), fans, picture_options);
  if (!bytes.ok()) return Fail(kExitFailed, bytes.error());
  if (const Status problem = WriteFile(options.output, bytes.value())) return Fail(kExitFailed, *problem);
  return kExitDone;
}

}  // namespace troupe
