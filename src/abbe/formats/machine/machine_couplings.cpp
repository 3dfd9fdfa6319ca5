#include "abbe/formats/machine/machine_couplings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

/// A key for axes of one kind that are coupled to axes of the same or the other kind.
struct CouplingKey {
  const char* name;
  AxisKind axis, of;
  bool has_degrees;

  double inside(double written) const {
    if (!has_degrees) return written;
    return axis == AxisKind::rotary ? written * kDegree : written / kDegree;
  }
  double written(double inside) const {
    if (!has_degrees) return inside;
    return axis == AxisKind::rotary ? inside / kDegree : inside * kDegree;
  }
};

constexpr CouplingKey kCouplingKeys[] = {
    {"coupled", AxisKind::linear, AxisKind::linear, false},
    {"coupled", AxisKind::rotary, AxisKind::rotary, false},
    {"coupled_mm_per_deg", AxisKind::linear, AxisKind::rotary, true},
    {"coupled_mm_per_rad", AxisKind::linear, AxisKind::rotary, false},
    {"coupled_deg_per_mm", AxisKind::rotary, AxisKind::linear, true},
    {"coupled_rad_per_mm", AxisKind::rotary, AxisKind::linear, false},
};

std::string other_axes(std::span<const Axis> axes, std::size_t but) {
  std::string names;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (i != but) names += (names.empty() ? "" : ", ") + axes[i].name;
  }
  return names;
}

const char* kind_word(AxisKind kind) { return kind == AxisKind::linear ? "linear" : "rotary"; }

/// The key whose numbers read back to the same bits.
const CouplingKey& key_of(AxisKind axis, AxisKind of, double ratio) {
  const CouplingKey* found = nullptr;
  for (const CouplingKey& key : kCouplingKeys) {
    if (key.axis != axis || key.of != of) continue;
    found = &key;
    if (key.inside(key.written(ratio)) == ratio) break;
  }
  return *found;
}

}  // namespace

void read_couplings(TomlTable& table, std::span<const Axis> axes, std::size_t axis,
                    std::vector<AxisCoupling>& couplings) {
  for (const CouplingKey& key : kCouplingKeys) {
    if (key.axis != axes[axis].kind) continue;
    auto ratios = table.optional_table(key.name);
    if (!ratios) continue;
    for (const std::string& name : ratios->keys()) {
      const auto* const of =
          std::find_if(axes.data(), axes.data() + axes.size(), [&](const Axis& one) { return one.name == name; });
      if (of == axes.data() + axes.size()) {
        ratios->fail(name, "there is no axis " + name, "one of " + other_axes(axes, axis));
      }
      if (of->kind != key.of) {
        ratios->fail(name, fmt::format("{} is a {} axis", name, kind_word(of->kind)),
                     fmt::format("the key {} for it", key_of(axes[axis].kind, of->kind, 1).name));
      }
      const double ratio = ratios->number(name, Quantity::dimensionless);
      couplings.push_back({axis, static_cast<std::size_t>(of - axes.data()), key.inside(ratio)});
    }
    ratios->finish();
  }
}

std::vector<WrittenCoupling> written_couplings(const Machine& machine, std::size_t axis) {
  std::vector<WrittenCoupling> written;
  for (const AxisCoupling& coupling : machine.couplings) {
    if (coupling.axis != axis) continue;
    const CouplingKey& key = key_of(machine.axes[axis].kind, machine.axes[coupling.of].kind, coupling.ratio);
    const auto same = std::find_if(written.begin(), written.end(),
                                   [&](const WrittenCoupling& other) { return other.key == key.name; });
    WrittenCoupling& line = same == written.end() ? written.emplace_back(WrittenCoupling{key.name, {}}) : *same;
    line.ratios.push_back({machine.axes[coupling.of].name, key.written(coupling.ratio)});
  }
  return written;
}

std::string couplings_text(const Machine& machine, std::size_t axis) {
  std::string text;
  for (const WrittenCoupling& line : written_couplings(machine, axis)) {
    text += line.key + " = {";
    for (std::size_t k = 0; k < line.ratios.size(); ++k) {
      text += fmt::format("{} {} = {}", k == 0 ? "" : ",", line.ratios[k].of, shortest_text(line.ratios[k].value));
    }
    text += " }\n";
  }
  return text;
}

void refuse_couplings(const Machine& machine, const std::string& job, const std::string& file) {
  if (machine.couplings.empty()) return;
  throw InputError({.file = file, .field = "axis." + machine.axes[machine.couplings.front().axis].name},
                   first_coupling(machine) + ", and " + job + " needs axes that move by their own commands alone",
                   "a machine without coupled axes");
}

}  // namespace abbe
