#include "worldfile/grids/path_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/json_tree.h"
#include "common/base/source_text.h"
#include "common/traffic/path_schedule.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// A place of a path as it is written, before its cell is checked.
struct WrittenPlace {
  std::array<std::int64_t, 2> numbers{};
  std::uint32_t step = 0;
  SourceLocation where;
};

struct WrittenPath {
  std::vector<WrittenPlace> places;
  SourceLocation where;
};

// The numbers of one pair of parentheses, and the text around it.
class PlaceScanner {
 public:
  explicit PlaceScanner(const GridLine& line) : line_(line) {}

  bool Skip(std::string_view word) {
    SkipBlanks();
    if (!line_.text.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  bool IsAtEnd() {
    SkipBlanks();
    return at_ == line_.text.size();
  }
  std::optional<double> Number() {
    SkipBlanks();
    double number = 0.0;
    const char* const begin = line_.text.data() + at_;
    const auto read = std::from_chars(begin, line_.text.data() + line_.text.size(), number);
    if (read.ec != std::errc() || !(std::fabs(number) < 1e9)) return std::nullopt;
    at_ += static_cast<std::size_t>(read.ptr - begin);
    return number;
  }
  SourceLocation Where() {
    SkipBlanks();
    return line_.At(at_);
  }
  std::string Rest() const { return Quoted(line_.text.substr(at_), 20); }

 private:
  void SkipBlanks() {
    while (at_ < line_.text.size() && (line_.text[at_] == ' ' || line_.text[at_] == '\t')) ++at_;
  }

  const GridLine& line_;
  std::size_t at_ = 0;
};

Result<WrittenPlace> ReadPlace(PlaceScanner& scanner, const std::vector<WrittenPlace>& before) {
  WrittenPlace place;
  place.where = scanner.Where();
  const auto fail = [&] {
    const SourceLocation where = scanner.Where();
    return Error{where, fmt::format("found {}, expected a place (a,b) or (a,b,step) of whole numbers", scanner.Rest())};
  };
  if (!scanner.Skip("(")) return fail();
  for (std::size_t i = 0; i < 2; ++i) {
    if (i > 0 && !scanner.Skip(",")) return fail();
    const std::optional<double> number = scanner.Number();
    if (!number || *number != std::floor(*number)) return fail();
    place.numbers[i] = static_cast<std::int64_t>(*number);
  }
  place.step = before.empty() ? 0 : before.back().step + 1;
  if (scanner.Skip(",")) {
    const SourceLocation where = scanner.Where();
    const std::optional<double> step = scanner.Number();
    if (!step || *step != std::floor(*step) || *step < 0.0) return fail();
    const auto number = static_cast<std::uint32_t>(*step);
    if (before.empty() ? number != 0 : number <= before.back().step) {
      return Error{where, fmt::format("found step {}, expected {}", number,
                                      before.empty() ? "0" : fmt::format("more than {}", before.back().step))};
    }
    place.step = number;
  }
  if (!scanner.Skip(")")) return fail();
  return place;
}

// By agent; the second line of one is an error, and none is an empty path.
Result<std::vector<WrittenPath>> ReadTextPaths(const std::string& text, const std::string& path, std::size_t agents) {
  std::vector<WrittenPath> paths(agents);
  for (const GridLine& line : GridLinesOf(text, path)) {
    PlaceScanner scanner(line);
    if (scanner.IsAtEnd()) continue;
    if (!scanner.Skip("Agent")) {
      return Error{scanner.Where(), fmt::format("found {}, expected 'Agent N:' and its path", scanner.Rest())};
    }
    const SourceLocation where = scanner.Where();
    const std::optional<double> number = scanner.Number();
    if (!number || *number < 0.0 || *number != std::floor(*number)) {
      return Error{where, "found no number of an agent, expected a whole number from 0"};
    }
    if (*number >= static_cast<double>(agents)) continue;  // of more agents than are asked for
    WrittenPath& written = paths[static_cast<std::size_t>(*number)];
    if (!written.places.empty()) {
      return Error{where, fmt::format("found agent {} again, expected each once", *number)};
    }
    written.where = line.where;
    if (!scanner.Skip(":")) return Error{scanner.Where(), fmt::format("found {}, expected ':'", scanner.Rest())};
    while (!scanner.IsAtEnd()) {
      Result<WrittenPlace> place = ReadPlace(scanner, written.places);
      if (!place.ok()) return place.error();
      written.places.push_back(std::move(place).value());
      if (!scanner.Skip("->") && !scanner.IsAtEnd()) {
        return Error{scanner.Where(), fmt::format("found {}, expected '->'", scanner.Rest())};
      }
    }
  }
  return paths;
}

// The League's actions: a robot with an orientation, which moves along rows and columns.
class ActionPlayer {
 public:
  // `counter`: ticks of FW or a turn.
  ActionPlayer(std::int64_t row, std::int64_t column, int orientation, std::uint32_t counter)
      : row_(row), column_(column), orientation_(orientation), counter_(counter) {}

  // One tick. False: no such action.
  bool Play(std::string_view action, const SourceLocation& where, WrittenPath& path) {
    ++step_;
    if (action == "W" || action == "NA" || action == "T") return true;
    const bool is_forward = action == "FW" || action == "F";
    const bool is_turn = action == "CR" || action == "CCR" || action == "R" || action == "C";
    if (!is_forward && !is_turn) return false;
    if (++done_ < counter_) return true;
    done_ = 0;
    if (is_turn) {
      orientation_ = (orientation_ + (action == "CR" || action == "R" ? 1 : 3)) % 4;
      return true;
    }
    // East, south, west, north.
    column_ += orientation_ == 0 ? 1 : orientation_ == 2 ? -1 : 0;
    row_ += orientation_ == 1 ? 1 : orientation_ == 3 ? -1 : 0;
    path.places.push_back({{row_, column_}, step_, where});
    return true;
  }

 private:
  std::int64_t row_;
  std::int64_t column_;
  int orientation_;
  std::uint32_t counter_;
  std::uint32_t done_ = 0;  // ticks of the present action
  std::uint32_t step_ = 0;
};

constexpr std::uint64_t kMaxTicks = 100'000'000;

// "[(0,3,4,0,0):(FW 3,CR 1)]...": the first state counts, the others follow from the actions.
Result<WrittenPath> PlaySegments(std::string_view text, const SourceLocation& where, std::uint32_t counter) {
  WrittenPath path{.places = {}, .where = where};
  std::optional<ActionPlayer> player;
  std::uint64_t ticks = 0;
  const auto fail = [&](std::string_view rest) {
    return Error{where,
                 fmt::format("found {} in a path, expected '[(t,row,column,orientation,counter):(ACTION N,...)]'",
                             Quoted(rest, 20))};
  };
  while (!text.empty()) {
    const std::size_t end = text.find(":(");
    const std::size_t close = text.find(")]", end);
    if (!text.starts_with("[(") || close == std::string_view::npos) return fail(text);
    std::string_view state = text.substr(2, end - 2);
    if (!state.empty() && state.back() == ')') state.remove_suffix(1);
    std::vector<std::int64_t> numbers;
    while (!state.empty()) {
      const std::size_t comma = std::min(state.find(','), state.size());
      const std::optional<std::int64_t> number = GridWord{state.substr(0, comma), {}}.To<std::int64_t>();
      if (!number) return fail(state);
      numbers.push_back(*number);
      state.remove_prefix(std::min(comma + 1, state.size()));
    }
    if (numbers.size() != 5 || numbers[3] < 0 || numbers[3] > 3) return fail(text);
    if (!player) {
      player.emplace(numbers[1], numbers[2], static_cast<int>(numbers[3]), counter);
      path.places.push_back({{numbers[1], numbers[2]}, 0, where});
    }
    std::string_view actions = text.substr(end + 2, close - end - 2);
    while (!actions.empty()) {
      const std::size_t comma = std::min(actions.find(','), actions.size());
      const std::vector<GridWord> words = GridLine{actions.substr(0, comma), {}}.Words();
      const std::optional<std::uint32_t> count = words.size() == 2 ? words[1].To<std::uint32_t>() : std::nullopt;
      if (!count || (ticks += *count) > kMaxTicks) return fail(actions);
      for (std::uint32_t i = 0; i < *count; ++i) {
        if (!player->Play(words[0].text, where, path)) return fail(actions);
      }
      actions.remove_prefix(std::min(comma + 1, actions.size()));
    }
    text.remove_prefix(close + 2);
    while (!text.empty() && (text.front() == ',' || text.front() == ' ')) text.remove_prefix(1);
  }
  return path;
}

// "F,R,W": from the state [row, column, "E"] on.
Result<WrittenPath> PlayWords(const JsonTree& json, const JsonNode& start, std::string_view actions,
                              const SourceLocation& where) {
  WrittenPath path{.places = {}, .where = where};
  const bool is_state = start.is_array() && start.items.size() == 3 && start.items[0].is_number() &&
                        start.items[1].is_number() && start.items[2].is_string();
  const std::size_t orientation = is_state ? std::string_view("ESWN").find(start.items[2].text) : std::string::npos;
  if (orientation == std::string::npos) return json.ErrorAt(start, "found no state [row, column, \"E\"], expected one");
  const auto row = static_cast<std::int64_t>(start.items[0].number);
  const auto column = static_cast<std::int64_t>(start.items[1].number);
  ActionPlayer player(row, column, static_cast<int>(orientation), 1);
  path.places.push_back({{row, column}, 0, where});
  while (!actions.empty()) {
    const std::size_t comma = std::min(actions.find(','), actions.size());
    if (comma > 0 && !player.Play(actions.substr(0, comma), where, path)) {
      return Error{where, fmt::format("found the action {}, expected F, R, C or W", Quoted(actions.substr(0, comma)))};
    }
    actions.remove_prefix(std::min(comma + 1, actions.size()));
  }
  return path;
}

Result<std::vector<WrittenPath>> ReadLeaguePaths(const std::string& text, const std::string& file, std::size_t agents) {
  const Result<JsonTree> read = JsonTree::Parse(text, file, {.bytes = kMaxTextFileBytes, .values = 10'000'000});
  if (!read.ok()) return read.error();
  const JsonTree& json = read.value();
  const JsonNode& root = json.root();
  const JsonNode* const list = root.is_object() ? root.Find("actualPaths") : nullptr;
  if (list == nullptr || !list->is_array()) {
    return json.ErrorAt(root, "found no list 'actualPaths', expected one as in an output of the League");
  }
  if (list->items.size() < agents) {
    return json.ErrorAt(*list, fmt::format("found {}, expected one for each of {}",
                                           CountText(list->items.size(), "path"), CountText(agents, "agent")));
  }
  std::uint32_t counter = 1;
  if (const JsonNode* const given = root.Find("agentMaxCounter")) {
    if (!given->is_number() || !(given->number >= 1.0 && given->number <= 1e6)) {
      return json.ErrorAt(*given, "found " + Describe(*given) + ", expected ticks of an action");
    }
    counter = given->ToInteger<std::uint32_t>();
  }
  const std::vector<JsonNode>& starts = root.ItemsOf("start");
  std::vector<WrittenPath> paths;
  for (std::size_t i = 0; i < agents; ++i) {
    const JsonNode& item = list->items[i];
    if (!item.is_string()) return json.ErrorAt(item, "found " + Describe(item) + ", expected a path as a string");
    const bool has_segments = item.text.starts_with("[");
    if (!has_segments && i >= starts.size()) return json.ErrorAt(item, "found no start of this path, expected 'start'");
    Result<WrittenPath> path = has_segments ? PlaySegments(item.text, json.Where(item), counter)
                                            : PlayWords(json, starts[i], item.text, json.Where(item));
    if (!path.ok()) return path.error();
    paths.push_back(std::move(path).value());
  }
  return paths;
}

// Whether the numbers are (row, column): not all starts are theirs as (x, y), and all are so.
bool AreRowsFirst(const std::vector<WrittenPath>& paths, const GridProblem& problem) {
  const auto fit = [&](std::size_t x) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i].places.empty()) continue;
      const WrittenPlace& first = paths[i].places.front();
      const GridCell& start = problem.agents[i].start;
      if (first.numbers[x] != start.x || first.numbers[1 - x] != start.y) return false;
    }
    return true;
  };
  return !fit(0) && fit(1);
}

