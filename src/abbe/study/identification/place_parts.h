#pragma once

// Internal to study: parts of the readings from one place, in their order, that each fit by themselves.
#include <cstddef>
#include <optional>
#include <vector>

#include "abbe/instruments/instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

constexpr std::size_t kFewestOfPlace = 6;  ///< readings by which a place can be judged
constexpr double kExplainedExtent = 0.03;  ///< of the extent of the points: a reading within is explained

/// Parts of the readings from one place.
struct PlaceParts {
  std::vector<std::size_t> begins;  ///< [parts] index into StartFit::readings; the first is 0
  double rms_mm = 0;                ///< of the readings that their part explains
};

/// Looks for places that moved while readings were taken.
///
/// Windows of many lengths over the readings are fitted as if each were all there is; readings are then assigned to
/// these fits, so that the sum of min(1, (deviation / tolerance)^2) and of a price per change is smallest (Viterbi
/// 1967). Parts are fitted again and readings assigned anew (Isack and Boykov, Int. J. Comput. Vis. 97 (2012) 123);
/// neighbours that fit together become one. The tolerance is kExplainedExtent of the extent of all points. At most 300
/// readings, evenly chosen, take part in the search; the ends of the parts are then found among all.
///
/// @return parts of kFewestOfPlace readings or more, which explain nine tenths of the readings; nothing if there are
///   none, if one part is enough, or if there are more than eight
std::optional<PlaceParts> parts_of_place(const Machine& machine, const Instrument& instrument,
                                         const InstrumentReadings& readings, const StartFit& place);

/// At most so many, evenly over all, in their order.
std::vector<std::size_t> evenly_chosen(const std::vector<std::size_t>& readings, std::size_t most);

}  // namespace abbe
