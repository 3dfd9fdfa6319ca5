#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "ma/study.h"

namespace abbe {
namespace {

constexpr std::size_t kSteps = 12;

/// One motion over the turn, [steps].
using Course = std::array<double, kSteps>;
using Courses = std::array<Course, 6>;

double step_angle(std::size_t k) { return 2 * std::numbers::pi * static_cast<double>(k) / kSteps; }

/// Largest motion of the table after compensation (Table 3) and its repeatability (section 4), eps_x ... delta_z.
constexpr double kLargestMotion[6] = {15.93, 16.69, 27.38, 12.74, 11.12, 2.57};
constexpr double kRepeatability[6] = {0.87, 1.28, 15.13, 0.74, 0.87, 0.34};

double unit(std::size_t i) { return i < 3 ? kArcsec : kMicrometre; }

/// Motions with four harmonics, zero at the first position, as large as the paper's.
Courses table_motions(RandomStream& random) {
  Courses courses{};
  for (std::size_t i = 0; i < 6; ++i) {
    double largest = 0;
    double part[8];
    for (int h = 0; h < 8; ++h) {
      const int harmonic = 1 + h / 2;
      part[h] = random.normal() / harmonic;
    }
    for (std::size_t k = 0; k < kSteps; ++k) {
      for (int h = 0; h < 4; ++h) {
        const double angle = (h + 1) * step_angle(k);
        courses[i][k] += part[2 * h] * (std::cos(angle) - 1) + part[2 * h + 1] * std::sin(angle);
      }
      largest = std::max(largest, std::abs(courses[i][k]));
    }
    for (double& value : courses[i]) value *= kLargestMotion[i] * unit(i) / largest;
  }
  return courses;
}

std::vector<TableMotion> motions_of(const Courses& courses) {
  std::vector<TableMotion> motions(kSteps);
  for (std::size_t k = 0; k < kSteps; ++k) {
    motions[k].angles << courses[0][k], courses[1][k], courses[2][k];
    motions[k].displacement << courses[3][k], courses[4][k], courses[5][k];
  }
  return motions;
}

/// The table's motion in one run: it comes back to within its repeatability, except that a run starts at zero.
Courses repeated(const Courses& mean, RandomStream& random) {
  Courses courses = mean;
  for (std::size_t i = 0; i < 6; ++i) {
    // Over eleven positions the largest span of ten evenly distributed values nearly fills the width.
    const double half_width = kRepeatability[i] * unit(i);
    for (std::size_t k = 1; k < kSteps; ++k) courses[i][k] += random.uniform(-half_width, half_width);
  }
  return courses;
}

/// What is left of a course after fitting a constant, a cosine and a sine; `removed` gets what was taken away, both
/// counted from the first position.
Course without_first_harmonic(const Course& course, Course* removed = nullptr) {
  double mean = 0, cosine = 0, sine = 0;
  for (std::size_t k = 0; k < kSteps; ++k) {
    mean += course[k] / kSteps;
    cosine += course[k] * std::cos(step_angle(k)) * 2 / kSteps;
    sine += course[k] * std::sin(step_angle(k)) * 2 / kSteps;
  }
  Course left{};
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double fit = mean + cosine * std::cos(step_angle(k)) + sine * std::sin(step_angle(k));
    left[k] = course[k] - fit;
    if (removed) (*removed)[k] = fit;
  }
  return left;
}

/// Table 3 and section 4 over all runs.
struct Runs {
  std::vector<Courses> courses;

  void evaluate(SixMotions& largest, SixMotions& repeatability, MaCourses& at) const {
    at.mean.resize(kSteps);
    at.half_range.resize(kSteps);
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < kSteps; ++k) {
        double mean = 0, low = courses[0][i][k], high = low;
        for (const Courses& run : courses) {
          mean += run[i][k] / static_cast<double>(courses.size());
          low = std::min(low, run[i][k]);
          high = std::max(high, run[i][k]);
        }
        largest[i] = std::max(largest[i], std::abs(mean));
        repeatability[i] = std::max(repeatability[i], (high - low) / 2);
        at.mean[k][i] = mean;
        at.half_range[k][i] = (high - low) / 2;
      }
    }
  }
};

