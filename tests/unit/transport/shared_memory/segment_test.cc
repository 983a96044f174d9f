// Both ends of shared memory, in one process and with processes that are killed, stopped or write garbage.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "tests/support/memory_maps.h"
#include "transport/shared_memory/agent_segment.h"
#include "transport/shared_memory/service_segment.h"

namespace troupe {
namespace {

constexpr AgentId kFirst = 11;
constexpr AgentId kSecond = 12;

FrameMessage Frame(Tick tick, std::size_t robots = 2) {
  FrameMessage frame;
  frame.run = 7;
  frame.state.tick = tick;
  frame.state.robots.resize(robots);
  return frame;
}

ProposalMessage Proposal(AgentId agent, Tick tick, std::size_t robots = 1) {
  ProposalMessage message{.run = 7, .agent = agent, .tick = tick};
  for (std::size_t i = 0; i < robots; ++i) message.proposals.push_back({RobotId(i), {1.0, 0.0, 0.0}});
  return message;
}

std::unique_ptr<ServiceSegment> MakeService() {
  auto made = ServiceSegment::Create();
  EXPECT_TRUE(made.ok());
  return std::move(made).value();
}

std::unique_ptr<AgentSegment> OpenFor(const ServiceSegment& service) {
  auto opened = AgentSegment::Open(service.address());
  EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
  return std::move(opened).value();
}

// Waits for `count` answers; gives the proposals.
std::vector<ProposalMessage> CollectSome(ServiceSegment& service, std::size_t count) {
  std::vector<ProposalMessage> all;
  while (all.size() < count && service.Wait()) {
    for (const SharedAnswer& answer : service.Collect()) {
      if (answer.malformed.ok()) all.push_back(answer.proposal);
    }
  }
  return all;
}

// A process that calls `act` and then waits to be killed.
class Process {
 public:
  explicit Process(const std::function<void()>& act) : pid_(fork()) {
    if (pid_ != 0) return;
    act();
    for (;;) pause();
  }
  ~Process() { Kill(); }
  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(std::exchange(pid_, 0), nullptr, 0);
  }
  // For a process that ends by itself.
  void Await() { waitpid(std::exchange(pid_, 0), nullptr, 0); }
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_;
};

TEST(SegmentTest, FrameAndAnswersTravel) {
  const auto service = MakeService();
  const auto first = OpenFor(*service);
  const auto second = OpenFor(*service);
  service->Bind(kFirst);
  service->Bind(kSecond);
  for (Tick tick = 1; tick <= 100; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok());
    for (AgentSegment* agent : {first.get(), second.get()}) {
      FrameMessage came;
      ASSERT_TRUE(agent->Wait());
      ASSERT_EQ(agent->Read(came), AgentSegment::Outcome::kFrame);
      EXPECT_EQ(came, Frame(tick));
      EXPECT_EQ(agent->Read(came), AgentSegment::Outcome::kNothing);
      const AgentId id = agent == first.get() ? kFirst : kSecond;
      EXPECT_EQ(agent->Send(Proposal(id, tick + 1)), AgentSegment::Sent::kYes);
    }
    const std::vector<ProposalMessage> answers = CollectSome(*service, 2);
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(answers[0], Proposal(kFirst, tick + 1));
    EXPECT_EQ(answers[1], Proposal(kSecond, tick + 1));
  }
}

TEST(SegmentTest, AgentsOfOtherProcessesKeepUpWithThousandsOfTicks) {
  constexpr Tick kTicks = 3000;
  const auto service = MakeService();
  std::vector<std::unique_ptr<Process>> agents;
  for (AgentId id = 1; id <= 5; ++id) {
    service->Bind(id);
    agents.push_back(std::make_unique<Process>([&] {
      const auto agent = OpenFor(*service);
      FrameMessage frame;
      while (agent->Wait()) {
        if (agent->Read(frame) == AgentSegment::Outcome::kFrame) agent->Send(Proposal(id, frame.state.tick + 1));
      }
    }));
  }
  for (Tick tick = 1; tick <= kTicks; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok());
    for (const ProposalMessage& answer : CollectSome(*service, 5)) ASSERT_EQ(answer.tick, tick + 1);
  }
}

