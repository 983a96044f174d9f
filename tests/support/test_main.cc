// The main function of all test programs: GoogleTest's, with one more option,
//   --sources=unit/core/step_test.cc,...    runs the tests in these files of the folder tests, and no others
// and a line "SKIPPED test: reason" for each test that skips itself. Files without a test, or none that is known, are
// an error: a test that is never run would pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

namespace {

std::string NameOf(const testing::TestInfo& test) {
  return std::string(test.test_suite_name()) + "." + test.name();
}

// The filter that selects the tests in some files; empty if there are none.
std::string FilterOf(const std::set<std::string, std::less<>>& files) {
  std::string filter;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      const std::string_view path = test.file();
      const std::size_t folder = path.rfind("/tests/");
      if (folder == std::string_view::npos || !files.contains(path.substr(folder + 7))) continue;
      if (!filter.empty()) filter += ':';
      filter += NameOf(test);
    }
  }
  return filter;
}

class SkipPrinter final : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo& test) override {
    if (!test.result()->Skipped()) return;
    for (int i = 0; i < test.result()->total_part_count(); ++i) {
      const testing::TestPartResult& part = test.result()->GetTestPartResult(i);
      if (part.skipped()) std::printf("SKIPPED %s: %s\n", NameOf(test).c_str(), part.message());
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  for (int i = 1; i < argc; ++i) {
    constexpr std::string_view kOption = "--sources=";
    const std::string_view argument = argv[i];
    if (!argument.starts_with(kOption)) {
      std::fprintf(stderr, "found '%s', expected --sources=FILE,... or options of GoogleTest\n", argv[i]);
      return 2;
    }
    std::set<std::string, std::less<>> files;
    std::istringstream names{std::string(argument.substr(kOption.size()))};
    for (std::string name; std::getline(names, name, ',');) files.insert(name);
    const std::string filter = FilterOf(files);
    if (filter.empty()) {
      std::fprintf(stderr, "found no test in %s\n", argv[i]);
      return 2;
    }
    testing::GTEST_FLAG(filter) = filter;
  }
  testing::UnitTest::GetInstance()->listeners().Append(new SkipPrinter);  // which deletes it
  return RUN_ALL_TESTS();
}
