#include "worldfile/grids/grid_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "common/base/source_text.h"
#include "worldfile/grids/grid_lines.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

Status CheckSize(const GridMap& map, const SourceLocation& where) {
  const std::uint64_t cells = std::uint64_t{map.width} * map.height;
  if (map.width > 0 && map.height > 0 && cells <= GridMap::kMaxCells) return Status();
  return Error{where, fmt::format("found a map of {} x {} cells, expected 1 to {} cells", map.width, map.height,
                                  GridMap::kMaxCells)};
}

// The lines before the cells; the number of the first line of cells.
Result<std::size_t> ReadHeader(const std::vector<GridLine>& lines, GridMap& map) {
  std::optional<std::uint32_t> width;
  std::optional<std::uint32_t> height;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::vector<GridWord> words = lines[i].Words();
    if (words.empty()) continue;
    const std::string_view key = words[0].text;
    if (key == "map" && words.size() == 1) {
      if (!width || !height) {
        return Error{words[0].where, fmt::format("found no {} of the map, expected a line '{} N' before 'map'",
                                                 width ? "height" : "width", width ? "height" : "width")};
      }
      map.width = *width;
      map.height = *height;
      if (Status status = CheckSize(map, words[0].where); !status.ok()) return status.error();
      return i + 1;
    }
    if (words.size() != 2 || (key != "type" && key != "width" && key != "height")) {
      return Error{words[0].where, fmt::format("found {}, expected type, height, width or map", Quoted(lines[i].text))};
    }
    if (key == "type") {
      if (words[1].text != "octile") {
        return Error{words[1].where, fmt::format("found a map of type {}, expected octile", Quoted(words[1].text))};
      }
      continue;
    }
    const std::optional<std::uint32_t> number = words[1].To<std::uint32_t>();
    if (!number) {
      return Error{words[1].where,
                   fmt::format("found {} for the {}, expected a number of cells", Quoted(words[1].text), key)};
    }
    (key == "width" ? width : height) = number;
  }
  return Error{lines.empty() ? SourceLocation{map.file} : lines.back().where,
               "found the end of the file, expected a line 'map' and the cells"};
}

bool IsPogemaLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string ToString(const GridCell& cell) {
  return fmt::format("({}, {})", cell.x, cell.y);
}

Bitmap GridMap::ToBitmap() const {
  Bitmap bitmap(static_cast<int>(width), static_cast<int>(height));
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      if (!IsFree({x, y})) bitmap.set_occupied(static_cast<int>(x), static_cast<int>(height - 1 - y), true);
    }
  }
  return bitmap;
}

bool IsGridMapPath(const std::string& path) {
  return path.ends_with(".map") || path.ends_with(".pogema");
}

Result<GridMap> ReadGridMap(const std::string& path, const SourceLocation& where, const AllowedPaths& allowed) {
  const Result<std::string> text = ReadTextFile(path, where, allowed);
  if (!text.ok()) return text.error();
  return path.ends_with(".pogema") ? ReadPogemaText(text.value(), path) : ReadMovingaiText(text.value(), path);
}

Result<GridMap> ReadMovingaiText(const std::string& text, const std::string& path) {
  GridMap map;
  map.file = path;
  const std::vector<GridLine> lines = GridLinesOf(text, path);
  const Result<std::size_t> first = ReadHeader(lines, map);
  if (!first.ok()) return first.error();
  map.blocked.assign(std::size_t{map.width} * map.height, false);
  for (std::uint32_t y = 0; y < map.height; ++y) {
    const std::size_t number = first.value() + y;
    if (number >= lines.size()) {
      return Error{lines.back().where, fmt::format("found {} of cells, expected {}", CountText(y, "line"), map.height)};
    }
    const GridLine& line = lines[number];
    if (line.text.size() != map.width) {
      return Error{line.At(std::min<std::size_t>(line.text.size(), map.width)),
                   fmt::format("found {}, expected {}", CountText(line.text.size(), "cell"), map.width)};
    }
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const char c = line.text[x];
      const bool is_blocked = std::string_view("@OTW").find(c) != std::string_view::npos;
      if (!is_blocked && std::string_view(".GSE").find(c) == std::string_view::npos) {
        return Error{line.At(x), fmt::format("found {} for a cell, expected one of . G S E @ O T W",
                                             Quoted(line.text.substr(x, 1)))};
      }
      map.blocked[map.IndexOf({x, y})] = is_blocked;
    }
  }
  for (std::size_t i = first.value() + map.height; i < lines.size(); ++i) {
    if (lines[i].text.empty()) continue;
    return Error{lines[i].where, fmt::format("found more than {} of cells", CountText(map.height, "line"))};
  }
  return map;
}

// Rows are separated by white space of any kind.
Result<GridMap> ReadPogemaText(const std::string& text, const std::string& path) {
  GridMap map;
  map.file = path;
  std::vector<GridWord> rows;
  const std::vector<GridLine> lines = GridLinesOf(text, path);
  for (const GridLine& line : lines) {
    for (const GridWord& word : line.Words()) rows.push_back(word);
  }
  map.height = static_cast<std::uint32_t>(std::min<std::size_t>(rows.size(), 0xffffffff));
  map.width = rows.empty() ? 0 : static_cast<std::uint32_t>(rows[0].text.size());
  if (Status status = CheckSize(map, rows.empty() ? SourceLocation{path} : rows[0].where); !status.ok()) {
    return status.error();
  }
  map.blocked.assign(std::size_t{map.width} * map.height, false);
  for (std::uint32_t y = 0; y < map.height; ++y) {
    const GridWord& row = rows[y];
    const auto at = [&](std::size_t x) {
      return SourceLocation{path, row.where.line, row.where.column + static_cast<int>(x)};
    };
    if (row.text.size() != map.width) {
      return Error{at(std::min<std::size_t>(row.text.size(), map.width)),
                   fmt::format("found a row of {}, expected {} as in the first one", CountText(row.text.size(), "cell"),
                               map.width)};
    }
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const char c = row.text[x];
      if (c == '#') {
        map.blocked[map.IndexOf({x, y})] = true;
      } else if (IsPogemaLetter(c)) {
        const bool is_start = c >= 'a';
        GridMark& mark = map.marks[is_start ? c : static_cast<char>(c - 'A' + 'a')];
        std::optional<GridCell>& cell = is_start ? mark.start : mark.target;
        if (cell) {
          return Error{at(x), fmt::format("found '{}' for a second time, expected each {} once", c,
                                          is_start ? "start" : "target")};
        }
        cell = GridCell{x, y};
      } else if (std::string_view(".!@$").find(c) == std::string_view::npos) {
        return Error{at(x), fmt::format("found {} for a cell, expected one of . # ! @ $ or a letter",
                                        Quoted(row.text.substr(x, 1)))};
      }
    }
  }
  for (const auto& [letter, mark] : map.marks) {
    if (mark.start && mark.target) continue;
    const char capital = static_cast<char>(letter - 'a' + 'A');
    return Error{rows[0].where, fmt::format("found '{}' without '{}', expected a start and a target of each agent",
                                            mark.start ? letter : capital, mark.start ? capital : letter)};
  }
  return map;
}

}  // namespace troupe