/// Prism and installation: a prism of grade 0 (1 arcsec, 5 arcsec, here also 1 um), mounted within some arcsec and um.
void prism_errors(PolygonCampaign& campaign, RandomStream& random) {
  for (PolygonFace& face : campaign.polygon.faces) {
    face.azimuth_error = random.uniform(-1, 1) * kArcsec;
    face.tilt = random.uniform(-5, 5) * kArcsec;
    face.distance = campaign.face_distance + random.uniform(-1, 1) * kMicrometre;
  }
  campaign.polygon.top.tilt_x = campaign.polygon.top.tilt_y = 4.13 * kArcsec;
}

Courses courses_of(const std::vector<PolygonReadings>& readings) {
  Courses courses{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < kSteps; ++k) {
      const std::size_t reading = static_cast<std::size_t>(kMaReadingOf[i]);
      courses[i][k] = readings[k][reading] - readings[0][reading];
    }
  return courses;
}

Courses inverted(const PolygonCampaign& campaign, const std::vector<PolygonReadings>& readings) {
  Courses courses{};
  for (std::size_t k = 0; k < kSteps; ++k) {
    const PolygonInversion found = invert_polygon_readings(readings[k], campaign.polygon, campaign.mounts[0],
                                                           campaign.bench, campaign.position(k, 0));
    for (std::size_t i = 0; i < 3; ++i) {
      courses[i][k] = found.motion.angles[static_cast<int>(i)];
      courses[3 + i][k] = found.motion.displacement[static_cast<int>(i)];
    }
  }
  return courses;
}

}  // namespace

PolygonCampaign ma_campaign(const std::vector<std::size_t>& shifts, std::uint64_t seed) {
  PolygonCampaign campaign = regular_campaign(12, 48.3, 17, shifts);
  RandomStream motions(seed, 1), prism(seed, 2), installation(seed, 3);
  campaign.motions = motions_of(table_motions(motions));
  prism_errors(campaign, prism);
  for (PolygonMount& mount : campaign.mounts) {
    for (int i = 0; i < 3; ++i) {
      mount.angles[i] = installation.uniform(-50, 50) * kArcsec;
      mount.offset[i] = installation.uniform(-10, 10) * kMicrometre;
    }
  }
  return campaign;
}

MaTable ma_table(std::size_t runs, std::uint64_t seed) {
  RandomStream random(seed);
  PolygonCampaign campaign = regular_campaign(12, 48.3, 17, {0});
  const Courses mean = table_motions(random);
  prism_errors(campaign, random);
  // As far from the axis and as oblique as Table 3 lets one conclude.
  campaign.mounts[0].angles << 7 * kArcsec, -6 * kArcsec, 0;
  campaign.mounts[0].offset << 18 * kMicrometre, -21 * kMicrometre, 10 * kMicrometre;
  for (PolygonSensor* sensor :
       {&campaign.bench.autocollimator_x, &campaign.bench.autocollimator_y, &campaign.bench.displacement_x,
        &campaign.bench.displacement_y, &campaign.bench.displacement_z}) {
    for (int i = 0; i < 3; ++i) sensor->angles[i] = random.uniform(-100, 100) * kArcsec;
  }
  // Half a digit of the instruments of Table 2, evenly distributed.
  const auto read_off = [&](std::vector<PolygonReadings>& readings) {
    for (PolygonReadings& position : readings)
      for (std::size_t i = 0; i < kPolygonReadings; ++i) {
        const bool angle = is_angle(static_cast<PolygonReading>(i));
        position[i] += random.uniform(-0.5, 0.5) * (angle ? 0.01 * kArcsec : 0.03 * kMicrometre);
      }
  };

  Runs raw, fitted, exact, truth;
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<std::vector<TableMotion>> did;
    Courses true_courses{};
    for (std::size_t setup = 0; setup < 3; ++setup) {
      const Courses courses = repeated(mean, random);
      did.push_back(motions_of(courses));
      // The motions each set-up measures: 1: eps_y, eps_z, delta_y; 2: eps_x, delta_x; 3: delta_z.
      for (const std::size_t i : setup == 0   ? std::vector<std::size_t>{1, 2, 4}
                                 : setup == 1 ? std::vector<std::size_t>{0, 3}
                                              : std::vector<std::size_t>{5}) {
        true_courses[i] = courses[i];
      }
    }
    std::vector<PolygonReadings> readings = stepwise_readings(campaign, did);
    read_off(readings);
    const Courses before = courses_of(readings);
    Courses after = before;
    for (const std::size_t i : {0U, 1U, 3U, 4U}) after[i] = without_first_harmonic(before[i]);
    raw.courses.push_back(before);
    fitted.courses.push_back(after);
    exact.courses.push_back(inverted(campaign, readings));
    truth.courses.push_back(true_courses);
  }
  MaTable table;
  for (std::size_t k = 0; k < kSteps; ++k) table.angles.push_back(step_angle(k));
  raw.evaluate(table.before, table.repeatability_before, table.courses_before);
  fitted.evaluate(table.fitted, table.repeatability_fitted, table.courses_fitted);
  exact.evaluate(table.inverted, table.repeatability_inverted, table.courses_inverted);
  truth.evaluate(table.truth, table.repeatability_truth, table.courses_truth);
  for (const std::size_t i : {0U, 1U, 3U, 4U}) {
    Course removed;
    without_first_harmonic(mean[i], &removed);
    for (const double value : removed) table.absorbed[i] = std::max(table.absorbed[i], std::abs(value));
  }
  return table;
}

