#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace abbe {

/// Bad input: what is wrong, where, and what was expected. Caught once in main() and once per binding.
///
/// what() reads "file:line:column: field: problem; expected ..."; parts that are unknown are left out.
class InputError : public std::runtime_error {
 public:
  struct Place {
    std::string file{};
    std::size_t line = 0;    ///< from 1; 0: the whole file
    std::size_t column = 0;  ///< character in the line, from 1; 0: the whole line
    std::string field{};     ///< key or column name as written: "axis.X.travel_mm", "measured_x_mm"
  };

  /// @param problem   what was found: "unknown unit 'kg'"
  /// @param expected  what would be right, with its unit: "a length in mm"; may be empty
  InputError(Place place, std::string problem, std::string expected = "");

  const Place& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  const std::string& expected() const { return expected_; }

 private:
  Place place_;
  std::string problem_;
  std::string expected_;
};

}  // namespace abbe
