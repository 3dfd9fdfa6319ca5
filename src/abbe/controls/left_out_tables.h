#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/compensate/program/command_correction.h"
#include "abbe/controls/table_format.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// A table that is small against its uncertainty in all its places.
struct SmallTable {
  std::string name;
  double times = 0;  ///< largest correction in standard uncertainties

  std::string text() const;  ///< "X: at most 1.2 times its standard uncertainty"
};

/// Largest standard uncertainty of every table, mm or rad, and the tables that are nowhere `times` of it or more.
std::vector<double> table_uncertainties(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                        const std::vector<WrittenTable>& tables, double times,
                                        std::vector<SmallTable>& small);

/// What tables do together, against the uncertainty of the whole correction of the functional point.
///
/// Tables that are small one by one need not be so together: errors that hang together (correlations) may be well known
/// in their sum.
class TablesTogether {
 public:
  /// @param covariance  [p, p] of ErrorSet::parameters()
  /// @param all         correction with all tables
  TablesTogether(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                 const PoseList& poses, const CommandCorrection& all);

  /// Whether what is missing against all tables shifts the point by less than `times` the standard uncertainty, in
  /// that direction, of the whole correction, at every pose.
  bool is_small(const CommandCorrection& without, double times) const;

 private:
  struct Place {
    Eigen::Matrix3Xd by_parameters, by_positions;
  };
  const Eigen::MatrixXd& covariance_;
  const PoseList& poses_;
  std::vector<Place> places_;  ///< [poses]
  PoseList all_;               ///< corrections
};

/// Tables again without those that are small by themselves and together: while they are not, the one that is largest
/// against its uncertainty goes back.
/// @param tables    made with nothing left out; becomes those that are to be written
/// @param left_out  in: the small ones; out: those that are left out
/// @returns those that went back
std::vector<SmallTable> leave_out_tables(const Machine& machine, const ErrorSet& errors,
                                         const Eigen::MatrixXd& covariance, const PoseList& poses,
                                         const TableFormat& format, WriterRequest& request, double times,
                                         WrittenTables& tables, std::vector<SmallTable>& left_out);

}  // namespace abbe
