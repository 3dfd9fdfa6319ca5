#include "abbe/formats/readings/reading_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/readings/checked_parts.h"
#include "abbe/formats/readings/shard_table.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/stopped.h"
#include "abbe/instruments/observations.h"

namespace abbe {
namespace {

static_assert(ReadingShards::kTogether % Observations::kBlockSize == 0);

std::uint64_t fingerprint_of(const std::string& text) {
  Digest digest;
  digest.add_text(text);
  return digest.value();
}

bool is_drawn(std::size_t reading, std::size_t wanted, std::size_t count) {
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
  std::vector<std::size_t> outermost;  ///< ascending
  std::vector<CheckedParts> checked;   ///< of blocks of parts

  void advance(std::size_t bytes) {
    stop_if_asked(source.stop);
    done_bytes += bytes;
    if (source.progress) source.progress(done_bytes, 2 * total_bytes);
  }

  void open_files();
  void find_all_rows();
  void check_all_rows();
  void check_part(std::size_t number, const std::vector<std::string>& names, CheckedParts& checked_parts) const;
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
  const std::size_t together = ReadingShards::parts_together(parts.size());
  checked.resize((parts.size() + together - 1) / together);
  const auto last_of = [&](std::size_t block) { return std::min((block + 1) * together, parts.size()); };
  NumberedWork work{.name = "check of the readings", .blocks = checked.size(), .threads = source.threads};
  work.is_followed = true;
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] {
    Digest digest;
    digest.add_text("check of the readings");
    digest.add(fingerprint);
    digest.add(source.drawn);
    for (const std::string& name : names) digest.add_text(name);
    return digest.value();
  };
  work.compute = [&](std::size_t block) {
    for (std::size_t i = block * together; i < last_of(block); ++i) check_part(i, names, checked[block]);
  };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) { checked[block].pack(bytes); };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    checked[block] = CheckedParts::unpack(bytes, last_of(block) - block * together);
  };
  work.finished = [&](std::size_t block) {
    for (std::size_t i = block * together; i < last_of(block); ++i) advance(files[parts[i].file]->bytes_of(parts[i]));
  };
  do_work(source.work, work);
  OutermostReadings all;
  for (std::size_t block = 0; block < checked.size(); ++block) {
    all.take(std::exchange(checked[block].outermost, {}));
    for (std::size_t i = block * together; i < last_of(block); ++i) {
      parts[i].bytes = checked[block].fingerprints[i - block * together];
    }
  }
  outermost = all.readings();
}

void ReadingShards::Implementation::check_part(std::size_t number, const std::vector<std::string>& names,
                                               CheckedParts& checked_parts) const {
  stop_if_asked(source.stop);
  const ShardPart& part = parts[number];
  const std::string text = files[part.file]->read(part);
  checked_parts.fingerprints.push_back(fingerprint_of(text));
  const InstrumentFile file = parse(part, text);
  if (file.device->target_names() != names) {
    const InputError late({.file = files[part.file]->path().string(), .line = 2},
                          "names " + file.device->target_names().back() + " for the first time far down in the file",
                          "all of them within the first rows of a file, or in the study");
    throw files[part.file]->placed(late, part);
  }
  OutermostReadings own;
  own.take(file.readings, part.first);
  checked_parts.outermost.take(own);
  if (source.drawn >= count) return;  // all of them are wanted
  const std::vector<std::size_t> ends = own.readings();
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < part.count; ++k) {
    const std::size_t reading = part.first + k;
    if (is_drawn(reading, source.drawn, count) || std::binary_search(ends.begin(), ends.end(), reading)) {
      wanted.push_back(k);
    }
  }
  checked_parts.keep(file.readings, part.first, wanted);
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

std::size_t ReadingShards::parts_together(std::size_t parts) {
  constexpr std::size_t kBlocks = 256, kMostTogether = 8;
  return std::clamp<std::size_t>(parts / kBlocks, 1, kMostTogether);
}

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

InstrumentReadings ReadingShards::drawn() const {
  const Implementation& self = *implementation_;
  if (self.source.drawn >= self.count) return read(0, self.count);
  InstrumentReadings result;
  for (const CheckedParts& block : self.checked) {
    std::vector<std::size_t> taken;
    for (std::size_t k = 0; k < block.numbers.size(); ++k) {
      const std::size_t reading = block.numbers[k];
      if (is_drawn(reading, self.source.drawn, self.count) ||
          std::binary_search(self.outermost.begin(), self.outermost.end(), reading)) {
        taken.push_back(k);
      }
    }
    if (taken.empty()) continue;
    if (result.count() == 0) {
      result = block.kept.subset(taken);
    } else {
      result.append(block.kept.subset(taken), true);
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
