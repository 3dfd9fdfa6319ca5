#include <array>
#include <cstddef>

#include "abbe/controls/table_format.h"
#include "abbe/formats/text/input_error.h"

// A format is a function that returns its row, in a file of its own, and a line here. The order is that of --help.
#define ABBE_TABLE_FORMATS(FORMAT) \
  FORMAT(linuxcnc_format)          \
  FORMAT(siemens_cec_format)       \
  FORMAT(siemens_eec_format)       \
  FORMAT(beckhoff_format)          \
  FORMAT(etalon_format)            \
  FORMAT(lattice_csv_format)       \
  FORMAT(lattice_vtk_format)       \
  FORMAT(klipper_format)           \
  FORMAT(marlin_format)            \
  FORMAT(heidenhain_format)        \
  FORMAT(heidenhain_comp_format)   \
  FORMAT(fanuc_pitch_format)       \
  FORMAT(fanuc_lattice_format)     \
  FORMAT(aerotech_1d_format)       \
  FORMAT(aerotech_2d_format)

namespace abbe {

#define ABBE_DECLARE(row) TableFormat row();
ABBE_TABLE_FORMATS(ABBE_DECLARE)
#undef ABBE_DECLARE

const std::vector<TableFormat>& table_formats() {
#define ABBE_MAKE(row) row(),
  static const std::vector<TableFormat> formats = {ABBE_TABLE_FORMATS(ABBE_MAKE)};
#undef ABBE_MAKE
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

namespace {

struct SettingOption {
  TableSetting setting;
  const char* option;
};
constexpr std::array kSettingOptions = {
    SettingOption{TableSetting::type, "--type"},
    SettingOption{TableSetting::first_table, "--first-table"},
    SettingOption{TableSetting::encoder, "--encoder"},
    SettingOption{TableSetting::negate, "--negate"},
    SettingOption{TableSetting::negate_own, "--negate-own"},
    SettingOption{TableSetting::detection_unit, "--detection-unit-um"},
    SettingOption{TableSetting::reference_position, "--reference-position"},
    SettingOption{TableSetting::reference, "--at"},
    SettingOption{TableSetting::names, "--name"},
    SettingOption{TableSetting::axes, "--axis"},
    SettingOption{TableSetting::tolerance_mm, "--interpolation-um"},
    SettingOption{TableSetting::tolerance_rad, "--interpolation-urad"},
    SettingOption{TableSetting::most_nodes, "--max-points"},
};

}  // namespace

const std::vector<TableSetting>& table_settings() {
  static const std::vector<TableSetting> settings = [] {
    std::vector<TableSetting> all;
    for (const SettingOption& one : kSettingOptions) all.push_back(one.setting);
    return all;
  }();
  return settings;
}

const char* setting_option(TableSetting setting) {
  return kSettingOptions.at(static_cast<std::size_t>(setting)).option;
}

void refuse_settings_of_other_formats(const TableFormat& format, const std::set<TableSetting>& given) {
  for (const TableSetting setting : given) {
    if (format.takes.contains(setting)) continue;
    std::string others;
    for (const TableFormat& other : table_formats()) {
      if (other.takes.contains(setting)) others += (others.empty() ? "" : ", ") + other.name;
    }
    throw InputError({.field = setting_option(setting)}, "would change nothing in tables for " + format.name,
                     "--for " + others + "; or to leave it out");
  }
}

}  // namespace abbe
