#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/machine/machine.h"
#include "abbe/machine/state_channel.h"

namespace abbe {

/// A CSV file of what was recorded over time.
struct ChannelFile {
  std::filesystem::path file;
  ColumnMapping mapping;
  std::optional<double> largest_gap_s;  ///< as make_channel()
};

/// From where readings take values of states that their own file does not have.
struct ChannelPlan {
  std::vector<ChannelFile> files;
  std::map<std::size_t, double> lag_start;  ///< index into Machine::states -> value at the first sample of its channel
};

/// A lag that is taken to be in equilibrium at the first sample, and readings that still depend on that.
struct UncertainStart {
  std::size_t state = 0;  ///< of the lag
  std::string source;     ///< of its channel
  double first_sample_s = 0;
  double first_reading_s = 0;  ///< less than kLagMemory time constants later
};

/// "column is taken to be in equilibrium with ambient at 0 s, ...": for people.
std::string uncertain_start_words(const Machine& machine, const UncertainStart& start);

/// What rows of readings are called in messages.
struct ReadingRows {
  std::string file;                                    ///< or set-up
  std::string time_column;                             ///< "time_s"
  std::function<std::size_t(std::size_t row)> line{};  ///< in the file; null: there is none
  std::string counted{};                               ///< "reading": rows are numbered from 0; empty: they are not
};

/// Channels of measured states, from any number of files, each with times of its own on one clock.
class StateChannels {
 public:
  bool empty() const { return channels_.empty(); }
  /// Channel of a state, or null.
  const StateChannel* of(std::size_t state) const;

  /// The first and the last time that all channels cover, s; the first is the later one if there is no such time.
  std::pair<double, double> common_time() const;

  /// Adds a file: a column of times and columns of measured and lag states, of which fields may be empty.
  /// @param file  name for messages
  /// @throws InputError for times that do not increase, no column of a state, and a state that another file has
  void add(std::string_view text, const std::string& file, const Machine& machine, const ChannelFile& description);
  /// Adds values of lags at the first sample of their channels.
  /// @throws InputError for one that is not computed from a channel
  void start_lags(const Machine& machine, const std::map<std::size_t, double>& lag_start);

  /// Gives readings the states that were recorded, and lags behind them that have no column of their own.
  /// @param time_s  [poses] or empty
  /// @param poses   gets states; those that it has already stay, and must not be recorded too
  /// @param starts  if not null: lags whose start matters are appended
  /// @throws InputError naming the reading, the channel, and what it covers
  void give(const Machine& machine, const std::vector<double>& time_s, const ReadingRows& rows, PoseList& poses,
            std::vector<UncertainStart>* starts = nullptr) const;

 private:
  std::map<std::size_t, StateChannel> channels_;
  std::map<std::size_t, double> lag_start_;
};

/// Channels that a reader of readings uses.
struct ChannelUse {
  const StateChannels* from = nullptr;            ///< null: none
  std::vector<UncertainStart>* starts = nullptr;  ///< as in StateChannels::give()
};

/// Reads the files of a study and of one of its set-ups. @throws InputError
StateChannels read_channels(const Machine& machine, const ChannelPlan& of_study, const ChannelPlan& of_setup);

}  // namespace abbe
