#include "abbe/instruments/surface_probe.h"

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

SurfaceProbe::SurfaceProbe(const SurfaceProbeSetup& setup)
    : EquationInstrument(setup.name), standard_(setup.standard), noise_(std::hypot(setup.noise, setup.form)) {
  using Standard = SurfaceProbeSetup::Standard;
  if (setup.clampings.empty()) throw std::invalid_argument(setup.name + ": no clamping of a standard");
  if (!(setup.beam.norm() > 0)) throw std::invalid_argument(setup.name + ": the beam has no direction");
  if (standard_ != Standard::plane && !(setup.radius.value > 0)) {
    throw std::invalid_argument(setup.name + ": the radius is not above zero");
  }
  beam_ = DirectionFrame::of(setup.beam);
  components_ = {{"indication", false}};
  const std::array<std::size_t, 3> zero = add(setup.name + ".zero", setup.zero);
  const std::size_t first = add(quantity(setup.name + ".beam_first", true, setup.beam_first));
  const std::size_t second = add(quantity(setup.name + ".beam_second", true, setup.beam_second));
  std::vector<std::size_t> common = {zero[0], zero[1], zero[2], first, second};
  // What a standard does not have is an exact zero that nobody is told about.
  const bool has_radius = standard_ != Standard::plane, has_taper = standard_ == Standard::cylinder;
  const std::size_t radius =
      add(quantity(setup.name + ".radius", false, has_radius ? setup.radius : SetupNumber::exact(0)));
  SetupQuantity taper_quantity = quantity(setup.name + ".taper", true, has_taper ? setup.taper : SetupNumber::exact(0));
  taper_quantity.scale = 1e-5;
  const std::size_t taper = add(std::move(taper_quantity));
  for (const SurfaceProbeSetup::Clamping& clamping : setup.clampings) {
    if (standard_ != Standard::sphere && !(clamping.direction.norm() > 0)) {
      throw std::invalid_argument(clamping.name + ": the direction has no length");
    }
    const bool is_sphere = standard_ == Standard::sphere;
    mounted_.push_back(
        {clamping.point, is_sphere ? DirectionFrame{} : DirectionFrame::of(clamping.direction), clamping.reversed});
    static constexpr const char* kAlong[] = {".offset_first", ".offset_second", ".offset_along"};
    static constexpr const char* kSphere[] = {".offset_x", ".offset_y", ".offset_z"};
    std::vector<std::size_t> used = common;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool there = is_sphere || (standard_ == Standard::plane) == (i == 2);
      used.push_back(add(quantity(clamping.name + (is_sphere ? kSphere[i] : kAlong[i]), false,
                                  there ? clamping.offset.coordinate[i] : SetupNumber::exact(0))));
    }
    used.push_back(
        add(quantity(clamping.name + ".tilt_first", true, is_sphere ? SetupNumber::exact(0) : clamping.tilt_first)));
    used.push_back(
        add(quantity(clamping.name + ".tilt_second", true, is_sphere ? SetupNumber::exact(0) : clamping.tilt_second)));
    used.push_back(radius);
    used.push_back(taper);
    add(InstrumentItem{clamping.name, setup.probe_body, setup.standard_body, used});
  }
}

template <typename S>
Eigen::Matrix<S, 3, 1> SurfaceProbe::clamped_point(const Mounted& mounted, const S* quantities) const {
  Eigen::Matrix<S, 3, 1> result;
  for (int i = 0; i < 3; ++i) {
    if (standard_ == SurfaceProbeSetup::Standard::sphere) {
      result[i] = quantities[5 + i] + S(mounted.point[i]);
    } else {
      result[i] = quantities[5] * S(mounted.frame.first[i]) + quantities[6] * S(mounted.frame.second[i]) +
                  quantities[7] * S(mounted.frame.direction[i]) + S(mounted.point[i]);
    }
  }
  return result;
}

double SurfaceProbe::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const { return noise_; }

std::vector<InstrumentPlace> SurfaceProbe::places() const {
  std::vector<InstrumentPlace> places;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const std::vector<std::size_t>& q = items_[i].quantities;
    double value[12];
    for (std::size_t k = 0; k < 12; ++k) value[k] = quantities_[q[k]].value;
    if (places.empty()) {
      places.push_back({name_ + ".beam", items_[i].from, Eigen::Vector3d(value[0], value[1], value[2]), std::nullopt,
                        Eigen::Vector3d(beam_.tilted(value[3], value[4])),
                        std::vector<std::size_t>(q.begin(), q.begin() + 5)});
    }
    InstrumentPlace place{items_[i].name, items_[i].to, clamped_point(mounted_[i], value),
                          std::nullopt,   std::nullopt, std::vector<std::size_t>(q.begin() + 5, q.begin() + 10)};
    if (standard_ != SurfaceProbeSetup::Standard::sphere) {
      place.direction = mounted_[i].frame.tilted(value[8], value[9]);
    }
    places.push_back(std::move(place));
  }
  return places;
}

std::optional<MeetingPoints> SurfaceProbe::meeting_points(std::size_t item) const {
  double value[12];
  for (std::size_t i = 0; i < 12; ++i) value[i] = quantities_[items_[item].quantities[i]].value;
  const Mounted& mounted = mounted_[item];
  const Eigen::Vector3d beam = beam_.tilted(value[3], value[4]);
  Eigen::Vector3d against = -beam;
  if (standard_ == SurfaceProbeSetup::Standard::cylinder) {
    const Eigen::Vector3d direction = mounted.frame.tilted(value[8], value[9]);
    against -= against.dot(direction) * direction;
    if (against.norm() < 1e-9) return std::nullopt;  // the beam runs along the axis
    against.normalize();
  }
  const Eigen::Vector3d point = clamped_point(mounted, value);
  const bool plane = standard_ == SurfaceProbeSetup::Standard::plane;
  return MeetingPoints{{value[0], value[1], value[2]}, plane ? point : Eigen::Vector3d(point + value[10] * against)};
}

template <typename S>
void SurfaceProbe::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*,
                            S* reading) const {
  using std::sqrt;
  using Vector = Eigen::Matrix<S, 3, 1>;
  const Mounted& mounted = mounted_[item];
  const Vector start = seen.point(Vector(quantities[0], quantities[1], quantities[2]));
  const Vector beam = seen.rotation * beam_.tilted(quantities[3], quantities[4]);
  const Vector w = start - clamped_point(mounted, quantities);
  if (standard_ == SurfaceProbeSetup::Standard::sphere) {
    const S along = beam.dot(w);
    reading[0] = -along - sqrt(along * along - w.dot(w) + quantities[10] * quantities[10]);
    return;
  }
  const Vector direction = mounted.frame.tilted(quantities[8], quantities[9]);
  const S height = direction.dot(w), slope = direction.dot(beam);
  if (standard_ == SurfaceProbeSetup::Standard::plane) {
    reading[0] = -height / slope;
    return;
  }
  const S taper = mounted.reversed ? -quantities[11] : quantities[11];
  const S radius = quantities[10] + taper * height, widening = taper * slope;
  const S a = S(1.0) - slope * slope - widening * widening;
  const S b = beam.dot(w) - height * slope - radius * widening;
  const S c = w.dot(w) - height * height - radius * radius;
  reading[0] = (-b - sqrt(b * b - a * c)) / a;
}

template class EquationInstrument<SurfaceProbe, 12, 1>;

}  // namespace abbe
