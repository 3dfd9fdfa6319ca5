#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/geometry/numbered_work.h"

namespace abbe {

/// One file of readings and how its columns are called.
struct ShardFile {
  std::filesystem::path path;
  ColumnMapping mapping;
};

/// The files of one set-up that are too large for memory.
struct ShardSource {
  std::vector<ShardFile> files;
  InstrumentFileForm form;
  Machine machine;
  std::shared_ptr<const Instrument> device;
  std::string setup;
  bool noise_from_data = false;
  std::size_t drawn = 0;  ///< about so many readings are kept in memory (drawn())
  int threads = 0;
  WorkDriver work{};  ///< who checks the readings; empty: this process
  std::stop_token stop{};
  std::function<void(std::size_t done, std::size_t total)> progress{};  ///< in bytes, from any thread, one at a time
};

/// Readings in files that stay on disk: CSV, Parquet or Arrow IPC. Parts of them are read whenever they are wanted.
///
/// The constructor reads every file twice: it finds the rows, and checks every field. A file that is given twice, under
/// the same name or with the same bytes under another, and a text that ends within a row are refused. What is read
/// later has to have the bytes of that time, or, from files by columns, the values.
class ReadingShards {
 public:
  /// Readings that are parsed together, a multiple of Observations::kBlockSize.
  static constexpr std::size_t kTogether = 4096;
  /// How many such parts make a block of numbered work: one of few, so that every process gets some.
  static std::size_t parts_together(std::size_t parts);

  /// @throws InputError as the readers of the files do, with the line of the file; Stopped
  explicit ReadingShards(ShardSource source);
  ~ReadingShards();

  std::size_t count() const;
  std::size_t file_count() const;
  /// Of names, sizes and contents of all files, in their order.
  std::uint64_t fingerprint() const;
  /// As the files state it.
  const std::shared_ptr<const Instrument>& device() const;
  const std::vector<std::string>& contradictions() const;

  /// Readings first .. last - 1. Thread-safe. @throws InputError if a file has changed since it was checked
  InstrumentReadings read(std::size_t first, std::size_t last) const;

  /// About ShardSource::drawn readings, drawn evenly with a fixed seed, in their order. With them those that stand at
  /// the ends of what axes, known numbers and states run over, and one of every item.
  InstrumentReadings drawn() const;

  /// "reading 12 of bar.csv", counted from 0, for messages.
  std::string place(std::size_t reading) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
