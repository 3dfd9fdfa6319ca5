#include "abbe/instruments/polygon/polygon_campaign.h"

#include <fmt/format.h>

#include <cassert>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

using Eigen::Index;
using enum PolygonReading;

constexpr const char* kMotionNames[] = {"EAC", "EBC", "ECC", "EXC", "EYC", "EZC"};
constexpr const char* kMountNames[] = {"tilt_x", "tilt_y", "turn", "x", "y", "z"};
constexpr const char* kFaceNames[] = {"azimuth_error", "tilt", "distance"};

Index index(std::size_t value) { return static_cast<Index>(value); }

template <typename Six>
void put_six(const Six& six, Eigen::VectorXd& values, Index first) {
  values.segment<3>(first) = six.angles;
  values.segment<3>(first + 3) = [&] {
    if constexpr (requires { six.offset; }) {
      return six.offset;
    } else {
      return six.displacement;
    }
  }();
}

double standard_uncertainty(PolygonReading reading, const PolygonNoise& noise) {
  return is_angle(reading) ? noise.angle : noise.length;
}

}  // namespace

PolygonCampaign regular_campaign(std::size_t faces, double distance, double height,
                                 const std::vector<std::size_t>& shifts) {
  if (shifts.empty()) throw std::invalid_argument("polygon campaign: expected at least one mount");
  PolygonCampaign campaign;
  campaign.polygon = regular_polygon(faces, distance, height);
  campaign.face_distance = distance;
  campaign.motions.resize(faces);
  campaign.shifts = shifts;
  for (const std::size_t shift : shifts) {
    regular_position(faces, 0, shift);  // a number of faces that will not do is refused here
    PolygonMount mount;
    mount.turn = 2 * std::numbers::pi * static_cast<double>(shift) / static_cast<double>(faces);
    campaign.mounts.push_back(mount);
  }
  campaign.measured = {autocollimator_x_about_z, autocollimator_x_about_y, autocollimator_y_about_x,
                       displacement_x,           displacement_y,           displacement_z};
  for (PolygonSensor* sensor : {&campaign.bench.autocollimator_x, &campaign.bench.autocollimator_y,
                                &campaign.bench.displacement_x, &campaign.bench.displacement_y}) {
    sensor->position *= 0.5 + distance / 96.6;  // stand off as the paper's do
    sensor->position.z() = height / 2;
  }
  campaign.bench.displacement_z.position.z() = 83 + height;
  return campaign;
}

PolygonColumns polygon_columns(const PolygonCampaign& campaign) {
  PolygonColumns columns{};
  columns.mounts = 6 * index(campaign.steps());
  columns.faces = columns.mounts + 6 * index(campaign.mounts.size());
  columns.top = columns.faces + 3 * index(campaign.polygon.faces.size());
  columns.zeros = columns.top + 2;
  columns.count = columns.zeros + index(campaign.measured.size());
  return columns;
}

std::vector<PolygonUnknown> polygon_unknowns(const PolygonCampaign& campaign) {
  std::vector<PolygonUnknown> unknowns;
  const double turn = 360.0 / static_cast<double>(campaign.polygon.faces.size());
  for (std::size_t k = 0; k < campaign.steps(); ++k)
    for (std::size_t i = 0; i < 6; ++i) {
      unknowns.push_back({fmt::format("{}[{:g} deg]", kMotionNames[i], turn * static_cast<double>(k)), i < 3});
    }
  for (std::size_t m = 0; m < campaign.mounts.size(); ++m)
    for (std::size_t i = 0; i < 6; ++i) unknowns.push_back({fmt::format("mount{}.{}", m + 1, kMountNames[i]), i < 3});
  for (std::size_t j = 0; j < campaign.polygon.faces.size(); ++j)
    for (std::size_t i = 0; i < 3; ++i) unknowns.push_back({fmt::format("face{}.{}", j + 1, kFaceNames[i]), i < 2});
  unknowns.push_back({"top.tilt_x", true});
  unknowns.push_back({"top.tilt_y", true});
  for (const PolygonReading reading : campaign.measured) {
    unknowns.push_back({std::string("zero.") + reading_name(reading), is_angle(reading)});
  }
  return unknowns;
}

Eigen::VectorXd unknown_values(const PolygonCampaign& campaign) {
  const PolygonColumns columns = polygon_columns(campaign);
  Eigen::VectorXd values(columns.count);
  for (std::size_t k = 0; k < campaign.steps(); ++k) put_six(campaign.motions[k], values, 6 * index(k));
  for (std::size_t m = 0; m < campaign.mounts.size(); ++m) {
    put_six(campaign.mounts[m], values, columns.mounts + 6 * index(m));
  }
  for (std::size_t j = 0; j < campaign.polygon.faces.size(); ++j) {
    const PolygonFace& face = campaign.polygon.faces[j];
    values.segment<3>(columns.faces + 3 * index(j)) << face.azimuth_error, face.tilt,
        face.distance - campaign.face_distance;
  }
  values.segment<2>(columns.top) << campaign.polygon.top.tilt_x, campaign.polygon.top.tilt_y;
  for (std::size_t i = 0; i < campaign.measured.size(); ++i) {
    values[columns.zeros + index(i)] = campaign.zeros[static_cast<std::size_t>(campaign.measured[i])];
  }
  return values;
}

