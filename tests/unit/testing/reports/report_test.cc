// Reports: statistics, plots, JUnit, and reports that are merged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/reports/case_report.h"
#include "testing/reports/svg_plot.h"
#include "tests/support/files.h"

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

CaseReport ExampleReport(std::uint64_t first, std::uint64_t step) {
  constexpr std::array<CaseVerdict, 4> kVerdicts = {CaseVerdict::kFailed, CaseVerdict::kError, CaseVerdict::kPassed,
                                                    CaseVerdict::kPassed};
  CaseReport report;
  report.AddTest(ExampleTest());
  for (std::uint64_t i = first; i < 4; i += step) report.AddCase(0, ExampleCase(i, kVerdicts[i]));
  return report;
}

TEST(CaseReport, JUnitKeepsFailuresAndErrorsApart) {
  const std::string xml = ExampleReport(0, 1).JUnit();
  EXPECT_THAT(xml, HasSubstr("<testsuites tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"0\">"));
  EXPECT_THAT(xml, HasSubstr("<failure message=\"holds: failed at tick 4, robustness -inf, anna\" type=\"failure\">"));
  EXPECT_THAT(
      xml, HasSubstr("<error message=\"the process of the case was killed by signal 11 (&quot;&amp;&lt;&gt;&quot;)\""));
  EXPECT_THAT(xml, HasSubstr("classname=\"a&lt;b\" name=\"seed=2,n=5\""));
}

TEST(CaseReport, CountsKeptCasesApartAndLeavesThemOutOfTables) {
  CaseReport report = ExampleReport(0, 1);
  ReportedCase kept = ExampleCase(4, CaseVerdict::kFailed);
  kept.kept = true;
  report.AddCase(0, kept);
  EXPECT_EQ(report.Count(CaseVerdict::kFailed), 1U);
  EXPECT_EQ(report.CountKept(CaseVerdict::kFailed), 1U);
  EXPECT_THAT(report.JUnit(), HasSubstr("<testsuites tests=\"5\" failures=\"2\" errors=\"1\" skipped=\"0\">"));
  const test::TemporaryFolder folder;
  ASSERT_TRUE(report.Write(folder / "all").ok());
  ASSERT_TRUE(ExampleReport(0, 1).Write(folder / "design").ok());
  EXPECT_EQ(folder.Read("all/cases.csv"), folder.Read("design/cases.csv"));
  EXPECT_EQ(folder.Read("all/a_b-metric1-2.svg"), folder.Read("design/a_b-metric1-2.svg"));
  CaseReport read;
  ASSERT_TRUE(read.AddLines(folder / "all/cases.jsonl").ok());
  EXPECT_EQ(read.CountKept(CaseVerdict::kFailed), 1U);
}

TEST(CaseReport, HasCasesThatWereNotRun) {
  CaseReport report = ExampleReport(0, 1);
  report.AddCase(0, {4, false, {{"seed", "4"}, {"n", "5"}}});
  EXPECT_THAT(report.JUnit(),
              HasSubstr("name=\"seed=4,n=5\" time=\"0.000\"><skipped message=\"not run\"/></testcase>"));
  const test::TemporaryFolder folder;
  ASSERT_TRUE(report.Write(folder / "all").ok());
  CaseReport read;
  ASSERT_TRUE(read.AddLines(folder / "all/cases.jsonl").ok());
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
  ASSERT_TRUE(merged.AddLines(folder / "two/cases.jsonl").ok());
  ASSERT_TRUE(merged.AddLines(folder / "one/cases.jsonl").ok());
  ASSERT_TRUE(merged.Write(folder / "merged").ok());
  for (const char* const name : {"cases.jsonl", "cases.csv", "index.html", "a_b-metric1-2.svg"}) {
    EXPECT_EQ(folder.Read(std::string("merged/") + name), folder.Read(std::string("whole/") + name)) << name;
    EXPECT_NE(folder.Read(std::string("whole/") + name), "") << name;
  }
  EXPECT_THAT(folder.Read("whole/cases.csv"), HasSubstr("2,2,5,passed,9,0000000000000abe,0.5,1,0,3\n"));
  // Twice the same shard.
  CaseReport twice;
  ASSERT_TRUE(twice.AddLines(folder / "one/cases.jsonl").ok());
  const Status again = twice.AddLines(folder / "one/cases.jsonl");
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(again.error().message, HasSubstr("found case 0 of 'a<b.test.json' again"));
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
  ASSERT_TRUE(read.AddLines(folder / "report/cases.jsonl").ok());
  ASSERT_TRUE(read.Write(folder / "read").ok());
  EXPECT_EQ(folder.Read("read/index.html"), page);
}

TEST(CaseReport, RefusesFilesThatAreNone) {
  const test::TemporaryFolder folder;
  for (const char* const text : {"x", "{}", "{\"test\": 3}", "{\"test\": \"a\", \"number\": 1}"}) {
    CaseReport report;
    EXPECT_FALSE(report.AddLines(folder.Write("cases.jsonl", text)).ok()) << text;
  }
}

}  // namespace
}  // namespace troupe
