#pragma once

// Internal to formats: which readings tell over what the axes, known numbers and states of a set-up run.
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "abbe/formats/readings/instrument_file.h"

namespace abbe {

/// The readings that stand farthest out in some column, and the first of every item. The order in which readings are
/// taken does not matter.
class OutermostReadings {
 public:
  /// @param first  number of the first of these readings among all
  void take(const InstrumentReadings& readings, std::size_t first);
  void take(const OutermostReadings& others);

  /// Their numbers, ascending, each once.
  std::vector<std::size_t> readings() const;

  void pack(std::vector<std::byte>& bytes) const;
  /// Takes what pack() has appended off the front. @throws WorkError if that is something else
  static OutermostReadings unpack(std::span<const std::byte>& bytes);

 private:
  /// A value and the first reading that has it.
  using End = std::pair<double, std::size_t>;
  struct Ends {
    End least, largest;

    void take(const Ends& other);
  };

  template <typename Values>
  void take_column(std::size_t column, const Values& values, std::size_t first);
  void take(std::size_t column, const Ends& ends);

  std::map<std::size_t, Ends> columns_;
  std::map<std::uint16_t, std::size_t> items_;
};

}  // namespace abbe
