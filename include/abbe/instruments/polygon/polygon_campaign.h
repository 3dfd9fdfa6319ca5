#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/instruments/polygon/polygon_inversion.h"

namespace abbe {

/// A prism put on the table one or several times, each time turned by some faces, and the table measured at the
/// positions 2 pi k / n each time. The table repeats its motions.
struct PolygonCampaign {
  Polygon polygon;
  double face_distance = 0;              ///< nominal, mm; PolygonFace::distance minus this is the face's error
  std::vector<PolygonMount> mounts;      ///< [mounts], with their nominal turn
  std::vector<std::size_t> shifts;       ///< [mounts], that turn in faces
  PolygonBench bench;                    ///< where the instruments nominally stand
  std::vector<TableMotion> motions;      ///< [steps]
  PolygonReadings zeros{};               ///< added to every reading of a kind: how the instruments are adjusted
  std::vector<PolygonReading> measured;  ///< which readings are taken: by default all but the redundant one

  std::size_t steps() const { return motions.size(); }
  std::size_t reading_count() const { return mounts.size() * steps() * measured.size(); }
  PolygonPosition position(std::size_t step, std::size_t mount) const {
    return regular_position(polygon.faces.size(), step, shifts[mount]);
  }
};

/// A campaign without errors.
/// @param shifts  by how many faces the prism is turned in each of its mounts, {0} or {0, 1}
/// @throws std::invalid_argument a number of faces not divisible by four, or no mount
PolygonCampaign regular_campaign(std::size_t faces, double distance, double height,
                                 const std::vector<std::size_t>& shifts);

/// An unknown of a campaign.
struct PolygonUnknown {
  std::string name;  ///< "EXC[30 deg]", "mount2.tilt_x", "face4.distance", "top.tilt_y", "zero.displacement_x"
  bool is_angle = false;
};

/// All unknowns: six motions per position, six numbers per mount, three per face, the tilt of the mirror, and the zero
/// of every reading: 6 n + 6 m + 3 n + 2 + readings.
std::vector<PolygonUnknown> polygon_unknowns(const PolygonCampaign& campaign);

/// Where groups of unknowns begin.
struct PolygonColumns {
  Eigen::Index motions, mounts, faces, top, zeros, count;
};
PolygonColumns polygon_columns(const PolygonCampaign& campaign);

/// Present values of the unknowns as deviations from the nominal campaign, rad and mm, and the way back.
Eigen::VectorXd unknown_values(const PolygonCampaign& campaign);
PolygonCampaign with_values(PolygonCampaign campaign, const Eigen::VectorXd& values);

/// All readings: mount by mount, step by step, in the order of `measured`; rad and mm.
/// @param jacobian  null or out, [readings, unknowns], analytic
Eigen::VectorXd campaign_readings(const PolygonCampaign& campaign, Eigen::MatrixXd* jacobian = nullptr);

/// Standard uncertainties of the readings.
struct PolygonNoise {
  double angle = 0.05 * 4.84813681109536e-6;  ///< rad
  double length = 0.03e-3;                    ///< mm
};

/// [readings]: the uncertainty of every reading of the campaign.
Eigen::VectorXd reading_uncertainties(const PolygonCampaign& campaign, const PolygonNoise& noise);

/// Readings with normal noise; the same seed gives the same noise.
Eigen::VectorXd simulate_campaign(const PolygonCampaign& campaign, const PolygonNoise& noise, std::uint64_t seed);

/// One run of the stepwise measurement with one autocollimator and one displacement sensor, as the paper did it: the
/// table is turned three times, and repeats its motions only so far.
///
///  set-up 1: autocollimator along x (about z and y), displacement sensor along y;
///  set-up 2: autocollimator along y (about x), displacement sensor along x;
///  set-up 3: displacement sensor along z.
/// @param motions  [3][steps]: what the table did in each set-up
/// @return [steps] the readings put together as if taken at once; the redundant one is NaN
std::vector<PolygonReadings> stepwise_readings(const PolygonCampaign& campaign,
                                               const std::vector<std::vector<TableMotion>>& motions);

}  // namespace abbe
