#include "compensate/table_formats.h"

#include "abbe/formats/input_error.h"
#include "compensate/axis_table_formats.h"
#include "compensate/fanuc_lattice_format.h"
#include "compensate/lattice_formats.h"
#include "compensate/pitch_formats.h"
#include "compensate/skew_formats.h"
#include "compensate/volumetric_formats.h"

namespace abbe {

const std::vector<TableFormat>& table_formats() {
  static const std::vector<TableFormat> formats = {linuxcnc_format(),    siemens_cec_format(), siemens_eec_format(),
                                                   beckhoff_format(),    etalon_format(),      lattice_csv_format(),
                                                   lattice_vtk_format(), klipper_format(),     marlin_format(),
                                                   heidenhain_format(),  fanuc_pitch_format(), fanuc_lattice_format()};
  return formats;
}

const TableFormat& table_format(const std::string& name) {
  std::string names;
  for (const TableFormat& format : table_formats()) {
    if (format.name == name) return format;
    names += (names.empty() ? "" : ", ") + format.name;
  }
  throw InputError({.field = "--for"}, "unknown format '" + name + "'", names);
}

}  // namespace abbe
