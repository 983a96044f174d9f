// Reports: statistics, plots, JUnit, and reports that are merged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/base/xml_text.h"
#include "testing/reports/case_report.h"
#include "testing/reports/svg_plot.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Statistics, HasTheConfidenceOfStudent) {
  Statistics statistics;
  for (const double number : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) statistics.Add(number);
  EXPECT_DOUBLE_EQ(statistics.mean(), 5.0);
  EXPECT_NEAR(statistics.deviation(), 2.13809, 1e-5);
  EXPECT_NEAR(statistics.confidence(), 2.3646 * 2.13809 / std::sqrt(8.0), 1e-4);
  EXPECT_EQ(statistics.min(), 2.0);
  EXPECT_EQ(statistics.max(), 9.0);
  // Half the width in standard errors, for samples of any size.
  for (const auto& [count, quantile] :
       {std::pair{2, 12.706204736175}, std::pair{3, 4.302652729749}, std::pair{4, 3.182446305284},
        std::pair{31, 2.042272456301}, std::pair{32, 2.039513446396}, std::pair{101, 1.983971518524},
        std::pair{1001, 1.962339080826}}) {
    Statistics sample;
    for (int i = 0; i < count; ++i) sample.Add(i % 2);
    EXPECT_NEAR(sample.confidence() / sample.deviation() * std::sqrt(count), quantile, 1e-9) << count;
  }
}

TEST(SvgPlot, EscapesTextsAndLeavesOutWhatIsNotFinite) {
  const std::string svg =
      MakePlot({{0, 1}, {1, std::numeric_limits<double>::infinity()}, {2, 3, 0.5}}, {"a < b & \"c\"", "x", "y"});
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; &quot;c&quot;"));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(MakePlot({}, {"none", "x", "y"}), Not(HasSubstr("nan")));
}

ReportedTest ExampleTest() {
  return {"a<b.test.json",      "a<b",    {"seed", "n"}, {"holds"}, {"always tick < 9"},
          {"reached", "never"}, {"time"}, {"s"},         4};
}

ReportedCase ExampleCase(std::uint64_t number, CaseVerdict verdict) {
  ReportedCase reported;
  reported.number = number;
  reported.draws = {{"seed", std::to_string(number)}, {"n", number % 2 == 0 ? "5" : "10"}};
  CaseOutcome& outcome = reported.outcome;
  outcome.verdict = verdict;
  if (verdict == CaseVerdict::kError) {
    outcome.error = "the process of the case was killed by signal 11 (\"&<>\")";
    reported.command = "troupe test a --case 'seed=1'";
    return reported;
  }
  outcome.ticks = 9;
  outcome.state_hash = 0xabc + number;
  outcome.tick_seconds = 0.1;
  const bool holds = verdict == CaseVerdict::kPassed;
  outcome.expectations.resize(1);
  outcome.expectations[0].holds = holds;
  outcome.expectations[0].robustness = holds ? 0.5 : -std::numeric_limits<double>::infinity();
  if (!holds) {
    outcome.expectations[0].cause_tick = 4;
    outcome.expectations[0].causes = {"anna"};
    outcome.expectations[0].history = {{0, 0.5}, {4, -1.0}};
    reported.command = "troupe test a --case 'seed=0'";
  }
  outcome.covered = {holds, false};
  outcome.metrics = {holds ? std::optional(1.5 * static_cast<double>(number)) : std::nullopt};
  return reported;
}

ReportedCase FailedCaseWithFiles() {
  ReportedCase reported = ExampleCase(0, CaseVerdict::kFailed);
  reported.shrunk = "troupe test a --case 'seed=0,ticks=4' (1 robot, 4 ticks, after 3 runs)";
  reported.folder = "a #1";
  reported.recording = "run.mcap";
  reported.picture = "violation.png";
  reported.page = "run.html";
  return reported;
}

