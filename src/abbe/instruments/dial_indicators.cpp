#include "abbe/instruments/dial_indicators.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"

namespace abbe {

DialIndicators::DialIndicators(const DialIndicatorsSetup& setup)
    : EquationInstrument(setup.name), noise_(std::hypot(setup.noise, setup.flatness)) {
  if (setup.faces.empty()) throw std::invalid_argument(setup.name + ": no face");
  if (setup.arrangements.empty()) throw std::invalid_argument(setup.name + ": no dials");
  std::vector<std::array<std::size_t, 3>> faces;
  for (const DialIndicatorsSetup::Face& face : setup.faces) {
    if (!(face.normal.norm() > 0)) throw std::invalid_argument(face.name + ": the normal has no length");
    faces.push_back({add(quantity(face.name + ".offset", false, face.offset)),
                     add(quantity(face.name + ".tilt_first", true, face.tilt_first)),
                     add(quantity(face.name + ".tilt_second", true, face.tilt_second))});
  }
  for (const DialIndicatorsSetup::Dial& dial : setup.arrangements.front().dials)
    components_.push_back({dial.name, false});
  for (const DialIndicatorsSetup::Arrangement& arrangement : setup.arrangements) {
    const std::size_t count = arrangement.dials.size();
    if (count == 0 || count > 6 || count != components_.size()) {
      throw std::invalid_argument(arrangement.name + ": expected 1 to 6 dials, as many in every arrangement");
    }
    InstrumentItem item{arrangement.name, setup.carriage_body, setup.face_body, {}};
    std::string prefix = setup.name + ".";
    if (setup.arrangements.size() > 1) prefix += arrangement.name + ".";
    for (const DialIndicatorsSetup::Dial& dial : arrangement.dials) {
      if (dial.face >= faces.size()) throw std::invalid_argument(dial.name + ": there is no such face");
      if (!(dial.direction.norm() > 0)) throw std::invalid_argument(dial.name + ": the direction has no length");
      const std::array<std::size_t, 3> position = add(prefix + dial.name, dial.position);
      item.quantities.insert(item.quantities.end(), position.begin(), position.end());
      item.quantities.push_back(add(quantity(prefix + dial.name + ".zero", false, dial.zero)));
    }
    // A face that several dials touch is one set of quantities of the item.
    touches_.emplace_back();
    std::vector<std::size_t> place(faces.size(), 0);
    for (const DialIndicatorsSetup::Dial& dial : arrangement.dials) {
      if (place[dial.face] == 0) {
        place[dial.face] = item.quantities.size();
        item.quantities.insert(item.quantities.end(), faces[dial.face].begin(), faces[dial.face].end());
      }
      const DialIndicatorsSetup::Face& face = setup.faces[dial.face];
      touches_.back().push_back(
          {dial.direction.normalized(), face.point, DirectionFrame::of(face.normal), place[dial.face]});
    }
    add(std::move(item));
  }
}

double DialIndicators::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t) const {
  return noise_;
}

std::vector<InstrumentPlace> DialIndicators::places() const {
  std::vector<InstrumentPlace> places;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    for (const Touch& touch : touches_[i]) {
      const auto first = items_[i].quantities.begin() + static_cast<std::ptrdiff_t>(touch.face);
      const std::vector<std::size_t> q(first, first + 3);
      const bool known = std::any_of(places.begin(), places.end(),
                                     [&](const InstrumentPlace& place) { return place.quantities == q; });
      if (known) continue;
      const std::string& name = quantities_[q[0]].name;
      places.push_back({name.substr(0, name.size() - std::string(".offset").size()), items_[i].to,
                        Eigen::Vector3d(touch.point + quantities_[q[0]].value * touch.normal.direction), std::nullopt,
                        Eigen::Vector3d(touch.normal.tilted(quantities_[q[1]].value, quantities_[q[2]].value)), q});
    }
  }
  return places;
}

std::optional<MeetingPoints> DialIndicators::meeting_points(std::size_t item) const {
  const std::vector<std::size_t>& q = items_[item].quantities;
  const auto value = [&](std::size_t i) { return quantities_[q[i]].value; };
  return MeetingPoints{{value(0), value(1), value(2)}, touches_[item].front().point};
}

template <typename S>
void DialIndicators::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*,
                              S* reading) const {
  for (std::size_t i = 0; i < touches_[item].size(); ++i) {
    const Touch& touch = touches_[item][i];
    const S* own = quantities + 4 * i;
    const S* face = quantities + touch.face;
    const Eigen::Matrix<S, 3, 1> tip = seen.point(Eigen::Matrix<S, 3, 1>(own[0], own[1], own[2]));
    const Eigen::Matrix<S, 3, 1> plunger = seen.direction(touch.direction);
    const Eigen::Matrix<S, 3, 1> normal = touch.normal.tilted(face[1], face[2]);
    Eigen::Matrix<S, 3, 1> to_face;
    for (int k = 0; k < 3; ++k) to_face[k] = face[0] * S(touch.normal.direction[k]) + S(touch.point[k]) - tip[k];
    reading[i] = normal.dot(to_face) / normal.dot(plunger) + own[3];
  }
}

template class EquationInstrument<DialIndicators, 42, 6>;

}  // namespace abbe
