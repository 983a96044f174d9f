#include "transport/shared_memory/shared_memory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <utility>

#include "common/base/system_error.h"

namespace troupe {
namespace {

// A lock of the open file, not of the process: each AgentSegment has its own, also where a process has several.
struct flock LockOf(int type, std::size_t offset, std::size_t size) {
  struct flock lock {};
  lock.l_type = static_cast<short>(type);
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(offset);
  lock.l_len = static_cast<off_t>(size);
  return lock;
}

constexpr int kSizeSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

// "pid:[4026531836]"; empty: unknown.
std::string Namespace(const char* kind) {
  std::array<char, 64> target{};
  const std::string path = std::string("/proc/self/ns/") + kind;
  const ssize_t size = readlink(path.c_str(), target.data(), target.size());
  return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

template <typename Number>
bool ParseNumber(std::string_view text, Number& number, int base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

// The text up to the next comma, which is removed from `rest`.
std::string_view NextField(std::string_view& rest) {
  const std::size_t end = rest.find(',');
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return field;
}

}  // namespace

MappedMemory::MappedMemory(MappedMemory&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedMemory& MappedMemory::operator=(MappedMemory&& other) noexcept {
  std::swap(begin_, other.begin_);
  std::swap(size_, other.size_);
  return *this;
}

MappedMemory::~MappedMemory() {
  if (begin_ != nullptr) munmap(begin_, size_);
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), writable_(other.writable_) {}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(writable_, other.writable_);
  return *this;
}

SharedMemory::~SharedMemory() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<SharedMemory::OwnedMemory> SharedMemory::Create(const char* name, std::size_t size, Peers peers,
                                                       std::byte* place) {
  // Beyond the limit ftruncate would end the process with a signal.
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur < size) {
    return Failure("the limit of file sizes (ulimit -f) is too low for shared memory");
  }
  SharedMemory memory(memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING), true);
  if (memory.descriptor_ < 0) return SystemError("making shared memory");
  if (ftruncate(memory.descriptor_, static_cast<off_t>(size)) != 0) return SystemError("sizing shared memory");
  // The mapping of the owner precedes the seal that denies later ones.
  Result<MappedMemory> mapped = place != nullptr ? memory.MapAt(place, size, false) : memory.Map(0, size);
  if (!mapped.ok()) return mapped.error();
  const int seals = kSizeSeals | (peers == Peers::kMayRead ? F_SEAL_FUTURE_WRITE : 0);
  if (fcntl(memory.descriptor_, F_ADD_SEALS, seals) != 0) return SystemError("sealing shared memory");
  return OwnedMemory{std::move(memory), std::move(mapped).value()};
}

Result<SharedMemory> SharedMemory::Open(pid_t owner, int descriptor, std::size_t size, Peers access) {
  const std::string path = "/proc/" + std::to_string(owner) + "/fd/" + std::to_string(descriptor);
  const bool writable = access == Peers::kMayWrite;
  // Never waits, also if the descriptor belongs to something else by now.
  SharedMemory memory(open(path.c_str(), (writable ? O_RDWR : O_RDONLY) | O_CLOEXEC | O_NONBLOCK | O_NOCTTY), writable);
  if (memory.descriptor_ < 0) return SystemError("opening the shared memory of process " + std::to_string(owner));
  struct stat status {};
  const int seals = fcntl(memory.descriptor_, F_GET_SEALS);
  if (fstat(memory.descriptor_, &status) != 0 || seals < 0 || (seals & kSizeSeals) != kSizeSeals ||
      static_cast<std::size_t>(status.st_size) != size || status.st_uid != geteuid()) {
    return Failure("the descriptor of process " + std::to_string(owner) + " is not its shared memory");
  }
  return memory;
}

Result<MappedMemory> SharedMemory::Map(std::size_t offset, std::size_t size) const {
  void* const begin = mmap(nullptr, size, writable_ ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, descriptor_,
                           static_cast<off_t>(offset));
  if (begin == MAP_FAILED) return SystemError("mapping shared memory");
  return MappedMemory(static_cast<std::byte*>(begin), size);
}

Result<MappedMemory> SharedMemory::MapAt(std::byte* place, std::size_t size, bool copy_on_write) const {
  const int access = writable_ || copy_on_write ? PROT_READ | PROT_WRITE : PROT_READ;
  // Pages that are never written need no memory of this process.
  const int kind = copy_on_write ? MAP_PRIVATE | MAP_NORESERVE : MAP_SHARED;
  void* const begin = mmap(place, size, access, kind | MAP_FIXED_NOREPLACE, descriptor_, 0);
  if (begin == MAP_FAILED) return SystemError("mapping shared memory at its address");
  MappedMemory mapped(static_cast<std::byte*>(begin), size);
  // Systems before Linux 4.17 choose another address.
  if (begin != place) return Failure("the address of shared memory is in use");
  return mapped;
}

Status SharedMemory::Reserve(std::size_t offset, std::size_t size) const {
  // It may take milliseconds, in which a signal arrives.
  while (fallocate(descriptor_, 0, static_cast<off_t>(offset), static_cast<off_t>(size)) != 0) {
    if (errno != EINTR) return SystemError("reserving shared memory");
  }
  return {};
}

Result<bool> SharedMemory::Claim(std::size_t offset, std::size_t size) const {
  struct flock lock = LockOf(F_WRLCK, offset, size);
  if (fcntl(descriptor_, F_OFD_SETLK, &lock) == 0) return true;
  if (errno == EAGAIN || errno == EACCES) return false;
  return SystemError("claiming shared memory");
}

void SharedMemory::Release(std::size_t offset, std::size_t size) const {
  struct flock lock = LockOf(F_UNLCK, offset, size);
  fcntl(descriptor_, F_OFD_SETLK, &lock);
}

Result<bool> SharedMemory::IsClaimed(std::size_t offset, std::size_t size) const {
  struct flock lock = LockOf(F_WRLCK, offset, size);
  if (fcntl(descriptor_, F_OFD_GETLK, &lock) != 0) return SystemError("testing claims of shared memory");
  return lock.l_type != F_UNLCK;
}

std::string ThisMachine() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string boot;
  const std::string processes = Namespace("pid");
  const std::string network = Namespace("net");
  if (!(file >> boot) || processes.empty() || network.empty()) return {};
  return fmt::format("{}/{}/{}/uid:{}", boot, processes, network, geteuid());
}

bool IsThisBoot(const SharingAddress& address) {
  const std::string here = ThisMachine();
  return !here.empty() && address.machine.starts_with(here.substr(0, here.find('/') + 1));
}

std::string ToText(const SharingAddress& address) {
  return fmt::format("{},{},{},{},{:x}", address.machine, address.process, address.frames, address.answers,
                     address.key);
}

std::optional<SharingAddress> ParseSharingAddress(std::string_view text) {
  SharingAddress address;
  address.machine = NextField(text);
  const bool valid = !address.machine.empty() && ParseNumber(NextField(text), address.process, 10) &&
                     ParseNumber(NextField(text), address.frames, 10) &&
                     ParseNumber(NextField(text), address.answers, 10) && ParseNumber(NextField(text), address.key, 16);
  if (!valid || !text.empty() || address.process <= 0 || address.frames < 0 || address.answers < 0) {
    return std::nullopt;
  }
  return address;
}

}  // namespace troupe
