#pragma once

#include <string>
#include <vector>

#include "abbe/controls/described_chain.h"
#include "abbe/errors/error_set.h"
#include "abbe/formats/controls/table_heidenhain_kinematics.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Whether a row would be written as something else than zero, by its coordinate.
bool shown_in_row(std::size_t coordinate, double value);

/// The kinematics description of a machine: shifts to its rotary axes in COORD, with their location errors; columns of
/// `tables` in front of their axes, in the order X Y Z A B C; tilts of axes in front of MachAxis and undone behind it,
/// of the machine file in COORD, of location errors in COMPTAB.
/// @param tables  of any axes; columns that are not there have no row
std::vector<KinematicsRow> description_rows(const Machine& machine, const ErrorSet& errors,
                                            const std::vector<ComponentTable>& tables, const std::string& format);

}  // namespace abbe
