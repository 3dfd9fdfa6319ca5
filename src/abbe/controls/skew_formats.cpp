#include <fmt/format.h>

#include <array>
#include <cmath>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/skew_factors.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_skew.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

std::array<std::size_t, 3> printer_axes(const Machine& machine) {
  std::array<std::size_t, 3> axes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "XYZ"[c]);
    axes[c] = machine.find_axis(name);
    if (axes[c] == Machine::npos || machine.axes[axes[c]].kind != AxisKind::linear) {
      throw InputError({.field = "--for"}, "the machine has no linear axis " + name, "a machine with X, Y and Z");
    }
  }
  return axes;
}

WrittenTables make_skew(bool klipper, const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
  const std::array<std::size_t, 3> axes = printer_axes(machine);
  WrittenTables made;
  SkewFactors factors = fit_skew(machine, errors, axes, request.reference);
  const char* const names[3] = {"XY", "XZ", "YZ"};
  double* const values[3] = {&factors.xy, &factors.xz, &factors.yz};
  for (std::size_t f = 0; f < 3; ++f) {
    if (request.left_out.count(names[f]) != 0) {
      *values[f] = 0;
      continue;
    }
    if (std::abs(*values[f]) < 1e-9) continue;
    // The axis whose position it is multiplied with.
    const KnownTravel travel = known_travel(machine, errors, axes[f == 0 ? 1 : 2]);
    const double farthest = std::abs(travel.from) > std::abs(travel.to) ? travel.from : travel.to;
    WrittenTable summary;
    summary.name = names[f];
    summary.nodes = 1;
    summary.largest = std::abs(*values[f] * farthest);
    summary.corrections = {-*values[f] * farthest};
    summary.values = [&machine, axes, reference = request.reference, farthest, f](const ErrorSet& changed) {
      const SkewFactors found = fit_skew(machine, changed, axes, reference);
      return std::vector<double>{-farthest * (f == 0 ? found.xy : f == 1 ? found.xz : found.yz)};
    };
    made.tables.push_back(std::move(summary));
  }
  const std::string name = klipper ? "skew.cfg.gcode" : "skew.gcode";
  const std::string text = klipper ? klipper_skew_text(factors) : marlin_skew_text(factors);
  if (!made.tables.empty()) made.files.push_back({name, text});
  made.remarks.push_back(fmt::format("factors XY {:.9f}, XZ {:.9f}, YZ {:.9f}", factors.xy, factors.xz, factors.yz));
  made.remarks.push_back(klipper
                             ? "[skew_correction] in printer.cfg, and SKEW_PROFILE LOAD=abbe at the start of a print"
                             : "SKEW_CORRECTION, SKEW_CORRECTION_FOR_Z and SKEW_CORRECTION_GCODE in Configuration.h");
  made.correction =
      std::make_unique<SkewCorrection>(klipper ? parse_klipper_skew(text, name) : parse_marlin_skew(text, name), axes);
  return made;
}

TableFormat skew_format(bool klipper) {
  using enum TableSetting;
  TableFormat format;
  format.name = klipper ? "klipper" : "marlin";
  format.control = klipper ? "Klipper" : "Marlin";
  format.kind = TableKind::skew;
  format.what = klipper ? "skew of Klipper (SET_SKEW): three angles as lengths of parallelograms"
                        : "skew of Marlin (M852): three angles";
  format.convention =
      "X' = X - Y XY - Z (XZ - XY YZ), Y' = Y - Z YZ with factors (tangents) XY, XZ, YZ from machine zero; best fit "
      "over the travel with a free constant";
  format.takes = {reference};
  format.cannot =
      "three angles and nothing else: no scale, no straightness, no error motion; a remaining constant is a shift of "
      "the workpiece zero";
  if (!klipper) {
    format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
      return fmt::format("M425 {}... F1 of a firmware with BACKLASH_COMPENSATION compensates it: {}", axis,
                         lost_motion_words(lost_motion, rotary));
    };
  }
  format.write = [klipper](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_skew(klipper, machine, errors, request);
  };
  return format;
}

}  // namespace

TableFormat klipper_format() { return skew_format(true); }
TableFormat marlin_format() { return skew_format(false); }

}  // namespace abbe
