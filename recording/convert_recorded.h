// The parts of a recorded run as the CDR bytes of their types in idl/, and back. Private to this folder.
//
// Any bytes are safe: an error when they are not a sample of the type, or break the contract of its IDL file.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recording/recorded_run.h"
#include "troupe/result.h"

namespace troupe {

std::vector<std::byte> RunToBytes(const RecordedRun& run);
Result<RecordedRun> RunFromBytes(std::span<const std::byte> bytes);

std::vector<std::byte> EditToBytes(const RecordedEdit& edit);
Result<RecordedEdit> EditFromBytes(std::span<const std::byte> bytes);

// The number, tick, edition, hash and events only.
std::vector<std::byte> TickToBytes(const RecordedTick& tick);
Status TickFromBytes(std::span<const std::byte> bytes, RecordedTick& tick);

}  // namespace troupe
