#include "worldfile/grids/league_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "common/base/json_tree.h"
#include "common/base/source_text.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// A line of an .agents or .tasks file, with its numbers.
struct NumbersLine {
  std::vector<std::pair<std::uint64_t, SourceLocation>> numbers;
  SourceLocation where;
};

// Separated by commas or blanks; comments are left out.
Result<std::vector<NumbersLine>> ReadNumbers(const std::string& text, const std::string& path) {
  std::string plain = text;
  std::replace(plain.begin(), plain.end(), ',', ' ');
  std::vector<NumbersLine> read;
  for (const GridLine& line : GridLinesOf(plain, path)) {
    const std::vector<GridWord> words = line.Words();
    if (words.empty() || words[0].text.front() == '#') continue;
    NumbersLine& numbers = read.emplace_back();
    numbers.where = line.where;
    for (const GridWord& word : words) {
      const std::optional<std::uint64_t> number = word.To<std::uint64_t>();
      if (!number) return Error{word.where, fmt::format("found {}, expected a whole number", Quoted(word.text))};
      numbers.numbers.emplace_back(*number, word.where);
    }
  }
  return read;
}

class LeagueReader {
 public:
  LeagueReader(const JsonTree& json, const std::string& path, std::optional<std::uint32_t> most,
               const AllowedPaths& allowed)
      : json_(json), path_(path), most_(most), allowed_(allowed) {}

  Result<GridProblem> Read() {
    problem_.files = {path_};
    if (Status status = ReadMap(); !status.ok()) return status.error();
    if (Status status = ReadAgents(); !status.ok()) return status.error();
    if (Status status = ReadTasks(); !status.ok()) return status.error();
    if (Status status = ReadDelays(); !status.ok()) return status.error();
    return std::move(problem_);
  }

 private:
  struct Named {
    std::string path;
    SourceLocation where;
  };

  // The file that a key names.
  Result<Named> FileOf(const char* key) const {
    const JsonNode* const node = json_.root().Find(key);
    if (node == nullptr || !node->is_string() || node->text.empty()) {
      return json_.ErrorAt(node != nullptr ? *node : json_.root(),
                           fmt::format("found no '{}', expected the name of a file", key));
    }
    const std::filesystem::path folder = DirectoryOf(path_);
    return Named{(folder / node->text).lexically_normal().string(), json_.Where(*node)};
  }

  Result<std::vector<NumbersLine>> NumbersOf(const char* key, const char* what, std::size_t& count) {
    const Result<Named> file = FileOf(key);
    if (!file.ok()) return file.error();
    const Result<std::string> text = ReadTextFile(file.value().path, file.value().where, allowed_);
    if (!text.ok()) return text.error();
    problem_.files.push_back(file.value().path);
    Result<std::vector<NumbersLine>> lines = ReadNumbers(text.value(), file.value().path);
    if (!lines.ok()) return lines;
    if (lines.value().empty() || lines.value()[0].numbers.size() != 1) {
      return Error{lines.value().empty() ? SourceLocation{file.value().path} : lines.value()[0].where,
                   fmt::format("found no number of {}, expected it in the first line", what)};
    }
    count = static_cast<std::size_t>(lines.value()[0].numbers[0].first);
    if (lines.value().size() - 1 >= count) return lines;
    return Error{lines.value().back().where,
                 fmt::format("found {} of {}, expected {}", CountText(lines.value().size() - 1, "line"), what, count)};
  }

  Status ReadMap() {
    const Result<Named> file = FileOf("mapFile");
    if (!file.ok()) return file.error();
    Result<GridMap> map = ReadGridMap(file.value().path, file.value().where, allowed_);
    if (!map.ok()) return map.error();
    problem_.map = std::move(map).value();
    problem_.files.push_back(file.value().path);
    return Status();
  }

  Result<GridCell> CellOf(const std::pair<std::uint64_t, SourceLocation>& place) const {
    const std::uint64_t cells = problem_.map.blocked.size();
    if (place.first >= cells) {
      return Error{place.second, fmt::format("found the place {}, expected 0 to {}", place.first, cells - 1)};
    }
    const GridCell cell{static_cast<std::uint32_t>(place.first % problem_.map.width),
                        static_cast<std::uint32_t>(place.first / problem_.map.width)};
    if (problem_.map.IsFree(cell)) return cell;
    return Error{place.second, fmt::format("found the blocked cell {}, expected a free one", ToString(cell))};
  }

  Status ReadAgents() {
    std::size_t count = 0;
    const Result<std::vector<NumbersLine>> lines = NumbersOf("agentFile", "agents", count);
    if (!lines.ok()) return lines.error();
    if (const JsonNode* const size = json_.root().Find("teamSize")) {
      if (!size->is_number() || !(size->number >= 1.0 && size->number <= static_cast<double>(count))) {
        return json_.ErrorAt(*size, fmt::format("found {} for 'teamSize', expected 1 to {}, the agents of its file",
                                                Describe(*size), count));
      }
      count = size->ToInteger<std::size_t>();
    }
    if (most_) count = std::min<std::size_t>(count, *most_);
    for (std::size_t i = 0; i < count; ++i) {
      const NumbersLine& line = lines.value()[i + 1];
      const Result<GridCell> start = CellOf(line.numbers[0]);
      if (!start.ok()) return start.error();
      GridAgent& agent = problem_.agents.emplace_back();
      agent.start = start.value();
      agent.where = line.where;
    }
    return Status();
  }

