// Both ends of shared memory, in one process and with processes that are killed, stopped or write garbage.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "common/spatial/body_index.h"
#include "common/spatial/walk_routes.h"
#include "tests/support/memory_maps.h"
#include "tests/support/values.h"
#include "transport/shared_memory/agent_segment.h"
#include "transport/shared_memory/service_segment.h"
#include "transport/shared_memory/world_image.h"

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

// The newest frame, unless the agent has read it.
std::optional<FrameMessage> NewFrame(AgentSegment& agent) {
  const FrameInPlace* frame = nullptr;
  if (agent.Read(frame) != AgentSegment::Outcome::kNews) return std::nullopt;
  return frame->message;
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
      ASSERT_TRUE(agent->Wait());
      EXPECT_EQ(NewFrame(*agent), Frame(tick));
      EXPECT_EQ(NewFrame(*agent), std::nullopt);
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
      while (agent->Wait()) {
        if (const auto frame = NewFrame(*agent)) agent->Send(Proposal(id, frame->state.tick + 1));
      }
    }));
  }
  for (Tick tick = 1; tick <= kTicks; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok());
    for (const ProposalMessage& answer : CollectSome(*service, 5)) ASSERT_EQ(answer.tick, tick + 1);
  }
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
    const auto frames = SharedMemory::Open(service->address().process, service->address().frames, kPlaceBytes,
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
  for (const std::size_t robots : {1u, 5000u, 3u, 200000u}) {
    ASSERT_TRUE(service->Publish(Frame(robots, robots)).ok());
    const auto frame = NewFrame(*agent);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->state.robots.size(), robots);
  }
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1, 5000)), AgentSegment::Sent::kYes);
  EXPECT_EQ(CollectSome(*service, 1).front().proposals.size(), 5000u);
  EXPECT_EQ(agent->Send(Proposal(kFirst, 1, 10000)), AgentSegment::Sent::kImpossible);
}

TEST(SegmentTest, FrameThatIsTooLongEndsSharing) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  EXPECT_FALSE(service->Publish(Frame(1, kBufferBytes / sizeof(RobotState) + 1)).ok());
  const FrameInPlace* frame = nullptr;
  EXPECT_TRUE(agent->Wait());
  EXPECT_EQ(agent->Read(frame), AgentSegment::Outcome::kNetwork);
}

TEST(SegmentTest, EndOfTheRunFollowsTheLastFrame) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  ASSERT_TRUE(service->Publish(Frame(1, 2)).ok());
  service->EndRun();
  EXPECT_TRUE(service->Publish(Frame(2, 2)).ok());  // of no effect
  const FrameInPlace* frame = nullptr;
  EXPECT_TRUE(agent->Wait());
  ASSERT_EQ(agent->Read(frame), AgentSegment::Outcome::kNews);
  EXPECT_EQ(frame->message.state.tick, 1u);
  EXPECT_EQ(agent->Read(frame), AgentSegment::Outcome::kRunOver);
}

TEST(SegmentTest, SlowAgentReadsTheNewestFrame) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  for (Tick tick = 1; tick <= 9; ++tick) ASSERT_TRUE(service->Publish(Frame(tick)).ok());
  EXPECT_EQ(NewFrame(*agent), Frame(9));
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
    own->Wait();
    NewFrame(*own);
    own->Send(Proposal(kSecond, 2));
  });
  ASSERT_TRUE(service->Publish(Frame(1)).ok());
  ASSERT_TRUE(NewFrame(*agent).has_value());
  agent->Send(Proposal(kFirst, 2));
  EXPECT_EQ(CollectSome(*service, 2).size(), 2u);
  other.Kill();
  ASSERT_TRUE(service->Publish(Frame(2)).ok());
  ASSERT_TRUE(NewFrame(*agent).has_value());
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
  for (Tick tick = 1; tick <= 2000; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok());
    EXPECT_EQ(NewFrame(*agent), Frame(tick));
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

