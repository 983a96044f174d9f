#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "transport/shared_memory/shared_layout.h"

namespace troupe {
namespace {

struct LockedMemory {
  SeqlockHeader header{};
  std::array<Word, 8> words{};
};

void Write(LockedMemory& memory, std::uint64_t value) {
  SeqlockWriter writer(memory.header, memory.words);
  for (std::size_t i = 0; i < memory.words.size(); ++i) writer.words().Add(value);
  writer.Finish();
}

TEST(SeqlockTest, MessageIsReadOnce) {
  LockedMemory memory;
  std::uint64_t seen = 0;
  std::uint64_t value = 0;
  const auto read = [&](WordReader words) { EXPECT_TRUE(words.Read(value)); };
  EXPECT_FALSE(ReadNewer(memory.header, memory.words, seen, read));
  Write(memory, 5);
  EXPECT_TRUE(ReadNewer(memory.header, memory.words, seen, read));
  EXPECT_EQ(value, 5u);
  EXPECT_FALSE(ReadNewer(memory.header, memory.words, seen, read));
}

TEST(SeqlockTest, MessageOfAKilledWriterIsNotReadAndTheNextOneIs) {
  LockedMemory memory;
  std::uint64_t seen = 0;
  std::uint64_t value = 0;
  const auto read = [&](WordReader words) { EXPECT_TRUE(words.Read(value)); };
  Write(memory, 5);
  [[maybe_unused]] const SeqlockWriter killed(memory.header, memory.words);
  EXPECT_FALSE(ReadNewer(memory.header, memory.words, seen, read));
  Write(memory, 6);
  EXPECT_TRUE(ReadNewer(memory.header, memory.words, seen, read));
  EXPECT_EQ(value, 6u);
}

TEST(SeqlockTest, MessageThatDoesNotFitIsNone) {
  LockedMemory memory;
  std::uint64_t seen = 0;
  SeqlockWriter writer(memory.header, memory.words);
  for (std::size_t i = 0; i <= memory.words.size(); ++i) writer.words().Add(std::uint64_t{1});
  EXPECT_FALSE(writer.Finish());
  EXPECT_FALSE(ReadNewer(memory.header, memory.words, seen, [](WordReader) { FAIL(); }));
}

TEST(SeqlockTest, FalseLengthIsNotRead) {
  LockedMemory memory;
  std::uint64_t seen = 0;
  Write(memory, 5);
  memory.header.count = memory.words.size() + 1;
  EXPECT_FALSE(ReadNewer(memory.header, memory.words, seen, [](WordReader) { FAIL(); }));
}

TEST(SeqlockTest, ReaderNeverObtainsPartsOfTwoMessages) {
  LockedMemory memory;
  std::atomic<bool> over = false;
  std::thread writer([&] {
    for (std::uint64_t value = 1; value <= 200000; ++value) Write(memory, value);
    over = true;
  });
  std::uint64_t seen = 0;
  std::uint64_t newest = 0;
  std::uint64_t complete = 0;
  while (!over || complete == 0) {
    std::array<std::uint64_t, 8> values{};
    const bool is_whole = ReadNewer(memory.header, memory.words, seen, [&](WordReader words) {
      for (std::uint64_t& value : values) EXPECT_TRUE(words.Read(value));
    });
    if (!is_whole) continue;
    ++complete;
    EXPECT_GT(values.front(), newest);
    newest = values.front();
    for (const std::uint64_t value : values) EXPECT_EQ(value, newest);
  }
  writer.join();
}

}  // namespace
}  // namespace troupe
