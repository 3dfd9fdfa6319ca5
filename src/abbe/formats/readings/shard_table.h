#pragma once

// Internal to formats: one file of readings that stays on disk, text or columns.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "abbe/formats/readings/column_reader.h"
#include "abbe/formats/readings/reading_shards.h"
#include "abbe/formats/readings/shard_index.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

/// A file whose rows are read in parts, by several threads.
class ShardTable {
 public:
  explicit ShardTable(const std::filesystem::path& path) : file_(path) {}
  virtual ~ShardTable() = default;

  const std::filesystem::path& path() const { return file_.path(); }
  std::size_t size() const { return file_.size(); }  ///< bytes

  /// As the function of this name (shard_index.h).
  virtual ShardRows find_rows(std::size_t number, std::size_t first, std::size_t together,
                              const std::function<void(std::size_t)>& read) = 0;
  /// The rows of a part with their header, as InstrumentFileForm::parse takes them.
  virtual std::string read(const ShardPart& part) const = 0;
  /// How many bytes of the file a part is, for progress.
  virtual std::size_t bytes_of(const ShardPart& part) const = 0;
  /// An error with the place in the whole file instead of that in read(); in read() the first row is in line 2.
  virtual InputError placed(const InputError& error, const ShardPart& part) const = 0;

 protected:
  PartFile file_;
};

/// The files in their order; all column files are read by one process. @throws InputError if one cannot be opened
std::vector<std::unique_ptr<ShardTable>> open_shard_tables(const std::vector<ShardFile>& files);

}  // namespace abbe
