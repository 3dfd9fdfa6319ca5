// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Channels of a compensation that depends on states (temperatures, loads), as pins of the module.

#include <cstddef>

#include "abbe/runtime/abbe_runtime.h"

#ifndef ABBEKINS_NAME
#define ABBEKINS_NAME "abbekins"
#endif

namespace abbekins {

/// "abbekins: what: detail" on LinuxCNC's own output.
void complain(const char* what, const char* detail);

/// The whole file, by malloc; null if it cannot be read.
unsigned char* read_file(const char* path, size_t& size);

/// Pins of the channels, if the compensation has any, and the states that were stored before.
/// @param stored  path of them; empty: none
/// @param hours   older ones are not used
/// @returns 0, or a negative number that LinuxCNC takes for a failure
int make_states(int component, const abbe_runtime* runtime, const char* stored, int hours);

/// To be called in every servo cycle: reads the pins of the channels.
void advance_states();

/// The compensation at the present states; that which is given where none depends on them.
const abbe_runtime* at_states(const abbe_runtime* runtime);

void free_states();

}  // namespace abbekins
