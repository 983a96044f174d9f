// troupe import-plan: the walls of a floor plan (DXF, SVG) as a world file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "worldfile/plans/floor_plan.h"

namespace troupe {
namespace {

struct ImportPlanOptions {
  std::string file;
  std::string output;
  std::string unit;  // empty: that of the file
  double scale = 1.0;
  double thickness = 0.1;
  double height = 2.5;
  std::vector<std::string> layers;
};

std::optional<double> PositiveNumberOf(const std::string& text) {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || !(value > 0.0 && value < 1e6)) return std::nullopt;
  return value;
}

// m.
std::optional<double> LengthOfUnit(const std::string& unit) {
  for (const auto& [name, metres] : {std::pair{"m", 1.0}, std::pair{"cm", 0.01}, std::pair{"mm", 0.001},
                                     std::pair{"in", 0.0254}, std::pair{"ft", 0.3048}}) {
    if (unit == name) return metres;
  }
  return PositiveNumberOf(unit);
}

Result<PlanRule> RuleOf(const std::string& text, double height) {
  const std::size_t at = text.rfind('=');
  if (at == std::string::npos) return PlanRule{text, height};
  const std::optional<double> own = PositiveNumberOf(text.substr(at + 1));
  if (!own) return Error{{}, "option --layer: found '" + text + "', expected NAME or NAME=HEIGHT in metres"};
  return PlanRule{text.substr(0, at), *own};
}

int ImportPlanCommand(const ImportPlanOptions& options) {
  PlanUnit unit;
  if (!options.unit.empty()) {
    unit = LengthOfUnit(options.unit);
    if (!unit) {
      return Fail(
          {{}, "option --unit: found '" + options.unit + "', expected m, cm, mm, in, ft or the metres of a unit"});
    }
  }
  PlanWalls walls{options.thickness, options.height, {}};
  for (const std::string& text : options.layers) {
    Result<PlanRule> rule = RuleOf(text, options.height);
    if (!rule.ok()) return Fail(rule.error());
    walls.rules.push_back(std::move(rule).value());
  }
  const auto inputs = [&] { return std::vector{options.file}; };
  if (Status problem = CheckDistinct({{"-o", options.output}}, inputs); !problem.ok()) return Fail(problem.error());
  Result<FloorPlan> plan = ReadFloorPlan(options.file, unit);
  if (!plan.ok()) return Fail(plan.error());
  for (const Warning& warning : plan.value().warnings) PrintPlain(stderr, "{}\n", warning.ToString());
  std::size_t lines = 0;
  for (PlanLayer& layer : plan.value().layers) {
    for (PlanLine& line : layer.lines) line = {options.scale * line.start, options.scale * line.end};
    lines += layer.lines.size();
    PrintPlain(stdout, "layer {}: {} lines\n", layer.name.empty() ? "without a name" : layer.name, layer.lines.size());
  }
  const std::string source = std::filesystem::path(options.file).filename().string();
  const Result<std::string> text = PlanWorldText(plan.value(), walls, source);
  if (!text.ok()) return Fail({{options.file}, text.error().message});
  if (Status failure = WriteWholeFile(options.output, text.value()); !failure.ok()) return Fail(failure.error());
  PrintPlain(stdout, "{}: {} lines read\n", options.output, lines);
  return kExitDone;
}

}  // namespace

void AddImportPlanCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("import-plan", "Write the walls of a floor plan (DXF, SVG) as a world file");
  auto options = std::make_shared<ImportPlanOptions>();
  command->add_option("file", options->file, "The drawing: .dxf (text) or .svg")
      ->required()
      ->check(NotEmpty())
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "The world file")
      ->required()
      ->check(NotEmpty())
      ->type_name("FILE.world");
  command
      ->add_option("--unit", options->unit,
                   "The unit of the drawing: m, cm, mm, in, ft, or its length in metres "
                   "(default: what the file says)")
      ->check(NotEmpty())
      ->type_name("UNIT");
  command
      ->add_option("--scale", options->scale,
                   "By how much larger the building is than its drawing, as 50 for 1:50 (default: 1)")
      ->check(PositiveNumber())
      ->type_name("N");
  command->add_option("--thickness", options->thickness, "Of the walls, in metres (default: 0.1)")
      ->check(PositiveNumber())
      ->type_name("METRES");
  command->add_option("--height", options->height, "Of the walls, in metres (default: 2.5)")
      ->check(PositiveNumber())
      ->type_name("METRES");
  command
      ->add_option(
          "--layer", options->layers,
          "A layer that has walls, perhaps of a height of its own; * and ? stand for other letters; repeatable "
          "(default: all layers)")
      ->check(NotEmpty())
      ->type_name("NAME[=METRES]")
      ->allow_extra_args(false);
  command->final_callback([options, &exit_status] { exit_status = ImportPlanCommand(*options); });
}

}  // namespace troupe
