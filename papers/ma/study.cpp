#include "ma/study.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/vector_json.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/polygon/polygon_trace.h"
#include "shared_file.h"

namespace abbe {
namespace {

void place(const nlohmann::json& json, const char* position, const char* name, PolygonSensor& sensor) {
  sensor.position = vector_of(json.at(position));
  sensor.angles = vector_of(json.at("sang").at(name));
  sensor.exit = vector_of(json.at("src").at(name));
}

MaExample example_of(const nlohmann::json& json, PolygonFaceOrder order) {
  MaExample example;
  example.polygon.order = order;
  example.polygon.top = {json.at("exb").get<double>(), json.at("eyb").get<double>(), json.at("Hb").get<double>()};
  example.mount.angles = {json.at("bc").at(0).get<double>(), json.at("bc").at(1).get<double>(), 0};
  example.mount.offset = vector_of(json.at("bc"), 2);
  place(json, "P", "AC1", example.bench.autocollimator_x);
  place(json, "Q", "AC2", example.bench.autocollimator_y);
  place(json, "K", "L1", example.bench.displacement_x);
  place(json, "U", "L2", example.bench.displacement_y);
  place(json, "V", "L3", example.bench.displacement_z);
  const double distance = json.at("d").get<double>(), eps_px = json.at("epx").get<double>(),
               eps_py = json.at("epy").get<double>();
  const std::size_t count = json.at("epz").size();
  for (const bool along_y : {false, true}) {
    for (std::size_t k = 0; k < count; ++k) {
      const double azimuth = (along_y ? kTurn / 4 : 0) - kTurn * static_cast<double>(k) / 12;
      example.polygon.faces.push_back(
          {azimuth, -json.at("epz").at(k).get<double>(), along_y ? eps_px : -eps_py, distance});
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    example.positions.push_back({kTurn * static_cast<double>(k) / 12, k, count + k});
    const nlohmann::json& motion = json.at("motion_exyz_rad_dxyz_mm").at(k);
    example.motions.push_back({vector_of(motion), vector_of(motion, 3)});
  }
  return example;
}

SixMotions six_of(const TableMotion& motion) {
  SixMotions six;
  for (std::size_t i = 0; i < 3; ++i) {
    six[i] = motion.angles[static_cast<int>(i)];
    six[3 + i] = motion.displacement[static_cast<int>(i)];
  }
  return six;
}

void take_largest(const SixMotions& difference, SixMotions& largest) {
  for (std::size_t i = 0; i < 6; ++i) largest[i] = std::max(largest[i], std::abs(difference[i]));
}

}  // namespace

MaExample ma_example(PolygonFaceOrder order) {
  const std::filesystem::path path = shared_file("golden/ma/ma_sec33_params.json");
  std::ifstream file(path);
  try {
    return example_of(nlohmann::json::parse(file), order);
  } catch (const nlohmann::json::exception& error) {
    throw InputError({.file = path.string()}, error.what(), "the parameters of section 3.3");
  }
}

std::vector<PolygonReadings> read_ma_reference(PolygonFaceOrder order) {
  const std::filesystem::path path =
      shared_file(order == PolygonFaceOrder::face ? "golden/ma/ma_sec33_exactrot_faceorder.csv"
                                                  : "golden/ma/ma_sec33_exactrot_paperorder.csv");
  const CsvTable table = read_csv(read_text_file(path), path.string(),
                                  {{.base = "AC1z", .quantity = Quantity::angle},
                                   {.base = "AC1y", .quantity = Quantity::angle},
                                   {.base = "AC2x", .quantity = Quantity::angle},
                                   {.base = "AC2z", .quantity = Quantity::angle},
                                   {.base = "LDS1", .quantity = Quantity::length},
                                   {.base = "LDS2", .quantity = Quantity::length},
                                   {.base = "LDS3", .quantity = Quantity::length}},
                                  {.columns = {}, .ignore = {"k", "theta_deg"}});
  std::vector<PolygonReadings> readings(table.rows);
  for (std::size_t k = 0; k < table.rows; ++k)
    for (std::size_t i = 0; i < kPolygonReadings; ++i) readings[k][i] = table.columns[i].numbers[k];
  return readings;
}

ReadingDifference largest_difference(const std::vector<PolygonReadings>& a, const std::vector<PolygonReadings>& b) {
  ReadingDifference largest;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (std::size_t i = 0; i < kPolygonReadings; ++i) {
      double& of = is_angle(static_cast<PolygonReading>(i)) ? largest.angle : largest.length;
      of = std::max(of, std::abs(a[k][i] - b[k][i]));
    }
  return largest;
}

std::vector<PolygonReadings> ma_readings(const MaExample& example) {
  std::vector<PolygonReadings> readings;
  for (std::size_t k = 0; k < example.positions.size(); ++k) {
    readings.push_back(
        polygon_readings(example.polygon, example.mount, example.bench, example.positions[k], example.motions[k]));
  }
  return readings;
}

std::vector<PolygonReadings> ma_traced(const MaExample& example) {
  const std::size_t n = example.positions.size();
  std::vector<double> angle(n);
  std::vector<std::uint16_t> face_x(n), face_y(n);
  std::array<std::vector<double>, 6> motion;
  std::array<std::vector<double>, kPolygonReadings> traced;
  PolygonPositions positions{n, angle.data(), {}, face_x.data(), face_y.data()};
  PolygonTraces traces{};
  for (std::size_t i = 0; i < 6; ++i) {
    motion[i].resize(n);
    positions.motion[i] = motion[i].data();
  }
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    traced[i].resize(n);
    traces[i] = traced[i].data();
  }
  for (std::size_t k = 0; k < n; ++k) {
    angle[k] = example.positions[k].angle;
    face_x[k] = static_cast<std::uint16_t>(example.positions[k].face_x);
    face_y[k] = static_cast<std::uint16_t>(example.positions[k].face_y);
    for (std::size_t i = 0; i < 3; ++i) {
      motion[i][k] = example.motions[k].angles[static_cast<int>(i)];
      motion[3 + i][k] = example.motions[k].displacement[static_cast<int>(i)];
    }
  }
  PolygonTrace(example.polygon, example.mount, example.bench).trace(positions, traces);
  std::vector<PolygonReadings> readings(n);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < kPolygonReadings; ++i) readings[k][i] = traced[i][k];
  return readings;
}

