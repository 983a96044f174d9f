#include "transport/shared_memory/shared_arena.h"

#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>

#include "common/base/identity.h"
#include "common/base/system_error.h"
#include "transport/shared_memory/build_layout.h"

#if defined(__SANITIZE_THREAD__)
#define TROUPE_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TROUPE_THREAD_SANITIZER
#endif
#endif

namespace troupe {
namespace {

// Far from programs (0x55...), libraries and stacks (0x7f...), and from the tables of sanitizers. The thread sanitizer
// uses most of the rest itself.
#ifdef TROUPE_THREAD_SANITIZER
constexpr std::uintptr_t kFirstPlace = 0x5500'0000'0000;
constexpr std::uintptr_t kPlaces = 40;
#else
constexpr std::uintptr_t kFirstPlace = 0x2000'0000'0000;
constexpr std::uintptr_t kPlaces = 6144;
#endif
constexpr int kAttempts = 16;  // to find a place that is free

constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kReservedAtOnce = std::size_t{1} << 18;
constexpr std::size_t kLeastAlignment = 16;

bool IsInPlaces(std::uintptr_t address) {
  return address - kFirstPlace < kPlaces * kPlaceBytes;
}

// Precedes each block.
struct BlockHeader {
  std::uint32_t size_class;
  std::uint32_t offset;  // from the start of its memory to the block
  std::uint64_t unused;
};
static_assert(sizeof(BlockHeader) == kLeastAlignment && sizeof(BlockHeader) == SharedArena::kFirstObject);

// Four classes for each power of two from 64 bytes on, so that less than a fifth of a block is unused.
std::size_t ClassOf(std::size_t bytes) {
  if (bytes <= 64) return 0;
  const auto power = static_cast<std::size_t>(std::bit_width(bytes - 1)) - 1;  // 2^power < bytes <= 2^(power + 1)
  const std::size_t quarter = (bytes - 1 - (std::size_t{1} << power)) >> (power - 2);
  return (power - 6) * 4 + quarter + 1;
}
std::size_t SizeOf(std::size_t size_class) {
  if (size_class == 0) return 64;
  const std::size_t power = (size_class - 1) / 4 + 6;
  return (std::size_t{1} << power) + ((size_class - 1) % 4 + 1) * (std::size_t{1} << (power - 2));
}

// Of this process: what is mapped at the places, so that several users of one memory share its mapping.
struct Attached {
  dev_t device;
  ino_t inode;
  std::size_t bytes;
  std::weak_ptr<const MappedMemory> mapped;
};
std::mutex attached_mutex;
std::map<std::uintptr_t, Attached>& AttachedMemory() {
  static auto* const attached = new std::map<std::uintptr_t, Attached>();  // never destroyed: threads may still use it
  return *attached;
}

constinit thread_local SharedArena* arena_of_scope = nullptr;

}  // namespace

std::uint64_t LayoutOfBuild() {
  return kBuildLayout;
}

Result<PlacedMemory> PlacedMemory::Create(const char* name) {
  const std::lock_guard lock(attached_mutex);
  Error error;
  for (int i = 0; i < kAttempts; ++i) {
    auto* const begin = std::bit_cast<std::byte*>(kFirstPlace + MakeRandomId() % kPlaces * kPlaceBytes);
    auto made = SharedMemory::Create(name, kPlaceBytes, SharedMemory::Peers::kMayRead, begin);
    if (!made.ok()) {
      error = made.error();
      continue;
    }
    SharedMemory::OwnedMemory owned = std::move(made).value();
    struct stat status {};
    if (fstat(owned.memory.descriptor(), &status) != 0) return SystemError("reading the state of shared memory");
    PlacedMemory placed{std::move(owned.memory), std::make_shared<const MappedMemory>(std::move(owned.mapped)), begin};
    AttachedMemory()[reinterpret_cast<std::uintptr_t>(begin)] = {status.st_dev, status.st_ino, kPlaceBytes,
                                                                 placed.mapped};
    return placed;
  }
  return error;
}

Result<std::shared_ptr<const MappedMemory>> Attach(const SharedMemory& memory, std::uint64_t place, std::size_t bytes,
                                                   Attachment attachment) {
  if (!IsInPlaces(place) || (place - kFirstPlace) % kPlaceBytes != 0 || bytes == 0 || bytes > kPlaceBytes) {
    return Failure("shared memory at an address that is no place for it");
  }
  struct stat status {};
  if (fstat(memory.descriptor(), &status) != 0) return SystemError("reading the state of shared memory");
  const std::lock_guard lock(attached_mutex);
  auto& attached = AttachedMemory();
  std::erase_if(attached, [](const auto& known) { return known.second.mapped.expired(); });
  const auto known = attached.find(place);
  if (known != attached.end()) {
    auto mapped = known->second.mapped.lock();
    const bool is_same = known->second.device == status.st_dev && known->second.inode == status.st_ino;
    if (mapped != nullptr && is_same && known->second.bytes >= bytes) return mapped;
  }
  auto mapped = memory.MapAt(std::bit_cast<std::byte*>(place), bytes, attachment == Attachment::kCopyOnWrite);
  if (!mapped.ok()) return mapped.error();
  auto shared = std::make_shared<const MappedMemory>(std::move(mapped).value());
  attached[place] = {status.st_dev, status.st_ino, bytes, shared};
  return shared;
}

SharedArena::SharedArena(const PlacedMemory& memory, std::size_t begin, std::size_t size)
    : memory_(memory), limit_(begin + size), next_(begin), reserved_(begin) {}

void* SharedArena::Allocate(std::size_t bytes, std::size_t alignment) {
  const std::size_t padding = alignment > kLeastAlignment ? alignment : 0;
  if (bytes > limit_) throw std::bad_alloc();
  const std::size_t size_class = ClassOf(bytes + sizeof(BlockHeader) + padding);
  std::byte* memory = nullptr;
  if (free_[size_class] != nullptr) {
    memory = static_cast<std::byte*>(free_[size_class]);
    free_[size_class] = *reinterpret_cast<void**>(memory);
  } else {
    const std::size_t size = SizeOf(size_class);
    if (size > limit_ - next_) throw std::bad_alloc();
    if (next_ + size > reserved_) {
      // A write to memory that the system does not have would end the process.
      const std::size_t missing = next_ + size - reserved_;
      const std::size_t more = std::min((missing + kReservedAtOnce - 1) / kReservedAtOnce * kReservedAtOnce,
                                        (limit_ - reserved_) / kPageBytes * kPageBytes);
      if (more < missing || !memory_.memory.Reserve(reserved_, more).ok()) throw std::bad_alloc();
      reserved_ += more;
    }
    memory = memory_.begin + next_;
    next_ += size;
  }
  auto block = reinterpret_cast<std::uintptr_t>(memory) + sizeof(BlockHeader);
  if (padding != 0) block = (block + alignment - 1) / alignment * alignment;
  auto* const header = std::bit_cast<BlockHeader*>(block) - 1;
  header->size_class = static_cast<std::uint32_t>(size_class);
  header->offset = static_cast<std::uint32_t>(block - reinterpret_cast<std::uintptr_t>(memory));
  return std::bit_cast<void*>(block);
}

void SharedArena::Free(void* pointer) noexcept {
  const BlockHeader header = *(static_cast<BlockHeader*>(pointer) - 1);
  auto* const memory = static_cast<std::byte*>(pointer) - header.offset;
  *reinterpret_cast<void**>(memory) = free_[header.size_class];
  free_[header.size_class] = memory;
}

bool SharedArena::Contains(const void* pointer) const {
  const auto* const place = static_cast<const std::byte*>(pointer);
  return place >= memory_.begin && place < memory_.begin + limit_;
}

std::size_t SharedArena::end() const {
  return (next_ + kPageBytes - 1) / kPageBytes * kPageBytes;
}

SharedArena::Scope::Scope(SharedArena& arena) {
  TROUPE_CHECK(arena_of_scope == nullptr);
  arena_of_scope = &arena;
}

SharedArena::Scope::~Scope() {
  arena_of_scope = nullptr;
}

namespace {

void* AllocateAnywhere(std::size_t size, std::size_t alignment) noexcept {
  if (arena_of_scope != nullptr) {
    try {
      return arena_of_scope->Allocate(size, alignment);
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
  }
  if (alignment <= kLeastAlignment) return std::malloc(std::max<std::size_t>(size, 1));
  return std::aligned_alloc(alignment, (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment);
}

void* AllocateOrThrow(std::size_t size, std::size_t alignment) {
  for (;;) {
    if (void* const block = AllocateAnywhere(size, alignment)) return block;
    const std::new_handler handler = arena_of_scope != nullptr ? nullptr : std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

// A block of another arena than that of the scope ends with its memory.
void FreeAnywhere(void* block) noexcept {
  if (IsInPlaces(reinterpret_cast<std::uintptr_t>(block))) {
    if (arena_of_scope != nullptr && arena_of_scope->Contains(block)) arena_of_scope->Free(block);
    return;
  }
  std::free(block);
}

constexpr std::size_t NumberOf(std::align_val_t alignment) {
  return static_cast<std::size_t>(alignment);
}

}  // namespace
}  // namespace troupe

// The replaced operators of the program (C++ standard, [new.delete]).

void* operator new(std::size_t size) {
  return troupe::AllocateOrThrow(size, troupe::kLeastAlignment);
}
void* operator new[](std::size_t size) {
  return troupe::AllocateOrThrow(size, troupe::kLeastAlignment);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return troupe::AllocateAnywhere(size, troupe::kLeastAlignment);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return troupe::AllocateAnywhere(size, troupe::kLeastAlignment);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return troupe::AllocateOrThrow(size, troupe::NumberOf(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return troupe::AllocateOrThrow(size, troupe::NumberOf(alignment));
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return troupe::AllocateAnywhere(size, troupe::NumberOf(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return troupe::AllocateAnywhere(size, troupe::NumberOf(alignment));
}
void operator delete(void* block) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete[](void* block) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete(void* block, std::size_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete[](void* block, std::size_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete[](void* block, std::align_val_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete[](void* block, std::size_t, std::align_val_t) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete(void* block, const std::nothrow_t&) noexcept {
  troupe::FreeAnywhere(block);
}
void operator delete[](void* block, const std::nothrow_t&) noexcept {
  troupe::FreeAnywhere(block);
}