std::vector<std::byte> Bytes(std::size_t count, unsigned value) {
  return std::vector<std::byte>(count, std::byte(value));
}

TEST(SegmentTest, AgentsFindAMapOfEqualBytesOnly) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  EXPECT_EQ(agent->FindMap(Bytes(5000, 1)), nullptr) << "there is none";
  service->ShareMap(Bytes(5000, 1));
  const auto first = agent->FindMap(Bytes(5000, 1));
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(std::memcmp(first.get(), Bytes(5000, 1).data(), 5000), 0);
  EXPECT_EQ(agent->FindMap(Bytes(5000, 2)), nullptr);
  EXPECT_EQ(agent->FindMap(Bytes(4999, 1)), nullptr);
  EXPECT_EQ(agent->FindMap({}), nullptr);
  // One of a later world; that of the earlier one stays with the agents that use it.
  service->ShareMap(Bytes(70'000, 2));
  EXPECT_EQ(agent->FindMap(Bytes(5000, 1)), nullptr);
  EXPECT_NE(agent->FindMap(Bytes(70'000, 2)), nullptr);
  EXPECT_EQ(std::memcmp(first.get(), Bytes(5000, 1).data(), 5000), 0);
  service->ShareMap({});
  EXPECT_EQ(agent->FindMap(Bytes(70'000, 2)), nullptr);
}

TEST(SegmentTest, AMapIsSharedAndReadOnly) {
  const auto service = MakeService();
  service->ShareMap(Bytes(5000, 1));
  const auto first = OpenFor(*service)->FindMap(Bytes(5000, 1));
  const auto second = OpenFor(*service)->FindMap(Bytes(5000, 1));
  ASSERT_TRUE(first != nullptr && second != nullptr);
  std::set<std::string> inodes;
  int writable = 0;
  for (const test::MappedArea& area : test::MapsOf(getpid())) {
    if (area.name != "/memfd:troupe-map") continue;
    inodes.insert(area.inode);
    EXPECT_TRUE(area.access == "r--s" || area.access == "rw-s") << area.access;
    if (area.access == "rw-s") ++writable;
  }
  EXPECT_EQ(writable, 1) << "that of the service itself";
  EXPECT_EQ(inodes.size(), 1u);
}

TEST(SegmentTest, WithoutMemoryForAMapAgentsKeepTheirOwn) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit low{4096, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
  service->ShareMap(Bytes(5000, 1));
  EXPECT_EQ(agent->FindMap(Bytes(5000, 1)), nullptr);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  service->ShareMap(Bytes(5000, 1));
  EXPECT_NE(agent->FindMap(Bytes(5000, 1)), nullptr);
}

TEST(SegmentTest, OnlyAgentsWithASlotSend) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1)), AgentSegment::Sent::kNotJoined);
  service->Bind(kFirst);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1)), AgentSegment::Sent::kYes);
  EXPECT_EQ(CollectSome(*service, 1).size(), 1u);
  service->Unbind(kFirst);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 2)), AgentSegment::Sent::kNotJoined);
  service->Bind(kSecond);  // the same slot
  EXPECT_EQ(agent->Send(Proposal(kFirst, 2)), AgentSegment::Sent::kNotJoined);
  EXPECT_TRUE(service->Collect().empty());
}

// It is stopped anywhere, often in the middle of a message, which it completes later.
TEST(SegmentTest, AStoppedAgentDoesNotWriteIntoTheSlotOfAnother) {
  for (int round = 0; round < 50; ++round) {
    const auto service = MakeService();
    service->Bind(kFirst);
    Process stopped([&] {
      const auto own = OpenFor(*service);
      ProposalMessage message = Proposal(kFirst, 1, 500);
      for (::troupe::Proposal& proposal : message.proposals) proposal.twist = {2.0, 0.0, 0.0};
      while (own->Send(message) == AgentSegment::Sent::kYes) ++message.tick;
      _exit(0);
    });
    const auto answers = SharedMemory::Open(service->address().process, service->address().answers, kAnswersBytes,
                                            SharedMemory::Peers::kMayWrite);
    const auto slot = answers.value().Map(SlotOffset(0), kSlotBytes);
    while (slot.value().At<SlotHeader>(0).message.sequence < 3) std::this_thread::yield();
    kill(stopped.pid(), SIGSTOP);
    ASSERT_EQ(waitpid(stopped.pid(), nullptr, WUNTRACED), stopped.pid());
    service->Unbind(kFirst);
    service->Bind(kSecond);
    const auto agent = OpenFor(*service);
    ASSERT_EQ(agent->Send(Proposal(kSecond, 1, 500)), AgentSegment::Sent::kYes);
    kill(stopped.pid(), SIGCONT);
    stopped.Await();
    const auto collected = service->Collect();
    ASSERT_EQ(collected.size(), 1u);
    ASSERT_TRUE(collected.front().malformed.ok());
    ASSERT_EQ(collected.front().proposal, Proposal(kSecond, 1, 500));
  }
}