// A service in a process of its own, so that this one maps its memory as an agent does. It calls `act`, announces its
// address, and calls `then` until it is killed.
class OtherService {
 public:
  explicit OtherService(
      const std::function<void(ServiceSegment&)>& act,
      const std::function<void(ServiceSegment&)>& then = [](ServiceSegment&) { pause(); })
      : process_([&] {
          const auto segment = MakeService();
          act(*segment);
          const std::string text = ToText(segment->address()) + "\n";
          if (write(pipe_.ends[1], text.data(), text.size()) < 0) _exit(1);
          for (;;) then(*segment);
        }) {
    std::string text;
    for (char c = 0; c != '\n' && read(pipe_.ends[0], &c, 1) == 1;) text += c;
    if (!text.empty()) address_ = ParseSharingAddress(text.substr(0, text.size() - 1));
  }
  const SharingAddress& address() const { return address_.value(); }
  void Kill() { process_.Kill(); }

 private:
  struct Pipe {
    Pipe() { EXPECT_EQ(pipe(ends), 0); }
    ~Pipe() {
      close(ends[0]);
      close(ends[1]);
    }
    int ends[2];
  };
  Pipe pipe_;
  Process process_;
  std::optional<SharingAddress> address_;
};

TEST(SegmentTest, MemoryOfAKilledServiceStaysUsableAndItsAddressIsGone) {
  OtherService service([](ServiceSegment& segment) {
    segment.Bind(kFirst);
    EXPECT_TRUE(segment.Publish(Frame(5)).ok());
  });
  const SharingAddress address = service.address();
  auto opened = AgentSegment::Open(address);
  ASSERT_TRUE(opened.ok());
  service.Kill();
  EXPECT_EQ(NewFrame(*opened.value()), Frame(5));
  EXPECT_EQ(opened.value()->Send(Proposal(kFirst, 6)), AgentSegment::Sent::kYes);
  EXPECT_FALSE(AgentSegment::Open(address).ok());
}

TEST(SegmentTest, StoppedAgentReadsOneFrameToItsEndAndThenTheNewest) {
  const auto service = MakeService();
  service->Bind(kFirst);
  Process agent([&] {
    const auto own = OpenFor(*service);
    const FrameInPlace* frame = nullptr;
    while (own->Wait()) {
      const AgentSegment::Outcome outcome = own->Read(frame);
      // A frame that was read as soon as it was there wakes the next wait, too.
      if (outcome == AgentSegment::Outcome::kNothing) continue;
      if (outcome != AgentSegment::Outcome::kNews) _exit(1);
      const WorldState& state = frame->message.state;
      for (const RobotState& robot : state.robots) {
        if (robot.X_WR.x != static_cast<double>(state.tick)) _exit(2);
      }
      own->Send(Proposal(kFirst, state.tick + 1));
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

// Each frame has the same number in all its robots. The service is killed anywhere, mostly within a publication.
TEST(SegmentTest, NoPartOfAFrameOfAKilledServiceIsRead) {
  constexpr int kRounds = 60;
  int frames = 0;
  for (int round = 0; round < kRounds; ++round) {
    Tick next = 1;
    OtherService service(
        [](ServiceSegment&) {},
        [&](ServiceSegment& segment) {
          FrameMessage frame = Frame(next, 300 + next % 700);
          for (RobotState& robot : frame.state.robots) robot.X_WR.x = static_cast<double>(next);
          frame.events.resize(next % 3, Event{next, EventType::kStallBegan, {}, {}, "a long enough text"});
          EXPECT_TRUE(segment.Publish(frame).ok());
          ++next;
        });
    auto opened = AgentSegment::Open(service.address());
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    const auto read_one = [&] {
      const FrameInPlace* frame = nullptr;
      if (opened.value()->Read(frame) != AgentSegment::Outcome::kNews) return;
      const WorldState& state = frame->message.state;
      EXPECT_EQ(state.robots.size(), 300 + state.tick % 700);
      for (const RobotState& robot : state.robots) EXPECT_EQ(robot.X_WR.x, static_cast<double>(state.tick));
      for (const Event& event : frame->message.events) EXPECT_EQ(event.tick, state.tick);
      ++frames;
    };
    for (int i = 0; i <= round % 8; ++i) {
      ASSERT_TRUE(opened.value()->Wait());
      read_one();
    }
    service.Kill();
    read_one();
    ASSERT_FALSE(testing::Test::HasFailure()) << "round " << round;
  }
  EXPECT_GE(frames, kRounds);
}

TEST(SegmentTest, AFrameThatAnAgentReadsNeverChanges) {
  const auto service = MakeService();
  const auto slow = OpenFor(*service);
  const auto quick = OpenFor(*service);
  ASSERT_TRUE(service->Publish(Frame(1, 100)).ok());
  const FrameInPlace* kept = nullptr;
  ASSERT_EQ(slow->Read(kept), AgentSegment::Outcome::kNews);
  for (Tick tick = 2; tick < 300; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick, 100)).ok());
    EXPECT_EQ(NewFrame(*quick), Frame(tick, 100));
    EXPECT_EQ(kept->message, Frame(1, 100));
  }
  EXPECT_EQ(NewFrame(*slow), Frame(299, 100));
}

TEST(SegmentTest, FramesOfKilledReadersAreUsedAgain) {
  const auto service = MakeService();
  for (Tick tick = 1; tick < kBuffers + 10; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok()) << tick;
    Process reader([&] {
      const auto agent = OpenFor(*service);
      _exit(NewFrame(*agent) == Frame(tick) ? 0 : 1);
    });
    reader.Await();
  }
}

