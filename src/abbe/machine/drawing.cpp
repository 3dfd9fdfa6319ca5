#include "abbe/machine/drawing.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

constexpr std::size_t kWidth = 80;

/// Number for reading: to the micrometre, no trailing zeros, no "-0".
std::string readable_number(double value) {
  const double rounded = std::abs(value) < 1e9 ? std::round(value * 1000) / 1000 : value;
  return fmt::format("{:.9g}", rounded == 0 ? 0.0 : rounded);
}

std::string readable_vector(const Eigen::Vector3d& v) {
  return "(" + readable_number(v.x()) + ", " + readable_number(v.y()) + ", " + readable_number(v.z()) + ")";
}

/// "+X" for a principal direction, else the vector.
std::string direction_text(const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(std::abs(v[k]) - 1) < 1e-9) return std::string(v[k] > 0 ? "+" : "-") + "XYZ"[k];
  }
  return readable_vector(v);
}

/// Arrow of a direction as seen from the front of the machine: X to the right, Y away, Z up.
std::string arrow(const Eigen::Vector3d& v) {
  static constexpr std::array<const char*, 6> kArrows = {"→", "↗", "↑", "←", "↙", "↓"};
  Eigen::Index k = 0;
  v.cwiseAbs().maxCoeff(&k);
  return kArrows[static_cast<std::size_t>(v[k] > 0 ? k : k + 3)];
}

/// Width on the screen: characters, not bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(const std::string& text, std::size_t columns) {
  return text + std::string(columns > width(text) ? columns - width(text) : 0, ' ');
}

std::string repeated(const char* text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

using Cells = std::array<std::string, 4>;  // name, motion, point, travel

Cells axis_cells(const Machine& machine, std::size_t index) {
  const Axis& axis = machine.axes[index];
  const bool linear = axis.kind == AxisKind::linear;
  const Eigen::Vector3d motion = axis.sense() * axis.direction;
  Cells cells;
  cells[0] = std::string(linear ? "□ " : "○ ") + axis.name + (axis.primed ? "'" : "");
  cells[1] = linear ? arrow(motion) + " along " + direction_text(motion) : "↺ about " + direction_text(motion);
  if (!linear) cells[2] = "through " + readable_vector(axis.point);
  const double unit = linear ? 1 : kDegree;
  cells[3] = axis.endless ? "endless"
                          : readable_number(axis.travel_min / unit) + " … " + readable_number(axis.travel_max / unit) +
                                (linear ? " mm" : " deg");
  if (axis.setting) cells[3] += ", setting";
  if (is_coupled(machine, index)) cells[3] += ", coupled";
  return cells;
}

void append_line(std::string& drawing, std::string line) {
  while (!line.empty() && line.back() == ' ') line.pop_back();
  drawing += line + "\n";
}

/// Words on lines of at most kWidth columns, later lines indented.
void append_wrapped(std::string& drawing, const std::string& text, std::size_t indent) {
  std::string line;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    if (!line.empty() && width(line) + 1 + width(word) > kWidth) {
      append_line(drawing, line);
      line = std::string(indent, ' ') + word;
    } else {
      line += (line.empty() ? "" : " ") + word;
    }
    start = end + 1;
  }
  append_line(drawing, line);
}

}  // namespace

std::string draw_machine(const Machine& machine) {
  std::vector<Cells> rows;
  std::array<std::size_t, 4> columns{};
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    rows.push_back(axis_cells(machine, i));
    for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = std::max(columns[k], width(rows.back()[k]));
  }
  const std::size_t all = 2 + columns[0] + 2 + columns[1] + 2 + columns[2] + 2 + columns[3];

  std::string drawing;
  append_wrapped(drawing, machine.name, 0);
  append_wrapped(drawing, machine.chain(), 0);
  drawing += "\n  w  workpiece";
  drawing += "\n  │    ";
  std::string place = "origin " + readable_vector(machine.bed_from_workpiece.translation) + " mm";
  if ((machine.bed_from_workpiece.rotation - Eigen::Matrix3d::Identity()).norm() > 1e-12) place += ", turned";
  drawing += place + "\n";
  const std::size_t bed = machine.workpiece_axis_count();
  for (std::size_t i = 0; i <= rows.size(); ++i) {
    if (i == bed) {
      drawing += "══╪══ b  bed " + repeated("═", std::min(kWidth, std::max<std::size_t>(all, 40)) - 13) + "\n";
    }
    if (i == rows.size()) break;
    const Cells& cells = rows[i];
    std::string line = "  " + padded(cells[0], columns[0]) + "  " + padded(cells[1], columns[1]) + "  ";
    if (all <= kWidth) {
      line += padded(cells[2], columns[2]) + (columns[2] > 0 ? "  " : "") + cells[3];
      append_line(drawing, line);
      continue;
    }
    if (width(line) + width(cells[3]) > kWidth) {
      append_line(drawing, line);
      line = "  │" + std::string(columns[0] + 1, ' ');
    }
    append_line(drawing, line + cells[3]);
    if (!cells[2].empty()) append_line(drawing, "  │" + std::string(columns[0] + 1, ' ') + cells[2]);
  }
  drawing += "  │    gauge point " + readable_vector(machine.tool_reference) + " mm\n";
  drawing += "  │    functional point " + readable_vector(machine.tool_reference + machine.tool_offset) + " mm\n";
  drawing += "  t  tool " + arrow(-machine.tool_direction) + " pointing along " +
             direction_text(-machine.tool_direction) + "\n\n";
  append_wrapped(drawing,
                 "□ linear, ○ rotary: motion of what the axis carries at a positive command, seen from the front "
                 "(→ X, ↗ Y away, ↑ Z); ↺ right-handed. Points in mm with all axes at zero.",
                 0);
  return drawing;
}

}  // namespace abbe