TEST(SegmentTest, ASlotIsUsedAgainWhenItsAgentHasLeftItOrHasEnded) {
  const auto service = MakeService();
  const auto slot_of = [&](AgentId id) {
    const auto frames = SharedMemory::Open(service->address().process, service->address().frames, kFramesBytes,
                                           SharedMemory::Peers::kMayRead);
    const auto memory = frames.value().Map(0, kFramesHeaderBytes);
    const auto& agents = memory.value().At<const FramesHeader>(0).agents;
    return std::find(agents.begin(), agents.end(), id) - agents.begin();
  };
  auto first = OpenFor(*service);
  service->Bind(kFirst);
  ASSERT_EQ(first->Send(Proposal(kFirst, 1)), AgentSegment::Sent::kYes);
  service->Unbind(kFirst);
  service->Bind(kSecond);
  EXPECT_EQ(slot_of(kSecond), 1) << "the first agent does not know yet";
  EXPECT_EQ(first->Send(Proposal(kFirst, 2)), AgentSegment::Sent::kNotJoined);
  service->Bind(kFirst);
  EXPECT_EQ(slot_of(kFirst), 0);
  ASSERT_EQ(first->Send(Proposal(kFirst, 3)), AgentSegment::Sent::kYes);
  service->Unbind(kFirst);
  first.reset();  // as the end of its process
  service->Bind(kSecond + 1);
  EXPECT_EQ(slot_of(kSecond + 1), 0);
}

TEST(SegmentTest, WithoutASlotThatIsLeftAnAgentUsesTheNetwork) {
  const auto service = MakeService();
  const auto answers = SharedMemory::Open(service->address().process, service->address().answers, kAnswersBytes,
                                          SharedMemory::Peers::kMayWrite);
  ASSERT_TRUE(answers.value().Claim(SlotOffset(0), kSlots * kSlotBytes).value());
  service->Bind(kFirst);
  const auto agent = OpenFor(*service);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1)), AgentSegment::Sent::kImpossible);
}

TEST(SegmentTest, MessagesOfEverySizeTravelOrAreRefused) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  service->Bind(kFirst);
  FrameMessage came;
  for (const std::size_t robots : {1u, 5000u, 3u, 200000u}) {
    ASSERT_TRUE(service->Publish(Frame(robots, robots)).ok());
    ASSERT_EQ(agent->Read(came), AgentSegment::Outcome::kFrame);
    EXPECT_EQ(came.state.robots.size(), robots);
  }
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1, 5000)), AgentSegment::Sent::kYes);
  EXPECT_EQ(CollectSome(*service, 1).front().proposals.size(), 5000u);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1, 10000)), AgentSegment::Sent::kImpossible);
}

TEST(SegmentTest, FrameThatIsTooLongEndsSharing) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  EXPECT_FALSE(service->Publish(Frame(1, 2'000'000)).ok());
  FrameMessage came;
  EXPECT_TRUE(agent->Wait());
  EXPECT_EQ(agent->Read(came), AgentSegment::Outcome::kEnded);
}

TEST(SegmentTest, SlowAgentReadsTheNewestFrame) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  for (Tick tick = 1; tick <= 9; ++tick) ASSERT_TRUE(service->Publish(Frame(tick)).ok());
  FrameMessage came;
  ASSERT_EQ(agent->Read(came), AgentSegment::Outcome::kFrame);
  EXPECT_EQ(came.state.tick, 9u);
}

