#include "ball_probing.h"

#include "options.h"

namespace abbe {

void BallProbing::add_to(Subcommand* command, const bool* dry_run) {
  const std::string group = "Touches of a ball (LinuxCNC)";
  Option* const ball =
      command
          ->add_option("--probe-ball-mm", ball_mm_,
                       "Touch a ball on the table instead, at the rotary positions of the readings: its centre in the "
                       "workpiece frame and its radius")
          ->expected(4)
          ->type_name("X Y Z RADIUS")
          ->group(group);
  // Of no use for touches.
  for (const char* other : {"--sheet", "--trigger", "--trigger-number", "--reading-s", "--pulse-s", "--stop-at",
                            "--shorten", "--start", "--machine-coordinates"}) {
    ball->excludes(other);
  }
  const auto length = [&](const char* name, double& value, const char* words) {
    command->add_option(name, value, words)
        ->check(in_range(1e-3, 1e4))
        ->capture_default_str()
        ->needs("--probe-ball-mm")
        ->group(group);
  };
  length("--tip-radius-mm", tip_radius_mm_, "Radius of the stylus tip, whose centre is the functional point");
  length("--pre-touch-mm", before_mm_, "Distance from the tip to the ball where a touch begins");
  length("--over-travel-mm", beyond_mm_, "Distance beyond the surface of the ball at which the control gives up");
  length("--probing-feed-mm-per-min", feed_mm_per_min_, "Feed of a touch");
  command->add_option("--touches-per-ball", touches_, "One along the tool, the others around it")
      ->check(in_range(4, 99))
      ->capture_default_str()
      ->needs("--probe-ball-mm")
      ->group(group);
  command->add_option("--probe-log", log_, "File that the control is to write (PROBEOPEN)")
      ->capture_default_str()
      ->needs("--probe-ball-mm")
      ->group(group);
  command
      ->add_output_file("--touches", touches_file_,
                        "Touches to write (*.csv); abbe import needs them to turn the log into readings", dry_run)
      ->needs("--probe-ball-mm")
      ->group(group);
}

void BallProbing::take(ProbingRequest& request) const {
  request.ball_centre = {ball_mm_[0], ball_mm_[1], ball_mm_[2]};
  request.ball_radius = ball_mm_[3];
  request.tip_radius = tip_radius_mm_;
  request.touches = static_cast<std::size_t>(touches_);
  request.before = before_mm_;
  request.beyond = beyond_mm_;
  request.program.probing_feed = feed_mm_per_min_ / 60;
  request.program.log = log_;
}

}  // namespace abbe
