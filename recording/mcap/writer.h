// Writer: writes an MCAP file: messages in compressed chunks, each with its index; at the end a summary.
//
// A file that is not closed, because its process has ended, is readable up to its last chunk.
//
// A chunk is the unit of compression, of reading and of loss: a message is in the file once its chunk is. All that the
// summary needs is kept in memory (WrittenPart), and written once at the end; a reader of a file without it scans
// instead. Errors of the sink stay: after one nothing more is written, and each later call returns it.
//
// One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recording/mcap/byte_stream.h"
#include "recording/mcap/bytes.h"
#include "recording/mcap/format.h"
#include "troupe/result.h"

namespace troupe::mcap {

class Writer {
 public:
  // Begins the file. `profile` and `library` are for its header.
  static Result<Writer> Create(std::unique_ptr<ByteSink> sink, const std::string& profile, const std::string& library);

  // The chunks from now on are not compressed.
  void LeaveUncompressed() { compressor_ = Compressor::None(); }

  // Continues a file; the sink appends to its part.
  static Writer Continue(std::unique_ptr<ByteSink> sink, WrittenPart part);

  // Return the new id. Errors of the sink are returned by the next EndChunk.
  std::uint16_t AddSchema(const Schema& schema);
  std::uint16_t AddChannel(const Channel& channel);

  // Adds a message to the open chunk. REQUIRES: its channel was added.
  void Add(const Message& message);
  // Bytes of the open chunk, before compression.
  std::size_t open_size() const { return records_.size(); }

  // Writes the open chunk, unless it is empty. The error is that of the sink, now or before.
  Status EndChunk();
  // The chunks survive a loss of power.
  Status Sync() { return status_.ok() ? sink_->Sync() : status_; }
  // Writes the open chunk and the summary, and closes the sink.
  Status Close();

 private:
  // Log time and offset in the chunk of a message.
  struct IndexEntry {
    std::uint64_t log_time;
    std::uint64_t offset;
  };

  explicit Writer(std::unique_ptr<ByteSink> sink) : sink_(std::move(sink)) {}
  // Writes bytes of the data section.
  void Write(std::span<const std::byte> bytes);
  // Writes `buffer_` as bytes of the data section, and clears it.
  void WriteBuffer();
  void WriteSummary();

  std::unique_ptr<ByteSink> sink_;
  Status status_;
  WrittenPart written_;

  Compressor compressor_;
  std::vector<std::byte> records_;                            // of the open chunk
  std::map<std::uint16_t, std::vector<IndexEntry>> indices_;  // of the open chunk, by channel
  std::uint64_t start_time_ = 0;                              // of the open chunk, ns
  std::uint64_t end_time_ = 0;
  std::vector<std::byte> compressed_;
  std::vector<std::byte> buffer_;
};

}  // namespace troupe::mcap
