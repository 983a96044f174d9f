#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include "transport/shared_memory/shared_layout.h"
#include "transport/shared_memory/shared_memory.h"

namespace troupe {
namespace {

// As in shared memory.
struct Memory {
  explicit Memory(std::size_t size) : words(std::make_unique<Word[]>(size)), count(size) {}
  std::span<Word> all() const { return {words.get(), count}; }
  std::unique_ptr<Word[]> words;
  std::size_t count;
};

ProposalMessage SomeProposal() {
  ProposalMessage message{.run = 77, .agent = 5, .tick = 12};
  const double infinity = std::numeric_limits<double>::infinity();
  message.proposals = {
      {RobotId(2),
       {0.1, -0.0, infinity},
       {1.0, 2.0},
       {{1, std::nullopt, {7, 8}}},
       {LightOrder{0, true}, LightOrder{3, false}, CameraOrder{4, 0.5, infinity}, DoorOrder{1, 0.25},
        LiftOrder{0, 2, true}, TwistOrder{{0.5, -0.0, 1e-300}}, ChargeOrder{4, true}, ChargeOrder{},
        JobOrder{true, false, true}, WaitOrder{ModelId(3), 7}, WaitOrder{}, LoadOrder{ModelId(9), false, 1.5, -0.0}},
       "hello",
       {{FleetTopic::kState, "{\"orderId\":\"\"}"}}},
      {RobotId(4000000000), {}, {}, {{0, RobotId(2), {}}, {0, {}, {255}}}}};
  message.reports = {"a report", ""};
  message.edition = 3;
  message.incarnation = 2;
  return message;
}

// No words of another process may do more than give an error.
TEST(MessageWordsTest, RandomWordsAreReadOrRefused) {
  std::mt19937_64 random(1);
  const ProposalMessage proposal = SomeProposal();
  const Memory memory(400);
  ProposalMessage proposed;
  int read = 0;
  for (int round = 0; round < 20000; ++round) {
    WordWriter writer(memory.all());
    AddProposal(proposal, writer);
    for (int i = 0; i < 3; ++i) {
      const std::uint64_t value = random() % 2 == 0 ? random() % 9 : random();
      memory.words[random() % writer.count()].store(value);
    }
    read += ReadProposal(WordReader(memory.all().first(writer.count())), proposed).ok() ? 1 : 0;
  }
  EXPECT_GT(read, 0);
}

TEST(ProposalWordsTest, ProposalArrivesIntact) {
  const ProposalMessage sent = SomeProposal();
  const Memory memory(200);
  WordWriter writer(memory.all());
  AddProposal(sent, writer);
  ProposalMessage came;
  ASSERT_TRUE(ReadProposal(WordReader(memory.all().first(writer.count())), came).ok());
  EXPECT_EQ(came, sent);
}

TEST(ProposalWordsTest, CutProposalAndRobotsOutOfOrderAreRefused) {
  ProposalMessage sent = SomeProposal();
  const Memory memory(200);
  WordWriter writer(memory.all());
  AddProposal(sent, writer);
  ProposalMessage came;
  for (std::size_t size = 0; size < writer.count(); ++size) {
    EXPECT_FALSE(ReadProposal(WordReader(memory.all().first(size)), came).ok()) << size;
  }
  sent.proposals[1].robot = sent.proposals[0].robot;
  WordWriter again(memory.all());
  AddProposal(sent, again);
  EXPECT_FALSE(ReadProposal(WordReader(memory.all().first(again.count())), came).ok());
}

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

TEST(SharingAddressTest, TextIsReadBack) {
  const SharingAddress address{ThisMachine(), 4711, 5, 6, 0xfedcba9876543210};
  ASSERT_FALSE(address.machine.empty());
  EXPECT_EQ(ToText(address).find(';'), std::string::npos);
  EXPECT_EQ(ParseSharingAddress(ToText(address)), address);
  EXPECT_TRUE(IsThisBoot(address));
}

TEST(SharingAddressTest, OtherTextsAreRefused) {
  for (const char* text : {"", ",1,2,3,4", "m", "m,1,2,3", "m,0,2,3,4", "m,-1,2,3,4", "m,1,-2,3,4", "m,1,2,3,4,5",
                           "m,1,2,3,x", "m,1,2,99999999999,4", "m,1,2,3,10000000000000000"}) {
    EXPECT_FALSE(ParseSharingAddress(text)) << text;
  }
}

TEST(SharingAddressTest, AnotherBootIsAnotherMachine) {
  EXPECT_FALSE(IsThisBoot({"another-boot/pid:[1]/net:[2]/uid:0", 1, 2, 3, 4}));
  const std::string boot = ThisMachine().substr(0, ThisMachine().find('/'));
  EXPECT_TRUE(IsThisBoot({boot + "/pid:[1]/net:[2]/uid:0", 1, 2, 3, 4}));
}

}  // namespace
}  // namespace troupe
