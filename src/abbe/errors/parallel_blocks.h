#pragma once

#include "abbe/geometry/parallel_blocks.h"
