#include "abbe/formats/controls/table_fanuc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "abbe/formats/nc/fanuc_blocks.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/table_numbers.h"

namespace abbe {
namespace {

constexpr std::size_t kMostPoint = 9999;
constexpr std::size_t kDataBlock = 10000;

}  // namespace

FanucPitch fanuc_pitch(const AxisTable& table, double unit, std::size_t first_point, double reference_position) {
  const std::vector<double>& nodes = table.positions;
  FanucPitch pitch;
  pitch.axis = table.input;
  pitch.first_point = first_point;
  const auto nearest = static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end(),
                                                                 [&](double a, double b) {
                                                                   return std::abs(a - reference_position) <
                                                                          std::abs(b - reference_position);
                                                                 }) -
                                                nodes.begin());
  pitch.reference_point = first_point + nearest;
  pitch.interval = nodes.size() > 1 ? (nodes.back() - nodes.front()) / static_cast<double>(nodes.size() - 1) : 1;
  // Rounding the correction and not its steps keeps the rounding from adding up.
  for (pitch.magnification = 1; pitch.magnification <= 100; ++pitch.magnification) {
    pitch.steps.assign(nodes.size(), 0);
    int largest = 0;
    double before = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const double correction = 0.5 * (table.forward[k] + table.reverse[k]);
      const double zero = 0.5 * (table.forward[nearest] + table.reverse[nearest]);
      const double whole = std::round((correction - zero) / (unit * pitch.magnification));
      const double step = k == 0 ? 0 : std::clamp(whole - before, -1e6, 1e6);
      before = whole;
      pitch.steps[k] = static_cast<int>(step);
      largest = std::max(largest, std::abs(pitch.steps[k]));
    }
    if (largest <= kFanucLargestStep) break;
  }
  return pitch;
}

AxisTable fanuc_table(const FanucPitch& pitch, double unit, double reference_position) {
  AxisTable table;
  table.input = table.output = pitch.axis;
  const std::size_t reference = pitch.reference_point - pitch.first_point;
  std::vector<double> sums;
  double sum = 0;
  for (const int step : pitch.steps) sums.push_back(sum += step);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    table.positions.push_back(reference_position +
                              pitch.interval * (static_cast<double>(k) - static_cast<double>(reference)));
    table.forward.push_back(unit * pitch.magnification * (sums[k] - sums[reference]));
  }
  table.reverse = table.forward;
  return table;
}

std::string fanuc_pitch_text(const std::vector<FanucPitch>& pitches, const std::vector<TableAxisName>& axes) {
  std::string text = "%\n";
  const auto block = [&](int number, const auto& value) {
    text += fmt::format("N{:05}", number);
    for (const FanucPitch& pitch : pitches) {
      const TableAxisName& axis = table_axis(axes, pitch.axis);
      text += fmt::format("A{}P{}", axis.name, value(pitch, axis.rotary));
    }
    text += "\n";
  };
  const auto real = [](double value, bool rotary) { return fanuc_real(shown_position(value, rotary)); };
  block(3620, [](const FanucPitch& p, bool /*rotary*/) { return fmt::format("{}", p.reference_point); });
  block(3621, [](const FanucPitch& p, bool /*rotary*/) { return fmt::format("{}", p.first_point); });
  block(3622,
        [](const FanucPitch& p, bool /*rotary*/) { return fmt::format("{}", p.first_point + p.steps.size() - 1); });
  block(3623, [](const FanucPitch& p, bool /*rotary*/) { return fmt::format("{}", p.magnification); });
  block(3624, [&](const FanucPitch& p, bool rotary) { return real(p.interval, rotary); });
  for (const FanucPitch& pitch : pitches) {
    for (std::size_t k = 0; k < pitch.steps.size(); ++k) {
      text += fmt::format("N{:05}P{}\n", kDataBlock + pitch.first_point + k, pitch.steps[k]);
    }
  }
  return text + "%\n";
}

