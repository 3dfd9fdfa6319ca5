// Tables of controls, the first byte chooses the format: any bytes give tables of finite numbers with increasing
// positions, or an InputError; what was read is written and read again.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include "abbe/formats/controls/table_aerotech.h"
#include "abbe/formats/controls/table_fanuc.h"
#include "abbe/formats/controls/table_fanuc_lattice.h"
#include "abbe/formats/controls/table_heidenhain.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/formats/controls/table_lattice.h"
#include "abbe/formats/controls/table_linuxcnc.h"
#include "abbe/formats/controls/table_siemens.h"
#include "abbe/formats/controls/table_skew.h"
#include "abbe/formats/controls/table_volumetric.h"
#include "abbe/formats/text/input_error.h"

namespace {

const std::vector<abbe::TableAxisName> kAxes = {{0, "X1", false}, {1, "Y1", false}, {2, "C1", true}};

void check(const std::vector<abbe::AxisTable>& tables) {
  for (const abbe::AxisTable& table : tables) {
    if (table.positions.empty() || table.forward.size() != table.positions.size() ||
        table.reverse.size() != table.positions.size()) {
      std::abort();
    }
    for (std::size_t k = 0; k < table.positions.size(); ++k) {
      if (!std::isfinite(table.forward[k]) || !std::isfinite(table.reverse[k])) std::abort();
      if (k > 0 && !(table.positions[k] > table.positions[k - 1])) std::abort();
    }
    if (!std::isfinite(table.at(1.5))) std::abort();
  }
}

const std::vector<abbe::TableAxisName> kNumbers = {{0, "1", false}, {1, "2", false}, {2, "3", true}};
const std::vector<abbe::TableAxisName> kLetters = {{0, "X", false}, {1, "Y", false}, {2, "C", true}};
const std::vector<abbe::TableAxisName> kLinear = {{0, "1", false}, {1, "2", false}, {2, "3", false}};

void check(const abbe::CorrectionLattice& lattice) {
  if (lattice.inputs.size() != lattice.positions.size() || lattice.inputs.size() != lattice.modulo.size()) std::abort();
  for (const std::vector<double>& values : lattice.corrections) {
    if (values.size() != lattice.count()) std::abort();
  }
  abbe::PoseList pose, found;
  pose.append({1, 2, 3});
  abbe::LatticeCorrection(lattice).evaluate(pose, found);
  for (const std::vector<double>& values : found.axis) {
    if (!std::isfinite(values[0])) std::abort();
  }
}

void check_fanuc_lattice(std::string_view parameters, std::string_view points) {
  const abbe::FanucLattice lattice = abbe::parse_fanuc_lattice(parameters, "fuzz", points, "fuzz", kLinear);
  const abbe::CorrectionLattice corrections = abbe::fanuc_lattice_corrections(lattice, 1e-3, {0, -5, 100});
  check(corrections);
  for (const std::vector<double>& nodes : corrections.positions) {
    if (std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) != nodes.end()) std::abort();
  }
  const abbe::FanucLattice again =
      abbe::parse_fanuc_lattice(abbe::fanuc_lattice_parameter_text(lattice, kLinear), "fuzz",
                                abbe::fanuc_lattice_point_text(lattice, kLinear), "fuzz", kLinear);
  if (again.values != lattice.values || again.points != lattice.points || again.axes != lattice.axes ||
      again.magnification != lattice.magnification || again.reference_point != lattice.reference_point) {
    std::abort();
  }
}

void check_aerotech_1d(std::string_view text) {
  const std::vector<abbe::AxisTable> tables = abbe::parse_aerotech_1d(text, "fuzz", kNumbers);
  check(tables);
  // Steps so small that their digits are not written cannot be read again.
  for (const abbe::AxisTable& table : tables) {
    if (table.positions[1] - table.positions[0] < 1e-3) return;
  }
  const std::vector<abbe::AxisTable> again =
      abbe::parse_aerotech_1d(abbe::aerotech_1d_text(tables, kNumbers), "fuzz", kNumbers);
  if (again.size() != tables.size()) std::abort();
  for (std::size_t t = 0; t < tables.size(); ++t) {
    if (again[t].input != tables[t].input || again[t].output != tables[t].output ||
        again[t].forward.size() != tables[t].forward.size()) {
      std::abort();
    }
  }
}

