#pragma once

#include <string>
#include <vector>

#include "abbe/machine/test_piece.h"
#include "bindings/use/arguments.h"

namespace abbe::python {

/// A curve with the names of its axes, so that it belongs to no machine.
struct NamedCurve {
  Curve curve;
  std::vector<std::string> indexed;  ///< names of Curve::indexed
  std::string file;                  ///< name for messages
};

/// The curve on a machine. @throws KeyError of Python for an axis that it does not have
Curve curve_on(const NamedCurve& curve, const Machine& machine);

}  // namespace abbe::python
