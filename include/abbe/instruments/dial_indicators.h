#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"
#include "abbe/instruments/setup_orientation.h"

namespace abbe {

/// Dial indicators on one body against flat reference faces on another: straightedge, square, surface plate.
struct DialIndicatorsSetup {
  struct Face {
    std::string name = "face1";
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< mm, nominal point of the face, frame of face_body
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< nominal, out of the material; any length
    SetupNumber offset;  ///< mm, by how much the face at `point` lies outwards along the nominal normal
    SetupNumber tilt_first, tilt_second;  ///< rad, of the normal about `point`, see DirectionFrame
  };
  struct Dial {
    std::string name = "dial1";
    SetupPoint position;  ///< mm, tip at the indication zero, frame of carriage_body; tool: from the gauge point
    /// In which the plunger is pushed in (positive indication), from the face to the dial; frame of carriage_body.
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    SetupNumber zero;      ///< mm, added to the indication
    std::size_t face = 0;  ///< index into faces
  };
  /// Dials that are read together. One dial on two faces one after the other is two arrangements of one dial.
  struct Arrangement {
    std::string name = "carriage1";
    std::vector<Dial> dials;  ///< 1 to 6, as many in every arrangement
  };
  std::string name = "dials1";
  Body carriage_body = Body::tool;
  Body face_body = Body::workpiece;
  std::vector<Face> faces;
  std::vector<Arrangement> arrangements;
  double noise = 0.5e-3;  ///< mm, standard uncertainty of one indication
  double flatness = 0;    ///< mm, standard uncertainty of the height of a place of a face
};

/// Indications of dials: how far the plunger is pushed in where its line meets the face.
///
/// With (R, t) the carriage's body seen from the faces', tip P = R a + t, plunger direction D = R d, and the face
/// through q + offset n0 with the tilted normal n:
///
///     indication = n . (q + offset n0 - P) / (n . D) + zero
///
/// exactly, so a tilted face shifts the place that is touched. A ball tip has P in its centre and its radius in `zero`
/// (as long as the faces are flat and the tilts small: 1 - cos(tilt) of the radius).
/// Flatness enters as an independent normal deviation per reading, sqrt(noise^2 + flatness^2). That is right for a grid
/// of different places; readings repeated at one place share it, and averaging does not help there.
/// Cannot be told apart: a dial's zero and the offset of its face (several dials on one face: but for a common part);
/// the tilts of a face from the straightness slope of the axis, that is its parallelism or squareness, unless two faces
/// of a calibrated square or the other axes hold them: state a face's tilt `within` if its alignment is known; pitch
/// and yaw from straightness with one dial per carriage position. Items: the arrangements. Components: the dials, named
/// as in the first arrangement (mm). Source: ISO 230-1:2012, 8 (straightness), 10 (squareness), annex C; Wang et al.,
/// Int. J. Mach. Tools Manuf. 2020, for grids and carriages.
class DialIndicators : public EquationInstrument<DialIndicators, 42, 6> {
 public:
  /// @throws std::invalid_argument no face, no arrangement, different or wrong numbers of dials, a direction or normal
  /// without length, a dial without a face
  explicit DialIndicators(const DialIndicatorsSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// Tip of the first dial and the nominal point of its face.
  std::optional<MeetingPoints> meeting_points(std::size_t item) const override;
  /// The faces.
  std::vector<InstrumentPlace> places() const override;
  PoseFreedom pose_freedom() const override { return PoseFreedom::along_line; }

  template <typename S>
  void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  struct Touch {
    Eigen::Vector3d direction, point;
    DirectionFrame normal;
    std::size_t face;  ///< place of the face's three quantities among the item's
  };
  std::vector<std::vector<Touch>> touches_;  ///< [items][dials]
  double noise_;
};

}  // namespace abbe
