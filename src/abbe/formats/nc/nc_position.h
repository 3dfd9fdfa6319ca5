#pragma once

// Internal to formats: where the axes stand in an NC program.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "abbe/formats/nc/nc_block.h"
#include "abbe/formats/nc/nc_tilted_plane.h"
#include "abbe/formats/nc/nc_units.h"

namespace abbe {

/// A position of which some words are known: where a move goes, or a reference position.
struct NcPlace {
  NcAxisValues values{};
  std::uint32_t known = 0;
};

/// Fails for the words of a position that are not known; nothing if there are none.
/// @param why  it has to be known: "G92 takes it"
/// @throws InputError
void require_known_words(std::uint32_t unknown, const NcBlock& block, std::string_view why);

/// Where a program has sent the axes, as far as it is known, and what its values count from; mm, degrees as the control
/// has them.
///
/// Program value = (value - zero()) / unit. In a tilted plane X, Y, Z of values() count in it; axes() are always the
/// positions of the axes themselves.
class NcPosition {
 public:
  /// @param machine_words  bits of the axis words that the machine has
  explicit NcPosition(std::uint32_t machine_words) : machine_words_(machine_words) {}

  std::uint32_t machine_words() const { return machine_words_; }
  std::uint32_t known() const { return known_; }
  bool is_known(std::size_t axis) const { return (known_ >> axis & 1) != 0; }
  /// Words of the machine that are not known.
  std::uint32_t unknown() const { return machine_words_ & ~known_; }
  /// @throws InputError if one of `words` is not known
  void require(std::uint32_t words, const NcBlock& block, std::string_view why) const {
    if ((words & ~known_) != 0) require_known_words(words & ~known_, block, why);
  }

  const NcAxisValues& values() const { return values_; }
  const NcAxisValues& axes() const { return axes_; }
  NcPlace here() const { return {values_, known_}; }
  /// Positions of the axes where a move goes.
  NcAxisValues axes_at(const NcAxisValues& values) const { return counts_in_plane_ ? plane_->axes(values) : values; }

  void begin_at(std::size_t axis, double value);
  void go(const NcPlace& target, const NcAxisValues& axes) {
    values_ = target.values;
    known_ = target.known;
    axes_ = axes;
  }
  void forget(std::uint32_t words) { known_ &= ~words; }

  const NcAxisValues& zero() const { return zero_; }
  /// Program values count from this sum of the offsets, X, Y, Z from the origin of a tilted plane while there is one.
  void count_from(const NcAxisValues& offsets);

  /// The plane that G68.2 has said until G69.
  const std::optional<NcTiltedPlane>& plane() const { return plane_; }
  /// A tilted plane, or none; X, Y, Z count in it once it is entered.
  void set_plane(const std::optional<NcTiltedPlane>& plane);
  bool counts_in_plane() const { return counts_in_plane_; }
  /// From here on X, Y, Z count in the plane, which is mapped by `axes_at` (see NcTiltedPlane::map()).
  void enter_plane(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& axes_at);
  /// X, Y, Z are those of the axes again.
  void leave_plane();

 private:
  std::uint32_t machine_words_;
  std::uint32_t known_ = 0;
  NcAxisValues values_{};
  NcAxisValues axes_{};
  NcAxisValues zero_{};
  std::optional<NcTiltedPlane> plane_;
  bool counts_in_plane_ = false;
};

}  // namespace abbe
