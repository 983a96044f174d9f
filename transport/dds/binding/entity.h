// Entity: owner of a handle of Cyclone DDS. Deleting it deletes the entities that were created from it. Move-only.
#pragma once

#include <dds/dds.h>

#include <utility>

namespace troupe::dds {

class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    if (this != &other) {
      close();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }
  ~Entity() { close(); }

  // The handle for Cyclone's C functions; 0 if there is none.
  dds_entity_t handle() const { return handle_; }
  bool is_open() const { return handle_ != 0; }

  // Deletes the entity. Waits for its listeners to return, so never call it from one.
  void close() noexcept {
    if (handle_ != 0) dds_delete(handle_);
    handle_ = 0;  // not before: a listener may still be reading it
  }

 private:
  dds_entity_t handle_ = 0;
};

}  // namespace troupe::dds