CaseReport ExampleReport(std::uint64_t first, std::uint64_t step) {
  constexpr std::array<CaseVerdict, 4> kVerdicts = {CaseVerdict::kFailed, CaseVerdict::kError, CaseVerdict::kPassed,
                                                    CaseVerdict::kPassed};
  CaseReport report;
  ReportedTest test = ExampleTest();
  test.shard = {first + 1, step};
  report.AddTest(test);
  for (std::uint64_t i = first; i < 4; i += step) report.AddCase(0, ExampleCase(i, kVerdicts[i]));
  return report;
}

TEST(CaseReport, JUnitKeepsFailuresAndErrorsApart) {
  const std::string xml = ExampleReport(0, 1).JUnit("");
  EXPECT_THAT(xml, HasSubstr("<testsuites tests=\"4\" failures=\"1\" errors=\"1\">"));
  EXPECT_THAT(xml, HasSubstr("tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"0\">"));
  EXPECT_THAT(xml, HasSubstr("<failure message=\"holds: fails at tick 4 of anna, robustness -inf\" type=\"failure\">"));
  EXPECT_THAT(
      xml, HasSubstr("<error message=\"the process of the case was killed by signal 11 (&quot;&amp;&lt;&gt;&quot;)\""));
  EXPECT_THAT(xml, HasSubstr("classname=\"a&lt;b\" name=\"seed=2,n=5\""));
}

TEST(CaseReport, JUnitHasAllThatShowsAFailure) {
  CaseReport report;
  report.AddTest(ExampleTest());
  report.AddCase(0, FailedCaseWithFiles(), 0.25);
  const std::string xml = report.JUnit("out");
  EXPECT_THAT(xml, HasSubstr(" time=\"0.250\">"));
  EXPECT_THAT(xml,
              HasSubstr("\nrepeat: troupe test a --case &#39;seed=0&#39;\n"
                        "smallest: troupe test a --case &#39;seed=0,ticks=4&#39; (1 robot, 4 ticks, after 3 runs)\n"
                        "recording: out/a #1/run.mcap\npage: out/a #1/run.html\npicture: out/a #1/violation.png\n"
                        "</failure>"));
}

TEST(CaseReport, CountsKeptCasesApartAndLeavesThemOutOfTables) {
  CaseReport report = ExampleReport(0, 1);
  ReportedCase kept = ExampleCase(4, CaseVerdict::kFailed);
  kept.kept = true;
  report.AddCase(0, kept);
  EXPECT_EQ(report.Count(CaseVerdict::kFailed), 1U);
  EXPECT_EQ(report.CountKept(CaseVerdict::kFailed), 1U);
  EXPECT_THAT(report.JUnit(""), HasSubstr("<testsuites tests=\"5\" failures=\"2\" errors=\"1\">"));
  const test::TemporaryFolder folder;
  ASSERT_TRUE(report.Write(folder / "all").ok());
  ASSERT_TRUE(ExampleReport(0, 1).Write(folder / "design").ok());
  EXPECT_EQ(folder.Read("all/cases.csv"), folder.Read("design/cases.csv"));
  EXPECT_EQ(folder.Read("all/a_b-metric1-2.svg"), folder.Read("design/a_b-metric1-2.svg"));
  CaseReport read;
  ASSERT_TRUE(read.Merge(folder / "all", folder / "merged").ok());
  EXPECT_EQ(read.CountKept(CaseVerdict::kFailed), 1U);
}

TEST(CaseReport, HasCasesThatWereNotRun) {
  CaseReport report = ExampleReport(0, 1);
  report.AddCase(0, {4, false, {{"seed", "4"}, {"n", "5"}}});
  EXPECT_THAT(report.JUnit(""), HasSubstr("name=\"seed=4,n=5\"><skipped message=\"not run\"/></testcase>"));
  const test::TemporaryFolder folder;
  ASSERT_TRUE(report.Write(folder / "all").ok());
  CaseReport read;
  ASSERT_TRUE(read.Merge(folder / "all", folder / "merged").ok());
  EXPECT_EQ(read.Count(CaseVerdict::kNotRun), 1U);
}

TEST(CaseReport, ListsSituationsThatNoCaseReached) {
  EXPECT_THAT(ExampleReport(0, 1).Uncovered(), testing::ElementsAre("a<b: never"));
}

