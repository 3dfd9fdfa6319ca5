#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/instruments/instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Readings from one place that the nominal machine does not explain, and what would make them fit.
struct UnexplainedReadings {
  std::string place;         ///< "station1"
  std::size_t readings = 0;  ///< from there
  double share = 0;          ///< of them, that lie within 3 % of the extent of the points
  double rms_mm = 0;         ///< of these
  std::vector<std::string>
      causes;                   ///< in words, each of which would explain them; more than one: they fit equally well
  double mended_rms_mm = 0;     ///< without the cause; 0 where none was found
  bool set_up_is_open = false;  ///< other numbers of the set-up are only roughly known, and may be what is wrong

  /// Two sentences at most, without the end of a line.
  std::string words() const;
};

/// How well the nominal machine explains the readings of one set-up.
struct JudgedReadings {
  std::size_t places = 0;                        ///< that could be judged
  std::vector<UnexplainedReadings> unexplained;  ///< those among them that do not fit
};

/// Looks for what is wrong with readings of which more than a fifth lie farther than 3 % of the extent of the points
/// from where the nominal machine puts them: the instrument's usual mistakes; axes that are swapped, reversed or in
/// other units; rows whose commands belong to the row before or after; a place that moved while readings were taken.
/// Taken are the fewest mistakes without which at least nine tenths of the readings fit. A place that moved is also
/// looked for where six readings or more, one after the other, lie that far off.
///
/// Places whose readings determine no place are passed over, and those with fewer than six readings that some place
/// explains.
/// @param started  by the instrument with these readings
JudgedReadings judge_readings(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
                              const StartedInstrument& started);

}  // namespace abbe
