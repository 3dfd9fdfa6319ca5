#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/geometry/rigid_transform.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/machine/machine.h"

// The standard cylinder of section 4 on the simulated scanner, without a mesh: the beam is traced to it exactly.
namespace abbe {

inline constexpr double kLiuRadius = 10;          ///< mm, of the standard cylinder
inline constexpr double kLiuMeasuredLength = 24;  ///< mm, along the cylinder

struct LiuAxisLine {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  ///< unit
};

/// The standard cylinder where it is clamped.
struct LiuStandard {
  RigidTransform clamped;                                ///< workpiece_from_part
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  ///< unit, of its axis, part's frame
  double taper = 0;  ///< mm/mm, growth of the radius along the axis, zero in the middle
  double lobes = 0;  ///< mm, amplitude of three lobes round the axis

  LiuAxisLine axis() const { return {clamped.translation, clamped.rotation * direction}; }
};

/// Deviations of the axes from their commands and of the indications, standard deviations, independent.
struct LiuNoise {
  double linear = 0, rotary = 0, probe = 0;  ///< mm, rad, mm
  bool is_none() const { return linear == 0 && rotary == 0 && probe == 0; }
};
LiuNoise liu_table_2_noise();

struct LiuScan {
  PoseList positions;              ///< as commanded
  std::vector<double> indication;  ///< mm
};

/// Indications on the standard. Z is commanded in steps of 0.1 mm to where the indication is small.
/// @param planned  positions; those of Z are replaced
/// @param stream   of the noise
LiuScan liu_scan_standard(const Machine& machine, const ErrorSet& actual, PoseList planned, const LiuStandard& standard,
                          const LiuNoise& noise, std::uint64_t stream);

/// What a machine with these errors would indicate at these commands on a cylinder of the nominal radius, mm.
std::vector<double> liu_indications(const Machine& machine, const ErrorSet& errors, const PoseList& positions,
                                    const LiuAxisLine& cylinder);

/// 13 places along by 9 across the cylinder, at four angles of a stage: 24 mm by 8 mm.
inline constexpr std::size_t kLiuAlong = 13, kLiuAcross = 9, kLiuQuarters = 4;
PoseList liu_four_quarters(const Machine& machine, const std::string& stage);

/// A probe on a cylinder along a direction; where exactly it is clamped is not known.
std::shared_ptr<const Instrument> liu_probe_on(const Eigen::Vector3d& direction, const LiuNoise& noise,
                                               const std::string& name);
InstrumentReadings liu_readings(const LiuScan& scan);

/// Parameters of the cylinder in an identification: tilts towards, then offsets along, DirectionFrame's first and
/// second.
std::array<Eigen::Index, 4> liu_cylinder_parameters(const Identification& found, const std::string& probe);
/// The axis of the cylinder by these parameters.
LiuAxisLine liu_line(const Eigen::Vector4d& parameters, const Eigen::Vector3d& direction);

}  // namespace abbe