TEST(CaseReport, TheMergedReportIsThatOfAllCases) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(ExampleReport(0, 1).Write(folder / "whole").ok());
  ASSERT_TRUE(ExampleReport(0, 2).Write(folder / "one").ok());
  ASSERT_TRUE(ExampleReport(1, 2).Write(folder / "two").ok());
  CaseReport merged;
  ASSERT_TRUE(merged.Merge(folder / "two", folder / "merged").ok());
  ASSERT_TRUE(merged.Merge(folder / "one", folder / "merged").ok());
  ASSERT_TRUE(merged.FinishMerge().ok());
  ASSERT_TRUE(merged.Write(folder / "merged").ok());
  for (const char* const name : {"cases.jsonl", "cases.csv", "index.html", "a_b-metric1-2.svg"}) {
    EXPECT_EQ(folder.Read(std::string("merged/") + name), folder.Read(std::string("whole/") + name)) << name;
    EXPECT_NE(folder.Read(std::string("whole/") + name), "") << name;
  }
  EXPECT_THAT(folder.Read("whole/cases.csv"), HasSubstr("2,2,5,passed,9,0000000000000abe,0.5,1,0,3\n"));
}

TEST(CaseReport, AMergedReportLinksTheFilesOfItsShards) {
  const test::TemporaryFolder folder;
  CaseReport report;
  ReportedTest test = ExampleTest();
  test.cases = 1;
  report.AddTest(test);
  report.AddCase(0, FailedCaseWithFiles());
  ASSERT_TRUE(report.Write(folder / "one").ok());
  EXPECT_THAT(folder.Read("one/index.html"), HasSubstr("<a href=\"a%20%231/run.html\">"));
  CaseReport merged;
  ASSERT_TRUE(merged.Merge(folder / "one", folder / "deep/merged").ok());
  ASSERT_TRUE(merged.FinishMerge().ok());
  ASSERT_TRUE(merged.Write(folder / "deep/merged").ok());
  EXPECT_THAT(folder.Read("deep/merged/index.html"), HasSubstr("<a href=\"../../one/a%20%231/run.html\">"));
  EXPECT_THAT(merged.JUnit(folder / "deep/merged"), HasSubstr("/deep/merged/../../one/a #1/run.mcap\n"));
}

TEST(CaseReport, AMergeWithoutAllShardsIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(ExampleReport(0, 2).Write(folder / "one").ok());
  ASSERT_TRUE(ExampleReport(1, 2).Write(folder / "two").ok());
  ASSERT_TRUE(ExampleReport(0, 3).Write(folder / "third").ok());
  const std::string into = folder / "merged";
  CaseReport report;
  ASSERT_TRUE(report.Merge(folder / "one", into).ok());
  EXPECT_EQ(report.FinishMerge().error().message, "found no shard 2/2 of 'a<b.test.json', expected all");
  EXPECT_THAT(report.Merge(folder / "one", into).error().message,
              HasSubstr("found shard 1/2 of 'a<b.test.json' again, expected each once"));
  EXPECT_THAT(report.Merge(folder / "third", into).error().message,
              HasSubstr("found shard 1/3 of 'a<b.test.json' beside shard 1/2"));
  // The other shard by another path of the test.
  std::string lines = folder.Read("two/cases.jsonl");
  for (std::size_t at = 0; (at = lines.find("\"a<b.test.json\"", at)) != std::string::npos; ++at)
    lines.insert(at + 1, "./");
  folder.Write("two/cases.jsonl", lines);
  ASSERT_TRUE(report.Merge(folder / "two", into).ok());
  EXPECT_EQ(report.FinishMerge().error().message,
            "found no shard 2/2 of 'a<b.test.json', expected all; found shard 2/2 of './a<b.test.json': are these two "
            "paths of one test?");
  // A shard whose file was cut off.
  const std::string first = folder.Read("one/cases.jsonl");
  folder.Write("one/cases.jsonl", first.substr(0, first.rfind('\n', first.size() - 2) + 1));
  ASSERT_TRUE(ExampleReport(1, 2).Write(folder / "two").ok());
  CaseReport cut;
  ASSERT_TRUE(cut.Merge(folder / "one", into).ok());
  ASSERT_TRUE(cut.Merge(folder / "two", into).ok());
  EXPECT_EQ(cut.FinishMerge().error().message, "found 3 of the 4 cases of 'a<b.test.json', expected all");
}

