// WorldImage: the world of a run, prepared for all agents of a machine: its description, its scene and its hash, made
// once in shared memory (SharedArena) and read in place. An agent that attaches it reads, checks and indexes nothing,
// and has memory of its own only for the pages that it changes: it counts references of shared parts, and makes routes
// when they are first asked for.
#pragma once

#include <cstdint>
#include <memory>

#include "common/spatial/scene.h"
#include "transport/protocol/transport.h"
#include "transport/shared_memory/shared_arena.h"
#include "troupe/fields.h"
#include "troupe/result.h"
#include "troupe/shared.h"
#include "troupe/world_description.h"

namespace troupe {

// Where an image is: in the memory behind a descriptor of the world service. No bytes: there is none.
struct WorldImagePlace {
  std::uint32_t descriptor = 0;
  std::uint64_t place = 0;  // address
  std::uint64_t bytes = 0;  // from the start of the memory
  std::uint64_t root = 0;   // address
  bool operator==(const WorldImagePlace&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"descriptor", &WorldImagePlace::descriptor},
        Field{"place", &WorldImagePlace::place},
        Field{"bytes", &WorldImagePlace::bytes},
        Field{"root", &WorldImagePlace::root},
    };
  }
};

class WorldImage {
 public:
  // The error: the world is not valid, or there is no memory.
  static Result<std::unique_ptr<WorldImage>> Make(const Shared<WorldDescription>& world);

  WorldImagePlace place() const;
  const Scene& scene() const { return *scene_; }

 private:
  explicit WorldImage(PlacedMemory memory) : memory_(std::move(memory)) {}

  const PlacedMemory memory_;
  std::size_t bytes_ = 0;
  const void* root_ = nullptr;
  const Scene* scene_ = nullptr;
};

// The image of a process on this machine. The scene keeps it, and so does its description (WorldOf).
Result<PreparedWorld> AttachWorld(pid_t owner, const WorldImagePlace& place);

}  // namespace troupe
