#include "troupe/simulation_page.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/file.h"
#include "common/base/identity.h"
#include "common/base/system_error.h"
#include "common/base/text.h"
#include "common/model/states.h"
#include "common/spatial/scene.h"
#include "library/runs/state_stream.h"

extern char** environ;

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Clock::duration kPeriod = std::chrono::microseconds(1'000'000 / 60);
constexpr int kStartMilliseconds = 20'000;  // for the program to open its page, on a busy machine
constexpr int kEndMilliseconds = 5'000;     // for it to show the end; then it is killed
constexpr std::size_t kMaxEvents = 10'000;  // between two frames
constexpr std::size_t kMaxOutput = 4096;

// The library is loaded from any program, so that the folder of that program says nothing: the installation is found by
// the library's own file, then by the PATH.
Result<std::string> FindProgram(const std::string& given) {
  const auto runs = [](const std::string& path) { return access(path.c_str(), X_OK) == 0; };
  if (!given.empty()) {
    if (runs(given)) return given;
    return SystemError("cannot start", given, ErrorCode::kBadInput);
  }
  std::vector<std::string> folders;
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&FindProgram), &info) != 0 && info.dli_fname != nullptr) {
    const std::string file = info.dli_fname;
    const std::string folder = file.substr(0, file.rfind('/') + 1);
    folders = {folder + "../bin", folder + "../../bin"};  // lib, lib/x86_64-linux-gnu
  }
  const char* const path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (const std::string& folder : folders) {
    if (runs(folder + "/troupe")) return folder + "/troupe";
  }
  return Failure("found no program troupe beside the library or on the PATH; the package troupe has it");
}

}  // namespace

// Behind a pointer, because the thread keeps its address while the page is moved.
struct SimulationPage::Impl {
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();

  Status Start(const SimulationPageOptions& options);
  Result<std::string> ReadAddress();
  void Show(const Simulation& simulation);
  void Run();
  bool SendNewest(std::unique_lock<std::mutex>& lock, bool last);

  FileDescriptor socket{-1};
  FileDescriptor output{-1};  // of the program
  pid_t pid = -1;
  std::string address;

  mutable std::mutex mutex;  // guards the others but for `thread`
  std::condition_variable changed;
  std::shared_ptr<const Scene> scene;  // of the newest state
  std::shared_ptr<const WorldState> state;
  std::vector<Event> events;  // since the frame that was sent last
  bool is_new = false;        // not sent yet
  bool is_ending = false;
  bool is_open = true;
  bool is_done = false;  // the thread
  const RunId run = MakeRandomId();
  std::shared_ptr<const Scene> sent_scene;
  Tick sent_tick = 0;
  Edition edition = 0;
  Edition world_edition = 0;
  std::thread thread;  // last
};

// posix_spawn and not fork: the program that uses the library may have many threads and much memory.
Status SimulationPage::Impl::Start(const SimulationPageOptions& options) {
  const Result<std::string> program = FindProgram(options.program);
  if (!program.ok()) return program.error();
  std::array<int, 2> ends = {};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return FileError("socket");
  socket = FileDescriptor(ends[0]);
  FileDescriptor input(ends[1]);
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return FileError("pipe");
  output = FileDescriptor(ends[0]);
  FileDescriptor written(ends[1]);

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, input.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, written.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, written.get(), STDERR_FILENO);
  // A terminal's Ctrl-C is for this process, and the child does not inherit what it does with signals.
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const std::string listen = fmt::format("{}:{}", options.address, options.port);
  std::array<std::string, 5> words = {program.value(), "view", "--states", "--listen", listen};
  std::array<char*, 6> arguments = {};
  std::transform(words.begin(), words.end(), arguments.begin(), [](std::string& word) { return word.data(); });
  const int problem = posix_spawn(&pid, program.value().c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (problem != 0) {
    pid = -1;
    return Error{{program.value()}, "cannot start: " + std::string(strerror(problem)), ErrorCode::kFailure};
  }
  return {};
}

