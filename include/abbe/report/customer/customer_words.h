#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/study/report_facts.h"

namespace abbe {

/// Texts of a customer report. Some have places "{}" for what they are about.
enum class CustomerWord {
  report,       ///< heading of every report
  linear_axis,  ///< what was tested
  rotary_axis,
  diagonals,
  geometry,
  report_number,
  customer,
  machine,
  serial_number,
  place,
  operator_name,
  date,
  temperature,
  temperature_mean,   ///< {} degC
  temperature_range,  ///< {} to {} degC
  standard,
  remarks,
  not_stated,
  instruments,
  instrument,
  certificate,
  valid_until,
  certificate_not_valid,  ///< {}: name of the instrument
  verdict,                ///< heading
  conformity_proven,      ///< {}: symbols of figures, in this and the next two
  nonconformity_proven,
  not_proven,
  no_verdict,  ///< {}: reason
  short_conformity_proven,
  short_nonconformity_proven,
  short_not_proven,
  short_no_verdict,
  without_tolerance,    ///< a reason, like those that follow
  without_uncertainty,  ///< {}: symbols
  without_value,        ///< {}: symbols
  without_measurement,  ///< of a prediction
  without_simulation,   ///< of a simulated machine
  without_trust,        ///< of a result that must not be used
  only_identified,      ///< {}: symbols
  decision_rule,
  figures,
  symbol,
  figure,
  tolerance,
  before,
  after,
  measured,
  predicted_after,
  uncertainty_note,
  predicted_note,
  range_note,
  convention_note,
  target_errors,  ///< caption of a table
  axis_errors,    ///< {}: name of the axis
  position,
  target,
  diagonal,
  mean_positive,
  mean_negative,
  scatter_positive,
  scatter_negative,
  reversal,
  mean_both,
  deviation,
  positive_approach,
  negative_approach,
  mean_with_scatter,
  there,
  back,
  drawing_linear,  ///< errors along the linear axes
  drawing_rotary,
  must_not_be_used,
  out_of_tolerance,
  simulated,
  few_runs,     ///< {}: fewest
  uneven_runs,  ///< {}: fewest, {}: most
  few_targets,  ///< {}: wanted, {}: travel, {}: found
  equal_spacing,
  no_readings,  ///< why a figure is not evaluated, like those that follow
  needs_two_runs,
  needs_both_directions,
  needs_this_direction,
  needs_two_positions,
  notes,
  notes_in_english,
  signatures,
  tested_by,
  accepted_by,
  place_and_date,
  name,
  signature,
  produced_by,  ///< {}: name and version of the program
  files,
  positioning_motion,
  straightness_motion,  ///< {}: direction
  angular_motion,       ///< {}: direction
  radial_motion,        ///< {}: direction
  axial_motion,
  tilt_motion,  ///< {}: direction
  rotary_positioning_motion,
  other_motion,
  orientation,  ///< {}: axis, {}: direction
  offset,       ///< {}: axis, {}: direction
  reversal_value,
  volumetric_mean,
  volumetric_largest,
  circular_test,  ///< what was tested, like those that follow
  rotation_motions,
  straightness_test,
  squareness_test,
  contour_test,
  linkage_test,
  etve_test,
  spindle_distortion_test,
  axis_distortion_test,
  location_distortion_test,
  clockwise,
  counterclockwise,
  angle,
  radial_deviation,
  radial_near_angles,     ///< caption of a table, of the readings nearest to angles
  synchronous_at_angles,  ///< caption of a table
  synchronous,
  total,
  line_deviations,  ///< caption of a table; {}: name of the line, or empty
  from_least_squares,
  from_minimum_zone,
  section,
  section_errors,  ///< caption of a table
  contour_error,
  rounding,
  along,         ///< where on a curve
  point_errors,  ///< caption of a table
  across,
  out_of_surface,
  distance,
  plane_fact,  ///< a condition, like those that follow; {}: text
  radius_fact,
  centre_fact,
  turns_fact,
  length_fact,
  reading_count_fact,
  centre_least_squares,
  centre_minimum_zone,
  centre_instrument,
  time,
  displacement,
  changes_over_time,  ///< caption of a table
  stop,               ///< of a spindle
  heating_stop,
  first_order,    ///< response
  duration_fact,  ///< a condition, like those that follow; {}: text
  rotation_fact,
  heating_fact,
  cycles_fact,
  cooling_fact,
  targets_fact,
  count_  ///< number of words
};

/// A text in a language; never empty.
std::string_view customer_word(CustomerWord word, ReportLanguage language);

/// The same with its places filled, in their order. @param places  as many texts as it has places
std::string customer_text(CustomerWord word, ReportLanguage language, const std::vector<std::string>& places);
std::string customer_text(CustomerWord word, ReportLanguage language, const std::string& place);

/// Name of a figure of ISO 230-2 or ISO 230-6 by its symbol ("A", "R+", "E_d"): as the national editions of the
/// standard call it. Empty for another symbol.
std::string_view positioning_figure_name(std::string_view symbol, ReportLanguage language);

}  // namespace abbe
