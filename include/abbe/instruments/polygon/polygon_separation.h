#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/instruments/polygon/polygon_campaign.h"

namespace abbe {

/// What the readings of a campaign can see.
struct PolygonObservability {
  std::size_t unknowns = 0, readings = 0, rank = 0;
  Eigen::VectorXd singular_values;  ///< of the Jacobian with unit columns, relative to the largest, decreasing
  Eigen::MatrixXd unseen;           ///< [unknowns, unknowns - rank]: directions that change no reading, rad and mm
};

/// Rank of the analytic Jacobian at the campaign's present values (take a nominal campaign for the rank of first
/// order).
PolygonObservability polygon_observability(const PolygonCampaign& campaign, const PolygonNoise& noise = {});

/// One equation functional . unknowns = 0 that fixes one unseen direction, in words.
struct PolygonGaugeEquation {
  std::string words;
  Eigen::VectorXd functional;
};

/// The stated gauge: equations chosen in this order, each taken if it fixes a direction that is still open.
///  1. the mean of each error motion is zero (a constant is the zero of an instrument);
///  2. the once-per-turn parts of tilt and of radial motion that turn with the table are zero (axis average line: they
///     are the installation of the prism);
///  3. mean azimuth error, mean tilt and mean distance error of the faces are zero (so is defined the prism's azimuth,
///     and what a zero is);
///  4. the once-per-turn parts of the faces' tilts and distances are zero (so are defined the prism's axis and centre);
///  5. the mirror is square to that axis;
///  6. the mounts, first to last, have no error; 7. the faces have none; 8. nor have the zeros.
/// Numbers 6 to 8 are reached only where there are too few mounts: then they are assumptions, not definitions.
std::vector<PolygonGaugeEquation> polygon_gauge(const PolygonCampaign& nominal,
                                                const PolygonObservability& observability);

/// Moves values along the unseen directions until the gauge holds: what a measurement can be compared with.
Eigen::VectorXd in_gauge(const Eigen::VectorXd& values, const PolygonObservability& observability,
                         const std::vector<PolygonGaugeEquation>& gauge);

enum class PolygonSeparationStatus { not_run, converged, not_converged, rank_deficient };

/// Motions of the table, errors of the prism and its mounts, from the readings of a campaign.
struct PolygonSeparation {
  PolygonSeparationStatus status = PolygonSeparationStatus::not_run;
  Eigen::VectorXd values;                  ///< [unknowns], rad and mm, within the gauge
  Eigen::VectorXd standard_uncertainties;  ///< [unknowns]
  double chi_square = 0;
  std::size_t degrees_of_freedom = 0;
  int iterations = 0;
};

/// Weighted least squares within the gauge (Gauss-Newton from the nominal campaign, orthogonal factors).
/// @param readings  as campaign_readings() orders them
PolygonSeparation separate_polygon(const PolygonCampaign& nominal, const Eigen::VectorXd& readings,
                                   const PolygonNoise& noise, const std::vector<PolygonGaugeEquation>& gauge);

}  // namespace abbe