std::string NumbersText(const WrittenPlace& place) {
  return fmt::format("({}, {})", place.numbers[0], place.numbers[1]);
}

// The path of one agent, without waits.
Status SetPath(const WrittenPath& written, std::size_t x, const GridProblem& problem, GridAgent& agent,
               std::vector<SourceLocation>& where) {
  for (const WrittenPlace& place : written.places) {
    if (!problem.map.Contains(place.numbers[x], place.numbers[1 - x])) {
      return Error{place.where, fmt::format("found the place {} outside of the map of {} x {} cells",
                                            NumbersText(place), problem.map.width, problem.map.height)};
    }
    const GridCell cell{static_cast<std::uint32_t>(place.numbers[x]), static_cast<std::uint32_t>(place.numbers[1 - x])};
    if (!problem.map.IsFree(cell)) {
      return Error{place.where, fmt::format("found the blocked cell {}, expected a free one", NumbersText(place))};
    }
    if (agent.path.empty()) {
      if (cell != agent.start) {
        return Error{place.where, fmt::format("found the place {}, expected the start {} of {}", NumbersText(place),
                                              ToString(agent.start), agent.name)};
      }
    } else if (cell == agent.path.back()) {
      continue;
    } else {
      const std::vector<GridCell> next = FreeNeighbours(problem.map, agent.path.back());
      if (std::find(next.begin(), next.end(), cell) == next.end()) {
        return Error{place.where,
                     fmt::format("found a jump to {}, expected the cell before or one beside it", NumbersText(place))};
      }
    }
    agent.path.push_back(cell);
    agent.steps.push_back(place.step);
    where.push_back(place.where);
  }
  if (agent.path.empty()) {
    return Error{written.where, fmt::format("found no path of {}, expected one", agent.name)};
  }
  if (problem.has_tasks || agent.goals.empty() || agent.path.back() == agent.goals.back()) return Status();
  return Error{where.back(), fmt::format("found the end {} of the path of {}, expected its goal {}",
                                         ToString(agent.path.back()), agent.name, ToString(agent.goals.back()))};
}

