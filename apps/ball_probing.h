#pragma once

#include <string>
#include <vector>

#include "abbe/study/planning/planned_probing.h"

namespace abbe {

class Subcommand;

/// Options of `abbe program` for touches of a ball.
class BallProbing {
 public:
  /// Adds the options; this object has to live on.
  /// @param dry_run  where the program is not written, its touches are not either
  void add_to(Subcommand* command, const bool* dry_run);

  bool is_wanted() const { return !ball_mm_.empty(); }
  /// Takes what the options say into a request.
  void take(ProbingRequest& request) const;
  const std::string& touches_file() const { return touches_file_; }

 private:
  std::vector<double> ball_mm_;
  std::string log_ = "touches.txt", touches_file_;
  int touches_ = 5;
  double tip_radius_mm_ = 3, before_mm_ = 3, beyond_mm_ = 2, feed_mm_per_min_ = 60;
};

}  // namespace abbe
