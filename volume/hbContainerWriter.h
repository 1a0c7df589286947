#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "volume/hbContainerFormat.h"
#include "volume/hbOutputFile.h"
#include "volume/hbProgress.h"

class hbContainerReader;

/// Writes an `.hbv` file chunk by chunk; the file appears whole with commit(), or not at all.
///
/// The same chunks in the same order give the same bytes (nothing depends on time, machine or threads; zstd's bytes
/// depend on its version). Only the table is kept in memory. After a failed write the temporary file is gone and every
/// further call throws.
class hbContainerWriter {
public:
  /// Begins a new file that will replace `target`. Throws hbError where it cannot be written.
  explicit hbContainerWriter(const std::filesystem::path& target);

  /// Goes on with the chunks of an existing file: a series grows by further steps.
  ///
  /// The old chunks are copied into the new temporary file, checksums compared on the way, and the old file is replaced
  /// by commit(). Writing behind the chunks of the old file itself would save that copy, but would overwrite its table
  /// (which must be at the end), so that an interruption would lose the whole series; this way it leaves the old file
  /// as it was. Costs one read and write of the old file.
  ///
  /// Throws hbError where the old file is damaged, newer, or holds critical chunks of a type outside `knownTypes`.
  /// Unknown ancillary chunks are kept; doc/formats.md has the rule that makes this right.
  static hbContainerWriter appendTo(const std::filesystem::path& target, std::vector<hbChunkType> knownTypes,
                                    hbProgress& progress = hbProgress::none());

  ~hbContainerWriter();
  hbContainerWriter(const hbContainerWriter&) = delete;
  hbContainerWriter& operator=(const hbContainerWriter&) = delete;

  /// Writes one chunk. Where the codec does not make it smaller it is stored as it is. Throws hbError where the id
  /// occurred before or its type is not four printable ASCII characters (nothing is written, the writer stays usable),
  /// and where writing fails.
  void add(const hbChunkId& id, hbChunkKind kind, std::span<const std::byte> bytes, hbCodec codec);

  /// Writes table and header, flushes to disk and renames. Throws hbError where that fails.
  void commit();

  /// The chunks so far, in the order of the file.
  std::span<const hbChunkEntry> entries() const { return entries_; }

private:
  hbContainerWriter(const hbContainerReader& old, hbProgress& progress);

  void open();
  void expectOpen() const;
  void write(std::span<const std::byte> bytes);
  void pad();
  void closeFile();
  [[noreturn]] void fail();

  std::filesystem::path target_;
  std::unique_ptr<hbOutputFile> output_; ///< None once committed or failed.
  int file_ = -1;
  std::uint64_t position_ = 0;
  std::uint16_t minor_ = hb::kContainerMinor; ///< An appended file keeps a newer minor version, and its features.
  std::uint64_t features_ = 0;
  std::vector<hbChunkEntry> entries_;
  std::set<hbChunkId> ids_;
};