  // Without tasks the agents have nothing to do.
  Status ReadTasks() {
    std::size_t count = 0;
    const Result<std::vector<NumbersLine>> lines = NumbersOf("taskFile", "tasks", count);
    if (!lines.ok()) return lines.error();
    problem_.has_tasks = true;
    const auto distance = [](const GridCell& a, const GridCell& b) {
      return static_cast<std::uint64_t>(std::abs(std::int64_t{a.x} - b.x) + std::abs(std::int64_t{a.y} - b.y));
    };
    std::vector<std::uint64_t> free_at(problem_.agents.size(), 0);  // steps
    for (std::size_t i = 1; i <= count && !problem_.agents.empty(); ++i) {
      std::vector<GridCell> places;
      for (const auto& number : lines.value()[i].numbers) {
        const Result<GridCell> place = CellOf(number);
        if (!place.ok()) return place.error();
        places.push_back(place.value());
      }
      const auto last_of = [](const GridAgent& agent) {
        return agent.goals.empty() ? agent.start : agent.goals.back();
      };
      const std::uint64_t soonest = *std::min_element(free_at.begin(), free_at.end());
      std::optional<std::size_t> best;
      for (std::size_t each = 0; each < free_at.size(); ++each) {
        if (free_at[each] != soonest) continue;
        const auto from = [&](std::size_t agent) { return distance(last_of(problem_.agents[agent]), places[0]); };
        if (!best || from(each) < from(*best)) best = each;
      }
      GridAgent& agent = problem_.agents[*best];
      GridTask& task = problem_.tasks.emplace_back();
      task.agent = *best;
      for (const GridCell& place : places) {
        free_at[*best] += distance(last_of(agent), place);
        if (agent.goals.empty() || place != agent.goals.back()) agent.goals.push_back(place);
        task.goals.push_back(agent.goals.size() - 1);
      }
      task.places = std::move(places);
      ++free_at[*best];
    }
    return Status();
  }

  Result<double> NumberOf(const JsonNode& object, const char* key, double otherwise, double most) const {
    const JsonNode* const node = object.Find(key);
    if (node == nullptr) return otherwise;
    if (node->is_number() && node->number >= 0.0 && node->number <= most) return node->number;
    return json_.ErrorAt(*node,
                         fmt::format("found {} for '{}', expected a number up to {}", Describe(*node), key, most));
  }

  Status ReadDelays() {
    const JsonNode* const config = json_.root().Find("delayConfig");
    if (config == nullptr) return Status();
    const Result<double> counter = NumberOf(json_.root(), "agentCounter", 10.0, 1e6);
    if (!counter.ok()) return counter.error();
    const Result<double> probability = NumberOf(*config, "pDelay", 0.0, 1.0);
    if (!probability.ok()) return probability.error();
    const Result<double> least = NumberOf(*config, "minDelay", 1.0, 1e6);
    if (!least.ok()) return least.error();
    const Result<double> most = NumberOf(*config, "maxDelay", 1.0, 1e6);
    if (!most.ok()) return most.error();
    const double ticks = std::max(counter.value(), 1.0);
    if (least.value() > most.value()) return json_.ErrorAt(*config, "found 'minDelay' above 'maxDelay'");
    if (probability.value() == 0.0) return Status();
    problem_.delays =
        MoveDelays{std::min(1.0, probability.value() * ticks), least.value() / ticks, most.value() / ticks};
    return Status();
  }

  const JsonTree& json_;
  const std::string& path_;
  std::optional<std::uint32_t> most_;
  const AllowedPaths& allowed_;
  GridProblem problem_;
};

}  // namespace

bool IsLeaguePath(const std::string& path, const AllowedPaths& allowed) {
  if (!path.ends_with(".json")) return false;
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  // A file without the word is no such problem: no second parse of large scenarios.
  if (!text.ok() || text.value().find("\"mapFile\"") == std::string::npos) return false;
  const Result<JsonTree> json = JsonTree::Parse(text.value(), path);
  return json.ok() && json.value().root().is_object() && json.value().root().Find("mapFile") != nullptr;
}

Result<GridProblem> ReadLeagueProblem(const std::string& text, const std::string& path,
                                      std::optional<std::uint32_t> agents, const AllowedPaths& allowed) {
  const Result<JsonTree> json = JsonTree::Parse(text, path);
  if (!json.ok()) return json.error();
  return LeagueReader(json.value(), path, agents, allowed).Read();
}

}  // namespace troupe