TEST(SegmentTest, SharingEndsWhenStoppedAgentsReadAllFrames) {
  const auto service = MakeService();
  std::vector<std::unique_ptr<AgentSegment>> stopped;
  Tick tick = 1;
  for (; tick <= kBuffers; ++tick) {
    ASSERT_TRUE(service->Publish(Frame(tick)).ok()) << tick;
    stopped.push_back(OpenFor(*service));
    ASSERT_EQ(NewFrame(*stopped.back()), Frame(tick));
  }
  EXPECT_FALSE(service->Publish(Frame(tick)).ok());
  EXPECT_TRUE(service->Publish(Frame(tick)).ok()) << "it has ended";
  const FrameInPlace* frame = nullptr;
  for (const auto& agent : stopped) EXPECT_EQ(agent->Read(frame), AgentSegment::Outcome::kNetwork);
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

TEST(SegmentTest, MemoryOfAnotherBuildIsRefused) {
  const auto service = MakeService();
  EXPECT_TRUE(AgentSegment::Open(service->address()).ok());
  const auto frames = SharedMemory::Open(service->address().process, service->address().frames, kPlaceBytes,
                                         SharedMemory::Peers::kMayRead);
  const auto header = frames.value().Map(0, kFramesHeaderBytes);
  // That of the service itself.
  auto* const own = reinterpret_cast<FramesHeader*>(header.value().At<const FramesHeader>(0).place.load());
  own->layout = SharedLayout() + 1;
  const auto opened = AgentSegment::Open(service->address());
  ASSERT_FALSE(opened.ok());
  EXPECT_NE(opened.error().message.find("another run or version"), std::string::npos) << opened.error().message;
}

TEST(SegmentTest, AnAddressInUseIsAnError) {
  OtherService service([](ServiceSegment&) {});
  const auto frames = SharedMemory::Open(service.address().process, service.address().frames, kPlaceBytes,
                                         SharedMemory::Peers::kMayRead);
  const auto header = frames.value().Map(0, kFramesHeaderBytes);
  auto* const place = reinterpret_cast<std::byte*>(header.value().At<const FramesHeader>(0).place.load());
  ASSERT_EQ(mmap(place + kPage, kPage, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0),
            place + kPage);
  EXPECT_FALSE(AgentSegment::Open(service.address()).ok());
  munmap(place + kPage, kPage);
  EXPECT_TRUE(AgentSegment::Open(service.address()).ok());
}

// A world with all parts that worlds can have in common.
WorldDescription SomeWorld(std::size_t robots = 3) {
  WorldDescription world;
  world.name = "a world with a name that needs memory";
  Shape solid;
  solid.blocks = {{{{0.1, 0.1}, {-0.1, 0.1}, {-0.1, -0.1}, {0.1, -0.1}}, {0.0, 0.3}}};
  Bitmap bitmap(40, 40);
  for (int i = 0; i < 40; ++i) bitmap.set_occupied(i, (7 * i) % 40, true);
  Shape dense;
  dense.area = PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), {.center = 20.0, .factor = 0.25},
                         {.center = 20.0, .factor = 0.25});
  dense.rectangles_z = {0.0, 1.0};
  world.shapes = {solid, dense};
  world.models.push_back({.name = "map", .type = "model", .X_PM = {20.0, 20.0, 0.0, 0.0}, .shape = ShapeId(1)});
  world.models.push_back({.name = "wall", .type = "model", .X_PM = {-5.0, 0.0, 0.0, 0.5}, .shape = ShapeId(0)});
  const RangerParameters ranger{.ray_sensors = {RaySensorDescription{}, RaySensorDescription{}}};
  for (std::size_t i = 0; i < robots; ++i) {
    const ModelId root(world.models.size());
    world.models.push_back({.name = "robot" + std::to_string(i),
                            .type = "position",
                            .X_PM = {static_cast<double>(i), 0.0, 0.0, 0.0},
                            .shape = ShapeId(0)});
    RobotDescription robot;
    robot.name = world.models.back().name;
    robot.root = root;
    robot.sensors.push_back({.name = "laser", .model = root, .parameters = ranger});
    world.robots.push_back(robot);
  }
  return world;
}