std::vector<MaRank> ma_rank_table() {
  std::vector<MaRank> table = {{"one mount", {0}, 0},
                               {"two mounts, turned by one face", {0, 1}, 0},
                               {"two mounts, turned by two faces", {0, 2}, 0},
                               {"two mounts, turned by three faces", {0, 3}, 0},
                               {"two mounts, turned by one face, sensor along z 20 mm off the axis", {0, 1}, 20},
                               {"three mounts, turned by one and by two faces", {0, 1, 2}, 0}};
  for (MaRank& line : table) {
    PolygonCampaign campaign = regular_campaign(12, 48.3, 17, line.shifts);
    campaign.bench.displacement_z.position.x() = line.mirror_lever;
    const PolygonObservability seen = polygon_observability(campaign);
    line.unknowns = seen.unknowns;
    line.readings = seen.readings;
    line.rank = seen.rank;
  }
  return table;
}

MaSeparation ma_separation(const PolygonNoise& noise, bool noisy, std::uint64_t seed) {
  MaSeparation separation;
  const PolygonCampaign nominal = regular_campaign(12, 48.3, 17, {0, 1});
  const PolygonCampaign truth = ma_campaign({0, 1}, seed);
  const PolygonObservability seen = polygon_observability(nominal, noise);
  separation.gauge = polygon_gauge(nominal, seen);
  const Eigen::VectorXd readings = noisy ? simulate_campaign(truth, noise, seed + 1) : campaign_readings(truth);
  separation.result = separate_polygon(nominal, readings, noise, separation.gauge);
  const Eigen::VectorXd expected = in_gauge(unknown_values(truth), seen, separation.gauge);

  PolygonCampaign one = nominal;
  one.mounts.resize(1);
  one.shifts.resize(1);
  const PolygonObservability seen_once = polygon_observability(one, noise);
  const PolygonSeparation alone = separate_polygon(one, readings.head(static_cast<Eigen::Index>(one.reading_count())),
                                                   noise, polygon_gauge(one, seen_once));

  const PolygonColumns columns = polygon_columns(nominal);
  const auto largest = [](double value, double& of) { of = std::max(of, std::abs(value)); };
  for (std::size_t k = 0; k < kSteps; ++k)
    for (std::size_t i = 0; i < 6; ++i) {
      const Eigen::Index column = static_cast<Eigen::Index>(6 * k + i);
      largest(separation.result.values[column] - expected[column], separation.error[i]);
      largest(alone.values[column] - expected[column], separation.confused[i]);
      if (separation.result.standard_uncertainties.size() > 0) {
        largest(separation.result.standard_uncertainties[column], separation.uncertainty[i]);
      }
    }
  for (Eigen::Index j = 0; j < 12; ++j) {
    const Eigen::Index first = columns.faces + 3 * j;
    largest(separation.result.values[first] - expected[first], separation.azimuth_error);
    largest(separation.result.values[first + 1] - expected[first + 1], separation.tilt_error);
    largest(separation.result.values[first + 2] - expected[first + 2], separation.distance_error);
  }
  return separation;
}

}  // namespace abbe
