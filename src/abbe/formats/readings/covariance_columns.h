#pragma once

#include <array>
#include <string>

#include "abbe/formats/text/unit.h"
#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// A column of a measurement file with one element of the readings' covariance.
struct CovarianceColumn {
  std::string base;       ///< "cov_xy", "cov_range_azimuth"
  Quantity quantity;      ///< decides the units its name may have
  const char* unit;       ///< in which it is written
  bool variance = false;  ///< on the diagonal: above zero
};

/// The six columns in the order of TrackerReadings::uncertainty: three variances, then the elements 01, 02, 12.
inline std::array<CovarianceColumn, 6> covariance_columns(TrackerMeasure measure) {
  using enum Quantity;
  if (measure == TrackerMeasure::cartesian) {
    return {{{"cov_xx", length_squared, "um2", true},
             {"cov_yy", length_squared, "um2", true},
             {"cov_zz", length_squared, "um2", true},
             {"cov_xy", length_squared, "um2"},
             {"cov_xz", length_squared, "um2"},
             {"cov_yz", length_squared, "um2"}}};
  }
  return {{{"cov_range_range", length_squared, "um2", true},
           {"cov_azimuth_azimuth", angle_squared, "arcsec2", true},
           {"cov_elevation_elevation", angle_squared, "arcsec2", true},
           {"cov_range_azimuth", length_angle, "um_arcsec"},
           {"cov_range_elevation", length_angle, "um_arcsec"},
           {"cov_azimuth_elevation", angle_squared, "arcsec2"}}};
}

}  // namespace abbe
