#include "abbe/formats/nc/nc_check_words.h"

#include <cmath>

namespace abbe {
namespace {

/// The code of motion that the words of a block belong to.
NcCode motion_that_runs(const NcCodedBlock& block, NcCode in_force) {
  const NcCode code = block.has(NcGroup::motion) ? block.code(NcGroup::motion) : in_force;
  if (code == 800) return kNoCode;
  if (block.has_free_axes()) return code;
  if (block.has(NcGroup::motion)) return code >= 20 ? code : kNoCode;
  // An arc goes on with its centre alone: a full circle.
  return block.axes == 0 && code >= 20 && code <= 30 && block.has_centre() ? code : kNoCode;
}

void check_every_word(const NcCodedBlock& block, NcCode motion, std::uint32_t machine_words) {
  for_axes(block.axes & ~machine_words,
           [&](std::size_t k) { block.fail(kAxisLetters[k], "the machine has no axis of this word"); });
  const bool is_arc = motion == 20 || motion == 30, is_thread = motion == 330 || motion == 331,
             is_cycle = motion >= 730;
  const bool is_g10 = block.code(NcGroup::non_modal) == 100, is_plane = block.sets_plane();
  const bool is_tool_in_g10 = is_g10 && block.has('l') && block.value('l') == 1;
  const bool calls = block.is_m(NcMGroup::stop, 98);
  const bool is_user = block.has(NcMGroup::user), has_signal = block.has(NcMGroup::signals),
             orients = block.is_m(NcMGroup::spindle, 19);
  const bool waits = block.is_m(NcMGroup::signals, 66),
             is_analog = block.is_m(NcMGroup::signals, 67) || block.is_m(NcMGroup::signals, 68);
  const bool has_step = motion == 730 || motion == 830,
             has_dwell = is_cycle && !has_step && motion != 810 && motion != 850;
  const bool overrides = block.has(NcMGroup::overrides) && block.word(NcMGroup::overrides).value > 49;  // M50 to M53
  const auto only_with = [&](char letter, bool is_used, const char* codes) {
    if (!is_used && block.has(letter)) block.fail(letter, "no code of this block uses it", codes);
  };
  for (const char letter : {'i', 'j', 'k'}) {
    only_with(letter, is_arc || is_plane || (is_tool_in_g10 && letter != 'k') || (is_thread && letter == 'k'),
              "G2, G3 or G68.2");
  }
  only_with('r', is_arc || is_cycle || is_g10 || orients, "G2, G3 or a canned cycle");
  only_with('h',
            block.code(NcGroup::tool_length) >= 430 && block.code(NcGroup::tool_length) != 431 &&
                block.code(NcGroup::tool_length) != 490,
            "G43");
  only_with('l', is_cycle || is_g10 || waits || calls, "G10, a canned cycle, M66 or M98");
  only_with('d', block.code(NcGroup::spindle) == 960, "G96; cutter compensation is not handled");
  only_with('q',
            has_step || is_g10 || waits || is_analog || is_user || block.code(NcGroup::path) == 640 || orients ||
                block.is_m(NcMGroup::tool, 61),
            "G64, G73, G83, M19, M61, M66 or M100-M199");
  only_with('p',
            is_arc || has_dwell || is_g10 || is_user || (has_signal && !is_analog) ||
                block.code(NcGroup::non_modal) == 40 || block.code(NcGroup::path) == 640 || overrides || calls ||
                orients || is_plane || block.code(NcGroup::non_modal) == 531,
            "G2, G3, G4, G10, G64, a canned cycle, M50-M68, M98 or M100-M199");
  only_with('e', waits || is_analog, "M66, M67 or M68");
  if (block.has('f') && block.value('f') < 0) block.fail('f', "the feed is negative");
  if (block.has('s') && block.value('s') < 0) block.fail('s', "the speed of the spindle is negative");
  if (block.has('t')) {
    const double tool = block.value('t');
    if (tool < 0 || std::abs(tool - std::round(tool)) > 1e-4) block.fail('t', "is not the number of a tool");
  }
}

void check_missing_words(const NcCodedBlock& block) {
  const auto needs = [&](const NcWord& word, char letter, const char* expected) {
    if (!block.has(letter)) block.fail(word, "a word of this code is missing", expected);
  };
  if (block.code(NcGroup::spindle) == 960) needs(block.word(NcGroup::spindle), 's', "S, the cutting speed");
  if (block.is_m(NcMGroup::tool, 61)) {
    needs(block.word(NcMGroup::tool), 'q', "Q, the number of the tool");
    if (block.value('q') < 0) block.fail('q', "is not the number of a tool");
  }
  if (!block.has(NcMGroup::signals)) return;
  const NcWord& signal = block.word(NcMGroup::signals);
  if (signal.value <= 65) needs(signal, 'p', "P, the number of the output");
  if (signal.value >= 67) {
    needs(signal, 'e', "E, the number of the output");
    if (block.value('e') < 0) block.fail('e', "is not the number of an output");
  }
  if (signal.value == 66 && block.has('p') == block.has('e')) {
    block.fail(signal, "it is not said which input is waited for", "P or E");
  }
}

void check_plane_words(const NcCodedBlock& block, const NcState& state, const PlaneKinematics* planes) {
  const NcModes& modes = state.modes;
  const bool is_tilted = state.position.plane().has_value();
  const NcCode tilt = block.code(NcGroup::tilt);
  const NcCode other = block.code(NcGroup::non_modal);
  if ((tilt == 682 || (is_tilted && tilt == 690) || other == 531) && modes.motion >= 730 && modes.motion != 800) {
    block.fail(block.word(other == 531 ? NcGroup::non_modal : NcGroup::tilt),
               "a canned cycle is in force, which would continue in another plane", "G80 before it");
  }
  if (tilt == 682) {
    const NcWord& word = block.word(NcGroup::tilt);
    for (std::size_t i = 0; i < block.word_count; ++i) {
      const NcWord& beside = block.words[i];
      if (beside.letter == 'g' && &beside != &word) {
        block.fail(beside, "another G code in a block with G68.2", "a block of its own");
      }
      if (beside.letter == 'p' && beside.value != 0) {
        block.fail(beside, "this form of G68.2 is not handled", "P0, or no P: Euler angles I, J, K");
      }
      if (beside.letter == 'q' || beside.letter == 'r' || beside.letter == 'l' || beside.letter == 'd') {
        block.fail(beside, "this form of G68.2 is not handled", "X Y Z I J K");
      }
    }
    if ((block.axes & ~kXyzWords) != 0) block.fail(word, "G68.2 with words of other axes", "X Y Z I J K");
    if (block.has(NcMGroup::stop)) block.fail(word, "G68.2 with a stop", "a block of its own");
    if (!modes.absolute) block.fail(word, "G68.2 in incremental distances", "G90");
    if (is_tilted) block.fail(word, "a tilted plane in a tilted plane", "G69 before it");
    if (planes == nullptr) block.fail(word, "the machine is not known, which a tilted plane needs");
    if (!planes->problem().empty()) {
      block.fail(word, "the machine has no tilted planes: " + planes->problem());
    }
  }
  if (other == 531) {
    const NcWord& word = block.word(NcGroup::non_modal);
    if (!is_tilted) block.fail(word, "there is no tilted plane", "G68.2 before it");
    if (block.axes != 0 || block.has(NcGroup::motion) || block.has(NcGroup::tool_length)) {
      block.fail(word, "G53.1 with axis words, a motion or a tool length", "a block of its own");
    }
    if (block.has('p')) block.fail('p', "choosing the solution is not handled", "G53.1 without P");
  }
  if (!is_tilted) return;
  const auto refuse = [&](const NcWord& word) {
    block.fail(word, "is not handled while a plane is tilted", "G69 before it");
  };
  if (block.has(NcGroup::work_offset)) refuse(block.word(NcGroup::work_offset));
  if (other != kNoCode && other != 40 && other != 530 && other != 531) refuse(block.word(NcGroup::non_modal));
  if (tilt == 690 && (block.axes != 0 || other != kNoCode)) {
    block.fail(block.word(NcGroup::tilt), "G69 with axis words or codes that move", "a block of its own");
  }
  if (block.has(NcGroup::tool_length)) return;
  for_axes(block.axes & ~kXyzWords, [&](std::size_t k) {
    block.fail(kAxisLetters[k], "moves another axis than X, Y, Z while a plane is tilted", "G53.1, or G69 before it");
  });
}

/// One code takes the axis words, and a motion is there for those that no other takes.
void check_use_of_axes(const NcCodedBlock& block, NcCode motion) {
  const bool sets_offset = block.sets_offset(), to_reference = block.goes_to_reference();
  const bool tool_length = block.says_tool_length();
  if (sets_offset || to_reference || (tool_length && block.axes != 0)) {
    if (block.has(NcGroup::motion) && block.code(NcGroup::motion) != 800) {
      block.fail(block.word(NcGroup::motion), "two codes of this block use the axis words");
    }
    if (static_cast<int>(sets_offset) + static_cast<int>(to_reference) + static_cast<int>(tool_length) > 1) {
      block.fail(block.word(NcGroup::tool_length), "two codes of this block use the axis words");
    }
  }
  if (motion == kNoCode && block.has_free_axes()) {
    const auto first = static_cast<std::size_t>(std::countr_zero(block.axes));
    block.fail(kAxisLetters[first], "axis words without a code that uses them", "G0, G1, G2, G3 or a canned cycle");
  }
}

}  // namespace

NcCode check_nc_words(const NcCodedBlock& block, const NcState& state, const PlaneKinematics* planes) {
  const NcCode motion = motion_that_runs(block, state.modes.motion);
  check_every_word(block, motion, state.position.machine_words());
  check_missing_words(block);
  if (state.position.plane() || block.has(NcGroup::tilt) || block.code(NcGroup::non_modal) == 531) {
    check_plane_words(block, state, planes);
  }
  check_use_of_axes(block, motion);
  // I, J and K are its angles, not the centre of a circle.
  return block.sets_plane() ? kNoCode : motion;
}

void check_subprogram_words(const NcCodedBlock& block, const NcWord& word) {
  for (std::size_t i = 0; i < block.word_count; ++i) {
    const NcWord& beside = block.words[i];
    if (&beside == &word || (word.value == 98 && (beside.letter == 'p' || beside.letter == 'l'))) continue;
    block.fail(beside, "is given together with M98 or M99, which have no other words", "a block of its own before it");
  }
  if (!block.assignments.empty()) {
    block.fail(word, "a parameter is set beside M98 or M99", "a block of its own before it");
  }
}

}  // namespace abbe
