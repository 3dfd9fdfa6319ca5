#include "ma/effects.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr double kNoEffect = 1e-12;  // mm/rad or 1: rounding of the gradient

/// Gradients of the six readings at every position, [positions][6].
using Gradients = std::vector<std::array<PolygonGradient, 6>>;

Gradients gradients_of(const MaExample& example) {
  Gradients result(example.positions.size());
  for (std::size_t k = 0; k < result.size(); ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      polygon_reading(kMaReadingOf[i], example.polygon, example.mount, example.bench, example.positions[k],
                      example.motions[k], &result[k][i]);
    }
  }
  return result;
}

PolygonSide side_of(std::size_t motion) { return PolygonBench().sensor(kMaReadingOf[motion]).side; }

enum class Against { nothing, first_position };

/// Largest change of the readings by one unit of a column; readings for which `concerns` is false do not see it.
template <class Concerns>
SixMotions largest_change(const Gradients& gradients, int column, Against against, Concerns concerns) {
  SixMotions largest{};
  for (const auto& at : gradients) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (!concerns(i)) continue;
      const double first = against == Against::first_position ? gradients.front()[i][column] : 0;
      largest[i] = std::max(largest[i], std::abs(at[i][column] - first));
    }
  }
  return largest;
}

MaEffect for_its_size(MaEffect effect, const SixMotions& per_unit) {
  for (std::size_t i = 0; i < 6; ++i) effect.change[i] = per_unit[i] * effect.size;
  return effect;
}

/// The five errors of the prism with sizes as given.
std::vector<MaEffect> prism_effects(const Gradients& gradients, double azimuth, double tilt, double top) {
  const auto on = [](PolygonSide side) { return [side](std::size_t i) { return side_of(i) == side; }; };
  const auto on_faces = [](std::size_t i) { return side_of(i) != PolygonSide::z; };
  using namespace polygon_column;
  const Against alone = Against::nothing;  // every position has its own face
  return {for_its_size({"eps_px", "tilt of the face seen along y", true, tilt, {}},
                       largest_change(gradients, face + 1, alone, on(PolygonSide::y))),
          for_its_size({"eps_py", "tilt of the face seen along x", true, tilt, {}},
                       largest_change(gradients, face + 1, alone, on(PolygonSide::x))),
          for_its_size({"eps_pz", "working angle of the face", true, azimuth, {}},
                       largest_change(gradients, face, alone, on_faces)),
          for_its_size({"eps_xb", "tilt of the mirror about x", true, top, {}},
                       largest_change(gradients, face, Against::first_position, on(PolygonSide::z))),
          for_its_size({"eps_yb", "tilt of the mirror about y", true, top, {}},
                       largest_change(gradients, face + 1, Against::first_position, on(PolygonSide::z)))};
}

struct MaInstrument {
  const char* name;
  const char* angles[3];
  const char* coordinates[3];
  PolygonReading reading;
};
constexpr MaInstrument kMaInstruments[] = {{"autocollimator along x",
                                            {"eps_xl", "eps_yl", "eps_zl"},
                                            {"P_x", "P_y", "P_z"},
                                            PolygonReading::autocollimator_x_about_z},
                                           {"autocollimator along y",
                                            {"eps_xm", "eps_ym", "eps_zm"},
                                            {"Q_x", "Q_y", "Q_z"},
                                            PolygonReading::autocollimator_y_about_x},
                                           {"displacement sensor along x",
                                            {"eps_xn", "eps_yn", "eps_zn"},
                                            {"K_x", "K_y", "K_z"},
                                            PolygonReading::displacement_x},
                                           {"displacement sensor along y",
                                            {"eps_xu", "eps_yu", "eps_zu"},
                                            {"U_x", "U_y", "U_z"},
                                            PolygonReading::displacement_y},
                                           {"displacement sensor along z",
                                            {"eps_xv", "eps_yv", "eps_zv"},
                                            {"V_x", "V_y", "V_z"},
                                            PolygonReading::displacement_z}};

bool same_instrument(PolygonReading a, PolygonReading b) {
  const PolygonBench bench;
  return &bench.sensor(a) == &bench.sensor(b);
}

}  // namespace

std::vector<MaPrismEffect> ma_prism_effects() {
  MaExample example = ma_example(PolygonFaceOrder::face);
  for (PolygonFace& face : example.polygon.faces) face.azimuth_error = face.tilt = 0;
  example.polygon.top.tilt_x = example.polygon.top.tilt_y = 0;
  example.mount = {};
  for (TableMotion& motion : example.motions) motion = {};
  for (const MaInstrument& instrument : kMaInstruments) example.bench.sensor(instrument.reading).angles.setZero();
  // eps_x, eps_y, eps_z, delta_x, delta_y, delta_z
  constexpr std::array<std::array<bool, 6>, 5> kMarks = {{{true, false, false, false, true, false},
                                                          {false, true, false, true, false, false},
                                                          {false, false, true, true, true, false},
                                                          {false, false, false, false, false, true},
                                                          {false, false, false, false, false, true}}};
  std::vector<MaPrismEffect> result;
  for (MaEffect& effect : prism_effects(gradients_of(example), kArcsec, kArcsec, kArcsec)) {
    MaPrismEffect entry{std::move(effect), kMarks[result.size()], {}};
    for (std::size_t i = 0; i < 6; ++i) entry.found[i] = entry.effect.change[i] > kNoEffect * kArcsec;
    result.push_back(std::move(entry));
  }
  return result;
}

std::vector<MaEffect> ma_all_effects() {
  const Gradients gradients = gradients_of(ma_example(PolygonFaceOrder::face));
  using namespace polygon_column;
  const auto all = [](std::size_t) { return true; };
  std::vector<MaEffect> effects;
  const char* motions[6] = {"eps_x", "eps_y", "eps_z", "delta_x", "delta_y", "delta_z"};
  for (int i = 0; i < 6; ++i) {
    const double size = i < 3 ? 100 * kArcsec : (i < 5 ? 100 : 10) * kMicrometre;
    effects.push_back(for_its_size({motions[i], "motion of the table", i < 3, size, {}},
                                   largest_change(gradients, motion + i, Against::nothing, all)));
  }
  const char* installation[6] = {"eps_xbc", "eps_ybc", "", "delta_xbc", "delta_ybc", "delta_zbc"};
  for (int i = 0; i < 6; ++i) {
    if (i == 2) continue;  // the turn of the prism about the axis is the zero of the angle
    const double size = i < 3 ? 50 * kArcsec : 10 * kMicrometre;
    effects.push_back(for_its_size({installation[i], "installation of the prism", i < 3, size, {}},
                                   largest_change(gradients, mount + i, Against::first_position, all)));
  }
  for (MaEffect& effect : prism_effects(gradients, kArcsec, 5 * kArcsec, 4.13 * kArcsec)) {
    effects.push_back(std::move(effect));
  }
  for (const MaInstrument& instrument : kMaInstruments) {
    const auto its_own = [&](std::size_t i) { return same_instrument(kMaReadingOf[i], instrument.reading); };
    for (int i = 0; i < 6; ++i) {
      const bool is_angle = i < 3;
      const int column = is_angle ? sensor_angles + i : polygon_column::position + i - 3;
      effects.push_back(for_its_size({is_angle ? instrument.angles[i] : instrument.coordinates[i - 3],
                                      instrument.name,
                                      is_angle,
                                      is_angle ? 100 * kArcsec : 100 * kMicrometre,
                                      {}},
                                     largest_change(gradients, column, Against::first_position, its_own)));
    }
  }
  return effects;
}

}  // namespace abbe