TEST(SegmentTest, AgentsCannotWriteFrames) {
  const auto service = MakeService();
  const std::string path = "/proc/self/fd/" + std::to_string(service->address().frames);
  const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor >= 0) {
    EXPECT_EQ(mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0), MAP_FAILED);
    EXPECT_LT(pwrite(descriptor, "x", 1, 0), 0);
    EXPECT_NE(ftruncate(descriptor, 0), 0);
    close(descriptor);
  }
}

// The answers of the others are found without their wake, because the count of missing ones never becomes zero.
TEST(SegmentTest, KilledAgentDelaysNoOtherForLong) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  service->Bind(kFirst);
  service->Bind(kSecond);
  Process other([&] {
    const auto own = OpenFor(*service);
    FrameMessage frame;
    own->Wait();
    own->Read(frame);
    own->Send(Proposal(kSecond, 2));
  });
  FrameMessage frame;
  ASSERT_TRUE(service->Publish(Frame(1)).ok());
  ASSERT_EQ(agent->Read(frame), AgentSegment::Outcome::kFrame);
  agent->Send(Proposal(kFirst, 2));
  EXPECT_EQ(CollectSome(*service, 2).size(), 2u);
  other.Kill();
  ASSERT_TRUE(service->Publish(Frame(2)).ok());
  ASSERT_EQ(agent->Read(frame), AgentSegment::Outcome::kFrame);
  agent->Send(Proposal(kFirst, 3));
  EXPECT_EQ(CollectSome(*service, 1), std::vector{Proposal(kFirst, 3)});
}

TEST(SegmentTest, GarbageOfAnAgentAffectsItsOwnSlotOnly) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  service->Bind(kFirst);
  service->Bind(kSecond);
  Process garbage([&] {
    auto answers = SharedMemory::Open(service->address().process, service->address().answers, kAnswersBytes,
                                      SharedMemory::Peers::kMayWrite);
    const auto header = answers.value().Map(0, kPage);
    const auto slot = answers.value().Map(SlotOffset(1), kSlotBytes);
    std::uint64_t state = 1;
    for (;;) {
      for (const auto& memory : {&header.value(), &slot.value()}) {
        for (Word& word : memory->Array<Word>(0, kPage / sizeof(Word))) {
          state = state * 6364136223846793005 + 1442695040888963407;
          word.store(state % 3 == 0 ? state >> 60 : state);
        }
      }
    }
  });
  const auto answers = SharedMemory::Open(service->address().process, service->address().answers, kAnswersBytes,
                                          SharedMemory::Peers::kMayWrite);
  const auto slot = answers.value().Map(SlotOffset(1), kSlotBytes);
  while (slot.value().At<Word>(0) == 0) std::this_thread::yield();  // until the garbage begins
  FrameMessage frame;
  for (Tick tick = 1; tick <= 2000; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok());
    ASSERT_EQ(agent->Read(frame), AgentSegment::Outcome::kFrame);
    EXPECT_EQ(frame, Frame(tick));
    ASSERT_EQ(agent->Send(Proposal(kFirst, tick + 1)), AgentSegment::Sent::kYes);
    bool arrived = false;
    while (!arrived) {
      service->Wait();
      for (const SharedAnswer& answer : service->Collect()) {
        if (answer.agent == kFirst) {
          ASSERT_TRUE(answer.malformed.ok());
          EXPECT_EQ(answer.proposal, Proposal(kFirst, tick + 1));
          arrived = true;
        } else if (answer.malformed.ok()) {
          EXPECT_EQ(answer.proposal.agent, kSecond);
        }
      }
    }
  }
}

TEST(SegmentTest, ProposalInTheNameOfAnotherAgentIsMalformed) {
  const auto service = MakeService();
  service->Bind(kFirst);
  auto answers = SharedMemory::Open(service->address().process, service->address().answers, kAnswersBytes,
                                    SharedMemory::Peers::kMayWrite);
  const auto slot = answers.value().Map(SlotOffset(0), kSlotBytes);
  SlotHeader& header = slot.value().At<SlotHeader>(0);
  SeqlockWriter writer(header.message, slot.value().Array<Word>(sizeof(SlotHeader), kSlotWords));
  AddProposal(Proposal(kSecond, 1), writer.words());
  writer.Finish();
  const auto collected = service->Collect();
  ASSERT_EQ(collected.size(), 1u);
  EXPECT_FALSE(collected.front().malformed.ok());
}

