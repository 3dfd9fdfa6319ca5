#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

/// What a reading was taken with or on, of all readings of one set-up: its station, its reflector, its ball.
struct ReadingLabel {
  std::string kind;                       ///< "station"
  std::vector<std::string> names;         ///< of the stations
  std::vector<std::uint16_t> of_reading;  ///< [readings] index into names
};

/// What else is known of the readings of one set-up beside Observations, to look for patterns in them.
struct ReadingFacts {
  std::string setup;                          ///< name
  std::vector<ReadingLabel> labels;           ///< may be empty
  std::vector<double> time_s;                 ///< [readings] or empty
  std::vector<std::vector<double>> measured;  ///< [components][readings], mm or rad
  /// [components] change of the deviation with the measured number: 1, or the typical range (mm) of an angle whose
  /// deviation is the length across the beam.
  std::vector<double> arm;
  std::vector<std::vector<double>> inputs;  ///< [any number][readings]: known numbers of each reading
};

}  // namespace abbe