PolygonCampaign with_values(PolygonCampaign campaign, const Eigen::VectorXd& values) {
  const PolygonColumns columns = polygon_columns(campaign);
  assert(values.size() == columns.count);
  for (std::size_t k = 0; k < campaign.steps(); ++k) {
    campaign.motions[k].angles = values.segment<3>(6 * index(k));
    campaign.motions[k].displacement = values.segment<3>(6 * index(k) + 3);
  }
  for (std::size_t m = 0; m < campaign.mounts.size(); ++m) {
    campaign.mounts[m].angles = values.segment<3>(columns.mounts + 6 * index(m));
    campaign.mounts[m].offset = values.segment<3>(columns.mounts + 6 * index(m) + 3);
  }
  for (std::size_t j = 0; j < campaign.polygon.faces.size(); ++j) {
    PolygonFace& face = campaign.polygon.faces[j];
    const Index first = columns.faces + 3 * index(j);
    face.azimuth_error = values[first];
    face.tilt = values[first + 1];
    face.distance = campaign.face_distance + values[first + 2];
  }
  campaign.polygon.top.tilt_x = values[columns.top];
  campaign.polygon.top.tilt_y = values[columns.top + 1];
  for (std::size_t i = 0; i < campaign.measured.size(); ++i) {
    campaign.zeros[static_cast<std::size_t>(campaign.measured[i])] = values[columns.zeros + index(i)];
  }
  return campaign;
}

Eigen::VectorXd campaign_readings(const PolygonCampaign& campaign, Eigen::MatrixXd* jacobian) {
  const PolygonColumns columns = polygon_columns(campaign);
  Eigen::VectorXd readings(index(campaign.reading_count()));
  if (jacobian) *jacobian = Eigen::MatrixXd::Zero(readings.size(), columns.count);
  Index row = 0;
  for (std::size_t m = 0; m < campaign.mounts.size(); ++m) {
    for (std::size_t k = 0; k < campaign.steps(); ++k) {
      const PolygonPosition position = campaign.position(k, m);
      for (std::size_t i = 0; i < campaign.measured.size(); ++i, ++row) {
        const PolygonReading reading = campaign.measured[i];
        PolygonGradient gradient;
        readings[row] = campaign.zeros[static_cast<std::size_t>(reading)] +
                        polygon_reading(reading, campaign.polygon, campaign.mounts[m], campaign.bench, position,
                                        campaign.motions[k], jacobian ? &gradient : nullptr);
        if (!jacobian) continue;
        using namespace polygon_column;
        jacobian->row(row).segment<6>(6 * index(k)) = gradient.segment<6>(motion).transpose();
        jacobian->row(row).segment<6>(columns.mounts + 6 * index(m)) = gradient.segment<6>(mount).transpose();
        const PolygonSide side = campaign.bench.sensor(reading).side;
        if (side == PolygonSide::z) {
          jacobian->row(row).segment<2>(columns.top) = gradient.segment<2>(face).transpose();
        } else {
          const std::size_t seen = side == PolygonSide::x ? position.face_x : position.face_y;
          jacobian->row(row).segment<3>(columns.faces + 3 * index(seen)) = gradient.segment<3>(face).transpose();
        }
        (*jacobian)(row, columns.zeros + index(i)) = 1;
      }
    }
  }
  return readings;
}

Eigen::VectorXd reading_uncertainties(const PolygonCampaign& campaign, const PolygonNoise& noise) {
  Eigen::VectorXd uncertainties(index(campaign.reading_count()));
  for (Index row = 0; row < uncertainties.size(); ++row) {
    const std::size_t i = static_cast<std::size_t>(row) % campaign.measured.size();
    uncertainties[row] = standard_uncertainty(campaign.measured[i], noise);
  }
  return uncertainties;
}

Eigen::VectorXd simulate_campaign(const PolygonCampaign& campaign, const PolygonNoise& noise, std::uint64_t seed) {
  Eigen::VectorXd readings = campaign_readings(campaign);
  const Eigen::VectorXd uncertainties = reading_uncertainties(campaign, noise);
  RandomStream random(seed);
  for (Index row = 0; row < readings.size(); ++row) readings[row] += uncertainties[row] * random.normal();
  return readings;
}

std::vector<PolygonReadings> stepwise_readings(const PolygonCampaign& campaign,
                                               const std::vector<std::vector<TableMotion>>& motions) {
  assert(motions.size() == 3 && campaign.mounts.size() == 1);
  constexpr PolygonReading kTaken[3][3] = {{autocollimator_x_about_z, autocollimator_x_about_y, displacement_y},
                                           {autocollimator_y_about_x, displacement_x, displacement_x},
                                           {displacement_z, displacement_z, displacement_z}};
  std::vector<PolygonReadings> readings(campaign.steps());
  for (std::size_t k = 0; k < campaign.steps(); ++k) {
    readings[k].fill(std::numeric_limits<double>::quiet_NaN());
    for (std::size_t setup = 0; setup < 3; ++setup) {
      for (const PolygonReading reading : kTaken[setup]) {
        const std::size_t i = static_cast<std::size_t>(reading);
        readings[k][i] =
            campaign.zeros[i] + polygon_reading(reading, campaign.polygon, campaign.mounts[0], campaign.bench,
                                                campaign.position(k, 0), motions[setup][k]);
      }
    }
  }
  return readings;
}

}  // namespace abbe
