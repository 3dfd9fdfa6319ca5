#pragma once

#include <memory>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Range over which a table can be computed: the travel of an axis (for an endless axis a whole turn from 0), as far as
/// its error motions cover it.
struct KnownTravel {
  double from = 0;  ///< mm or rad; equal to `to`: nothing of the travel is covered, or the axis does not move
  double to = 0;
  bool whole_turn = false;  ///< of an endless rotary axis, all of it known
  bool narrowed = false;    ///< the errors are not known over all of the travel
};
KnownTravel known_travel(const Machine& machine, const ErrorSet& errors, std::size_t axis);

/// The machine with 20 mm or 0.1 rad more travel at both ends: travel limits apply to commands, and the corrections
/// that a control adds afterwards may go beyond them.
Machine with_room_beyond_travel(Machine machine);

/// Correction of an axis for its own positioning error alone: the errors of its scale and of its zero along (about) its
/// own direction u.
///
/// The axis comes to s q at the command q + c, with s its sense, z its zero position error and e.u the component of its
/// error motion along (rotary: of its rotation vector about) u:
///     s (q + c + z) + e(q + c).u = s q
double own_correction(const Machine& machine, const ErrorSet& errors, std::size_t axis, double command);

/// What the linear axes have to add so that the functional point is where the nominal machine has it, exactly, with
/// rotary axes corrected by own_correction() and held there. The orientation is left as it then is. Fewer than three
/// linear axes correct as much of the shift as they can (least squares); more than three take the shortest way.
///
/// Travel limits do not count: a table may ask for a correction at the end of the travel.
class PointCorrection final : public CommandCorrection {
 public:
  PointCorrection(const Machine& machine, const ErrorSet& errors);
  ~PointCorrection() override;

  void evaluate(const PoseList& commands, PoseList& correction) const override;
  /// Whether rotary axes are corrected too: not by a control that corrects X, Y and Z only.
  void set_rotary_corrected(bool corrected);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