SessionMessage Session(const WorldDescription& world, Edition edition = 0) {
  return {.run = 7,
          .protocol_version = 1,
          .host = "here",
          .pid = 5,
          .lease_seconds = 2.5,
          .begun = true,
          .world = world,
          .world_edition = edition,
          .incarnation = 3};
}

TEST(SharedWorldTest, SomeWorldIsValid) {
  const Status status = Validate(SomeWorld());
  EXPECT_TRUE(status.ok()) << status.error().message;
}

TEST(SharedWorldTest, TheWorldIsReadInPlace) {
  const WorldDescription world = SomeWorld(300);
  OtherService service([&](ServiceSegment& segment) {
    EXPECT_TRUE(segment.PublishSession(Session(world)).ok());
    FrameMessage frame = Frame(4);
    frame.state = PlacedState(world);
    EXPECT_TRUE(segment.Publish(frame).ok());
  });
  auto agent = AgentSegment::Open(service.address());
  ASSERT_TRUE(agent.ok()) << agent.error().message;
  SessionMessage session;
  PreparedWorld prepared;
  Status reason;
  ASSERT_EQ(agent.value()->ReadSession(session, prepared, reason), AgentSegment::Outcome::kNews);
  EXPECT_EQ(agent.value()->ReadSession(session, prepared, reason), AgentSegment::Outcome::kNothing);
  service.Kill();
  EXPECT_EQ(session, Session(world));
  EXPECT_EQ(prepared.world_hash, Hash(world));
  EXPECT_EQ(&prepared.scene->world(), &*session.world);
  // It changes only pages of its own: those of references that it counts.
  for (const test::MappedArea& area : test::MapsOf(getpid())) {
    if (area.name == "/memfd:troupe-world") EXPECT_EQ(area.access, "rw-p");
    if (area.name == "/memfd:troupe-frames") EXPECT_EQ(area.access, "r--s");
  }
  const Shared<std::vector<RaySensorDescription>> counted =
      std::get<RangerParameters>(session.world->robots[0].sensors[0].parameters).ray_sensors;
  EXPECT_EQ(counted->size(), 2u);

  const Scene own{Shared<WorldDescription>(world)};
  const std::span<const std::byte> map = prepared.scene->static_index().ray_map().bytes();
  EXPECT_TRUE(std::ranges::equal(map, own.static_index().ray_map().bytes()));
  ASSERT_EQ(prepared.scene->static_index().areas().size(), 1u);
  EXPECT_EQ(prepared.scene->static_index().areas()[0].bounds(), own.static_index().areas()[0].bounds());

  const FrameInPlace* frame = nullptr;
  ASSERT_EQ(agent.value()->Read(frame), AgentSegment::Outcome::kNews);
  EXPECT_TRUE(frame->is_checked);
  BodyIndex in_place(*prepared.scene);
  in_place.Assign(frame->message.state);
  BodyIndex assigned(own);
  assigned.Assign(PlacedState(world));
  for (std::size_t i = 0; i < own.body_count(); ++i) {
    EXPECT_EQ(in_place.pieces_in_world(BodyId(i))[0].vertices, assigned.pieces_in_world(BodyId(i))[0].vertices);
  }
}

