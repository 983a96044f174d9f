// SharedMemory: memory that processes of one user on one machine share. It has no name in the file system: another
// process opens it through the descriptors of its owner in /proc, and it ends with the last process that maps it,
// however that process ends. Nothing is left to clean.
//
// Sealed: the size can never change, so that no access faults because a peer has shrunk the file, and memory that peers
// may only read can never be mapped for writing again. Opening checks the seals, the size and the owner: any other
// descriptor is refused.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "troupe/result.h"

namespace troupe {

// A mapping; unmapped by its destructor.
class MappedMemory {
 public:
  MappedMemory() = default;
  MappedMemory(std::byte* begin, std::size_t size) : begin_(begin), size_(size) {}
  MappedMemory(MappedMemory&& other) noexcept;
  MappedMemory& operator=(MappedMemory&& other) noexcept;
  ~MappedMemory();

  // An object at this place. REQUIRES: it is inside.
  template <typename T>
  T& At(std::size_t offset) const {
    return *reinterpret_cast<T*>(begin_ + offset);
  }
  template <typename T>
  std::span<T> Array(std::size_t offset, std::size_t count) const {
    return {reinterpret_cast<T*>(begin_ + offset), count};
  }
  bool empty() const { return begin_ == nullptr; }

 private:
  std::byte* begin_ = nullptr;
  std::size_t size_ = 0;
};

class SharedMemory {
 public:
  enum class Peers : bool { kMayRead, kMayWrite };

  // New memory of zeros, which needs real memory only where it is written, and its mapping. Its size never changes.
  // Other processes may open it as `peers` says. With `place` it is mapped there, or nowhere.
  struct OwnedMemory;
  static Result<OwnedMemory> Create(const char* name, std::size_t size, Peers peers, std::byte* place = nullptr);
  // The memory behind a descriptor of another process, of the same user, or why it cannot be opened.
  static Result<SharedMemory> Open(pid_t owner, int descriptor, std::size_t size, Peers access);

  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  ~SharedMemory();

  int descriptor() const { return descriptor_; }

  // Multiples of the page size.
  Result<MappedMemory> Map(std::size_t offset, std::size_t size) const;
  // The first bytes at this address. The error: other memory is there. `copy_on_write`: writes change the pages in this
  // process alone.
  Result<MappedMemory> MapAt(std::byte* place, std::size_t size, bool copy_on_write) const;
  // Obtains real memory for this part: without it a write to the mapping would end the process.
  Status Reserve(std::size_t offset, std::size_t size) const;

  // Claims this part among all that have opened the memory. False: another one has claimed some of it. A claim lasts
  // until Release, or until the process ends, however it ends. REQUIRES: Peers::kMayWrite. The error of these: a system
  // without such claims.
  Result<bool> Claim(std::size_t offset, std::size_t size) const;
  void Release(std::size_t offset, std::size_t size) const;
  // Whether another one has claimed some of this part.
  Result<bool> IsClaimed(std::size_t offset, std::size_t size) const;

 private:
  SharedMemory(int descriptor, bool writable) : descriptor_(descriptor), writable_(writable) {}

  int descriptor_ = -1;
  bool writable_ = false;  // by this process
};

struct SharedMemory::OwnedMemory {
  SharedMemory memory;
  MappedMemory mapped;
};

// SharingAddress: where the processes of this machine find the shared memory of a world service. The service announces
// it to its agents.
struct SharingAddress {
  // The same for processes that can share memory: the boot of the machine, the namespaces of processes and networks (a
  // container, or a host that is emulated, counts as a machine of its own), and the user.
  std::string machine;
  std::int32_t process = 0;
  std::int32_t frames = 0;  // descriptors of that process
  std::int32_t answers = 0;
  std::uint64_t key = 0;  // random; in the memory, too, so that no other memory is mistaken for it
  bool operator==(const SharingAddress&) const = default;
};

// The machine of this process; empty: the system does not report it.
std::string ThisMachine();

// Whether the service is on this machine, since the same boot; its memory may belong to another user or container.
bool IsThisBoot(const SharingAddress& address);

// One word without ';'.
std::string ToText(const SharingAddress& address);
std::optional<SharingAddress> ParseSharingAddress(std::string_view text);

}  // namespace troupe
