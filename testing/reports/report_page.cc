// The page of a report and its plots.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/base/source_text.h"
#include "common/base/xml_text.h"
#include "testing/reports/case_report.h"
#include "testing/reports/svg_plot.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxFaults = 100;   // that the page shows in full
constexpr std::size_t kFirstFaults = 10;  // of them, those that are not behind one more click
constexpr std::size_t kMaxGroups = 200;   // rows of a table of metrics

// In the page, which is one file without scripts, to be opened from a disk or a build server. Light or dark as the
// system. Plots have their colours in their elements, since they are files of their own, too; here the dark theme
// replaces them.
constexpr const char* kStyle =
    R"(:root{color-scheme:light;--page:#fff;--side:#f3f5f8;--line:#ccd2da;--text:#1d2430;--accent:#1d5bc0;
--passed:#1a7543;--failed:#b3261e;--error:#8a5200;--not-run:#5d6672}
@media(prefers-color-scheme:dark){:root{color-scheme:dark;--page:#1c2128;--side:#14181e;--line:#3b4450;--text:#e4e8ee;--accent:#76abff;
--passed:#4cc083;--failed:#ff8a7a;--error:#f0a03c;--not-run:#a3aebb}
svg{color:var(--text)}svg text{fill:currentColor}svg [fill="#fff"]{fill:var(--page)}svg [stroke="#ddd"]{stroke:var(--line)}
svg [stroke="#2471a3"]{stroke:var(--accent)}svg [fill="#2471a3"]{fill:var(--accent)}svg [stroke="#c0392b"]{stroke:var(--failed)}}
body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:70em;padding:0 1em;color:var(--text);background:var(--page)}
a{color:var(--accent)}h1{font-size:1.5em}h2{font-size:1.25em;border-bottom:1px solid var(--line);margin-top:2em}h3{font-size:1.05em}
.table{overflow-x:auto;margin:.7em 0}table{border-collapse:collapse}
td,th{border:1px solid var(--line);padding:.2em .6em;text-align:left;font-weight:normal}
th{background:var(--side)}td.n{text-align:right;font-variant-numeric:tabular-nums}
code{background:var(--side);padding:.1em .3em;overflow-wrap:anywhere}
.passed{color:var(--passed)}.failed{color:var(--failed)}.error{color:var(--error)}.not-run{color:var(--not-run)}
.grid span{display:inline-block;width:10px;height:10px;margin:1px;background:currentColor}
.plots{display:flex;flex-wrap:wrap;gap:12px}
figure{margin:0}figcaption{font-size:.9em}
details{border:1px solid var(--line);padding:.4em .8em;margin:.6em 0}summary{cursor:pointer}img,svg{max-width:100%;height:auto})";

// A table that is wider than a phone moves in its own place.
constexpr const char* kTableEnd = "</table></div>\n";

std::string TableBegin(const std::string& name) {
  return "<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"" + XmlText(name) + "\"><table>";
}

std::string ClassOf(CaseVerdict verdict) {
  return verdict == CaseVerdict::kNotRun ? "not-run" : NameOf(verdict);
}

std::string Shown(double number) {
  return fmt::format("{:.4g}", number);
}

std::string WithUnit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

// The draws but that of the seed, over which statistics are made.
std::string GroupOf(const TestCase& draws) {
  TestCase others;
  std::copy_if(draws.begin(), draws.end(), std::back_inserter(others),
               [](const DrawnValue& draw) { return draw.path != "seed"; });
  return CaseText(others);
}

bool IsNumber(const std::string& value) {
  return nlohmann::json::parse(value, nullptr, false).is_number();
}

// A file as a relative address: other characters would end its path ('#', '?') or be no part of an address.
std::string LinkTo(const std::string& file) {
  std::string link;
  for (const char c : file) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
    link += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return link;
}

// A file of its own, as the pictures of faults: a build server may show no picture that is in the page.
std::string HeatFigure(const HeatMap& map, const std::string& name, std::uint64_t runs) {
  const char* const what = map.kind() == HeatKind::kRobots   ? "Where robots were"
                           : map.kind() == HeatKind::kPeople ? "Where people were"
                                                             : "Where robots waited";
  const std::string file = LinkTo(name + HeatSection::FileName(map));
  const std::string text = fmt::format("{} in {}, in the world of the first case", what, CountText(runs, "run"));
  return fmt::format(
      "<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\" width=\"840\"></a><figcaption>{1}</figcaption></figure>\n",
      file, text);
}