// They are in memory of the agent's own, which does not end with the mapping.
TEST(SharedWorldTest, RoutesEndWithTheLastUserOfAWorld) {
  // Of another process: a service in this one would keep the mapping.
  OtherService service(
      [&](ServiceSegment& segment) { EXPECT_TRUE(segment.PublishSession(Session(SomeWorld(3))).ok()); });
  const auto attach = [&] {
    const auto agent = test::ValueOf(AgentSegment::Open(service.address()));
    SessionMessage session;
    PreparedWorld prepared;
    Status reason;
    EXPECT_EQ(agent->ReadSession(session, prepared, reason), AgentSegment::Outcome::kNews);
    return prepared.scene;
  };
  const auto has_grid = [](const Scene& scene) {
    return scene.walk_routes().RobotGrid(scene, {0.0, 1.0}, 0.3) != nullptr;
  };
  std::shared_ptr<const Scene> first = attach();
  std::shared_ptr<const Scene> second = attach();
  ASSERT_EQ(first, second);
  const WalkRoutes* const routes = &first->walk_routes();
  first.reset();
  EXPECT_EQ(&second->walk_routes(), routes);
  EXPECT_TRUE(has_grid(*second));
  second.reset();
  constexpr std::size_t kRounds = 200;
  const auto heap = [] { return mallinfo2().uordblks; };
  EXPECT_TRUE(has_grid(*attach()));
  const std::size_t before = heap();
  for (std::size_t i = 0; i < kRounds; ++i) EXPECT_TRUE(has_grid(*attach()));
  EXPECT_LT(heap(), before + kRounds * sizeof(WalkRoutes) / 2);
}

// A pointer to memory of the maker alone would be wrong in every other process.
TEST(SharedWorldTest, AnImageHasNoPartInCommonWithItsWorld) {
  const Shared<WorldDescription> world(SomeWorld());
  std::set<std::uintptr_t> parts = {reinterpret_cast<std::uintptr_t>(&*world),
                                    reinterpret_cast<std::uintptr_t>(&world->shapes[1].area->cover())};
  for (const RobotDescription& robot : world->robots) {
    const auto& ranger = std::get<RangerParameters>(robot.sensors[0].parameters);
    parts.insert(reinterpret_cast<std::uintptr_t>(&*ranger.ray_sensors));
  }
  EXPECT_EQ(parts.size(), 3u) << "the robots have one list of rays";
  const auto image = WorldImage::Make(world);
  ASSERT_TRUE(image.ok());
  const WorldImagePlace place = image.value()->place();
  const std::span words(reinterpret_cast<const std::uintptr_t*>(place.place), place.bytes / sizeof(std::uintptr_t));
  for (const std::uintptr_t part : parts) EXPECT_EQ(std::ranges::count(words, part), 0);
}