TEST(CaseReport, SaysOfHowManyRunsAMetricIs) {
  CaseReport report = ExampleReport(0, 1);  // one of n = 5 has failed without the metric, one of n = 10 is an error
  report.AddTest({"other.test.json", "other", {"seed", "n"}, {}, {}, {}, {"time"}, {"s"}, 2});
  for (const std::uint64_t number : {0U, 1U}) {
    ReportedCase none = ExampleCase(number, CaseVerdict::kPassed);
    none.outcome.metrics = {std::nullopt};
    none.outcome.undefined = {3};
    report.AddCase(1, none);
  }
  const test::TemporaryFolder folder;
  ASSERT_TRUE(report.Write(folder / "report").ok());
  const std::string page = folder.Read("report/index.html");
  EXPECT_THAT(page, HasSubstr("<code>n=5</code></td><td class=\"n\">1 of 2</td><td class=\"n\">3</td>"));
  EXPECT_THAT(page, HasSubstr("<code>n=10</code></td><td class=\"n\">1 of 2</td><td class=\"n\">4.5</td>"));
  EXPECT_THAT(page, HasSubstr("<code>n=5</code></td><td class=\"n\">0 of 1</td><td class=\"n\">none</td>"));
  EXPECT_THAT(page, HasSubstr("6 values of ticks were no number"));
  CaseReport read;
  ASSERT_TRUE(read.Merge(folder / "report", folder / "read").ok());
  ASSERT_TRUE(read.FinishMerge().ok());
  ASSERT_TRUE(read.Write(folder / "read").ok());
  EXPECT_EQ(folder.Read("read/index.html"), page);
}

// The maps of a case: one robot that stands still in the cell of its number.
std::vector<HeatMap> HeatOfCase(const TestHeat& heat, std::uint64_t number) {
  std::vector<HeatMap> maps;
  for (const HeatKind kind : heat.kinds) {
    HeatMap::Times times{0, 100'000'000, {{{static_cast<std::int64_t>(number % 3), -1}, 9}}};
    if (kind == HeatKind::kWaits && number != 1) times = {};
    maps.push_back(test::ValueOf(HeatMap::Of(kind, heat.cell, std::move(times))));
  }
  return maps;
}

WorldDescription HeatWorld() {
  SmallWorld world;
  world.AddRobot("a", {0.0, 0.0, 0.0, 0.0});
  return world.world();
}

// The cases of a shard, with their heat maps, in the order of the numbers or against it.
CaseReport HeatReport(std::uint64_t first, std::uint64_t step, bool backwards = false, double cell = 0.5) {
  ReportedTest test = ExampleTest();
  test.shard = {first + 1, step};
  test.heat = {{HeatKind::kWaits, HeatKind::kRobots}, cell};
  CaseReport report;
  report.AddTest(test, HeatWorld());
  for (std::uint64_t i = 0; i < 4; ++i) {
    const std::uint64_t number = backwards ? 3 - i : i;
    if (number % step != first) continue;
    report.AddHeat(0, HeatOfCase(test.heat, number));
    report.AddCase(0, ExampleCase(number, CaseVerdict::kPassed));
  }
  return report;
}

