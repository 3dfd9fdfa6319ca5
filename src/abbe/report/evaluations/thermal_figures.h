#pragma once

// Internal to report: what the reports on thermal tests have in common.
#include <string>
#include <vector>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/thermal/first_order_response.h"
#include "abbe/verify/thermal/thermal_sensor.h"

namespace abbe {

/// A range of a displacement in um or of an angle in urad. @param about  the sensor
EvaluationFigure thermal_figure(const std::string& symbol, const std::string& name, const ThermalFigure& figure,
                                bool is_angle, const std::string& about);

/// A time constant in min.
EvaluationFigure time_constant_figure(const std::string& symbol, const std::string& name,
                                      const FirstOrderResponse& response, const std::string& about);

/// Why there is no time constant; empty: there is one.
std::string response_words(ResponseStatus status);

/// um per mm, or urad per rad.
double micro_factor(bool is_angle);
/// "12.3 um", "12.3 urad" for people.
std::string thermal_value_words(double value, bool is_angle);
/// "2 h 30 min".
std::string duration_words(double seconds);

nlohmann::ordered_json response_json(const FirstOrderResponse& response, bool is_angle);

/// Notes on the stated uncertainties, on tilts that are not known, and on readings that are far apart.
/// @param is_stated  an uncertainty of the readings was stated
void add_thermal_notes(bool is_stated, bool lacks_distance, const std::vector<const TimeSeries*>& series,
                       EvaluationReport& report);

}  // namespace abbe