// By the same rules as the execution. Steps that are longer than one are waits at the cell before.
Status CheckConflicts(const GridProblem& problem, const std::vector<std::vector<SourceLocation>>& where) {
  std::vector<LaneTrip> trips;
  for (const GridAgent& agent : problem.agents) {
    LaneTrip& trip = trips.emplace_back();
    trip.robot = RobotId(trips.size() - 1);
    trip.steps = agent.steps;
    for (const GridCell& cell : agent.path) trip.path.push_back(static_cast<std::uint32_t>(problem.map.IndexOf(cell)));
  }
  const std::optional<PathConflict> conflict = FindConflict(trips);
  if (!conflict) return Status();
  const std::string& first = problem.agents[conflict->first].name;
  const std::string& second = problem.agents[conflict->second].name;
  const GridCell& cell = problem.agents[conflict->second].path[conflict->place];
  return Error{where[conflict->second][conflict->place],
               conflict->is_swap ? fmt::format("found {} and {} changing places at {} in step {}, expected paths that "
                                               "do not meet",
                                               first, second, ToString(cell), conflict->step)
                                 : fmt::format("found {} and {} at {} in step {}, expected paths that do not meet",
                                               first, second, ToString(cell), conflict->step)};
}

}  // namespace

Status ReadPaths(const std::string& text, const std::string& path, GridProblem& problem) {
  if (problem.agents.empty()) return Error{{path}, "found paths for a problem without agents, expected agents"};
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_json = first != std::string::npos && text[first] == '{';
  Result<std::vector<WrittenPath>> read =
      is_json ? ReadLeaguePaths(text, path, problem.agents.size()) : ReadTextPaths(text, path, problem.agents.size());
  if (!read.ok()) return read.error();
  const std::size_t x = is_json || AreRowsFirst(read.value(), problem) ? 1 : 0;
  std::vector<std::vector<SourceLocation>> where(problem.agents.size());
  for (std::size_t i = 0; i < problem.agents.size(); ++i) {
    WrittenPath& written = read.value()[i];
    if (written.places.empty()) written.where = {path};
    if (Status status = SetPath(written, x, problem, problem.agents[i], where[i]); !status.ok()) return status;
  }
  return CheckConflicts(problem, where);
}

}  // namespace troupe
