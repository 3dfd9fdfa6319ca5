#include "abbe/formats/controls/table_fanuc_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "abbe/formats/nc/fanuc_blocks.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr int kAxisNumber = 10800, kPoints = 10803, kReferencePoint = 10806, kMagnification = 10809, kInterval = 10812,
              kBehind = 10815;
constexpr double kLeastInterval = 1e-3;  // mm
constexpr double kMostInterval = 1e5;

std::string field_of(std::size_t number) { return fmt::format("N{:05}", number); }

/// A whole number that may be below zero. @throws InputError
int whole_value(const TableLines& lines, std::string_view word, const std::string& field, int least, int most) {
  const std::string expected = fmt::format("a whole number from {} to {}", least, most);
  const double value = lines.value(word, field, expected);
  if (!(value >= least && value <= most) || value != std::floor(value)) lines.fail(field, "out of range", expected);
  return static_cast<int>(value);
}

std::size_t axis_number(const TableLines& lines, std::string_view word, const std::string& field,
                        const std::vector<TableAxisName>& axes) {
  const TableAxisName* const axis = find_table_axis(axes, word);
  if (axis == nullptr || axis->rotary) {
    std::vector<TableAxisName> linear;
    std::copy_if(axes.begin(), axes.end(), std::back_inserter(linear), [](const auto& one) { return !one.rotary; });
    lines.fail(field, axis == nullptr ? "no axis of the machine" : "a rotary axis", "axis " + table_axis_words(linear));
  }
  return axis->axis;
}

FanucLattice parse_parameters(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes) {
  FanucLattice lattice;
  std::map<std::size_t, std::size_t> line_of;  // by parameter
  TableLines lines(text, file);
  std::vector<FanucWord> words;
  while (next_fanuc_block(lines, words)) {
    const std::size_t number = lines.whole(words[0].text, "N", 0, 99999);
    const std::string field = field_of(number);
    if (number < kAxisNumber || number >= kBehind) lines.fail(field, "unknown parameter", "10800 to 10814");
    if (words.size() != 2 || words[1].letter != 'P') lines.fail(field, "not one value", "P and a number");
    if (!line_of.emplace(number, lines.number()).second) lines.fail(field, "is given twice", "every parameter once");
    const std::size_t a = (number - kAxisNumber) % 3;
    const std::string_view value = words[1].text;
    if (number < kPoints) {
      lattice.axes[a] = axis_number(lines, value, field, axes);
    } else if (number < kReferencePoint) {
      lattice.points[a] = lines.whole(value, field, 2, kFanucLatticePoints);
    } else if (number < kMagnification) {
      lattice.reference_point[a] = lines.whole(value, field, 1, kFanucLatticePoints);
    } else if (number < kInterval) {
      lattice.magnification[a] = whole_value(lines, value, field, 0, kFanucLatticeMagnification);
    } else {
      const std::string expected = fmt::format("an interval from {:g} to {:g} mm", kLeastInterval, kMostInterval);
      lattice.interval[a] = lines.value(value, field, expected);
      if (!(lattice.interval[a] >= kLeastInterval && lattice.interval[a] <= kMostInterval)) {
        lines.fail(field, "out of range", expected);
      }
    }
  }
  for (std::size_t number = kAxisNumber; number < kBehind; ++number) {
    if (line_of.count(number) == 0) {
      throw InputError({.file = file, .field = field_of(number)}, "is missing", "parameters 10800 to 10814");
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const auto fail = [&](std::size_t number, const std::string& problem, const std::string& expected) {
      throw InputError({.file = file, .line = line_of[number], .field = field_of(number)}, problem, expected);
    };
    if (lattice.reference_point[a] > lattice.points[a]) {
      fail(kReferencePoint + a, "behind the last point", fmt::format("1 to {}", lattice.points[a]));
    }
    if (a > 0 &&
        std::count(lattice.axes.begin(), lattice.axes.begin() + static_cast<std::ptrdiff_t>(a), lattice.axes[a]) > 0) {
      fail(kAxisNumber + a, "an axis twice", "three different axes");
    }
  }
  return lattice;
}

void parse_points(std::string_view text, const std::string& file, const std::vector<TableAxisName>& axes,
                  FanucLattice& lattice) {
  for (std::vector<int>& values : lattice.values) values.assign(lattice.count(), 0);
  std::vector<bool> given(lattice.count(), false);
  TableLines lines(text, file);
  std::vector<FanucWord> words;
  while (next_fanuc_block(lines, words)) {
    const std::size_t point = lines.whole(words[0].text, "N", 1, lattice.count());
    const std::string field = field_of(point);
    if (given[point - 1]) lines.fail(field, "is given twice", "every point once");
    given[point - 1] = true;
    std::array<bool, 3> seen{};
    for (std::size_t k = 1; k + 1 < words.size(); k += 2) {
      if (words[k].letter != 'A' || words[k + 1].letter != 'P') lines.fail(field, "not understood", "A and P in turns");
      const std::size_t axis = axis_number(lines, words[k].text, field, axes);
      const auto a =
          static_cast<std::size_t>(std::find(lattice.axes.begin(), lattice.axes.end(), axis) - lattice.axes.begin());
      if (a == 3 || seen[a]) {
        lines.fail(field, a == 3 ? "no compensation axis" : "an axis twice", "every compensation axis once");
      }
      seen[a] = true;
      lattice.values[a][point - 1] =
          whole_value(lines, words[k + 1].text, field, -kFanucLatticeLargest - 1, kFanucLatticeLargest);
    }
    if (words.size() != 7) lines.fail(field, "not three values", "A and P for every compensation axis");
  }
  const auto missing = std::find(given.begin(), given.end(), false);
  if (missing != given.end()) {
    throw InputError({.file = file, .field = field_of(static_cast<std::size_t>(missing - given.begin()) + 1)},
                     "is missing", fmt::format("points 1 to {}", lattice.count()));
  }
}

}  // namespace

