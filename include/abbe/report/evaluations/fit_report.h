#pragma once

#include <string>
#include <utility>
#include <vector>

#include "abbe/geometry/fits/coaxial_circles.h"
#include "abbe/geometry/fits/fit_choice.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// Settings of a fit, besides its points.
struct FitRequest {
  std::string title;  ///< "Fit of x.csv"
  FitChoice choice;
  std::vector<std::pair<std::string, std::string>> facts;  ///< of the file
};

/// Figures, the points that decide, a plot of the deviations and notes.
/// @param deviations  of the points, mm; empty if there is no answer
EvaluationReport fit_report(const FitRequest& request, const ShapeFit& fit, const FitPoints& points,
                            const std::vector<double>& deviations);

/// The same for circles about one axis. @param names  of the circles
EvaluationReport coaxial_report(const FitRequest& request, const CoaxialCircles& fit, const CoaxialOptions& options,
                                const std::vector<std::string>& names);

/// "roundness", "flatness": ISO 1101. Empty where the standard has no name for it.
std::string form_name(ShapeKind kind);

/// A length in mm with the digits of a nanometre, with its expanded uncertainty where the variance is above zero.
EvaluationFigure length_figure(const std::string& symbol, const std::string& name, double value, double variance);
/// The components of a direction. @param covariance  [3, 3] or zero
void add_direction(EvaluationReport& report, const Eigen::Vector3d& direction, const Eigen::Matrix3d& covariance);
/// A deviation in um.
EvaluationFigure deviation_figure(const std::string& symbol, const std::string& name, double value);

/// Deviations over the angle or along the points. @param contacts  indices of the points that decide
EvaluationPlot fit_plot(const FitRequest& request, const ShapeFit& fit, const FitPoints& points,
                        const std::vector<double>& deviations, const std::vector<std::size_t>& contacts);

}  // namespace abbe