MaInversions ma_inversions(const MaExample& example) {
  const std::vector<PolygonReadings> readings = ma_readings(example);
  MaInversions result;
  result.all_converged = true;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const auto miss = [&](const TableMotion& found) {
      return six_of({found.angles - example.motions[k].angles, found.displacement - example.motions[k].displacement});
    };
    const auto by_formula = [&](PolygonFormula formula) {
      return first_order_motion(formula, readings[k], readings[0], example.polygon, example.mount, example.bench,
                                example.positions[k], example.positions[0]);
    };
    result.printed_at.push_back(miss(by_formula(PolygonFormula::printed)));
    result.corrected_at.push_back(miss(by_formula(PolygonFormula::corrected)));
    take_largest(result.printed_at.back(), result.printed);
    take_largest(result.corrected_at.back(), result.corrected);
    for (const PolygonInversionOrder order : {PolygonInversionOrder::stepwise, PolygonInversionOrder::simultaneous}) {
      const PolygonInversion found = invert_polygon_readings(readings[k], example.polygon, example.mount, example.bench,
                                                             example.positions[k], order);
      result.all_converged = result.all_converged && found.status == PolygonInversionStatus::converged;
      take_largest(miss(found.motion),
                   order == PolygonInversionOrder::stepwise ? result.stepwise : result.simultaneous);
      if (order == PolygonInversionOrder::simultaneous) result.simultaneous_at.push_back(miss(found.motion));
    }
  }
  return result;
}

}  // namespace abbe