void check_aerotech_2d(std::string_view text) {
  const std::vector<abbe::CorrectionLattice> lattices = abbe::parse_aerotech_2d(text, "fuzz", kNumbers);
  bool can_be_written = true;
  for (const abbe::CorrectionLattice& lattice : lattices) {
    check(lattice);
    for (const std::vector<double>& nodes : lattice.positions) {
      if (std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) != nodes.end()) std::abort();
      can_be_written &= nodes[1] - nodes[0] >= 1e-3;
    }
  }
  if (!can_be_written) return;
  const std::vector<abbe::CorrectionLattice> again =
      abbe::parse_aerotech_2d(abbe::aerotech_2d_text(lattices, kNumbers), "fuzz", kNumbers);
  if (again.size() != lattices.size()) std::abort();
  for (std::size_t t = 0; t < lattices.size(); ++t) {
    if (again[t].inputs != lattices[t].inputs || again[t].outputs != lattices[t].outputs ||
        again[t].count() != lattices[t].count()) {
      std::abort();
    }
  }
}

void check(const abbe::ErrorTables& tables) {
  const abbe::ErrorSet errors = abbe::errors_of(tables);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double value : errors.evaluate(axis, 1.5)) {
      if (!std::isfinite(value)) std::abort();
    }
  }
}

void check_kinematics(std::string_view text) {
  const std::vector<abbe::KinematicsRow> rows = abbe::parse_heidenhain_kinematics(text, "fuzz", kNumbers, 1);
  const std::vector<abbe::KinematicsRow> again = abbe::parse_heidenhain_kinematics(
      abbe::heidenhain_kinematics_text(rows, "fuzz", kNumbers, 1), "fuzz", kNumbers, 1);
  if (again.size() != rows.size()) std::abort();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (again[k].key != rows[k].key || again[k].axis != rows[k].axis || again[k].column != rows[k].column) std::abort();
    if (!std::isfinite(rows[k].coord.value_or(0)) || !std::isfinite(rows[k].constant.value_or(0))) std::abort();
  }
}

void check(const abbe::ComponentTable& table) {
  if (table.own) check(std::vector<abbe::AxisTable>{*table.own});
  for (const auto& column : table.columns) {
    if (column) check(std::vector<abbe::AxisTable>{*column});
  }
}

void check(const abbe::SkewFactors& factors) {
  if (!(std::abs(factors.xy) <= 1) || !(std::abs(factors.xz) <= 1) || !(std::abs(factors.yz) <= 1)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string file = "fuzz";
  try {
    // Two more formats have letters, so that the others keep their bytes.
    switch (data[0] == 'K' ? 15 : data[0] == 'L' ? 16 : data[0] % 15) {
      case 0:
        check({abbe::parse_linuxcnc(text, file, false, abbe::LinuxCncCompensation::trim)});
        break;
      case 1:
        check({abbe::parse_linuxcnc(text, file, true, abbe::LinuxCncCompensation::actual)});
        break;
      case 2:
        check(abbe::parse_siemens_cec(text, file, kAxes));
        break;
      case 4:
        check(abbe::parse_lattice_csv(text, file, kLetters));
        break;
      case 5:
        check(abbe::parse_lattice_vtk(text, file, kLetters));
        break;
      case 6:
        check(abbe::parse_isg_csv(text, file, kLetters));
        break;
      case 7:
        check(abbe::parse_etalon(text, file, kLetters));
        break;
      case 8:
        check(abbe::parse_klipper_skew(text, file));
        break;
      case 9:
        check(abbe::parse_marlin_skew(text, file));
        break;
      case 10:
        check(abbe::parse_heidenhain_com(text, file, 0, kLetters, -1));
        break;
      case 11:
        for (const abbe::FanucPitch& pitch : abbe::parse_fanuc_pitch(text, file, kNumbers)) {
          check({abbe::fanuc_table(pitch, 1e-3, 0)});
        }
        break;
      case 12: {
        // Two files, a form feed between them.
        const std::size_t end = std::min(text.find('\f'), text.size());
        const std::string_view points = text.substr(std::min(end + 1, text.size()));
        check_fanuc_lattice(text.substr(0, end), points);
        break;
      }
      case 13:
        check_aerotech_1d(text);
        break;
      case 14:
        check_aerotech_2d(text);
        break;
      case 15:
        check_kinematics(text);
        break;
      case 16:
        check(abbe::parse_heidenhain_component(text, file, 2, kNumbers, -1, 1));
        break;
      default:
        check(abbe::parse_siemens_eec(text, file, kAxes));
        break;
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
