#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Provenance "method" of errors that a simulation is about: what the file does not state is zero.
inline constexpr const char* kTruthOfSimulation = "truth of a simulation";

/// Columns of states and their values, in the order of the machine: {"ambient_degC", 26.5}.
struct StateValues : std::vector<std::pair<std::string, double>> {
  using std::vector<std::pair<std::string, double>>::vector;
  /// Values beyond what the readings covered, a sentence each: there the errors are extrapolated.
  std::vector<std::string> outside;
};

/// Values of a state over which errors were measured.
struct CoveredState {
  std::string column;       ///< "ambient_degC"
  double from = 0, to = 0;  ///< unit of the state
  bool contains(double value) const { return value >= from && value <= to; }
};

/// How errors wander after their measurement: every coefficient without a state by itself, as a random walk.
struct ErrorAgeing {
  double length = 0;  ///< mm/sqrt(s)
  double angle = 0;   ///< rad/sqrt(s)
  bool any() const { return length > 0 || angle > 0; }
};

/// Contents of a `*.errors.toml` file: errors, their covariance and where they come from.
struct ErrorsFile {
  ErrorSet errors;
  /// Covariance of ErrorSet::parameters(), [p, p], products of mm and rad; 0 x 0: not stated.
  Eigen::MatrixXd covariance;
  /// Free text about the origin, in order: {"method", "joint identification"}.
  std::vector<std::pair<std::string, std::string>> provenance;
  std::vector<std::string> distrusted{};  ///< why they must not be used as they are, a sentence each; empty: trusted
  bool misfit_accepted = false;           ///< somebody who knew these reasons wanted to use the errors nevertheless
  std::vector<std::string> warnings{};    ///< what else the identification had to say
  StateValues at_state{};                 ///< at which the errors are taken; empty: as the file has them
  std::vector<CoveredState> covered{};    ///< states over which the readings were taken; empty: not stated
  double covered_time_s = 0;              ///< from the first to the last reading; 0: not stated
  ErrorAgeing ageing{};
};

/// Refuses to correct with errors that are not to be trusted, unless their user knows it.
/// @param path  of their file, for messages
/// @throws InputError if they are marked as not to be trusted and neither the file nor the caller accepts that
void require_trusted(const ErrorsFile& file, const std::string& path, bool accept_misfit);

/// Whether these errors are said to be the truth of a simulation.
bool is_truth(const ErrorsFile& file);

/// The covariance of an errors file; without one that of the standard uncertainties it states, as if they were
/// independent; 0 x 0 if it states none.
Eigen::MatrixXd covariance_of(const ErrorsFile& file);

/// Whether a job can take errors that depend on states of the machine. Most cannot, and must not overlook them.
enum class StatesOfErrors { refused, allowed };

/// Reads the errors of a machine and the CSV files that the file names (beside it). Bases without from/to run over the
/// travel of their axis. @throws InputError, also for errors with states where they are refused
ErrorsFile read_errors(const std::filesystem::path& path, const Machine& machine,
                       StatesOfErrors states = StatesOfErrors::refused);
/// The same from text. @param path  name for messages; its folder is where other files are looked for
ErrorsFile parse_errors(const std::string& text, const std::filesystem::path& path, const Machine& machine,
                        StatesOfErrors states = StatesOfErrors::refused);

/// States that a job takes into account by itself.
enum class UsableStates {
  none,
  of_commands,  ///< those that follow from the commands at a pose: of the kinds axis and gravity, and products of these
  of_motions    ///< these, sides of approach, and products of any of them
};

/// Refuses errors that depend on other states, in a job that cannot take them into account.
/// @param job  "a correction table". @throws InputError naming the first such error
void refuse_states(const Machine& machine, const ErrorSet& errors, const std::string& job,
                   UsableStates usable = UsableStates::none);

/// Text of an errors file; reading it back gives the same bits.
/// @param covariance_file  name of the CSV with the covariance, beside the file; empty: none
std::string errors_text(const Machine& machine, const ErrorsFile& contents, const std::string& covariance_file = "");

/// Covariance as CSV: columns `parameter`, `unit`, then one column per parameter; entry in the product of both units
/// (um, urad).
std::string covariance_text(const Machine& machine, const ErrorsFile& contents);

/// Where the covariance of an errors file is written: "x.errors.toml" -> "x.covariance.csv" beside it.
std::filesystem::path covariance_beside(const std::filesystem::path& path);

/// Writes `path` and, if there is a covariance, covariance_beside(), each atomically.
void write_errors(const std::filesystem::path& path, const Machine& machine, const ErrorsFile& contents);

}  // namespace abbe
