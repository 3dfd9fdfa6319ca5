#include "abbe/formats/files/sum_journal.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <string>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

// "abbesum1": another version of the format is another name.
constexpr std::uint64_t kJournalName = 0x316d757365626261U;
constexpr std::size_t kRecordHead = 3 * sizeof(std::uint64_t);

}  // namespace

SumJournal::SumJournal(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code ignored;
  const bool exists = std::filesystem::exists(path_, ignored);
  const std::uintmax_t size = exists ? std::filesystem::file_size(path_) : 0;
  std::uintmax_t good = 0;
  if (exists) {
    std::ifstream file(path_, std::ios::binary);
    for (std::array<std::uint64_t, 3> head; file.read(reinterpret_cast<char*>(head.data()), kRecordHead);) {
      if (head[0] != kJournalName || head[2] > size - good - kRecordHead) break;
      places_[head[1]] = {good + kRecordHead, head[2]};
      good += kRecordHead + head[2];
      file.seekg(static_cast<std::streamoff>(good));
    }
    if (good < size) std::filesystem::resize_file(path_, good);  // killed while the last record was written
  }
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  out_.open(path_, std::ios::binary | std::ios::app);
  if (!out_) throw InputError({.file = path_.string()}, "cannot be written", "a folder in which files can be made");
}

std::optional<std::vector<std::byte>> SumJournal::find(std::uint64_t key) const {
  const auto found = places_.find(key);
  if (found == places_.end()) return std::nullopt;
  std::vector<std::byte> bytes(found->second.size);
  std::ifstream file(path_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(found->second.at));
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    return std::nullopt;
  }
  return bytes;
}

void SumJournal::add(std::uint64_t key, std::span<const std::byte> bytes) {
  const std::uint64_t head[] = {kJournalName, key, bytes.size()};
  std::string record(kRecordHead + bytes.size(), '\0');
  std::memcpy(record.data(), head, kRecordHead);
  std::memcpy(record.data() + kRecordHead, bytes.data(), bytes.size());
  out_.seekp(0, std::ios::end);
  const auto at = static_cast<std::uintmax_t>(out_.tellp());
  out_.write(record.data(), static_cast<std::streamsize>(record.size()));
  out_.flush();
  if (!out_) throw InputError({.file = path_.string()}, "cannot be written to its end", "a disk with space left");
  places_[key] = {at + kRecordHead, bytes.size()};
}

void SumJournal::remove() {
  out_.close();
  places_.clear();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace abbe