FanucLattice fanuc_lattice(const CorrectionLattice& lattice, double unit, const std::array<std::size_t, 3>& anchor) {
  assert(lattice.inputs.size() == 3);
  FanucLattice rounded;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<double>& nodes = lattice.positions[a];
    rounded.axes[a] = lattice.inputs[a];
    rounded.points[a] = nodes.size();
    rounded.reference_point[a] = anchor[a] + 1;
    rounded.interval[a] = (nodes.back() - nodes.front()) / static_cast<double>(nodes.size() - 1);
    rounded.values[a].assign(lattice.count(), 0);
    const auto output = std::find(lattice.outputs.begin(), lattice.outputs.end(), lattice.inputs[a]);
    if (output == lattice.outputs.end()) continue;
    const std::vector<double>& corrections =
        lattice.corrections[static_cast<std::size_t>(output - lattice.outputs.begin())];
    double largest = 0;
    for (const double value : corrections) largest = std::max(largest, std::abs(value));
    const double needed = std::ceil(largest / (unit * kFanucLatticeLargest) - 1e-9);
    rounded.magnification[a] = static_cast<int>(std::clamp(needed, 1.0, 1e9));
    std::transform(corrections.begin(), corrections.end(), rounded.values[a].begin(), [&](double value) {
      return static_cast<int>(std::clamp(std::round(value / (unit * rounded.magnification[a])),
                                         -1.0 * kFanucLatticeLargest, 1.0 * kFanucLatticeLargest));
    });
  }
  return rounded;
}

CorrectionLattice fanuc_lattice_corrections(const FanucLattice& lattice, double unit,
                                            const std::array<double, 3>& reference) {
  CorrectionLattice corrections;
  corrections.modulo.assign(3, false);
  for (std::size_t a = 0; a < 3; ++a) {
    corrections.inputs.push_back(lattice.axes[a]);
    corrections.outputs.push_back(lattice.axes[a]);
    std::vector<double>& nodes = corrections.positions.emplace_back();
    for (std::size_t k = 1; k <= lattice.points[a]; ++k) {
      nodes.push_back(reference[a] +
                      lattice.interval[a] * (static_cast<double>(k) - static_cast<double>(lattice.reference_point[a])));
    }
    std::vector<double>& values = corrections.corrections.emplace_back();
    for (const int value : lattice.values[a]) values.push_back(unit * lattice.magnification[a] * value);
  }
  return corrections;
}

std::string fanuc_lattice_parameter_text(const FanucLattice& lattice, const std::vector<TableAxisName>& axes) {
  std::string text = "%\n";
  const auto blocks = [&](int first, const auto& value) {
    for (std::size_t a = 0; a < 3; ++a) {
      text += fmt::format("N{:05}P{}\n", static_cast<std::size_t>(first) + a, value(a));
    }
  };
  blocks(kAxisNumber, [&](std::size_t a) { return table_axis(axes, lattice.axes[a]).name; });
  blocks(kPoints, [&](std::size_t a) { return lattice.points[a]; });
  blocks(kReferencePoint, [&](std::size_t a) { return lattice.reference_point[a]; });
  blocks(kMagnification, [&](std::size_t a) { return lattice.magnification[a]; });
  blocks(kInterval, [&](std::size_t a) { return fanuc_real(lattice.interval[a]); });
  return text + "%\n";
}

std::string fanuc_lattice_point_text(const FanucLattice& lattice, const std::vector<TableAxisName>& axes) {
  std::string text = "%\n";
  for (std::size_t point = 0; point < lattice.count(); ++point) {
    text += field_of(point + 1);
    for (std::size_t a = 0; a < 3; ++a) {
      text += fmt::format("A{}P{}", table_axis(axes, lattice.axes[a]).name, lattice.values[a][point]);
    }
    text += "\n";
  }
  return text + "%\n";
}

FanucLattice parse_fanuc_lattice(std::string_view parameters, const std::string& parameter_file,
                                 std::string_view points, const std::string& point_file,
                                 const std::vector<TableAxisName>& axes) {
  FanucLattice lattice = parse_parameters(parameters, parameter_file, axes);
  parse_points(points, point_file, axes, lattice);
  return lattice;
}

}  // namespace abbe
