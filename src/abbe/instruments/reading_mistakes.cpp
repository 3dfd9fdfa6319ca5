#include "abbe/instruments/reading_mistakes.h"

#include <algorithm>
#include <array>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// Numbers that are in one unit and were read as another.
struct MistakenUnit {
  const char* is;
  const char* was_read_as;
  double factor;  ///< right = factor * read
};

constexpr double kInch = 25.4;
constexpr std::array<MistakenUnit, 6> kMistakenLengths = {{{"inch", "mm", kInch},
                                                           {"mm", "inch", 1 / kInch},
                                                           {"m", "mm", 1000},
                                                           {"mm", "m", 1e-3},
                                                           {"cm", "mm", 10},
                                                           {"mm", "cm", 0.1}}};
constexpr std::array<MistakenUnit, 6> kMistakenAngles = {{{"degrees", "radians", kDegree},
                                                          {"radians", "degrees", 1 / kDegree},
                                                          {"gon", "degrees", 0.9},
                                                          {"degrees", "gon", 1 / 0.9},
                                                          {"gon", "radians", 0.9 * kDegree},
                                                          {"radians", "gon", 1 / (0.9 * kDegree)}}};

template <std::size_t n>
std::vector<ReadingMistake> unit_mistakes(const std::array<MistakenUnit, n>& units,
                                          const std::vector<std::size_t>& components, const std::string& what) {
  std::vector<ReadingMistake> all;
  for (const MistakenUnit& unit : units) {
    const double factor = unit.factor;
    all.push_back(
        {{what + " are in " + unit.is + ", not in " + unit.was_read_as}, [components, factor](double* reading) {
           for (const std::size_t c : components) reading[c] *= factor;
         }});
  }
  return all;
}

}  // namespace

std::vector<ReadingMistake> length_unit_mistakes(const std::vector<std::size_t>& components, const std::string& what) {
  return unit_mistakes(kMistakenLengths, components, what);
}

std::vector<ReadingMistake> angle_unit_mistakes(const std::vector<std::size_t>& components, const std::string& what) {
  return unit_mistakes(kMistakenAngles, components, what);
}

std::vector<ReadingMistake> combined_mistakes(const std::vector<std::vector<ReadingMistake>>& groups) {
  std::vector<ReadingMistake> all = {ReadingMistake{}};
  for (const std::vector<ReadingMistake>& group : groups) {
    const std::size_t before = all.size();
    for (std::size_t i = 0; i < before; ++i) {
      for (const ReadingMistake& more : group) {
        ReadingMistake both = all[i];
        both.words.insert(both.words.end(), more.words.begin(), more.words.end());
        if (const auto first = both.undo; first) {
          both.undo = [first, second = more.undo](double* reading) {
            first(reading);
            second(reading);
          };
        } else {
          both.undo = more.undo;
        }
        all.push_back(std::move(both));
      }
    }
  }
  all.erase(all.begin());
  std::stable_sort(all.begin(), all.end(),
                   [](const ReadingMistake& a, const ReadingMistake& b) { return a.words.size() < b.words.size(); });
  return all;
}

}  // namespace abbe
