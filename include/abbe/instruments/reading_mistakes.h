#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

/// Mistakes that the measured numbers of a file contain now and then, and what undoes them.
struct ReadingMistake {
  std::vector<std::string> words;  ///< one entry each, a clause: "the azimuth counts clockwise"
  /// From the components of one reading as they were read to what they should be; mm and rad.
  std::function<void(double* reading)> undo;
};

/// Lengths in another unit than was read: inch, m and cm for mm, and the other way round.
/// @param components  indices of all lengths of a reading
/// @param what        in words: "the measured lengths"
std::vector<ReadingMistake> length_unit_mistakes(const std::vector<std::size_t>& components, const std::string& what);

/// Angles in another unit than was read: degrees and gon for radians or for each other.
std::vector<ReadingMistake> angle_unit_mistakes(const std::vector<std::size_t>& components, const std::string& what);

/// All combinations of at most one mistake of each group, undone in the order of the groups; those with fewer mistakes
/// come first. Each has one mistake at least.
std::vector<ReadingMistake> combined_mistakes(const std::vector<std::vector<ReadingMistake>>& groups);

}  // namespace abbe
