#include "abbe/study/scans/fitted_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/words/evaluation_text.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// Points on a circle about (10, -5, height), every `degrees`.
PointsToFit points_of_circle(double radius, double height, int degrees = 10) {
  PointsToFit points;
  points.file = "rings/ring.csv";
  points.fact = "CSV, mm";
  points.cloud.points.resize(3, 360 / degrees);
  for (int i = 0; i < 360 / degrees; ++i) {
    const double angle = i * degrees * kDegree;
    points.cloud.points.col(i) = Eigen::Vector3d(10 + radius * std::cos(angle), -5 + radius * std::sin(angle), height);
  }
  return points;
}

ShapeFitRequest circle_to_fit(double radius = 20) {
  ShapeFitRequest request;
  request.points = points_of_circle(radius, 0);
  request.choice.kind = ShapeKind::circle2;
  return request;
}

TEST(FittedPoints, AreOnTheShapeThatTheyWereMadeOf) {
  ShapeFitRequest request = circle_to_fit();
  request.points.cloud.points(2, 3) = 0.5;
  request.points.cloud.points(0, 0) += 0.01;
  const Eigen::Matrix3Xd points = request.points.cloud.points;
  const FittedShape fitted = fit_points(std::move(request));
  ASSERT_TRUE(fitted.is_ok()) << fitted.fit.reason;
  EXPECT_NEAR(fitted.fit.shape.radius, 20, 0.01);
  ASSERT_EQ(fitted.deviations.size(), 36U);
  for (Eigen::Index i = 0; i < 36; ++i) {
    const double from_centre = (points.col(i) - fitted.fit.shape.point).head<2>().norm();
    EXPECT_NEAR(fitted.deviations[static_cast<std::size_t>(i)], from_centre - fitted.fit.shape.radius, 1e-12);
  }
  EXPECT_EQ(fitted.report.title, "Fit of ring.csv");
  EXPECT_THAT(fitted.report.notes, testing::Contains("Fitted in x and y: z, from 0 to 0.5 mm, was left out."));
  EXPECT_THAT(evaluation_text(fitted.report), HasSubstr("CSV, mm"));
  // The points are written as they were, with their z.
  EXPECT_THAT(fitted_points_csv(fitted), testing::StartsWith("x_mm,y_mm,z_mm,deviation_mm\n"));
  const PointCloudFile read = parse_point_cloud(fitted_points_csv(fitted), "x.csv");
  EXPECT_EQ(read.cloud.points, points);
  EXPECT_EQ(read.deviation_mm, fitted.deviations);
}

TEST(FittedPoints, ThePageIsThereWhereItIsAskedForAndThereIsASurface) {
  const std::string bore = ABBE_SOURCE_DIR "/examples/fit/bore.csv";
  for (const bool page : {false, true}) {
    ShapeFitRequest request;
    request.points = read_points_to_fit(bore);
    request.choice.kind = ShapeKind::cylinder;
    request.page = page;
    const FittedShape fitted = fit_points(std::move(request));
    ASSERT_TRUE(fitted.is_ok());
    EXPECT_EQ(fitted.report.page.is_object(), page);
  }
}

TEST(FittedPoints, WithoutAnAnswerThereAreNoDeviations) {
  ShapeFitRequest request = circle_to_fit();
  request.points.cloud.points.conservativeResize(3, 2);
  const FittedShape fitted = fit_points(request);
  EXPECT_FALSE(fitted.is_ok());
  EXPECT_TRUE(fitted.deviations.empty());
  EXPECT_EQ(fitted.fit.status, FitStatus::too_few_points);
  request.points.cloud = {};
  EXPECT_EQ(fit_points(request).fit.status, FitStatus::too_few_points);
}

