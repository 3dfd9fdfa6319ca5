#pragma once

#include <stdexcept>
#include <string>

namespace abbe {

/// A number that is to be written is not finite. The values were read as finite ones; they are so large or so small,
/// or fit each other so badly, that the computation has no result. A command says so and ends with exit code 1.
class NotFinite : public std::invalid_argument {
 public:
  /// @param what_it_is  "report data: map.mean_um"
  explicit NotFinite(const std::string& what_it_is) : std::invalid_argument(what_it_is + " is not a finite number") {}
};

}  // namespace abbe