// Everything that a reader needs to repeat the fault: case, command, recording, picture, course of the robustness.
std::string FaultText(const ReportedTest& test, const ReportedCase& fault, bool open) {
  const CaseOutcome& outcome = fault.outcome;
  const std::string text = CaseText(fault.draws);
  std::string html = fmt::format("<details{}><summary><b class=\"{}\">{}</b> {}<code>{}</code></summary>\n",
                                 open ? " open" : "", ClassOf(outcome.verdict), NameOf(outcome.verdict),
                                 fault.kept ? "kept " : "", XmlText(text.empty() ? "the only case" : text));
  if (!outcome.error.empty()) html += "<p>" + XmlText(outcome.error) + "</p>\n";
  if (!fault.command.empty()) html += "<p>Repeat: <code>" + XmlText(fault.command) + "</code></p>\n";
  if (!fault.shrunk.empty()) html += "<p>The smallest case found: <code>" + XmlText(fault.shrunk) + "</code></p>\n";
  if (!fault.page.empty()) {
    html += fmt::format("<p><a href=\"{}\">Watch it</a>: a page that needs no server</p>\n",
                        LinkTo(fault.folder + "/" + fault.page));
  }
  if (!fault.recording.empty()) {
    const std::string file = fault.folder + "/" + fault.recording;
    html +=
        fmt::format("<p><a href=\"{}\">Recording</a>: <code>troupe view {}</code></p>\n", LinkTo(file), XmlText(file));
  }
  if (!fault.picture.empty()) {
    html += fmt::format("<p><img src=\"{}\" alt=\"The world at the tick that decides\" width=\"560\"></p>\n",
                        LinkTo(fault.folder + "/" + fault.picture));
  }
  for (std::size_t i = 0; i < outcome.expectations.size(); ++i) {
    const ExpectationOutcome& each = outcome.expectations[i];
    html += fmt::format("<p><b class=\"{}\">{}</b> {}: robustness {}{}{}</p>\n", each.holds ? "passed" : "failed",
                        each.holds ? "holds" : "fails", XmlText(test.expect[i]), Shown(each.robustness),
                        each.cause_tick ? fmt::format(", decided by tick {}", *each.cause_tick) : "",
                        each.causes.empty() ? "" : XmlText(fmt::format(" and {}", fmt::join(each.causes, ", "))));
    if (each.holds) continue;
    std::vector<PlotPoint> points;
    for (const Monitor::Moment& moment : each.history) {
      points.push_back({static_cast<double>(moment.tick) * outcome.tick_seconds, moment.robustness});
    }
    const bool finite =
        std::count_if(points.begin(), points.end(), [](const auto& p) { return std::isfinite(p.y); }) > 1;
    if (!finite) continue;
    PlotSettings settings{test.expect[i], "time (s)", "robustness"};
    settings.line = 0.0;
    settings.markers = false;
    settings.height = 220;
    html += MakePlot(points, settings);
  }
  return html + "</details>\n";
}

}  // namespace

// Each metric over each variation; the seed is averaged over, with the confidence of the mean.
std::vector<std::pair<std::string, std::string>> CaseReport::Plots(const Entry& entry) {
  std::vector<std::pair<std::string, std::string>> plots;
  const ReportedTest& test = entry.test;
  for (std::size_t metric = 0; metric < test.metrics.size(); ++metric) {
    for (std::size_t v = 0; v < test.vary.size(); ++v) {
      if (test.vary[v] == "seed") continue;
      std::map<std::string, Statistics> by_value;
      for (const auto& [number, row] : entry.rows) {
        if (row.kept || v >= row.draws.size() || metric >= row.metrics.size() || !row.metrics[metric]) continue;
        by_value[row.draws[v].value].Add(*row.metrics[metric]);
      }
      if (by_value.empty()) continue;
      const bool numbers =
          std::all_of(by_value.begin(), by_value.end(), [](const auto& each) { return IsNumber(each.first); });
      PlotSettings settings{test.metrics[metric], test.vary[v], WithUnit(test.metrics[metric], test.units[metric])};
      std::vector<PlotPoint> points;
      for (const auto& [value, statistics] : by_value) {
        const double x = numbers ? NumberIn(value) : static_cast<double>(settings.x_words.size());
        if (!numbers) settings.x_words.push_back(value.substr(0, 16));
        points.push_back({x, statistics.mean(), statistics.confidence()});
      }
      std::sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
      plots.emplace_back(fmt::format("-metric{}-{}.svg", metric + 1, v + 1), MakePlot(points, settings));
    }
  }
  return plots;
}

