#include "abbe/formats/readings/reading_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/readings/shard_table.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/instruments/observations.h"

namespace abbe {
namespace {

static_assert(ReadingShards::kTogether % Observations::kBlockSize == 0);

/// The readings that stand farthest out in some column, and the first of every item.
class OutermostReadings {
 public:
  void take(const InstrumentReadings& readings, std::size_t first) {
    std::size_t column = 0;
    const auto take_columns = [&](const auto& columns) {
      for (const auto& values : columns) take_column(column++, values, first);
    };
    take_columns(readings.poses.axis);
    take_columns(readings.poses.approach);
    take_columns(readings.poses.state);
    take_columns(readings.inputs);
    for (std::size_t k = 0; k < readings.item.size(); ++k) {
      const auto [place, is_new] = items_.try_emplace(readings.item[k], first + k);
      if (!is_new) place->second = std::min(place->second, first + k);
    }
  }

  std::vector<std::size_t> readings() const {
    std::vector<std::size_t> result;
    for (const auto& [column, ends] : columns_) {
      result.push_back(ends.least.second);
      result.push_back(ends.largest.second);
    }
    for (const auto& [item, reading] : items_) result.push_back(reading);
    return result;
  }

 private:
  struct Ends {
    std::pair<double, std::size_t> least, largest;  ///< and the first reading that has it
  };

  template <typename Values>
  void take_column(std::size_t column, const Values& values, std::size_t first) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double value = static_cast<double>(values[k]);
      if (std::isnan(value)) continue;
      const auto [place, is_new] = columns_.try_emplace(column, Ends{{value, first + k}, {value, first + k}});
      if (is_new) continue;
      Ends& ends = place->second;
      ends.least = std::min(ends.least, {value, first + k});
      if (value > ends.largest.first || (!(value < ends.largest.first) && first + k < ends.largest.second)) {
        ends.largest = {value, first + k};
      }
    }
  }

  std::map<std::size_t, Ends> columns_;
  std::map<std::uint16_t, std::size_t> items_;
};

std::uint64_t fingerprint_of(const std::string& text) {
  Digest digest;
  digest.add_text(text);
  return digest.value();
}

bool is_drawn(std::size_t reading, std::size_t wanted, std::size_t count) {
  if (wanted >= count) return true;
  RandomStream random(0x5eed, reading);
  return random.uniform() * static_cast<double>(count) < static_cast<double>(wanted);
}

}  // namespace

struct ReadingShards::Implementation {
  explicit Implementation(ShardSource from) : source(std::move(from)), device(source.device) {}

  ShardSource source;
  std::vector<std::unique_ptr<ShardTable>> files;
  std::vector<ShardPart> parts;
  std::vector<std::size_t> first_of_file;
  std::size_t count = 0, total_bytes = 0, done_bytes = 0;
  std::uint64_t fingerprint = 0;
  std::shared_ptr<const Instrument> device;
  std::vector<std::string> contradictions;
  OutermostReadings outermost;
  std::mutex mutex;

  void advance(std::size_t bytes) {
    stop_if_asked(source.stop);
    done_bytes += bytes;
    if (source.progress) source.progress(done_bytes, 2 * total_bytes);
  }

  void open_files();
  void find_all_rows();
  void check_all_rows();
  void check_like_first(const InstrumentFile& first, const InstrumentFile& file, const std::string& name) const;
  InstrumentFile parse(const ShardPart& part, const std::string& text) const;
  InstrumentReadings read_part(const ShardPart& part) const;
};

void ReadingShards::Implementation::open_files() {
  files = open_shard_tables(source.files);
  for (auto file = files.begin(); file != files.end(); ++file) {
    total_bytes += (*file)->size();
    for (auto other = files.begin(); other != file; ++other) {
      std::error_code ignored;
      if (!std::filesystem::equivalent((*file)->path(), (*other)->path(), ignored)) continue;
      throw InputError({.file = (*file)->path().string()}, "is given twice; its readings would count twice",
                       fmt::format("every file of set-up {} once", source.setup));
    }
  }
}

void ReadingShards::Implementation::find_all_rows() {
  std::map<std::pair<std::size_t, std::uint64_t>, std::string> known;
  Digest all;
  for (std::size_t f = 0; f < files.size(); ++f) {
    first_of_file.push_back(count);
    const ShardRows rows = files[f]->find_rows(f, count, kTogether, [&](std::size_t bytes) { advance(bytes); });
    const std::string name = files[f]->path().string();
    const auto [other, is_new] = known.try_emplace({files[f]->size(), rows.content}, name);
    if (!is_new) {
      throw InputError({.file = name}, "has the same content as " + other->second + "; its readings would count twice",
                       fmt::format("every file of set-up {} once", source.setup));
    }
    count += rows.count;
    all.add_text(name);
    all.add(rows.content);
    parts.insert(parts.end(), rows.parts.begin(), rows.parts.end());
  }
  fingerprint = all.value();
}

InstrumentFile ReadingShards::Implementation::parse(const ShardPart& part, const std::string& text) const {
  const std::string name = files[part.file]->path().string();
  MeasurementOptions options;
  options.mapping = source.files[part.file].mapping;
  options.threads = 1;
  try {
    InstrumentFile file =
        source.form.parse(text, name, source.machine, device, source.setup, source.noise_from_data, options);
    if (file.readings.count() == part.count) return file;
    throw InputError({.file = name, .line = 2},
                     fmt::format("{} readings in {} rows", file.readings.count(), part.count), "one in every row");
  } catch (const InputError& error) {
    throw files[part.file]->placed(error, part);
  }
}

