// Tilted planes of an NC program: G68.2, G53.1, G69.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "abbe/formats/nc/nc_interpreter.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

constexpr std::uint32_t kLinear = 0b111, kRotary = 0b111000;
/// Over which the map of a plane to the axes is taken: rounding falls with it.
constexpr double kSpan_mm = 1000;
/// An arc is in a plane of the axes if the normal is that of one, rad.
constexpr double kSameNormal = 1e-9;

std::size_t axis_index(Eigen::Index k) { return static_cast<std::size_t>(k); }

}  // namespace

void NcInterpreter::check_plane_words() const {
  const NcCode tilt = codes_[NcGroup::tilt];
  const NcCode other = codes_[NcGroup::non_modal];
  if ((tilt == 682 || (tilt_.on && tilt == 690) || other == 531) && modes_.motion >= 730 && modes_.motion != 800) {
    block_.fail(codes_.word(block_, other == 531 ? NcGroup::non_modal : NcGroup::tilt),
                "a canned cycle is in force, which would go on in another plane", "G80 before it");
  }
  if (tilt == 682) {
    const NcWord& word = codes_.word(block_, NcGroup::tilt);
    for (std::size_t i = 0; i < block_.word_count; ++i) {
      const NcWord& beside = block_.words[i];
      if (beside.letter == 'g' && &beside != &word) {
        block_.fail(beside, "another G code in a block with G68.2", "a block of its own");
      }
      if (beside.letter == 'p' && beside.value != 0) {
        block_.fail(beside, "this form of G68.2 is not handled", "P0, or no P: Euler angles I, J, K");
      }
      if (beside.letter == 'q' || beside.letter == 'r' || beside.letter == 'l' || beside.letter == 'd') {
        block_.fail(beside, "this form of G68.2 is not handled", "X Y Z I J K");
      }
    }
    if ((codes_.axes & ~kLinear) != 0) block_.fail(word, "G68.2 with words of other axes", "X Y Z I J K");
    if (codes_.has(NcMGroup::stop)) block_.fail(word, "G68.2 with a stop", "a block of its own");
    if (!modes_.absolute) block_.fail(word, "G68.2 in incremental distances", "G90");
    if (tilt_.on) block_.fail(word, "a tilted plane in a tilted plane", "G69 before it");
    if (options_.planes == nullptr) block_.fail(word, "the machine is not known, which a tilted plane needs");
    if (!options_.planes->problem().empty()) {
      block_.fail(word, "the machine has no tilted planes: " + options_.planes->problem());
    }
  }
  if (other == 531) {
    const NcWord& word = codes_.word(block_, NcGroup::non_modal);
    if (!tilt_.on) block_.fail(word, "there is no tilted plane", "G68.2 before it");
    if (codes_.axes != 0 || codes_.has(NcGroup::motion) || codes_.has(NcGroup::tool_length)) {
      block_.fail(word, "G53.1 with axis words, a motion or a tool length", "a block of its own");
    }
    if (block_.has('p')) block_.fail('p', "choosing the solution is not handled", "G53.1 without P");
  }
  if (!tilt_.on) return;
  const auto refuse = [&](const NcWord& word) {
    block_.fail(word, "is not handled while a plane is tilted", "G69 before it");
  };
  if (codes_.has(NcGroup::work_offset)) refuse(codes_.word(block_, NcGroup::work_offset));
  if (other != kNoCode && other != 40 && other != 530 && other != 531) refuse(codes_.word(block_, NcGroup::non_modal));
  if (tilt == 690 && (codes_.axes != 0 || other != kNoCode)) {
    block_.fail(codes_.word(block_, NcGroup::tilt), "G69 with axis words or codes that move", "a block of its own");
  }
  for (std::size_t k = 3; k < kAxisWords; ++k) {
    if ((codes_.axes >> k & 1) != 0 && !codes_.has(NcGroup::tool_length)) {
      block_.fail("xyzabcuvw"[k], "moves another axis than X, Y, Z while a plane is tilted", "G53.1, or G69 before it");
    }
  }
}

void NcInterpreter::set_plane() {
  if (codes_[NcGroup::tilt] == 690) {
    leave_plane();
    tilt_.on = false;
    update_frame();
    return;
  }
  const auto angle = [&](char letter) { return block_.has(letter) ? block_.value(letter) * kDegree : 0.0; };
  const auto length = [&](std::size_t k) { return block_.has("xyz"[k]) ? block_.value("xyz"[k]) * unit(k) : 0.0; };
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  // About Z, then about X as it is then, then about Z as it is then.
  tilt_.rotation = (AngleAxisd(angle('i'), Vector3d::UnitZ()) * AngleAxisd(angle('j'), Vector3d::UnitX()) *
                    AngleAxisd(angle('k'), Vector3d::UnitZ()))
                       .toRotationMatrix();
  tilt_.origin = {length(0), length(1), length(2)};
  tilt_.on = true;
  update_frame();
  enter_plane();
  plane_comment_ = "(G68.2";
  for (const char letter : {'x', 'y', 'z', 'i', 'j', 'k'}) {
    if (!block_.has(letter)) continue;
    plane_comment_ += fmt::format(" {}{:.10g}", static_cast<char>(letter - 'a' + 'A'), block_.value(letter));
  }
  plane_comment_ += ", until G69 written as moves of the axes)";
  block_.comments.push_back(plane_comment_);
}

WordValues NcInterpreter::radians(const Words& words) const {
  WordValues values{};
  for (std::size_t k = 0; k < kAxisWords; ++k) values[k] = k >= 3 && k < 6 ? words[k] * kDegree : words[k];
  return values;
}