// The program prints it when the page can be opened, or an error, and ends.
Result<std::string> SimulationPage::Impl::ReadAddress() {
  std::string text;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(kStartMilliseconds);
  for (;;) {
    const std::size_t begin = text.find("http://");
    const std::size_t stop = begin == std::string::npos ? begin : text.find('\n', begin);
    if (stop != std::string::npos) return text.substr(begin, stop - begin);
    pollfd waited = {output.get(), POLLIN, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return Failure("the program troupe has opened no page: " + PlainLine(text));
    const int ready = poll(&waited, 1, static_cast<int>(left));
    if (ready < 0 && errno != EINTR) return FileError("pipe");
    if (ready <= 0) continue;
    std::array<char, 512> part;
    const ssize_t got = read(output.get(), part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || text.size() > kMaxOutput) {
      while (text.ends_with('\n')) text.pop_back();
      return Failure("the program troupe has opened no page: " + PlainLine(text));
    }
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

// Keeps pointers alone: a state that no frame shows costs nothing more.
void SimulationPage::Impl::Show(const Simulation& simulation) {
  const std::lock_guard lock(mutex);
  if (!is_open) return;
  scene = simulation.scene();
  state = simulation.shared_state();
  if (events.size() < kMaxEvents) {
    events.insert(events.end(), simulation.events().begin(), simulation.events().end());
  }
  // Only the first new state since the last frame wakes the thread: a simulation makes thousands in a second.
  if (!std::exchange(is_new, true)) changed.notify_one();
}

// Ends when the program does not read any more, or at the end of the page.
void SimulationPage::Impl::Run() {
  std::unique_lock lock(mutex);
  fcntl(output.get(), F_SETFL, O_NONBLOCK);
  while (is_open) {
    changed.wait(lock, [this] { return is_new || is_ending; });
    try {
      is_open = SendNewest(lock, is_ending) && !is_ending;
    } catch (
        const std::exception&) {  // as without memory: the page ends, and not the program that steps the simulation
      if (!lock.owns_lock()) lock.lock();
      is_open = false;
    }
    // Not woken by newer states: at most one frame in each period.
    if (is_open) changed.wait_for(lock, kPeriod, [this] { return is_ending; });
  }
  is_done = true;
  changed.notify_all();
}

bool SimulationPage::Impl::SendNewest(std::unique_lock<std::mutex>& lock, bool last) {
  const bool is_other_world = scene != sent_scene;
  // A snapshot that was restored is an edit to viewers: ticks count up from one edit to the next.
  if (is_other_world || state->tick < sent_tick || (is_new && state->tick == sent_tick)) ++edition;
  if (is_other_world) world_edition = edition;
  sent_scene = scene;
  sent_tick = state->tick;
  is_new = false;
  FrameMessage frame;
  frame.run = run;
  frame.last = last;
  frame.edition = edition;
  frame.world_edition = world_edition;
  frame.events = std::exchange(events, {});
  // Copies of pointers: the simulation steps on while this thread hashes and sends.
  const std::shared_ptr<const WorldState> shown = state;
  const std::shared_ptr<const Scene> shown_scene = scene;
  lock.unlock();
  // What the program prints meanwhile is not awaited, and must not fill the pipe.
  std::array<char, 512> ignored;
  while (read(output.get(), ignored.data(), ignored.size()) > 0) {
  }
  frame.state = *shown;
  frame.state_hash = StateHash(frame.state);
  bool sent = true;
  if (is_other_world) {
    SessionMessage session;
    session.run = run;
    session.protocol_version = kProtocolVersion;
    session.host = HostName();
    session.pid = static_cast<std::uint32_t>(getpid());
    session.begun = true;
    session.world = WorldOf(shown_scene);
    session.world_edition = frame.world_edition;
    sent = SendState(socket.get(), session);
  }
  sent = sent && SendState(socket.get(), frame);
  lock.lock();
  return sent;
}

// The last state is sent before the connection ends; then the program has a bounded time to show it.
SimulationPage::Impl::~Impl() {
  if (thread.joinable()) {
    {
      std::unique_lock lock(mutex);
      is_ending = true;
      changed.notify_all();
      // A program that has been stopped does not read.
      if (!changed.wait_for(lock, std::chrono::milliseconds(kEndMilliseconds), [this] { return is_done; })) {
        kill(pid, SIGKILL);
      }
    }
    thread.join();
  }
  if (pid < 0) return;
  shutdown(socket.get(), SHUT_RDWR);
  // The end of its output is that of the program.
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(kEndMilliseconds);
  bool has_ended = false;
  while (!has_ended && Clock::now() < end) {
    pollfd waited = {output.get(), POLLIN, 0};
    poll(&waited, 1, 50);
    std::array<char, 512> ignored;
    has_ended = (waited.revents != 0) && read(output.get(), ignored.data(), ignored.size()) == 0;
  }
  if (!has_ended) kill(pid, SIGKILL);
  while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
}

SimulationPage::SimulationPage(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SimulationPage::SimulationPage(SimulationPage&& other) noexcept = default;
SimulationPage& SimulationPage::operator=(SimulationPage&& other) noexcept = default;
SimulationPage::~SimulationPage() = default;

Result<SimulationPage> SimulationPage::Open(const Simulation& simulation, const SimulationPageOptions& options) {
  auto impl = std::make_unique<Impl>();
  if (Status failure = impl->Start(options); !failure.ok()) return failure.error();
  // Before the address is awaited: a program of another version ends with an error in place of it.
  SendVersion(impl->socket.get(), VersionText());
  Result<std::string> address = impl->ReadAddress();
  if (!address.ok()) return address.error();
  impl->address = std::move(address).value();
  impl->Show(simulation);
  impl->events.clear();
  impl->thread = std::thread([impl = impl.get()] { impl->Run(); });
  return SimulationPage(std::move(impl));
}

const std::string& SimulationPage::address() const {
  return impl_->address;
}

bool SimulationPage::is_open() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->is_open;
}

void SimulationPage::Show(const Simulation& simulation) {
  impl_->Show(simulation);
}

}  // namespace troupe
