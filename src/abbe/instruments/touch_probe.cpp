#include "abbe/instruments/touch_probe.h"

#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

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
  stretch.is_pure_number = true;
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

std::vector<InstrumentPlace> TouchProbe::places() const {
  std::vector<InstrumentPlace> places;
  std::size_t last = quantities_.size();
  for (const InstrumentItem& item : items_) {
    const std::vector<std::size_t>& q = item.quantities;
    if (q[3] == last) continue;  // Another sphere of the same placement.
    last = q[3];
    const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
    const std::string& name = quantities_[q[3]].name;
    places.push_back({name.substr(0, name.size() - std::string(".position.x").size()), item.to,
                      Eigen::Vector3d(value(3), value(4), value(5)),
                      Eigen::Matrix3d(rotation_zyx(value(6), value(7), value(8))), std::nullopt,
                      std::vector<std::size_t>(q.begin() + 3, q.begin() + 9)});
  }
  return places;
}

std::vector<std::vector<double>> TouchProbe::planned_inputs(std::size_t) const {
  if (measure_ == TouchProbeSetup::Measure::centre) return {{}};
  return {{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
}

std::optional<MeetingPoints> TouchProbe::meeting_points(std::size_t item) const {
  double value[15];
  for (std::size_t i = 0; i < 15; ++i) value[i] = quantities_[items_[item].quantities[i]].value;
  return MeetingPoints{{value[0], value[1], value[2]}, sphere_centre<double>(value)};
}

template <typename S>
Eigen::Matrix<S, 3, 1> TouchProbe::sphere_centre(const S* quantities) {
  const Eigen::Matrix<S, 3, 1> position(quantities[3], quantities[4], quantities[5]);
  const S stretch = quantities[12] + S(1.0);
  const Eigen::Matrix<S, 3, 1> ball(stretch * quantities[9], stretch * quantities[10], stretch * quantities[11]);
  return position + rotation_zyx(quantities[6], quantities[7], quantities[8]) * ball;
}

template <typename S>
void TouchProbe::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double* inputs,
                          S* reading) const {
  using std::sqrt;
  const Eigen::Matrix<S, 3, 1> tip(quantities[0], quantities[1], quantities[2]);
  const Eigen::Matrix<S, 3, 1> gap = sphere_centre(quantities) - seen.point(tip);
  const bool own_frame = frame_ == TouchProbeSetup::Frame::probe;
  if (measure_ == TouchProbeSetup::Measure::centre) {
    Eigen::Matrix<S, 3, 1> deviation = gap;
    if (own_frame) deviation = seen.rotation.transpose() * gap;
    for (int i = 0; i < 3; ++i) reading[i] = deviation[i];
    return;
  }
  const Eigen::Vector3d given = Eigen::Vector3d(inputs[0], inputs[1], inputs[2]).normalized();
  Eigen::Matrix<S, 3, 1> approach = given.template cast<S>();
  if (own_frame) approach = seen.direction(given);
  const S along = approach.dot(gap), radii = quantities[13] + quantities[14];
  reading[0] = along - sqrt(radii * radii - gap.dot(gap) + along * along);
}

template class EquationInstrument<TouchProbe, 15, 3>;

}  // namespace abbe