TEST(SharedWorldTest, AnEarlierWorldStaysWithItsUsers) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  SessionMessage first;
  SessionMessage second;
  PreparedWorld first_world;
  PreparedWorld second_world;
  Status reason;
  ASSERT_TRUE(service->PublishSession(Session(SomeWorld(3), 0)).ok());
  ASSERT_EQ(agent->ReadSession(first, first_world, reason), AgentSegment::Outcome::kNews);
  ASSERT_TRUE(service->PublishSession(Session(SomeWorld(4), 1)).ok());
  ASSERT_EQ(agent->ReadSession(second, second_world, reason), AgentSegment::Outcome::kNews);
  EXPECT_EQ(first, Session(SomeWorld(3), 0));
  EXPECT_EQ(second, Session(SomeWorld(4), 1));
  EXPECT_NE(first_world.world_hash, second_world.world_hash);
  EXPECT_EQ(first_world.scene->body_count(), 3u);
}

TEST(SharedWorldTest, FramesOfTheWorldOfTheSessionAreChecked) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  const auto is_checked = [&](Edition edition, std::size_t robots) {
    FrameMessage frame = Frame(1);
    frame.world_edition = edition;
    frame.state = PlacedState(SomeWorld(robots));
    EXPECT_TRUE(service->Publish(frame).ok());
    const FrameInPlace* read = nullptr;
    EXPECT_EQ(agent->Read(read), AgentSegment::Outcome::kNews);
    return read->is_checked;
  };
  EXPECT_FALSE(is_checked(0, 3)) << "there is no session";
  ASSERT_TRUE(service->PublishSession(Session(SomeWorld(3), 0)).ok());
  EXPECT_TRUE(is_checked(0, 3));
  EXPECT_FALSE(is_checked(1, 3));
  EXPECT_FALSE(is_checked(0, 4)) << "a state that is not of the world";
  EXPECT_TRUE(is_checked(0, 3));
}

TEST(SharedWorldTest, WithoutMemoryForTheWorldSharingEnds) {
  const auto service = MakeService();
  const auto agent = OpenFor(*service);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit low{4096, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
  EXPECT_FALSE(service->PublishSession(Session(SomeWorld())).ok());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  SessionMessage session;
  PreparedWorld prepared;
  Status reason;
  EXPECT_EQ(agent->ReadSession(session, prepared, reason), AgentSegment::Outcome::kNetwork);
}

TEST(SharedArenaTest, BlocksAreUsedAgainAndAFullOneIsAnError) {
  const auto memory = PlacedMemory::Create("troupe-test");
  ASSERT_TRUE(memory.ok());
  constexpr std::size_t kSize = std::size_t{1} << 20;
  SharedArena arena(memory.value(), 0, kSize);
  for (int round = 0; round < 100; ++round) {
    const SharedArena::Scope scope(arena);
    std::vector<std::string> texts(100, std::string(1000, 'a'));
    ASSERT_TRUE(arena.Contains(texts.data()) && arena.Contains(texts[50].data()));
  }
  EXPECT_LT(arena.end(), kSize / 2);
  {
    const SharedArena::Scope scope(arena);
    EXPECT_THROW(std::string(kSize, 'a'), std::bad_alloc);
    struct alignas(64) Line {
      char bytes[64];
    };
    const auto line = std::make_unique<Line>();
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(line.get()) % 64, 0u);
  }
  const auto outside = std::make_unique<std::string>(1000, 'a');
  EXPECT_FALSE(arena.Contains(outside.get()) || arena.Contains(outside->data()));
}

}  // namespace
}  // namespace troupe
