// Recordings whose messages have other fields than those of today: their schemas, which are in the file, say which. A
// field that is new has the value zero, and none of its elements; one that is gone is left out.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

// A change from one layout of a type to another, for samples in plain little-endian CDR.
class LayoutChange {
 public:
  // The texts are of IDL files with all types that `type` ("troupe::wire::Frame") uses, in the part of the language
  // that idl/ uses. The error is another text, or a field whose type has changed.
  static Result<LayoutChange> Between(const std::string& from, const std::string& to, const std::string& type);

  // True if the texts differ in comments at most.
  static bool IsNone(const std::string& from, const std::string& to);

  // Any bytes are safe.
  Result<std::vector<std::byte>> Apply(std::span<const std::byte> sample) const;

  struct Struct;

 private:
  LayoutChange() = default;

  using Types = std::map<std::string, std::unique_ptr<Struct>>;
  std::shared_ptr<const Types> from_;
  std::shared_ptr<const Types> to_;
  const Struct* from_type_ = nullptr;
  const Struct* to_type_ = nullptr;
};

}  // namespace troupe
