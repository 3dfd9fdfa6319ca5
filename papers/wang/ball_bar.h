#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/identify/linkage/decoupled_errors.h"
#include "abbe/report/drawings/svg_drawing.h"
#include "wang/study.h"

namespace abbe {

/// A circle of radius 100 mm in one plane, driven with two linear axes about the middle of their travel; A, B and C
/// stand at 0. The bar sits between the tool point and a socket on the workpiece where the tool nominally is at the
/// centre.
struct WangCircle {
  std::string plane;              ///< "XY", "YZ", "ZX"
  std::vector<double> deviation;  ///< bar length less 100 mm as indicated, [360] by degrees, mm
  double circular = 0;            ///< ISO 230-4 circular deviation G about the least-squares centre, mm
  bool converged = false;         ///< G exists
  /// Standard uncertainties propagated from those of the errors, mm; empty and 0 without a covariance.
  std::vector<double> uncertainty;  ///< [360] of the deviation
  double circular_uncertainty = 0;  ///< of G
};

/// What a ball bar would read with these errors, in three planes.
///
/// Uncertainties of the deviation are of first order, with analytic derivatives of the indicated length; that of G is
/// found from 400 traces drawn from the covariance of the deviations, because noise also chooses the angles that decide
/// G. A trace with noise is wider than one without: its share in U(G) is not only scatter.
/// @param covariance  null, or of ErrorSet::parameters(), [p, p]
std::vector<WangCircle> wang_ball_bar(const ErrorSet& errors, const Eigen::MatrixXd* covariance = nullptr);

/// The circles of one reading of the paper's tables.
struct WangBallBarModel {
  std::string name;  ///< "displacements only"
  WangReading reading;
  std::vector<WangCircle> circles;  ///< XY, YZ, ZX; lengths in mm
};

/// What a ball bar would read according to the tables and to the errors found by dials and laser.
struct WangBallBarStudy {
  std::vector<WangBallBarModel> models;
  std::vector<WangCircle> with_noise, without_noise;  ///< from the errors found; lengths in mm
};

/// @param with_noise, without_noise  errors found from the same readings with and without noise, mm or rad
WangBallBarStudy wang_ball_bar_study(const DecoupledErrors& with_noise, const DecoupledErrors& without_noise);

/// Polar plot of a circle beside that without noise as SVG text, the k = 2 band by its two edges.
SvgPicture wang_circle_picture(const WangCircle& circle, const WangCircle& without_noise);
/// Share of the angles at which the deviation of `without_noise` lies within k = 2.
double wang_share_within(const WangCircle& circle, const WangCircle& without_noise);

}  // namespace abbe
