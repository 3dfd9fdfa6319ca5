#pragma once

// Internal to formats: parameters of an NC program that are its state.
#include <string>
#include <string_view>

#include "abbe/formats/nc/nc_parameters.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/formats/nc/nc_state.h"

namespace abbe {

/// Takes the parameters with which a program begins: offsets and reference positions into the state, others into
/// `parameters`.
/// @param file  of the program, for messages
/// @throws InputError
void take_nc_parameters(const NcProgramOptions& options, const std::string& file, NcState& state,
                        NcParameters& parameters);

/// What parameters say about the state: #5161 ... reference positions, #5211 ... offsets, #5400 tool, #5420 ...
/// position, and names such as #<_x> and #<_metric>.
class NcSystemParameters final : public NcSystemValues {
 public:
  /// @param block      that runs
  /// @param in_inches  lengths of stored parameters, which are mm otherwise
  NcSystemParameters(const NcState& state, const NcBlock& block, bool in_inches)
      : state_(state), block_(block), length_(in_inches ? kInch : 1) {}

  bool numbered(int number, double& value) const override;
  bool named(std::string_view name, double& value) const override;

 private:
  bool offset(int number, double& value) const;

  const NcState& state_;
  const NcBlock& block_;
  double length_;  ///< mm of the unit of stored lengths
};

}  // namespace abbe