// A row for all cases that differ in the seed alone.
std::string CaseReport::MetricTable(const Entry& entry, std::size_t metric) {
  struct Group {
    std::uint64_t runs = 0;
    Statistics statistics;  // of those in which the metric exists
  };
  std::map<std::string, Group> groups;
  std::vector<std::string> names;  // in the order of the cases
  std::uint64_t undefined = 0;
  for (const auto& [number, row] : entry.rows) {
    if (row.kept || row.verdict == CaseVerdict::kNotRun) continue;
    const std::string name = GroupOf(row.draws);
    if (!groups.contains(name)) names.push_back(name);
    Group& group = groups[name];
    ++group.runs;
    if (metric < row.metrics.size() && row.metrics[metric]) group.statistics.Add(*row.metrics[metric]);
    if (metric < row.undefined.size()) undefined += row.undefined[metric];
  }
  const std::string title = WithUnit(entry.test.metrics[metric], entry.test.units[metric]);
  std::string html = fmt::format(
      "<h3>{}</h3>\n{}<tr><th>case</th><th>runs</th><th>mean</th><th>95 % confidence</th>"
      "<th>deviation</th><th>least</th><th>greatest</th></tr>\n",
      XmlText(title), TableBegin(title));
  std::size_t shown = 0;
  for (const std::string& name : names) {
    const auto& [runs, statistics] = groups.at(name);
    if (++shown > kMaxGroups) {
      html += fmt::format("<tr><td colspan=\"7\">{} more: see the CSV file</td></tr>\n", groups.size() - kMaxGroups);
      break;
    }
    html += fmt::format(
        "<tr><td><code>{}</code></td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        XmlText(name.empty() ? "all" : name),
        statistics.count() == runs ? std::to_string(runs) : fmt::format("{} of {}", statistics.count(), runs),
        statistics.count() == 0 ? "none" : Shown(statistics.mean()),
        statistics.count() < 2 ? "" : "± " + Shown(statistics.confidence()),
        statistics.count() == 0 ? "" : Shown(statistics.deviation()),
        statistics.count() == 0 ? "" : Shown(statistics.min()), statistics.count() == 0 ? "" : Shown(statistics.max()));
  }
  html += kTableEnd;
  if (undefined > 0) {
    html += fmt::format("<p>{} no number, as 0 / 0, and left out</p>\n",
                        undefined == 1 ? "1 value of a tick was" : fmt::format("{} values of ticks were", undefined));
  }
  return html;
}

