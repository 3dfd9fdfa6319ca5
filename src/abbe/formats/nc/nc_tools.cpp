#include "abbe/formats/nc/nc_tools.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/geometry/angle_units.h"

namespace abbe {

NcTools::NcTools(const std::optional<NcToolTable>& table, std::optional<int> in_spindle)
    : has_table_(table.has_value()), in_spindle_(in_spindle) {
  if (!table) return;
  table_ = *table;
  for (auto& [number, offset] : table_) {
    for_axes(kRotaryWords, [&offset = offset](std::size_t k) { offset[k] /= kDegree; });
  }
}

void NcTools::take(const NcCodedBlock& block) {
  if (block.has('t')) selected_ = static_cast<int>(std::lround(block.value('t')));
  if (!block.has(NcMGroup::tool)) return;
  if (block.word(NcMGroup::tool).value == 6) {
    in_spindle_ = selected_;
  } else if (block.has('q')) {
    in_spindle_ = static_cast<int>(std::lround(block.value('q')));
  }
}

void NcTools::set_offset(const NcCodedBlock& block, int number, const NcModes& modes) {
  if (!has_table_) block.fail(block.word(NcGroup::non_modal), "there is no tool table");
  const auto tool = table_.find(number);
  if (tool == table_.end()) block.fail('p', fmt::format("the tool table has no tool {}", number));
  for_axes(block.axes, [&](std::size_t k) { tool->second[k] = modes.length(block, k); });
}

const NcAxisValues& NcTools::from_table(const NcCodedBlock& block) const {
  const NcWord& word = block.word(NcGroup::tool_length);
  if (!has_table_) {
    block.fail(word, "there is no tool table", "a tool table, or the length in the program by G43.1");
  }
  const bool has_number = block.has('h');
  if (has_number && (block.value('h') < 0 || std::abs(block.value('h') - std::round(block.value('h'))) > 1e-4)) {
    block.fail('h', "is not the number of a tool");
  }
  if (!has_number && !in_spindle_) {
    block.fail(word, "it is not known which tool is in the spindle", "H, or T and M6 before it");
  }
  const int number = has_number ? static_cast<int>(std::lround(block.value('h'))) : *in_spindle_;
  const auto tool = table_.find(number);
  if (tool == table_.end()) {
    block.fail(has_number ? block.word('h') : word, fmt::format("the tool table has no tool {}", number));
  }
  return tool->second;
}

NcAxisValues NcTools::offset(const NcCodedBlock& block, const NcModes& modes, const NcAxisValues& before) const {
  const NcCode code = block.code(NcGroup::tool_length);
  const NcWord& word = block.word(NcGroup::tool_length);
  if (code == 490) return {};
  if (code == 430 || code == 434) return from_table(block);
  if (code == 432 && block.has('h') == (block.axes != 0)) {
    block.fail(word, "the offset that is added is not said", "H, or axis words");
  }
  if (code == 431 && block.axes == 0) block.fail(word, "the offset of the tool is missing", "axis words");
  NcAxisValues offset = before;
  if (code == 432 && block.has('h')) {
    const NcAxisValues& added = from_table(block);
    for (std::size_t k = 0; k < kAxisWords; ++k) offset[k] += added[k];
  } else {
    for_axes(block.axes, [&](std::size_t k) {
      const double value = modes.length(block, k);
      offset[k] = code == 432 ? offset[k] + value : value;
    });
  }
  return offset;
}

}  // namespace abbe
