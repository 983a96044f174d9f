// SharedArena: memory at the same address in all processes of a machine, in which one process makes ordinary objects
// with their lists and texts, which the others read in place: a pointer among them is right everywhere. Nothing has to
// be copied, converted or made again in each process.
//
// While a SharedArena::Scope exists, whatever its thread allocates by operator new comes from the arena: the operators
// of a program with this file are replaced. So any value can be made there, without allocators of its own; what it
// refers to has to be made there, too (WorldImage copies shared parts). An object in an arena is never destroyed:
// it ends with the memory.
//
// Addresses: a range that programs, libraries and heaps do not use is divided into places of kPlaceBytes. The maker
// takes one at random that is free in its process; in a process where another memory is there already, it cannot be
// attached, and that process uses the network. Places are addresses, not memory: only what is written needs any.
//
// Programs of another build may lay out their objects otherwise: LayoutOfBuild() tells them apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "transport/shared_memory/shared_memory.h"
#include "troupe/result.h"

namespace troupe {

inline constexpr std::size_t kPlaceBytes = std::size_t{8} << 30;

// A number of the headers, the compiler and its options that this program was made with.
std::uint64_t LayoutOfBuild();

// Memory of kPlaceBytes at a place. In one process, all mappings of one memory are the same mapping.
struct PlacedMemory {
  SharedMemory memory;
  std::shared_ptr<const MappedMemory> mapped;
  std::byte* begin = nullptr;

  // Other processes may read it. The error: the system has no memory, or no place is free.
  static Result<PlacedMemory> Create(const char* name);
};

enum class Attachment : std::uint8_t {
  kReadOnly,
  kCopyOnWrite,  // a write changes the page in this process alone
};

// The first bytes of such a memory of another process, at its place. The error: the place is not free, or none.
Result<std::shared_ptr<const MappedMemory>> Attach(const SharedMemory& memory, std::uint64_t place, std::size_t bytes,
                                                   Attachment attachment);

// Threads: one at a time.
class SharedArena {
 public:
  // Of a part of a memory that outlives it. REQUIRES: `begin` is a multiple of the page size
  SharedArena(const PlacedMemory& memory, std::size_t begin, std::size_t size);
  SharedArena(const SharedArena&) = delete;
  SharedArena& operator=(const SharedArena&) = delete;

  // Bytes from the start of the part to the first object that is made there.
  static constexpr std::size_t kFirstObject = 16;

  // Throws std::bad_alloc if the part is full, or the system has no memory.
  void* Allocate(std::size_t bytes, std::size_t alignment);
  // REQUIRES: Contains(pointer); it was allocated here.
  void Free(void* pointer) noexcept;
  bool Contains(const void* pointer) const;
  // Bytes of the memory from its begin to the last that was allocated, a multiple of the page size.
  std::size_t end() const;

  // See above. Scopes of a thread do not overlap.
  class Scope {
   public:
    explicit Scope(SharedArena& arena);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  };

 private:
  static constexpr std::size_t kClasses = 160;  // of sizes: four for each power of two

  const PlacedMemory& memory_;
  const std::size_t limit_;             // bytes from the start of the memory, as the next two
  std::size_t next_;                    // the first that was never allocated
  std::size_t reserved_;                // up to here there is real memory
  std::array<void*, kClasses> free_{};  // lists of freed blocks, by class; each has the next one in its first bytes
};

}  // namespace troupe
