// As precompiled.h, for the command.
#pragma once

#include <nlohmann/json.hpp>

#include "precompiled.h"
