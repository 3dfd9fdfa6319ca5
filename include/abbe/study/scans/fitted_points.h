#pragma once

// A shape fitted to points, as `abbe fit` does it:
//
//   #include <abbe/study/scans/fitted_points.h>
//
//   #include <cstdio>
//   #include <utility>
//
//   int main() {
//     abbe::ShapeFitRequest request;
//     request.points = abbe::read_points_to_fit("examples/fit/bore.csv");
//     request.choice.kind = abbe::ShapeKind::cylinder;
//     request.choice.method = abbe::FitMethod::minimum_zone;
//     const abbe::FittedShape fitted = abbe::fit_points(std::move(request));
//     if (!fitted.is_ok()) return 1;
//     std::printf("radius %.4f mm, cylindricity %.2f um\n", fitted.fit.shape.radius, 1e3 * fitted.fit.form);
//     return 0;  // evaluation_text(fitted.report) says more
//   }
//
// It prints:
//
//   radius 15.0015 mm, cylindricity 11.56 um
//
// The report as JSON: evaluation_json(); as a page: evaluation_files(). Methods and figures: docs/fits.md.
// Without a report: fit_shape() and coaxial_circles_fit().

#include <map>
#include <string>
#include <vector>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/fits/coaxial_circles.h"
#include "abbe/geometry/fits/fit_choice.h"
#include "abbe/geometry/fits/shape_fit.h"
#include "abbe/geometry/fits/shapes.h"
#include "abbe/geometry/surface/point_cloud.h"
#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// Points, and what the report says of their file.
struct PointsToFit {
  std::string file;                  ///< name for texts
  PointCloud cloud;                  ///< mm
  std::string fact;                  ///< "CSV, mm"; may be empty
  std::vector<std::string> names{};  ///< [points] or empty
};

/// Reads a point cloud, or the corners of the triangles of an STL file. @throws InputError
PointsToFit read_points_to_fit(const std::string& file, const PointCloudOptions& options = {});

/// Points to which one shape is fitted; lengths in mm, angles in rad.
///
/// Messages name a field by the option of `abbe fit` that sets it: --shape, --method, --fixed-radius-mm,
/// --fixed-direction, --fixed-half-angle-deg.
struct ShapeFitRequest {
  PointsToFit points;
  FitChoice choice;
  std::vector<std::string> tolerances;  ///< --tolerance: "form_um=20", as apply_tolerances() takes them
  bool page = false;                    ///< the report is to have the points on the fitted surface, for its page
};

/// A fitted shape with its report. It holds no reference to the request.
struct FittedShape {
  ShapeFit fit;
  PointCloud points;               ///< of the request
  std::vector<double> deviations;  ///< [points] mm; empty if there is no answer
  std::vector<std::string> names;  ///< [points] of the request, or empty
  EvaluationReport report;         ///< with the tolerances of the request

  bool is_ok() const { return fit.ok(); }
};

/// Fits a shape. Shapes of the plane are fitted in x and y. Opens no file and prints nothing.
/// @throws InputError for what the shape does not have and is to be held, a method that the shape does not have, and as
///   apply_tolerances()
FittedShape fit_points(ShapeFitRequest request);

/// CSV of the points with their deviations and names. The fit must have an answer.
std::string fitted_points_csv(const FittedShape& fitted);

/// Circles about one axis, by least squares.
struct CirclesFitRequest {
  std::vector<PointsToFit> circles;
  CoaxialOptions options;
  std::vector<std::string> tolerances;  ///< --tolerance
};

struct FittedCircles {
  CoaxialCircles fit;
  EvaluationReport report;

  bool is_ok() const { return fit.ok(); }
};

/// @throws InputError for a direction that is none, radii that are not above zero or not one per circle, and as
///   apply_tolerances()
FittedCircles fit_circles(CirclesFitRequest request);

/// Whether a shape lies in the plane, so that the z of points does not count.
bool is_plane_shape(ShapeKind kind);

/// Shapes and methods by the names that --shape and --method have for them.
const std::map<std::string, ShapeKind>& shapes_by_name();
const std::map<std::string, FitMethod>& fit_methods_by_name();

}  // namespace abbe
