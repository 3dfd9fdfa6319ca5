#include "abbe/compensate/program/program_report.h"

namespace abbe {

bool ProgramPlace::take(const ProgramPlace& other) {
  if (other.line == 0 || (line != 0 && !(other.value > value))) return false;
  *this = other;
  return true;
}

void StatusCount::add(std::size_t at_line) {
  ++count;
  for (std::size_t& known : line) {
    if (known == at_line) return;
    if (known == 0) {
      known = at_line;
      return;
    }
  }
}

void StatusCount::add(const StatusCount& later) {
  const std::size_t before = count;
  for (const std::size_t at_line : later.line) {
    if (at_line != 0) add(at_line);
  }
  count = before + later.count;
}

void ProgramReport::add(const ProgramReport& later) {
  moves += later.moves;
  pieces += later.pieces;
  split_moves += later.split_moves;
  largest_shift.take(later.largest_shift);
  for (std::size_t i = 0; i < by_axis.size(); ++i) by_axis[i].take(later.by_axis[i]);
  largest_orientation_left.take(later.largest_orientation_left);
  for (std::size_t i = 0; i < status.size(); ++i) {
    status[i].add(later.status[i]);
    if (first_place[i].line == 0) first_place[i] = later.first_place[i];
  }
  held_at_travel.add(later.held_at_travel);
  largest_held.take(later.largest_held);
  held_starts.add(later.held_starts);
  largest_held_start.take(later.largest_held_start);
  bent_with_spindle.add(later.bent_with_spindle);
  largest_bend.take(later.largest_bend);
  play_with_spindle.add(later.play_with_spindle);
  not_proven.add(later.not_proven);
  tool_changes.add(later.tool_changes);
  inverse_time.add(later.inverse_time);
  above_limit.add(later.above_limit);
  impossible.add(later.impossible);
  for (std::size_t i = 0; i < take_ups.size(); ++i) {
    take_ups[i].add(later.take_ups[i]);
    direction_unknown[i].add(later.direction_unknown[i]);
  }
}

}  // namespace abbe
