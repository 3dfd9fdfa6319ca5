#include <algorithm>

#include "abbe/geometry/angle_units.h"
#include "ma/results.h"

namespace abbe {
namespace {

nlohmann::ordered_json motions_json(const SixMotions& in_unit) {
  return {{"eps_x_arcsec", in_unit[0]}, {"eps_y_arcsec", in_unit[1]}, {"eps_z_arcsec", in_unit[2]},
          {"delta_x_um", in_unit[3]},   {"delta_y_um", in_unit[4]},   {"delta_z_um", in_unit[5]}};
}

}  // namespace

nlohmann::ordered_json ma_details(const MaResults& r) {
  nlohmann::ordered_json json;
  const char* keys[] = {"paperorder", "faceorder"};
  for (std::size_t v = 0; v < 2; ++v) {
    json["reference_difference"][keys[v]] = {
        {"angle_arcsec", std::max(r.one_by_one[v].angle, r.traced[v].angle) / kArcsec},
        {"length_mm", std::max(r.one_by_one[v].length, r.traced[v].length)}};
    nlohmann::ordered_json& section = json["section_3_3"][keys[v]];
    section["printed"] = motions_json(in_ma_units(r.inversions[v].printed));
    section["corrected"] = motions_json(in_ma_units(r.inversions[v].corrected));
    section["exact_stepwise"] = motions_json(in_ma_units(r.inversions[v].stepwise));
    section["exact_simultaneous"] = motions_json(in_ma_units(r.inversions[v].simultaneous));
  }
  json["section_3_3"]["paper"] = motions_json(kMaPaper33);
  json["table_3"] = {{"paper_before", motions_json(kMaPaperBefore)},
                     {"paper_after", motions_json(kMaPaperAfter)},
                     {"before", motions_json(in_ma_units(r.table.before))},
                     {"after_trigonometric_fit", motions_json(in_ma_units(r.table.fitted))},
                     {"after_exact_inversion", motions_json(in_ma_units(r.table.inverted))},
                     {"truth", motions_json(in_ma_units(r.table.truth))},
                     {"motion_absorbed_by_the_fit", motions_json(in_ma_units(r.table.absorbed))}};
  json["rank"] = nlohmann::ordered_json::array();
  for (const MaRank& line : r.ranks) {
    json["rank"].push_back(
        {{"case", line.words}, {"unknowns", line.unknowns}, {"readings", line.readings}, {"rank", line.rank}});
  }
  nlohmann::ordered_json gauge = nlohmann::ordered_json::array();
  for (const PolygonGaugeEquation& equation : r.separation.gauge) gauge.push_back(equation.words);
  json["two_mounts"] = {{"gauge", gauge},
                        {"error", motions_json(in_ma_units(r.separation.error))},
                        {"error_without_noise", motions_json(in_ma_units(r.noise_free.error))},
                        {"standard_uncertainty", motions_json(in_ma_units(r.separation.uncertainty))},
                        {"one_mount_alone", motions_json(in_ma_units(r.separation.confused))},
                        {"face_azimuth_arcsec", r.separation.azimuth_error / kArcsec},
                        {"face_tilt_arcsec", r.separation.tilt_error / kArcsec},
                        {"face_distance_um", r.separation.distance_error / kMicrometre},
                        {"chi_square", r.separation.result.chi_square},
                        {"degrees_of_freedom", r.separation.result.degrees_of_freedom}};
  return json;
}

}  // namespace abbe
