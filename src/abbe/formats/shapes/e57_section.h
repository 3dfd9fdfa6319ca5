#pragma once

// Internal to formats: the binary section of an E57 file with the points of one scan.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/e57_pages.h"
#include "abbe/formats/shapes/e57_scans.h"

namespace abbe {

/// The section of one scan.
///
/// Its points are in packets of up to 64 KiB. A packet has one piece of the byte stream of every field; the pieces of a
/// stream, one after the other, are its values as bits, the lowest first.
class E57Section {
 public:
  /// Reads the header of the section. @throws InputError
  E57Section(const E57Pages& pages, const E57Scan& scan, const std::string& file);

  /// Logical bytes that it takes.
  std::pair<std::uint64_t, std::uint64_t> extent() const { return {begin_, end_}; }

  /// Finds the packets, which read() needs. @throws InputError also if they have values for fewer or more points than
  /// are stated
  void find_packets();

  /// Where the values of a wanted field go: the first of them, and how many doubles apart they are. Null: nowhere.
  struct Target {
    double* first = nullptr;
    std::size_t stride = 1;
  };
  /// Converts the values of all points. @throws InputError for a value out of the range of its field
  void read(const std::array<Target, kE57WantedCount>& targets) const;

 private:
  [[noreturn]] void fail(std::uint64_t at, const std::string& problem, const std::string& expected) const;
  std::uint64_t packet_length(std::uint64_t at) const;
  void require_values(const std::vector<std::uint64_t>& bytes) const;

  const E57Pages& pages_;
  const E57Scan& scan_;
  const std::string& file_;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t first_packet_ = 0;
  std::vector<std::uint64_t> packets_;  ///< logical places of the data packets
};

}  // namespace abbe
