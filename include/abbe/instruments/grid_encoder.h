#pragma once

#include <string>
#include <vector>

#include "abbe/instruments/equation_instrument.h"

namespace abbe {

/// A plate with a two-dimensional grid on one body and a head (or a camera) on another, which reads where it is above
/// the grid.
struct GridEncoderSetup {
  /// A place at which the grid is put.
  struct Placement {
    std::string name = "grid1";
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mm, about where the grid reads zero; frame of grid_body
    SetupNumber shift_x = SetupNumber::open(0), shift_y = SetupNumber::open(0);  ///< mm, of that place along u and v
    SetupPoint angles;  ///< rad, a, b, c of Rz(c) Ry(b) Rx(a): the plate's u, v, w in the frame of grid_body
  };
  std::string name = "grid";
  Body head_body = Body::tool;
  Body grid_body = Body::workpiece;
  SetupPoint head;  ///< mm, point of the head that is read; frame of head_body, tool: from the gauge point
  std::vector<Placement> placements;  ///< at least one
  SetupNumber scale_x, scale_y;       ///< read / true - 1 along each axis of the grid (pure numbers)
  SetupNumber squareness;             ///< rad, angle between the grid's axes x and y minus 90 degrees
  double noise = 0.1e-3;              ///< mm, standard uncertainty of one coordinate
  double noise_per_length = 0;        ///< further part, mm per mm of the coordinate
};

/// Position of a head above a two-dimensional grid.
///
/// With (R, t) the head's body seen from the grid's body, H = R h + t, and the plate through P with axes u, v, w (w out
/// of the surface), the grid's x axis along u and its y axis at 90 degrees + k from it:
///
///     p = u . (H - P) - d_x,  q = v . (H - P) - d_y      d: shift of the zero in the plane of the grid
///     y = (1 + s_y) q / cos k,   x = (1 + s_x) (p + q tan k)
///
/// The distance from the plate does not enter: a head reads along the plate's normal. Items: the placements.
/// Components: x, y (mm). Quantities: NAME.scale_x, .scale_y, .squareness, NAME.head.x .., PLACEMENT.shift_x,
/// .shift_y, .a, .b, .c. One placement cannot tell the grid's scales and squareness from those of the machine; turned
/// by 90 degrees it tells the difference of the scales, and the squareness. Source: the affine part of a
/// two-dimensional grid in self-calibration, Ye et al., Precision Engineering 20 (1997) 16; derivation in
/// docs/grid-encoder.md.
class GridEncoder : public EquationInstrument<GridEncoder, 11, 2> {
 public:
  /// @throws std::invalid_argument: no placement, head and grid on one body, noise not above zero
  explicit GridEncoder(const GridEncoderSetup& setup);

  double standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                              std::size_t component) const override;
  /// The head over the plate at a constant distance.
  PoseFreedom pose_freedom() const override { return PoseFreedom::along_line; }
  bool may_miss() const override { return false; }
  std::vector<InstrumentPlace> places() const override;

  template <typename S>
  void equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*, S* reading) const;

 private:
  /// Order of the quantities of an item.
  enum Place { kHead = 0, kShift = 3, kAngles = 5, kScaleX = 8, kScaleY = 9, kSquareness = 10 };
  std::vector<Eigen::Vector3d> position_;  ///< [items]
  double noise_, noise_per_length_;
};

}  // namespace abbe