std::vector<FanucPitch> parse_fanuc_pitch(std::string_view text, const std::string& file,
                                          const std::vector<TableAxisName>& axes) {
  std::map<std::size_t, std::map<std::size_t, double>> parameters;  // by number, by axis
  std::map<std::size_t, int> data;                                  // by point
  TableLines lines(text, file);
  std::vector<FanucWord> words;
  while (next_fanuc_block(lines, words)) {
    const std::size_t number = lines.whole(words[0].text, "N", 0, 99999);
    const std::string field = fmt::format("N{:05}", number);
    if (number >= kDataBlock) {
      const std::size_t point = number - kDataBlock;
      if (words.size() != 2 || words[1].letter != 'P') lines.fail(field, "not one value", "P and a whole number");
      const double value = lines.value(words[1].text, field, "a whole number");
      if (point > kMostPoint || !(std::abs(value) <= 127) || value != std::floor(value)) {
        lines.fail(field, "out of range", "a point up to 9999 with a whole number from -127 to 127");
      }
      if (!data.emplace(point, static_cast<int>(value)).second) lines.fail(field, "is given twice", "every point once");
      continue;
    }
    if (number < 3620 || number > 3624) {
      lines.fail(field, "unknown parameter", "3620 to 3624");
    }
    if (words.size() % 2 == 0) lines.fail(field, "not understood", "A and P in turns");
    for (std::size_t k = 1; k + 1 < words.size(); k += 2) {
      const TableAxisName* const axis = words[k].letter == 'A' ? find_table_axis(axes, words[k].text) : nullptr;
      if (axis == nullptr || words[k + 1].letter != 'P') {
        lines.fail(field, "not understood", "A and P in turns, axes " + table_axis_words(axes));
      }
      const double value = lines.value(words[k + 1].text, field, "a number");
      if (!parameters[number].emplace(axis->axis, value).second) lines.fail(field, "an axis twice", "every axis once");
    }
  }
  std::vector<FanucPitch> pitches;
  for (const TableAxisName& axis : axes) {
    if (parameters[3624].count(axis.axis) == 0) continue;
    const auto fail = [&](const std::string& problem, const std::string& expected) {
      throw InputError({.file = file, .field = "axis " + axis.name}, problem, expected);
    };
    const auto whole = [&](std::size_t number, double least, double most) {
      const auto found = parameters[number].find(axis.axis);
      if (found == parameters[number].end()) fail(fmt::format("no parameter {}", number), "3620 to 3624");
      if (!(found->second >= least && found->second <= most) || found->second != std::floor(found->second)) {
        fail(fmt::format("parameter {} is out of range", number), fmt::format("a whole number up to {}", most));
      }
      return static_cast<std::size_t>(found->second);
    };
    FanucPitch pitch;
    pitch.axis = axis.axis;
    pitch.reference_point = whole(3620, 0, static_cast<double>(kMostPoint));
    pitch.first_point = whole(3621, 0, static_cast<double>(pitch.reference_point));
    const std::size_t last = whole(3622, static_cast<double>(pitch.reference_point), static_cast<double>(kMostPoint));
    pitch.magnification = static_cast<int>(whole(3623, 0, 100));
    pitch.interval = inside_position(parameters[3624][axis.axis], axis.rotary);
    if (!(pitch.interval > 1e-6)) fail("parameter 3624 is too small", "an interval above zero");
    for (std::size_t point = pitch.first_point; point <= last; ++point) {
      const auto found = data.find(point);
      if (found == data.end()) fail(fmt::format("no data for point {}", point), "data for every point of the axis");
      pitch.steps.push_back(found->second);
    }
    pitches.push_back(std::move(pitch));
  }
  if (pitches.empty()) throw InputError({.file = file}, "no axis", "parameters 3620 to 3624 and data");
  return pitches;
}

}  // namespace abbe
