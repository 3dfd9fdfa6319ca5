#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace abbe {

/// Values by key in a file that grows: what a long job has computed, for the next one if it is killed.
///
/// A record that was not written to its end is dropped when the file is opened again. Values say by themselves whether
/// they are whole (to_bytes() of a sum).
class SumJournal {
 public:
  /// Goes on with the file if it is there. @throws InputError if it cannot be written
  explicit SumJournal(std::filesystem::path path);

  std::optional<std::vector<std::byte>> find(std::uint64_t key) const;
  /// @throws InputError if the disk is full
  void add(std::uint64_t key, std::span<const std::byte> bytes);
  std::size_t size() const { return places_.size(); }
  /// Removes the file; nothing can be added then.
  void remove();

 private:
  struct Place {
    std::uintmax_t at = 0, size = 0;
  };
  std::filesystem::path path_;
  std::ofstream out_;
  std::map<std::uint64_t, Place> places_;
};

}  // namespace abbe
