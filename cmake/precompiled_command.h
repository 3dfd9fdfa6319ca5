// As precompiled.h, for the command.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "precompiled.h"
