// Whether every word of a block belongs to a code of it, and every code has its words, as LinuxCNC 2.9 asks.
#include <cmath>
#include <string_view>

#include "abbe/formats/nc/nc_interpreter.h"

namespace abbe {

NcCode NcInterpreter::motion_that_runs() const {
  const NcCode code = codes_.has(NcGroup::motion) ? codes_[NcGroup::motion] : modes_.motion;
  if (code == 800) return kNoCode;
  const NcCode other = codes_[NcGroup::non_modal], tool_length = codes_[NcGroup::tool_length];
  const bool taken = codes_[NcGroup::tilt] == 682 || other == 100 || other == 520 || other == 920 || other == 280 ||
                     other == 300 || tool_length == 431 || (tool_length == 432 && !block_.has('h'));
  if (codes_.axes != 0 && !taken) return code;
  if (codes_.has(NcGroup::motion)) return code >= 20 ? code : kNoCode;
  // An arc goes on with its centre alone: a full circle.
  const bool is_circle =
      codes_.axes == 0 && code >= 20 && code <= 30 && (block_.has('i') || block_.has('j') || block_.has('k'));
  return is_circle ? code : kNoCode;
}

void NcInterpreter::check_words() const {
  for (std::size_t k = 0; k < kAxisWords; ++k) {
    if ((codes_.axes & ~machine_words_ & (std::uint32_t{1} << k)) != 0) {
      block_.fail("xyzabcuvw"[k], "the machine has no axis of this word");
    }
  }
  const NcCode motion = motion_that_runs();
  const bool is_arc = motion == 20 || motion == 30, is_thread = motion == 330 || motion == 331,
             is_cycle = motion >= 730;
  const bool is_g10 = codes_[NcGroup::non_modal] == 100, is_plane = codes_[NcGroup::tilt] == 682;
  const bool is_tool_in_g10 = is_g10 && block_.has('l') && block_.value('l') == 1;
  const bool calls = codes_.is_m(block_, NcMGroup::stop, 98);
  const bool is_user = codes_.has(NcMGroup::user), has_signal = codes_.has(NcMGroup::signals),
             orients = codes_.is_m(block_, NcMGroup::spindle, 19);
  const bool waits = codes_.is_m(block_, NcMGroup::signals, 66),
             is_analog = codes_.is_m(block_, NcMGroup::signals, 67) || codes_.is_m(block_, NcMGroup::signals, 68);
  const bool has_step = motion == 730 || motion == 830,
             has_dwell = is_cycle && !has_step && motion != 810 && motion != 850;
  const bool overrides =
      codes_.has(NcMGroup::overrides) && codes_.word(block_, NcMGroup::overrides).value > 49;  // M50 to M53
  const auto only_with = [&](char letter, bool is_used, const char* codes) {
    if (!is_used && block_.has(letter)) block_.fail(letter, "no code of this block uses it", codes);
  };
  for (const char letter : {'i', 'j', 'k'}) {
    only_with(letter, is_arc || is_plane || (is_tool_in_g10 && letter != 'k') || (is_thread && letter == 'k'),
              "G2, G3 or G68.2");
  }
  only_with('r', is_arc || is_cycle || is_g10 || orients, "G2, G3 or a canned cycle");
  only_with(
      'h',
      codes_[NcGroup::tool_length] >= 430 && codes_[NcGroup::tool_length] != 431 && codes_[NcGroup::tool_length] != 490,
      "G43");
  only_with('l', is_cycle || is_g10 || waits || calls, "G10, a canned cycle, M66 or M98");
  only_with('d', codes_[NcGroup::spindle] == 960, "G96; cutter compensation is not handled");
  only_with('q',
            has_step || is_g10 || waits || is_analog || is_user || codes_[NcGroup::path] == 640 || orients ||
                codes_.is_m(block_, NcMGroup::tool, 61),
            "G64, G73, G83, M19, M61, M66 or M100-M199");
  only_with('p',
            is_arc || has_dwell || is_g10 || is_user || (has_signal && !is_analog) ||
                codes_[NcGroup::non_modal] == 40 || codes_[NcGroup::path] == 640 || overrides || calls || orients ||
                is_plane || codes_[NcGroup::non_modal] == 531,
            "G2, G3, G4, G10, G64, a canned cycle, M50-M68, M98 or M100-M199");
  only_with('e', waits || is_analog, "M66, M67 or M68");
  if (block_.has('f') && block_.value('f') < 0) block_.fail('f', "the feed is negative");
  if (block_.has('s') && block_.value('s') < 0) block_.fail('s', "the speed of the spindle is negative");
  if (block_.has('t')) {
    const double tool = block_.value('t');
    if (tool < 0 || std::abs(tool - std::round(tool)) > 1e-4) block_.fail('t', "is not the number of a tool");
  }
  check_missing_words();
}

void NcInterpreter::check_missing_words() const {
  const auto needs = [&](const NcWord& word, char letter, const char* expected) {
    if (!block_.has(letter)) block_.fail(word, "a word of this code is missing", expected);
  };
  if (codes_[NcGroup::spindle] == 960) needs(codes_.word(block_, NcGroup::spindle), 's', "S, the cutting speed");
  if (codes_.is_m(block_, NcMGroup::tool, 61)) {
    needs(codes_.word(block_, NcMGroup::tool), 'q', "Q, the number of the tool");
    if (block_.value('q') < 0) block_.fail('q', "is not the number of a tool");
  }
  if (!codes_.has(NcMGroup::signals)) return;
  const NcWord& signal = codes_.word(block_, NcMGroup::signals);
  if (signal.value <= 65) needs(signal, 'p', "P, the number of the output");
  if (signal.value >= 67) {
    needs(signal, 'e', "E, the number of the output");
    if (block_.value('e') < 0) block_.fail('e', "is not the number of an output");
  }
  if (signal.value == 66 && block_.has('p') == block_.has('e')) {
    block_.fail(signal, "it is not said which input is waited for", "P or E");
  }
}

}  // namespace abbe