bool NcInterpreter::words_are_points() const { return modes_.tool_centre || options_.tool_centre; }

void NcInterpreter::enter_plane() {
  const std::uint32_t rotary = machine_words_ & kRotary;
  if ((rotary & ~known_) != 0) fail_unknown(rotary & ~known_, "a tilted plane counts from there");
  const Words offset = offsets_in_force();
  const WordValues at_zero = radians(offset);
  const std::array<double, 3> tool = {tool_offset_[0], tool_offset_[1], tool_offset_[2]};
  const auto axes_at = [&](const Eigen::Vector3d& in_plane) {
    const Eigen::Vector3d place = tilt_.origin + tilt_.rotation * in_plane;
    WordValues words = radians(position_);
    for (Eigen::Index k = 0; k < 3; ++k) words[axis_index(k)] = offset[axis_index(k)] + place[k];
    if (!words_are_points()) options_.planes->turn_with_workpiece(at_zero, tool, words);
    return Eigen::Vector3d(words[0], words[1], words[2]);
  };
  tilt_.at_zero = axes_at(Eigen::Vector3d::Zero());
  for (Eigen::Index k = 0; k < 3; ++k) {
    tilt_.axes_from_plane.col(k) = (axes_at(kSpan_mm * Eigen::Vector3d::Unit(k)) - tilt_.at_zero) / kSpan_mm;
  }
  tilt_.counts = true;
  machine_position_ = position_;
  if ((known_ & kLinear) != kLinear) {
    known_ &= ~kLinear;
    return;
  }
  const Eigen::Vector3d stands(position_[0], position_[1], position_[2]);
  const Eigen::Vector3d in_plane = tilt_.axes_from_plane.inverse() * (stands - tilt_.at_zero);
  for (Eigen::Index k = 0; k < 3; ++k) position_[axis_index(k)] = in_plane[k];
}

void NcInterpreter::leave_plane() {
  if (!tilt_.counts) return;
  tilt_.counts = false;
  for (std::size_t k = 0; k < 3; ++k) position_[k] = machine_position_[k];
}

NcInterpreter::Words NcInterpreter::axes_of_plane(const Words& words) const {
  const Eigen::Vector3d axes = tilt_.axes_from_plane * Eigen::Vector3d(words[0], words[1], words[2]) + tilt_.at_zero;
  Words result = words;
  for (Eigen::Index k = 0; k < 3; ++k) result[axis_index(k)] = axes[k];
  return result;
}

void NcInterpreter::turn_arc_to_axes(ProgramMove& move) const {
  // Its normal, and the centre with the start's coordinate along it.
  const std::size_t normal = move.plane == ArcPlane::XY ? 2 : move.plane == ArcPlane::ZX ? 1 : 0;
  Words centre = position_;
  for (std::size_t k = 0; k < 3; ++k) {
    if (k != normal) centre[k] = move.arc_centre[k];
  }
  centre = axes_of_plane(centre);
  for (std::size_t k = 0; k < 3; ++k) move.arc_centre[k] = centre[k];
  // Axes that are not at right angles show a circle of a turned workpiece as an ellipse.
  if ((tilt_.axes_from_plane.transpose() * tilt_.axes_from_plane - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() >
      kSameNormal) {
    block_.fail(block_.words[0], "an arc in a tilted plane, on a machine whose X, Y and Z are not at right angles",
                "straight moves: in these axes it is not an arc");
  }
  // Seen from the other side where the words are left-handed.
  bool other_side = tilt_.axes_from_plane.determinant() < 0;
  const Eigen::Vector3d turned = tilt_.axes_from_plane.col(static_cast<Eigen::Index>(normal)).normalized();
  Eigen::Index along = 0;
  const double largest = turned.cwiseAbs().maxCoeff(&along);
  if ((turned.cwiseAbs() - largest * Eigen::Vector3d::Unit(along)).cwiseAbs().maxCoeff() > kSameNormal) {
    move.plane = ArcPlane::tilted;
    move.arc_normal = {turned[0], turned[1], turned[2]};
  } else {
    move.plane = along == 2 ? ArcPlane::XY : along == 1 ? ArcPlane::ZX : ArcPlane::YZ;
    // And where the normal points against the axis.
    other_side = other_side != (turned[along] < 0);
  }
  if (other_side) {
    move.kind = move.kind == MoveKind::arc_clockwise ? MoveKind::arc_counterclockwise : MoveKind::arc_clockwise;
  }
}

void NcInterpreter::turn_to_plane() {
  const NcWord& word = codes_.word(block_, NcGroup::non_modal);
  leave_plane();
  const Eigen::Vector3d normal = tilt_.rotation.col(2);
  WordValues words = radians(position_);
  const std::string problem =
      options_.planes->turn_tool(words_are_points() ? ProgramCoordinates::tool_centre : ProgramCoordinates::axes,
                                 {normal[0], normal[1], normal[2]}, radians(offsets_in_force()), words);
  if (!problem.empty()) block_.fail(word, problem, "another plane, or an approach from where it can");
  Words end = position_;
  for (std::size_t k = 3; k < 6; ++k) {
    if ((machine_words_ >> k & 1) != 0 && words[k] != position_[k] * kDegree) end[k] = words[k] / kDegree;
  }
  // At the feed where the program moves at one, else at rapid traverse.
  if (modes_.motion >= 10 && modes_.motion <= 30) {
    check_feed("G53.1");
    straight(end, known_);
  } else {
    rapid(end, known_);
  }
  enter_plane();
}

}  // namespace abbe