TEST(FittedPoints, CirclesAboutOneAxis) {
  CirclesFitRequest request;
  request.circles = {points_of_circle(20, 0), points_of_circle(12, 30)};
  const FittedCircles fitted = fit_circles(request);
  ASSERT_TRUE(fitted.is_ok()) << fitted.fit.reason;
  EXPECT_NEAR(fitted.fit.radii[0], 20, 1e-9);
  EXPECT_NEAR(fitted.fit.radii[1], 12, 1e-9);
  EXPECT_NEAR(fitted.fit.heights[1] - fitted.fit.heights[0], 30, 1e-9);
  EXPECT_EQ(fitted.report.title, "Coaxial circles");
  request.options.radii = {20};
  EXPECT_THAT(message_of([&] { fit_circles(request); }),
              HasSubstr("--fixed-radius-mm: '20' is not valid; expected 2 numbers of mm above zero, one per file"));
  request.options.radii = {20, -1};
  EXPECT_THAT(message_of([&] { fit_circles(request); }), HasSubstr("--fixed-radius-mm: '20,-1' is not valid"));
  request.options = {};
  request.options.direction = Eigen::Vector3d::Zero();
  EXPECT_THAT(message_of([&] { fit_circles(request); }),
              HasSubstr("--fixed-direction: '0,0,0' is not a direction; expected three numbers"));
}

TEST(FittedPoints, FiguresAreJudgedByTheTolerancesOfTheRequest) {
  ShapeFitRequest request = circle_to_fit();
  request.points.cloud.points(0, 0) += 0.01;
  EXPECT_FALSE(fit_points(request).report.exceeds_tolerance());
  request.tolerances = {"form_um=1"};
  EXPECT_TRUE(fit_points(request).report.exceeds_tolerance());
  request.tolerances = {"Q_um=1"};
  EXPECT_THAT(message_of([&] { fit_points(request); }), HasSubstr("--tolerance Q_um=1: there is no such figure"));
  CirclesFitRequest circles;
  circles.circles = {points_of_circle(20, 0), points_of_circle(12, 30)};
  circles.tolerances = {"Q_um=1"};
  EXPECT_THAT(message_of([&] { fit_circles(circles); }), HasSubstr("--tolerance Q_um=1: there is no such figure"));
}

TEST(FittedPoints, WhatAShapeDoesNotHaveCannotBeHeld) {
  const auto problem = [](ShapeKind kind, const auto& change) {
    ShapeFitRequest request = circle_to_fit();
    request.choice.kind = kind;
    change(request.choice);
    return message_of([&] { fit_points(request); });
  };
  const auto radius = [](FitChoice& choice) { choice.options.constraints.radius = 20; };
  EXPECT_THAT(problem(ShapeKind::line3, radius), HasSubstr("--fixed-radius-mm: there is no radius of line to hold"));
  EXPECT_THAT(problem(ShapeKind::cone, radius), HasSubstr("there is no radius of cone to hold"));
  ShapeFitRequest with_radius = circle_to_fit();
  radius(with_radius.choice);
  EXPECT_TRUE(fit_points(with_radius).is_ok());
  const auto zero = [](FitChoice& choice) { choice.options.constraints.radius = 0; };
  EXPECT_THAT(problem(ShapeKind::circle2, zero),
              HasSubstr("--fixed-radius-mm: '0' is not valid; expected a number of mm above zero"));
  const auto up = [](FitChoice& choice) { choice.options.constraints.direction = Eigen::Vector3d::UnitZ(); };
  EXPECT_THAT(problem(ShapeKind::sphere, up), HasSubstr("there is no direction of sphere to hold"));
  EXPECT_THAT(problem(ShapeKind::line2, up), HasSubstr("--fixed-direction: it has no part in x, y"));
  const auto angle = [](FitChoice& choice) { choice.options.constraints.half_angle = 0.2; };
  EXPECT_THAT(problem(ShapeKind::cylinder, angle), HasSubstr("there is no half angle of cylinder to hold"));
  const auto wide = [](FitChoice& choice) { choice.options.constraints.half_angle = 2; };
  EXPECT_THAT(problem(ShapeKind::cone, wide), HasSubstr("--fixed-half-angle-deg: 114.592 is not valid"));
  const auto inscribed = [](FitChoice& choice) { choice.method = FitMethod::inscribed; };
  EXPECT_THAT(problem(ShapeKind::plane, inscribed), HasSubstr("--method inscribed: there is none of plane"));
  const auto held = [&](FitChoice& choice) {
    inscribed(choice);
    radius(choice);
  };
  EXPECT_THAT(problem(ShapeKind::circle2, held), HasSubstr("there is none of circle2 with its radius held"));
}

}  // namespace
}  // namespace abbe
