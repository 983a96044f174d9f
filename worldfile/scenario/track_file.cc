#include "worldfile/scenario/track_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "common/base/source_text.h"
#include "common/geometry/limits.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kPlainFields = 4;   // frame id x y
constexpr std::size_t kObsmatFields = 8;  // frame id x z y vx vz vy
constexpr double kMaxCount = 1e9;         // of frames and ids

struct TrackRow {
  std::int64_t person = 0;
  double frame = 0.0;
  Vec2 position{0.0, 0.0};
  SourceLocation where;
};

Result<TrackRow> ReadRow(const std::vector<GridWord>& words) {
  const std::size_t fields = words.size();
  const std::array<std::size_t, 4> places{0, 1, 2, fields == kObsmatFields ? std::size_t{4} : std::size_t{3}};
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GridWord& word = words[places[i]];
    const std::optional<double> number = word.To<double>();
    const double most = i < 2 ? kMaxCount : kMaxMagnitude;
    if (!number || !(std::fabs(*number) <= most)) {
      return Error{word.where, fmt::format("found {}, expected {}", Quoted(word.text),
                                           i == 0   ? "the number of a frame"
                                           : i == 1 ? "the number of a person"
                                                    : "a coordinate in m, within 1e6")};
    }
    numbers[i] = *number;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (numbers[i] == std::floor(numbers[i])) continue;
    return Error{words[i].where, fmt::format("found {}, expected a whole number of a {}", Quoted(words[i].text),
                                             i == 0 ? "frame" : "person")};
  }
  return TrackRow{static_cast<std::int64_t>(numbers[1]), numbers[0], {numbers[2], numbers[3]}, words[0].where};
}

Result<std::vector<TrackRow>> ReadRows(const std::string& text, const std::string& path) {
  std::vector<TrackRow> rows;
  std::size_t fields = 0;
  for (const GridLine& line : GridLinesOf(text, path)) {
    GridLine content = line;
    content.text = content.text.substr(0, content.text.find('#'));
    const std::vector<GridWord> words = content.Words();
    if (words.empty()) continue;
    if (fields == 0) fields = words.size();
    if (words.size() != fields || (fields != kPlainFields && fields != kObsmatFields)) {
      return Error{words.front().where, fmt::format("found {}, expected {}", CountText(words.size(), "field"),
                                                    fields == kObsmatFields && words.size() != fields
                                                        ? "8 as in the first row"
                                                        : "frame, person, x and y, or the 8 fields of an obsmat.txt")};
    }
    Result<TrackRow> row = ReadRow(words);
    if (!row.ok()) return row.error();
    rows.push_back(std::move(row).value());
  }
  if (rows.empty()) return Error{{path, 1, 1}, "found no row, expected recorded positions: frame, person, x and y"};
  return rows;
}

}  // namespace

Result<std::vector<RecordedPerson>> ReadTracks(const std::string& text, const std::string& path, double rate) {
  // Commas become blanks: columns in errors stay.
  std::string blank = text;
  std::replace(blank.begin(), blank.end(), ',', ' ');
  Result<std::vector<TrackRow>> read = ReadRows(blank, path);
  if (!read.ok()) return read.error();
  std::vector<TrackRow> rows = std::move(read).value();
  std::map<std::int64_t, std::size_t> order;  // of people, by their first rows
  for (const TrackRow& row : rows) order.emplace(row.person, order.size());
  double first = rows.front().frame;
  for (const TrackRow& row : rows) first = std::min(first, row.frame);
  std::stable_sort(rows.begin(), rows.end(), [&](const TrackRow& a, const TrackRow& b) {
    return std::pair(order[a.person], a.frame) < std::pair(order[b.person], b.frame);
  });
  std::vector<RecordedPerson> people(order.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TrackRow& row = rows[i];
    if (i > 0 && rows[i - 1].person == row.person && rows[i - 1].frame == row.frame) {
      return Error{row.where, fmt::format("found person {} in one frame a second time, expected one position of it "
                                          "(the first one is in line {})",
                                          row.person, rows[i - 1].where.line)};
    }
    RecordedPerson& person = people[order[row.person]];
    person.times.push_back((row.frame - first) / rate);
    person.positions.push_back(row.position);
  }
  std::erase_if(people, [](const RecordedPerson& person) { return person.times.size() < 2; });
  if (people.empty()) {
    return Error{{path, 1, 1}, "found no person with two positions, expected ways of people"};
  }
  return people;
}

}  // namespace troupe
