#include "transport/dds/binding/network_log.h"

#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe::dds {
namespace {

void Complain(int number) {
  dds_log(DDS_LC_WARNING, "file", 1, "function", "sample %d is malformed\n", number);
}

TEST(NetworkLog, ReportsALineUnchanged) {
  std::vector<std::string> lines;
  {
    const NetworkLog log([&](const std::string& line) { lines.push_back(line); });
    Complain(7);
  }
  EXPECT_THAT(lines, testing::ElementsAre("network: sample 7 is malformed"));
}

TEST(NetworkLog, CountsAFloodAndReportsItsFirstLines) {
  std::vector<std::string> lines;
  std::uint64_t counted = 0;
  constexpr int kFlood = 100'000;
  {
    const NetworkLog log([&](const std::string& line) {
      lines.push_back(line);
      const bool sum = line.find(" more lines like these") != std::string::npos;
      counted += sum ? std::stoull(line.substr(std::string("network: ").size())) : 1;
    });
    for (int i = 0; i < kFlood; ++i) Complain(i);
  }
  EXPECT_EQ(counted, kFlood);
  EXPECT_LT(lines.size(), kFlood / 100);
}

}  // namespace
}  // namespace troupe::dds
