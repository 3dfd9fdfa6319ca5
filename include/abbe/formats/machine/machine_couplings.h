#pragma once

#include <span>
#include <string>
#include <vector>

#include "abbe/formats/text/toml_table.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Reads what the position of an axis contains of the commands of others: `coupled = { A2 = -1 }`, with a unit in the
/// key between a linear and a rotary axis.
/// @param table      of the axis
/// @param axes       all of them, names and kinds known
/// @param axis       which of them
/// @param couplings  those found are added
void read_couplings(TomlTable& table, std::span<const Axis> axes, std::size_t axis,
                    std::vector<AxisCoupling>& couplings);

/// Couplings of one axis by the keys of a machine file.
struct WrittenCoupling {
  std::string key;  ///< "coupled", "coupled_mm_per_deg", ...
  struct Ratio {
    std::string of;
    double value;  ///< in the unit of the key; reads back to the same bits
  };
  std::vector<Ratio> ratios;
};
std::vector<WrittenCoupling> written_couplings(const Machine& machine, std::size_t axis);

/// The lines of a machine file; empty where the axis is not coupled.
std::string couplings_text(const Machine& machine, std::size_t axis);

/// For what works with axes that move independently of each other.
/// @param job   "a table of a control"
/// @param file  of the machine, if it is known
/// @throws InputError naming the first coupled axis, if the machine has one
void refuse_couplings(const Machine& machine, const std::string& job, const std::string& file = "");

}  // namespace abbe
