#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// How many of the errors that move the tool of a machine against its workpiece an errors file states.
///
/// A volumetric error that is computed from a part of them is that part's, however small its uncertainty is.
struct PartialErrors {
  std::size_t known = 0;             ///< error motions and location errors of the file, zero positions not counted
  std::vector<std::string> missing;  ///< names of the others: unmodelled_errors(); taken as zero
  StateValues at_state{};            ///< as ErrorsFile::at_state

  bool is_partial() const { return !missing.empty(); }
  std::size_t all() const { return known + missing.size(); }
  /// "3 of the 36 errors"
  std::string short_words() const;
  /// The first few of what is missing, and how many more.
  std::string missing_names() const;
  /// A sentence that names what is missing.
  std::string caution() const;
};

/// Number of error motions and location errors of a set, zero positions not counted.
std::size_t known_error_count(const Machine& machine, const ErrorSet& errors);

/// Nothing is missing in the truth of a simulation: what it does not state is zero.
PartialErrors partial_errors(const Machine& machine, const ErrorsFile& file);

/// Adds at_state; also errors_known, errors_of_machine, not_known and caution, if some are missing.
void add_partial_errors(const PartialErrors& errors, nlohmann::ordered_json& json);

}  // namespace abbe