void ReadingShards::Implementation::check_like_first(const InstrumentFile& first, const InstrumentFile& file,
                                                     const std::string& name) const {
  const InstrumentReadings &a = first.readings, &b = file.readings;
  const auto same_names = [](const ReadingComponent& one, const ReadingComponent& other) {
    return one.name == other.name;
  };
  const auto &own = file.device->components(), &others = first.device->components();
  const bool same_components = std::equal(own.begin(), own.end(), others.begin(), others.end(), same_names);
  if (same_components && a.uncertainty.empty() == b.uncertainty.empty() &&
      a.covariance.empty() == b.covariance.empty() && a.time_s.empty() == b.time_s.empty() &&
      a.point_name.empty() == b.point_name.empty()) {
    return;
  }
  throw InputError({.file = name}, "the files of one set-up differ in their columns",
                   "the same columns in all files of a set-up that is not read into memory");
}

void ReadingShards::Implementation::check_all_rows() {
  // The first part of every file, one after the other, because a file may add to the instrument.
  std::optional<InstrumentFile> first;
  for (const ShardPart& part : parts) {
    if (part.first != first_of_file[part.file]) continue;
    InstrumentFile file = parse(part, files[part.file]->read(part));
    if (!first) first = file;
    check_like_first(*first, file, files[part.file]->path().string());
    device = file.device;
    contradictions.insert(contradictions.end(), file.contradictions.begin(), file.contradictions.end());
  }
  const std::vector<std::string> names = device->target_names();
  for_each_block(parts.size(), source.threads, [&](std::size_t i) {
    ShardPart& part = parts[i];
    const std::string text = files[part.file]->read(part);
    part.bytes = fingerprint_of(text);
    const InstrumentFile file = parse(part, text);
    if (file.device->target_names() != names) {
      const InputError late({.file = files[part.file]->path().string(), .line = 2},
                            "names " + file.device->target_names().back() + " for the first time far down in the file",
                            "all of them within the first rows of a file, or in the study");
      throw files[part.file]->placed(late, part);
    }
    const std::lock_guard lock(mutex);
    outermost.take(file.readings, part.first);
    advance(files[part.file]->bytes_of(part));
  });
}

InstrumentReadings ReadingShards::Implementation::read_part(const ShardPart& part) const {
  const ShardTable& file = *files[part.file];
  const std::string text = file.read(part);
  if (fingerprint_of(text) != part.bytes) {
    const InputError changed(
        {.file = file.path().string(), .line = 2},
        fmt::format("one of {} rows from here on has changed since the file was read first", part.count),
        "a file that does not change until the end of the run");
    throw file.placed(changed, part);
  }
  return parse(part, text).readings;
}

ReadingShards::ReadingShards(ShardSource source)
    : implementation_(std::make_unique<Implementation>(std::move(source))) {
  implementation_->open_files();
  implementation_->find_all_rows();
  implementation_->check_all_rows();
}

ReadingShards::~ReadingShards() = default;
std::size_t ReadingShards::count() const { return implementation_->count; }
std::size_t ReadingShards::file_count() const { return implementation_->files.size(); }
std::uint64_t ReadingShards::fingerprint() const { return implementation_->fingerprint; }
const std::shared_ptr<const Instrument>& ReadingShards::device() const { return implementation_->device; }
const std::vector<std::string>& ReadingShards::contradictions() const { return implementation_->contradictions; }

InstrumentReadings ReadingShards::read(std::size_t first, std::size_t last) const {
  const std::vector<ShardPart>& parts = implementation_->parts;
  auto part = std::upper_bound(parts.begin(), parts.end(), first,
                               [](std::size_t reading, const ShardPart& one) { return reading < one.first; });
  InstrumentReadings result;
  for (--part; part != parts.end() && part->first < last; ++part) {
    InstrumentReadings own = implementation_->read_part(*part);
    if (first > part->first || last < part->first + part->count) {
      std::vector<std::size_t> wanted;
      for (std::size_t k = std::max(first, part->first); k < std::min(last, part->first + part->count); ++k) {
        wanted.push_back(k - part->first);
      }
      own = own.subset(wanted);
    }
    if (result.count() == 0) {
      result = std::move(own);
    } else {
      result.append(own, true);
    }
  }
  return result;
}

InstrumentReadings ReadingShards::drawn(std::size_t wanted) const {
  Implementation& self = *implementation_;
  std::vector<std::size_t> outermost = self.outermost.readings();
  std::sort(outermost.begin(), outermost.end());
  std::vector<InstrumentReadings> of_part(self.parts.size());
  for_each_block(self.parts.size(), self.source.threads, [&](std::size_t i) {
    stop_if_asked(self.source.stop);
    const ShardPart& part = self.parts[i];
    std::vector<std::size_t> taken;
    for (std::size_t k = 0; k < part.count; ++k) {
      if (is_drawn(part.first + k, wanted, self.count) ||
          std::binary_search(outermost.begin(), outermost.end(), part.first + k)) {
        taken.push_back(k);
      }
    }
    if (!taken.empty()) of_part[i] = self.read_part(part).subset(taken);
  });
  InstrumentReadings result;
  for (InstrumentReadings& own : of_part) {
    if (own.count() == 0) continue;
    if (result.count() == 0) {
      result = std::move(own);
    } else {
      result.append(own, true);
    }
  }
  return result;
}

std::string ReadingShards::place(std::size_t reading) const {
  const std::vector<std::size_t>& first = implementation_->first_of_file;
  const auto after = std::upper_bound(first.begin(), first.end(), reading);
  const std::size_t file = static_cast<std::size_t>(after - first.begin()) - 1;
  return fmt::format("reading {} of {}", reading - first[file], implementation_->files[file]->path().string());
}

}  // namespace abbe
