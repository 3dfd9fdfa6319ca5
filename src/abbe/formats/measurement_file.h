#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

enum class MeasuredKind { xyz, range_angles };
enum class StatedUncertainty { none, standard, covariance };

/// Readings of an instrument that sees points, structure of arrays, in the order of the file.
struct MeasurementTable {
  MeasuredKind kind = MeasuredKind::xyz;
  std::size_t count = 0;
  std::vector<std::vector<double>> positions;   ///< [axes][count] commands in chain order, mm or rad
  std::array<std::vector<double>, 3> measured;  ///< x y z (mm), or range (mm), azimuth, elevation (rad)

  StatedUncertainty stated = StatedUncertainty::none;
  std::array<std::vector<double>, 3> standard_uncertainty;  ///< of `measured`, mm or rad
  std::array<std::vector<double>, 6> covariance;            ///< xx, xy, xz, yy, yz, zz in mm^2; positive definite

  std::vector<std::string> stations;     ///< in order of appearance; one unnamed if the file has no column
  std::vector<std::uint32_t> station;    ///< [count] index into stations
  std::vector<std::string> reflectors;   ///< in order of appearance; "offset1", ... where only offsets are given
  std::vector<std::uint32_t> reflector;  ///< [count] index into reflectors
  std::vector<Eigen::Vector3d>
      reflector_offset;      ///< [reflectors.size()] mm, or empty if the file has no offset columns
  std::vector<double> time;  ///< [count] s, or empty
};

/// How the columns of a file that Abbe did not write are called, and which are left unread.
struct ColumnMapping {
  std::map<std::string, std::string> columns;  ///< our name with unit -> name in the file: {"C_deg", "c_deg"}
  std::vector<std::string> ignore;             ///< names in the file
};

struct MeasurementOptions {
  ColumnMapping mapping;
  bool check_travel = true;  ///< refuse commands outside an axis's travel
  int threads = 0;           ///< 0: all
};

/// Reads a measurement CSV: see docs/formats.md. Every row counts or is an error; rows keep their order. @throws
/// InputError
MeasurementTable read_measurements(const std::filesystem::path& path, const Machine& machine,
                                   const MeasurementOptions& options = {});
/// The same from text. @param file  name for messages
MeasurementTable parse_measurements(std::string_view text, const std::string& file, const Machine& machine,
                                    const MeasurementOptions& options = {});

/// CSV text of a table, mm and deg, uncertainties in um and arcsec; shortest decimals. Reads back to the same bits for
/// lengths, to one unit in the last place for angles.
std::string measurements_text(const Machine& machine, const MeasurementTable& table);

/// Poses from a CSV with one column per axis. @returns [axes][count], mm or rad @throws InputError
std::vector<std::vector<double>> read_poses(const std::filesystem::path& path, const Machine& machine,
                                            const MeasurementOptions& options = {});
std::vector<std::vector<double>> parse_poses(std::string_view text, const std::string& file, const Machine& machine,
                                             const MeasurementOptions& options = {});

}  // namespace abbe