TEST(CaseReport, AddsUpTheHeatMapsOfCasesInAnyOrderAndOfShards) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(HeatReport(0, 1).Write(folder / "whole").ok());
  ASSERT_TRUE(HeatReport(0, 1, true).Write(folder / "backwards").ok());
  ASSERT_TRUE(HeatReport(0, 2).Write(folder / "one").ok());
  ASSERT_TRUE(HeatReport(1, 2).Write(folder / "two").ok());
  CaseReport merged;
  ASSERT_TRUE(merged.Merge(folder / "two", folder / "merged").ok());
  ASSERT_TRUE(merged.Merge(folder / "one", folder / "merged").ok());
  ASSERT_TRUE(merged.FinishMerge().ok());
  ASSERT_TRUE(merged.Write(folder / "merged").ok());
  for (const char* const name : {"cases.jsonl", "index.html", "a_b-heat-robots.png", "a_b-heat-waits.png"}) {
    const std::string whole = folder.Read(std::string("whole/") + name);
    EXPECT_NE(whole, "") << name;
    EXPECT_EQ(folder.Read(std::string("backwards/") + name), whole) << name;
    EXPECT_EQ(folder.Read(std::string("merged/") + name), whole) << name;
    EXPECT_NE(folder.Read(std::string("one/") + name), whole) << name;
  }
  EXPECT_THAT(folder.Read("whole/cases.jsonl"), HasSubstr("\"cells\":[0,-1,18,1,-1,9,2,-1,9]"));
  const std::string page = folder.Read("whole/index.html");
  EXPECT_THAT(page, HasSubstr("<img src=\"a_b-heat-robots.png\" alt=\"Where robots were in 4 runs, in the world of the "
                              "first case\""));
  EXPECT_LT(page.find("a_b-heat-waits.png"), page.find("a_b-heat-robots.png")) << "in the order of the test";
}

TEST(CaseReport, AMergeRefusesHeatMapsOfAnotherTest) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(HeatReport(0, 2).Write(folder / "one").ok());
  ASSERT_TRUE(HeatReport(1, 2, false, 0.25).Write(folder / "two").ok());
  CaseReport other;
  ASSERT_TRUE(other.Merge(folder / "one", folder / "merged").ok());
  EXPECT_THAT(other.Merge(folder / "two", folder / "merged").error().message,
              HasSubstr("found another test 'a<b.test.json' than in the folders before"));
  // Lines that were changed: without the maps, with those of another kind, and with another world.
  const std::string lines = folder.Read("one/cases.jsonl");
  const std::size_t begin = lines.find('\n') + 1;
  const std::size_t end = lines.find('\n', begin) + 1;
  ASSERT_TRUE(HeatReport(1, 2).Write(folder / "two").ok());
  folder.Write("one/cases.jsonl", lines.substr(0, begin) + lines.substr(end));
  CaseReport without;
  ASSERT_TRUE(without.Merge(folder / "one", folder / "merged").ok());
  ASSERT_TRUE(without.Merge(folder / "two", folder / "merged").ok());
  EXPECT_EQ(without.FinishMerge().error().message,
            "found heat maps of 1 of the 2 shards of 'a<b.test.json', expected those of all");
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string changed = lines;
    changed.replace(changed.find(from, begin), from.size(), to);
    folder.Write("one/cases.jsonl", changed);
    CaseReport report;
    const Status merged = report.Merge(folder / "one", folder / "merged");
    EXPECT_FALSE(merged.ok()) << to;
    if (merged.ok()) return std::string();
    EXPECT_EQ(merged.error().where.line, 2) << to;
    return merged.error().message;
  };
  EXPECT_EQ(refused("\"of\":\"waits\"", "\"of\":\"people\""),
            "found heat maps of another test, expected those that its line names");
  EXPECT_EQ(refused("\"zstd\":\"", "\"zstd\":\"AAAA"), "found no world of a report");
  EXPECT_THAT(refused("\"unit_ns\":100000000", "\"unit_ns\":-1"), HasSubstr("found a heat map out of bounds"));
}

TEST(CaseReport, RefusesFilesThatAreNone) {
  const test::TemporaryFolder folder;
  for (const char* const text : {"x", "{}", "{\"test\": 3}", "{\"test\": \"a\", \"number\": 1}"}) {
    CaseReport report;
    folder.Write("one/cases.jsonl", text);
    EXPECT_FALSE(report.Merge(folder / "one", folder / "merged").ok()) << text;
  }
}

}  // namespace
}  // namespace troupe
