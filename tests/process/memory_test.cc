// Dense maps in bounded memory, and programs that cannot have the memory that they need.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <fstream>
#include <sstream>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kMebibyte = 1024 * 1024;

std::string BigEndian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255);
  return bytes;
}

std::string Chunk(const std::string& type_and_data) {
  const auto* bytes = reinterpret_cast<const Bytef*>(type_and_data.data());
  const auto size = static_cast<std::uint32_t>(type_and_data.size());
  return BigEndian(size - 4) + type_and_data + BigEndian(static_cast<std::uint32_t>(crc32(0, bytes, size)));
}

// A PNG of one bit for each pixel, whose rows are `even` and `odd` throughout.
void WritePng(const std::string& path, std::uint32_t side, char even, char odd) {
  std::string rows;
  for (std::uint32_t y = 0; y < side; ++y) rows += '\0' + std::string(side / 8, y % 2 == 0 ? even : odd);
  uLongf size = compressBound(rows.size());
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size(),
            9);
  packed.resize(size);
  std::ofstream(path, std::ios::binary) << "\x89PNG\r\n\x1a\n"
                                        << Chunk("IHDR" + BigEndian(side) + BigEndian(side) +
                                                 std::string("\x01\0\0\0\0", 5))
                                        << Chunk("IDAT" + packed) << Chunk("IEND");
}

// The number of kibibytes in a line of /proc/PROCESS/status.
std::size_t Kibibytes(pid_t process, const std::string& key) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    std::istringstream words(line);
    std::string name;
    std::size_t number = 0;
    if (words >> name >> number && name == key + ":") return number;
  }
  ADD_FAILURE() << "no " << key << " of process " << process;
  return 0;
}

// From now on the process may have so many bytes more than it has.
void LimitMemory(pid_t process, std::size_t more) {
  const rlim_t limit = Kibibytes(process, "VmSize") * 1024 + more;
  const rlimit limits{limit, limit};
  ASSERT_EQ(prlimit(process, RLIMIT_AS, &limits, nullptr), 0);
}

std::string WorldOf(const std::string& image) {
  return "model ( name \"map\" bitmap \"" + image +
         "\" size [400 400 1] pose [250 0 0 0] )\n"
         "position ( name \"r0\" size [0.4 0.4 0.3] ctrl \"wander\" ranger ( sensor ( range [0 30] fov 90 samples 5 ) "
         ") )\n";
}

class Memory : public testing::Test {
 protected:
  Memory() {
    WritePng(folder_.Path("checkerboard.png"), kSide, 0x55, static_cast<char>(0xaa));
    std::ofstream(folder_.Path("checkerboard.world")) << WorldOf("checkerboard.png");
    std::ofstream(folder_.Path("small.world")) << "position ( name \"r0\" size [0.4 0.4 0.3] ctrl \"wander\" )\n";
  }

  // Some gigabytes as a list of rectangles.
  static constexpr std::uint32_t kSide = 2000;
  static constexpr std::size_t kAllowed = 16 * kSide * kSide;  // bytes

  TemporaryFolder folder_;
};

TEST_F(Memory, OfARunWithADenseMapIsBounded) {
  const std::string session = TestSession("dense");
  Program run = Troupe({"run", folder_.Path("checkerboard.world"), "--headless", "--domain",
                        std::to_string(TestDomain()), "--session", session, "--paused", "--no-ros"});
  ControlClient client(NetworkOf(session));
  ASSERT_TRUE(client.WaitForService(kSeconds).ok());
  const ControlReply reply = ValueOf(client.Call(control::Step{.ticks = 20}, kSeconds));
  ASSERT_TRUE(reply.done) << reply.problem;
  const std::vector<pid_t> processes = ChildrenOf(run.pid());
  EXPECT_EQ(processes.size(), 2u) << "a service and an agent";
  const std::size_t program = (kCanLimitMemory ? 60 : 120) * kMebibyte;  // sanitizers keep freed memory
  for (const pid_t process : processes) {
    EXPECT_LE(Kibibytes(process, "VmHWM") * 1024, program + kAllowed) << CommandLineOf(process);
  }
  run.Interrupt();
}

TEST_F(Memory, ForALoadedWorldMayBeMissing) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers need more addresses than a limit leaves";
  WritePng(folder_.Path("huge.png"), 40'000, 0x55, static_cast<char>(0xaa));  // 200 MB as bits
  std::ofstream(folder_.Path("huge.world")) << WorldOf("huge.png");
  const std::string session = TestSession("load");
  Program run = Troupe({"run", folder_.Path("small.world"), "--headless", "--domain", std::to_string(TestDomain()),
                        "--session", session, "--paused", "--no-ros"});
  ControlClient client(NetworkOf(session));
  ASSERT_TRUE(client.WaitForService(kSeconds).ok());
  ASSERT_TRUE(client.Call(control::Step{.ticks = 5}, kSeconds).ok());
  for (const pid_t process : ChildrenOf(run.pid())) {
    if (CommandLineOf(process).find("world-service") != std::string::npos) LimitMemory(process, 100 * kMebibyte);
  }
  control::LoadWorld load{.source = folder_.Path("huge.world")};
  const ControlReply refused = ValueOf(client.Call(load, kSeconds));
  EXPECT_FALSE(refused.done);
  EXPECT_THAT(refused.problem, HasSubstr("there is not enough memory"));
  EXPECT_EQ(ValueOf(client.Call(control::Step{.ticks = 20}, kSeconds)).tick, 25u) << "the run continues";
  run.Interrupt();
}

TEST_F(Memory, MissingEndsAProgramWithOneLine) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers need more addresses than a limit leaves";
  WritePng(folder_.Path("huge.png"), 40'000, 0x55, static_cast<char>(0xaa));
  std::ofstream(folder_.Path("huge.world")) << WorldOf("huge.png");
  const std::string world = folder_.Path("huge.world");
  const std::string domain = std::to_string(TestDomain());
  const auto limited = [](const std::string& program) {
    return std::vector<std::string>{"/bin/sh", "-c", "ulimit -v 180000 && exec \"$0\" \"$@\"", ProgramPath(program)};
  };
  std::vector<std::vector<std::string>> commands;
  commands.push_back(limited("troupe"));
  commands.back().insert(commands.back().end(), {"check", world});
  commands.push_back(limited("troupe"));
  commands.back().insert(commands.back().end(), {"snapshot", world, "-o", folder_.Path("huge_picture.png")});
  commands.push_back(limited("troupe"));
  commands.back().insert(commands.back().end(), {"run", world, "--in-process", "--headless", "--ticks", "3"});
  commands.push_back(limited("troupe"));
  commands.back().insert(commands.back().end(), {"run", world, "--headless", "--ticks", "3", "--domain", domain,
                                                 "--session", TestSession("limited")});
  commands.push_back(limited("world-service"));
  commands.back().insert(commands.back().end(),
                         {world, "--domain", domain, "--session", TestSession("limited-service")});
  for (const std::vector<std::string>& command : commands) {
    EXPECT_THAT(OutputOf(Program(command), 3), HasSubstr("error: there is not enough memory"))
        << command[3] << " " << command[4];
  }
}

}  // namespace
}  // namespace troupe::test