// The least robustness tells how near a test that passes is to failing.
std::string CaseReport::PageOf(const Entry& entry, const std::string& name) const {
  const ReportedTest& test = entry.test;
  const std::uint64_t kept = Sum(entry.kept_counts);
  const std::uint64_t count = Sum(entry.counts);
  const std::string cases = test.cases > 0 ? fmt::format("{} of {} cases of its design", count, test.cases)
                                           : fmt::format("{} case{} of a search", count, count == 1 ? "" : "s");
  std::string html =
      fmt::format("<h2>{}</h2>\n<p><code>{}</code>, {}{}</p>\n", XmlText(test.name), XmlText(test.path), cases,
                  kept > 0 ? fmt::format(", and {} kept case{}", kept, kept == 1 ? "" : "s") : "");
  // What one looks for first: the plots, as those of a sweep, or the cases that did not pass.
  std::string plots;
  for (const auto& [file, svg] : Plots(entry)) plots += svg;
  for (const HeatMap& map : entry.heat.maps()) plots += HeatFigure(map, name, RunsOfHeat(entry));
  if (!plots.empty()) plots = "<div class=\"plots\">\n" + plots + "</div>\n";
  if (entry.faults.empty()) html += std::exchange(plots, "");
  if (!test.expect.empty()) {
    html += TableBegin("Expectations") +
            "<tr><th>expectation</th><th>formula</th><th>holds</th><th>fails</th><th>least robustness</th><th>in "
            "case</th></tr>\n";
    for (std::size_t i = 0; i < test.expect.size(); ++i) {
      std::uint64_t holds = 0;
      std::uint64_t fails = 0;
      const Row* nearest = nullptr;
      for (const auto& [number, row] : entry.rows) {
        if (row.kept || i >= row.robustness.size()) continue;
        ++(std::signbit(row.robustness[i]) ? fails : holds);
        if (nearest == nullptr || row.robustness[i] < nearest->robustness[i]) nearest = &row;
      }
      html += fmt::format(
          "<tr><td>{}</td><td><code>{}</code></td><td class=\"n\">{}</td><td class=\"n {}\">{}</td>"
          "<td class=\"n\">{}</td><td><code>{}</code></td></tr>\n",
          XmlText(test.expect[i]), XmlText(test.formulas[i]), holds, fails > 0 ? "failed" : "", fails,
          nearest != nullptr ? Shown(nearest->robustness[i]) : "",
          nearest != nullptr ? XmlText(CaseText(nearest->draws)) : "");
    }
    html += kTableEnd;
  }
  if (!test.cover.empty()) {
    html += TableBegin("Situations") + "<tr><th>situation</th><th>cases that reach it</th></tr>\n";
    for (std::size_t i = 0; i < test.cover.size(); ++i) {
      const auto reached = std::count_if(entry.rows.begin(), entry.rows.end(), [&](const auto& row) {
        return !row.second.kept && i < row.second.covered.size() && row.second.covered[i];
      });
      html += fmt::format("<tr><td>{}</td><td class=\"n {}\">{}</td></tr>\n", XmlText(test.cover[i]),
                          reached == 0 ? "failed" : "", reached);
    }
    html += kTableEnd;
  }
  html += "<p class=\"grid\" role=\"img\" aria-label=\"A square for each case\">";
  constexpr std::size_t kMaxSquares = 5000;
  std::size_t squares = 0;
  for (const auto& [number, row] : entry.rows) {
    if (++squares > kMaxSquares) break;
    html += fmt::format("<span class=\"{}\" title=\"{}\"></span>", ClassOf(row.verdict), XmlText(CaseText(row.draws)));
  }
  html += "</p>\n";
  std::size_t shown = 0;
  for (const auto& [number, fault] : entry.faults) {
    if (++shown > kMaxFaults) {
      html += fmt::format("<p>{} more: see cases.jsonl</p>\n", entry.faults.size() - kMaxFaults);
      break;
    }
    if (shown == kFirstFaults + 1)
      html += fmt::format("<details><summary>{} more</summary>\n", entry.faults.size() - kFirstFaults);
    html += FaultText(test, fault, shown == 1);
  }
  if (shown > kFirstFaults) html += "</details>\n";
  html += plots;
  for (std::size_t i = 0; i < test.metrics.size(); ++i) html += MetricTable(entry, i);
  return html;
}

std::string CaseReport::Page() const {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Cases</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<style>{}</style></head><body><main>\n<h1>",
      kStyle);
  const auto list = [&](const auto& count_of) {
    bool first = true;
    for (const CaseVerdict verdict :
         {CaseVerdict::kPassed, CaseVerdict::kFailed, CaseVerdict::kError, CaseVerdict::kNotRun}) {
      const std::uint64_t count = count_of(verdict);
      if (count == 0 && verdict != CaseVerdict::kPassed) continue;
      html +=
          fmt::format("{}<span class=\"{}\">{} {}</span>", first ? "" : ", ", ClassOf(verdict), count, NameOf(verdict));
      first = false;
    }
  };
  list([&](CaseVerdict verdict) { return Count(verdict); });
  if (HasKept()) {
    html += "<br><small>kept cases: ";
    list([&](CaseVerdict verdict) { return CountKept(verdict); });
    html += "</small>";
  }
  html += "</h1>\n";
  const std::vector<std::string> names = FileNames();
  for (std::size_t i = 0; i < entries_.size(); ++i) html += PageOf(entries_[i], names[i]);
  return html + "</main></body></html>\n";
}

}  // namespace troupe
