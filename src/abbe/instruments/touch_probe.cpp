#include "abbe/instruments/touch_probe.h"

#include <stdexcept>

namespace abbe {

TouchProbe::TouchProbe(const TouchProbeSetup& setup)
    : EquationInstrument(setup.name), measure_(setup.measure), frame_(setup.frame), noise_(setup.noise) {
  if (setup.spheres.empty()) throw std::invalid_argument(setup.name + ": no sphere");
  if (measure_ == TouchProbeSetup::Measure::centre) {
    components_ = {{"x", false}, {"y", false}, {"z", false}};
  } else {
    components_ = {{"travel", false}};
    inputs_ = {{"approach_x", false}, {"approach_y", false}, {"approach_z", false}};
  }
  const std::array<std::size_t, 3> tip = add(setup.name + ".tip", setup.tip);
  const std::size_t tip_radius = add(quantity(setup.name + ".tip_radius", false, setup.tip_radius));
  SetupQuantity stretch = quantity(setup.name + ".scale", true, setup.scale);
  stretch.scale = 1e-5;
  const std::size_t scale = add(std::move(stretch));
  struct Ball {
    std::array<std::size_t, 3> centre;
    std::size_t radius;
  };
  std::vector<Ball> balls;
  for (const TouchProbeSetup::Sphere& sphere : setup.spheres) {
    if (!(sphere.radius.value > 0 && setup.tip_radius.value >= 0)) {
      throw std::invalid_argument(sphere.name + ": the radius is not above zero");
    }
    const std::array<std::size_t, 3> centre = add(sphere.name, sphere.centre);
    balls.push_back({centre, add(quantity(sphere.name + ".radius", false, sphere.radius))});
  }
  std::vector<TouchProbeSetup::Placement> placements = setup.placements;
  if (placements.empty()) placements.push_back({setup.name, {}, {}});
  for (const TouchProbeSetup::Placement& placement : placements) {
    const std::array<std::size_t, 3> p = add(placement.name + ".position", placement.position);
    std::array<std::size_t, 3> a{};
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = add(quantity(placement.name + "." + "abc"[i], true, placement.angles.coordinate[i]));
    }
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const std::array<std::size_t, 3>& c = balls[i].centre;
      const std::string& sphere = setup.spheres[i].name;
      add(InstrumentItem{placements.size() == 1 ? sphere : placement.name + "/" + sphere,
                         setup.probe_body,
                         setup.artefact_body,
                         {tip[0], tip[1], tip[2], p[0], p[1], p[2], a[0], a[1], a[2], c[0], c[1], c[2], scale,
                          balls[i].radius, tip_radius}});
    }
  }
}

double TouchProbe::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const { return noise_; }

std::vector<std::vector<double>> TouchProbe::planned_inputs(std::size_t) const {
  if (measure_ == TouchProbeSetup::Measure::centre) return {{}};
  return {{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
}

std::optional<MeetingPoints> TouchProbe::meeting_points(std::size_t item) const {
  double value[15];
  for (std::size_t i = 0; i < 15; ++i) value[i] = quantities_[items_[item].quantities[i]].value;
  return MeetingPoints{{value[0], value[1], value[2]}, sphere_centre<double>(value)};
}

}  // namespace abbe
