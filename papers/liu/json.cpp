#include <nlohmann/json.hpp>

#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/geometry/angle_units.h"
#include "liu/results.h"

namespace abbe {
namespace {

nlohmann::ordered_json deviation_json(const LiuDeviation& d) {
  nlohmann::ordered_json json = {
      {"registered", d.registered}, {"points", d.points}, {"rms_um", 1e3 * d.rms}, {"largest_um", 1e3 * d.largest}};
  if (d.fitted_radius > 0) json["fitted_radius_mm"] = d.fitted_radius;
  return json;
}

nlohmann::ordered_json measurement_json(const LiuMeasurement& m) {
  return {{"part", m.part},
          {"planned", m.planned},
          {"lost", m.lost},
          {"too_steep", m.too_steep},
          {"before", deviation_json(m.before)},
          {"after", deviation_json(m.after)}};
}

nlohmann::ordered_json calibration_json(const LiuCalibration& c) {
  return {{"A_direction_arcsec", c.direction[0] / kArcsec},
          {"A_distance_um", 1e3 * c.distance[0]},
          {"C_direction_arcsec", c.direction[1] / kArcsec},
          {"C_distance_um", 1e3 * c.distance[1]}};
}

nlohmann::ordered_json plan_json(const Machine& machine, const LiuMeasuredPart& part) {
  nlohmann::ordered_json json = scan_plan_summary(machine, part.plan, part.model.name);
  for (const char* name : {"part", "machine"}) json.erase(name);
  return json;
}

}  // namespace

nlohmann::ordered_json liu_details(const LiuResults& r) {
  nlohmann::ordered_json json;
  json["reference_difference_mm"] = {
      {"nominal", r.reference[0]}, {"table_3_mm", r.reference[1]}, {"table_3_um", r.reference[2]}};
  json["recursion_difference_mm"] = {{"as_worded", r.recursion[0]}, {"corrected", r.recursion[1]}};
  json["table_1"] = nlohmann::ordered_json::array();
  for (const LiuGroup& group : r.sensitivity.groups) {
    json["table_1"].push_back({{"group", group.name},
                               {"paper_percent", group.paper},
                               {"stated_ranges_percent", group.stated},
                               {"stated_ranges_registered_percent", group.stated_remaining},
                               {"table_3_percent", group.as_found},
                               {"table_3_registered_percent", group.as_found_remaining}});
  }
  json["terms"] = nlohmann::ordered_json::array();
  for (const LiuTerm& term : r.sensitivity.terms) {
    const std::string unit = term.is_angle ? "um_per_mrad" : "um_per_um";
    json["terms"].push_back(
        {{"term", term.name}, {"across_" + unit, term.across}, {"registered_" + unit, term.remaining}});
  }
  for (const LiuUnitResults& results : r.units) {
    nlohmann::ordered_json& unit = json[std::string("table_3_in_") + liu_unit_name(results.unit)];
    unit["calibration"] = calibration_json(results.calibration);
    for (const LiuMeasuredPart& measured : results.parts) {
      nlohmann::ordered_json part = measurement_json(measured.measurement);
      part["plan"] = plan_json(r.machine, measured);
      if (measured.paper_before > 0) part["paper_before_um"] = measured.paper_before;
      if (measured.paper_after > 0) part["paper_after_um"] = measured.paper_after;
      unit["parts"].push_back(part);
    }
  }
  for (const LiuVariant& v : r.variants) {
    nlohmann::ordered_json entry = {{"calibration_with", v.words}, {"calibration", calibration_json(v.calibration)}};
    entry["cylinder"] = measurement_json(v.cylinder);
    for (const LiuMeasurement& sphere : v.spheres) entry["spheres"].push_back(measurement_json(sphere));
    json["variants"].push_back(entry);
  }
  return json;
}

}  // namespace abbe
