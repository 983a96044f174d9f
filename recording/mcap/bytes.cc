#include "recording/mcap/bytes.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <utility>

#include "troupe/check.h"

namespace troupe::mcap {
namespace {

// Fast: a level more costs half as much time again and saves 2 percent of a recording.
constexpr int kLevel = 1;
constexpr std::size_t kFirstSize = std::size_t{256} * 1024;  // bytes

struct FreeDecompression {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};

}  // namespace

std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t crc) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

struct Compressor::Context {
  ~Context() { ZSTD_freeCCtx(zstd); }
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
};

Compressor::Compressor() : context_(std::make_unique<Context>()) {
  if (context_->zstd == nullptr) throw std::bad_alloc();
}
Compressor::~Compressor() = default;
Compressor::Compressor(Compressor&& other) noexcept = default;
Compressor& Compressor::operator=(Compressor&& other) noexcept = default;

Compressor Compressor::None() {
  Compressor none;
  none.context_.reset();
  return none;
}

void Compressor::Compress(std::span<const std::byte> from, std::vector<std::byte>& to) {
  if (context_ == nullptr) return to.assign(from.begin(), from.end());
  to.resize(ZSTD_compressBound(from.size()));
  const std::size_t size = ZSTD_compressCCtx(context_->zstd, to.data(), to.size(), from.data(), from.size(), kLevel);
  TROUPE_CHECK(ZSTD_isError(size) == 0);  // fails for a buffer that is too small only
  to.resize(size);
}

Result<std::vector<std::byte>> Decompress(std::span<const std::byte> from, std::uint64_t size) {
  const std::unique_ptr<ZSTD_DStream, FreeDecompression> stream(ZSTD_createDStream());
  if (stream == nullptr) throw std::bad_alloc();
  std::vector<std::byte> bytes;
  ZSTD_inBuffer in = {from.data(), from.size(), 0};
  std::size_t done = 0;
  std::size_t wanted = 1;  // 0: the end of a frame
  for (;;) {
    // The stated size is of unknown origin: memory doubles as bytes really arrive.
    if (done == bytes.size() && done < size) {
      bytes.resize(std::min<std::uint64_t>(size, std::max(kFirstSize, 2 * bytes.size())));
    }
    ZSTD_outBuffer out = {bytes.data(), bytes.size(), done};
    const std::size_t read_before = in.pos;
    wanted = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(wanted) != 0) return Error{{}, std::string("cannot decompress: ") + ZSTD_getErrorName(wanted)};
    const bool stuck = out.pos == done && in.pos == read_before;
    done = out.pos;
    if (wanted == 0 && in.pos == in.size) break;
    if (stuck) {
      if (done == size && wanted != 0) return Error{{}, "cannot decompress: found more bytes than its size says"};
      return Error{{}, "cannot decompress: found too few bytes"};
    }
  }
  if (done != size) {
    return Error{{}, "found " + std::to_string(done) + " decompressed bytes, expected " + std::to_string(size)};
  }
  return bytes;
}

}  // namespace troupe::mcap
