#include "abbe/formats/nc/nc_codes.h"

#include <cmath>

#include "abbe/formats/nc/nc_units.h"

namespace abbe {
namespace {

NcGroup group_of(NcCode code) {
  switch (code) {
    case 40:
    case 100:
    case 280:
    case 281:
    case 300:
    case 301:
    case 520:
    case 530:
    case 531:
    case 920:
    case 921:
    case 922:
    case 923:
      return NcGroup::non_modal;
    case 0:
    case 10:
    case 20:
    case 30:
    case 330:
    case 331:
    case 730:
    case 740:
    case 800:
    case 810:
    case 820:
    case 830:
    case 840:
    case 850:
    case 860:
    case 890:
      return NcGroup::motion;
    case 170:
    case 180:
    case 190:
      return NcGroup::plane;
    case 900:
    case 910:
      return NcGroup::distance;
    case 901:
    case 911:
      return NcGroup::arc_centre;
    case 930:
    case 940:
    case 950:
      return NcGroup::feed_mode;
    case 200:
    case 210:
      return NcGroup::units;
    case 400:
      return NcGroup::cutter;
    case 430:
    case 431:
    case 432:
    case 434:
    case 490:
      return NcGroup::tool_length;
    case 980:
    case 990:
      return NcGroup::retract;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
    case 591:
    case 592:
    case 593:
      return NcGroup::work_offset;
    case 610:
    case 611:
    case 640:
      return NcGroup::path;
    case 960:
    case 970:
      return NcGroup::spindle;
    case 80:
      return NcGroup::diameter;
    case 682:
    case 690:
      return NcGroup::tilt;
    default:
      return NcGroup::none;
  }
}

/// Why a code is refused that other controls or LinuxCNC know.
const char* reason(NcCode code) {
  switch (code) {
    case 410:
    case 411:
    case 420:
    case 421:
      return "cutter compensation is not handled: its path depends on the tool";
    case 332:
    case 333:
    case 760:
      return "this thread is not handled, only G33, G33.1, and the cycles G74 and G84";
    case 382:
    case 383:
    case 384:
    case 385:
      return "only the control knows where probing ends";
    case 50:
    case 51:
    case 52:
    case 53:
      return "splines are not handled, nor is smoothing by the control (G5.1 Q1)";
    case 70:
      return "diameter programming is not handled";
    case 680:
    case 681:
      return "rotated coordinates are not handled but for tilted planes by G68.2";
    case 683:
    case 684:
      return "a tilted plane defined by the tool direction or by another plane is not handled, only that of G68.2";
    case 533:
    case 536:
      return "turning to a tilted plane while the tool keeps its place is not handled, only G53.1";
    case 870:
    case 880:
      return "this cycle is not handled: it needs the operator or an oriented spindle";
    case 435:
      return "tool centre control by direction vectors is not handled";
    case 500:
    case 510:
      return "scaling, mirroring and limits of the spindle are not handled";
    case 541:
      return "further work offsets are not handled, only G54 to G59.3";
    case 650:
    case 660:
    case 670:
      return "macro calls are not handled, only O words and M98";
    default:
      return "is not a G code that is handled";
  }
}

NcMGroup m_group_of(int code) {
  switch (code) {
    case 0:
    case 1:
    case 2:
    case 30:
    case 60:
    case 98:
    case 99:
      return NcMGroup::stop;
    case 6:
    case 61:
      return NcMGroup::tool;
    case 3:
    case 4:
    case 5:
    case 19:
      return NcMGroup::spindle;
    case 7:
      return NcMGroup::mist;
    case 8:
      return NcMGroup::flood;
    case 9:
      return NcMGroup::no_coolant;
    case 48:
    case 49:
    case 50:
    case 51:
    case 52:
    case 53:
      return NcMGroup::overrides;
    case 62:
    case 63:
    case 64:
    case 65:
    case 66:
    case 67:
    case 68:
      return NcMGroup::signals;
    default:
      return code >= 100 && code <= 199 ? NcMGroup::user : NcMGroup::none;
  }
}

void sort_m_code(NcCodedBlock& block, std::size_t i) {
  const NcWord& word = block.words[i];
  const double rounded = std::round(word.value);
  if (std::abs(word.value - rounded) > 1e-4 || rounded < 0 || rounded > 199) {
    block.fail(word, "is not an M code", "a whole number from 0 to 199");
  }
  const NcMGroup group = m_group_of(static_cast<int>(rounded));
  if (group == NcMGroup::none) {
    block.fail(word,
               rounded >= 70 && rounded <= 73 ? "saving and restoring the modes is not handled"
                                              : "is not an M code that is handled",
               "M0-M9 M19 M30 M48-M53 M60-M68 M98 M99 M100-M199");
  }
  // Mist and flood may stand together, but not beside what stops both.
  const bool is_coolant = group == NcMGroup::mist || group == NcMGroup::flood;
  if (block.has(group) || (is_coolant && block.has(NcMGroup::no_coolant)) ||
      (group == NcMGroup::no_coolant && (block.has(NcMGroup::mist) || block.has(NcMGroup::flood)))) {
    block.fail(word, "a second M code of the same modal group in one block");
  }
  block.m_places[static_cast<std::size_t>(group)] = static_cast<std::uint8_t>(i);
  if (++block.m_count > 4) block.fail(word, "more than four M codes in one block");
}

}  // namespace

std::size_t nc_axis(char letter) {
  switch (letter) {
    case 'x':
      return 0;
    case 'y':
      return 1;
    case 'z':
      return 2;
    case 'a':
      return 3;
    case 'b':
      return 4;
    case 'c':
      return 5;
    case 'u':
      return 6;
    case 'v':
      return 7;
    case 'w':
      return 8;
    default:
      return kAxisWords;
  }
}

void sort_nc_codes(NcCodedBlock& block) {
  block.codes.fill(kNoCode);
  block.axes = 0;
  block.m_places.fill(NcBlock::kNoWord);
  block.m_count = 0;
  block.cancel_place = NcBlock::kNoWord;
  for (std::size_t i = 0; i < block.word_count; ++i) {
    const NcWord& word = block.words[i];
    const std::size_t axis = nc_axis(word.letter);
    if (axis < kAxisWords) {
      block.axes |= std::uint32_t{1} << axis;
    } else if (word.letter == 'm') {
      sort_m_code(block, i);
    } else if (word.letter == 'g') {
      const double tenths = std::round(word.value * 10);
      if (word.value == 234 || word.value == 254) {
        block.fail(word,
                   word.value == 234 ? "tool centre control is not asked for so here"
                                     : "work offsets that turn with the workpiece are not handled",
                   word.value == 234 ? "G43.4 until G49, or --tool-centre for the whole program" : "G68.2, or G43.4");
      }
      if (std::abs(word.value * 10 - tenths) > 1e-3 || tenths < 0 || tenths > 999) {
        block.fail(word, "is not a G code", "G0 to G99.9 in tenths");
      }
      const auto code = static_cast<NcCode>(tenths);
      const auto group = static_cast<std::size_t>(group_of(code));
      if (group == 0) block.fail(word, reason(code), "a code of docs/nc-programs.md");
      // G80 may stand beside the code that goes on.
      std::uint8_t& place = block.places[group];
      if (code == 800 && block.codes[group] != kNoCode) {
        block.cancel_place = static_cast<std::uint8_t>(i);
        continue;
      }
      if (code != 800 && block.codes[group] == 800) {
        block.cancel_place = place;
        block.codes[group] = kNoCode;
      }
      // G53 stands beside the motion that it is for, like no other code of its group; LinuxCNC says the same.
      if (block.codes[group] != kNoCode) block.fail(word, "a second G code of the same modal group in one block");
      block.codes[group] = code;
      place = static_cast<std::uint8_t>(i);
    }
  }
}

}  // namespace abbe
