#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Corrections of axes on a grid of the commands of axes, linear in each between its nodes (multilinear).
struct CorrectionLattice {
  std::vector<std::size_t> inputs;             ///< axes whose commands are looked up, each once
  std::vector<std::vector<double>> positions;  ///< [inputs][nodes] increasing, mm or rad, at least one
  std::vector<bool> modulo;          ///< [inputs] repeats itself after its last node; else the end values hold
  std::vector<std::size_t> outputs;  ///< axes that are corrected, each once
  /// [outputs][count()] added to the command, mm or rad; the first input varies fastest.
  std::vector<std::vector<double>> corrections;
  bool operator==(const CorrectionLattice&) const = default;

  std::size_t count() const {
    std::size_t product = 1;
    for (const std::vector<double>& nodes : positions) product *= nodes.size();
    return product;
  }
};

class LatticeCorrection final : public CommandCorrection {
 public:
  explicit LatticeCorrection(CorrectionLattice lattice) : lattice_(std::move(lattice)) {}
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  CorrectionLattice lattice_;
};

struct LatticeOptions {
  std::vector<std::size_t> inputs;   ///< axes of the grid
  std::vector<std::size_t> outputs;  ///< axes that are corrected
  std::vector<double> reference;     ///< [axes] where all other axes stand; mm or rad
  double tolerance_mm = 1e-4;        ///< of the interpolation
  double tolerance_rad = 1e-7;
  std::size_t most_nodes = 2'000'000;   ///< in all
  std::size_t most_per_axis = 100'000;  ///< along one input
};

/// The limit of an arbitrarily fine lattice: PointCorrection of the chosen axes, with all axes that are not inputs at
/// the reference.
class LatticeFunction final : public CommandCorrection {
 public:
  LatticeFunction(const Machine& machine, const ErrorSet& errors, LatticeOptions options);
  ~LatticeFunction() override;
  void evaluate(const PoseList& commands, PoseList& correction) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

struct BuiltLattice {
  CorrectionLattice lattice;
  std::vector<double> interpolation_error;  ///< [outputs] largest found, mm or rad
  bool within = true;
};

/// Evenly spaced nodes along every input, from end to end of its known travel, with which straight lines keep within
/// the tolerance; fewer where there is no room for them.
///
/// The error of multilinear interpolation is at most the sum of those along each input, so nodes along one input are
/// chosen for an equal share of the tolerance, on the lines through the corners and the middle of the others' travel.
/// Source: tensor product interpolation, de Boor, A Practical Guide to Splines, ch. XVII.
std::vector<std::vector<double>> lattice_nodes(const Machine& machine, const ErrorSet& errors,
                                               const LatticeOptions& options);
/// The same for another function of the inputs, which gives the corrections of the outputs.
std::vector<std::vector<double>> lattice_nodes(const Machine& machine, const ErrorSet& errors,
                                               const LatticeOptions& options, const CommandCorrection& function);

/// Lattice over these nodes, [inputs][nodes]. Its interpolation error is the largest found at 4000 places between them,
/// half of which are the middles of cells.
BuiltLattice lattice_over(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options,
                          std::vector<std::vector<double>> positions);
/// The same for another function of the inputs.
BuiltLattice lattice_over(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options,
                          std::vector<std::vector<double>> positions, const CommandCorrection& function);

/// lattice_over() lattice_nodes().
BuiltLattice build_lattice(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options);

}  // namespace abbe