TEST(SegmentTest, MemoryOfAnotherProcessOrRunIsRefused) {
  const auto service = MakeService();
  SharingAddress address = service->address();
  ++address.key;
  EXPECT_FALSE(AgentSegment::Open(address).ok());
  address = service->address();
  address.frames = 0;
  EXPECT_FALSE(AgentSegment::Open(address).ok());
  address = service->address();
  address.machine += "0";
  EXPECT_FALSE(AgentSegment::Open(address).ok());
  address = service->address();
  address.process = 0x3fffffff;
  EXPECT_FALSE(AgentSegment::Open(address).ok());
}

TEST(SegmentTest, MemoryOfAKilledServiceStaysUsableAndItsAddressIsGone) {
  int pipes[2];
  ASSERT_EQ(pipe(pipes), 0);
  Process service([&] {
    const auto segment = MakeService();
    segment->Bind(kFirst);
    if (!segment->Publish(Frame(5)).ok()) return;
    const std::string text = ToText(segment->address()) + "\n";
    if (write(pipes[1], text.data(), text.size()) < 0) return;
    for (;;) pause();
  });
  std::string text;
  for (char c = 0; c != '\n'; text += c) ASSERT_EQ(read(pipes[0], &c, 1), 1);
  const SharingAddress address = *ParseSharingAddress(text.substr(0, text.size() - 1));
  auto opened = AgentSegment::Open(address);
  ASSERT_TRUE(opened.ok());
  service.Kill();
  FrameMessage frame;
  EXPECT_EQ(opened.value()->Read(frame), AgentSegment::Outcome::kFrame);
  EXPECT_EQ(opened.value()->Send(Proposal(kFirst, 6)), AgentSegment::Sent::kYes);
  EXPECT_FALSE(AgentSegment::Open(address).ok());
  close(pipes[0]);
  close(pipes[1]);
}

TEST(SegmentTest, StoppedAgentReadsAWholeFrameWhenItContinues) {
  const auto service = MakeService();
  service->Bind(kFirst);
  Process agent([&] {
    const auto own = OpenFor(*service);
    FrameMessage frame;
    while (own->Wait()) {
      if (own->Read(frame) != AgentSegment::Outcome::kFrame) _exit(1);
      for (const RobotState& robot : frame.state.robots) {
        if (robot.X_WR.x != static_cast<double>(frame.state.tick)) _exit(2);
      }
      own->Send(Proposal(kFirst, frame.state.tick + 1));
    }
  });
  Tick tick = 1;
  const auto publish = [&] {
    FrameMessage frame = Frame(tick, 1000);
    for (RobotState& robot : frame.state.robots) robot.X_WR.x = static_cast<double>(tick);
    ASSERT_TRUE(service->Publish(frame).ok());
    ++tick;
  };
  publish();
  ASSERT_EQ(CollectSome(*service, 1).size(), 1u);
  for (int round = 0; round < 50; ++round) {
    publish();
    kill(agent.pid(), SIGSTOP);
    for (int i = 0; i < 20; ++i) publish();
    kill(agent.pid(), SIGCONT);
    publish();
    const Tick awaited = tick;
    for (Tick answered = 0; answered < awaited;) answered = CollectSome(*service, 1).back().tick;
  }
  int status = 0;
  EXPECT_EQ(waitpid(agent.pid(), &status, WNOHANG), 0);
}

TEST(SegmentTest, CloseEndsWaits) {
  for (int round = 0; round < 200; ++round) {
    const auto service = MakeService();
    const auto agent = OpenFor(*service);
    std::thread service_thread([&] {
      while (service->Wait()) {
      }
    });
    std::thread agent_thread([&] { EXPECT_FALSE(agent->Wait()); });
    agent->Close();
    service->Close();
    service_thread.join();
    agent_thread.join();
  }
}

TEST(SegmentTest, LowLimitOfFileSizesIsAnError) {
  Process limited([] {
    const rlimit limit{1 << 20, 1 << 20};
    setrlimit(RLIMIT_FSIZE, &limit);
    _exit(ServiceSegment::Create().ok() ? 1 : 0);
  });
  int status = -1;
  waitpid(limited.pid(), &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace troupe
